//! Images on their way from the disk to the eye.

use anyhow::Context;
use artifact::picture::Rgb;
use stage::CameraImages;
use std::path::Path;
use wrinkle_track::{FLOOR, Picture};

/// A camera's image, and its codes in 8 bits for people.
pub(crate) struct Shot {
    pub(crate) picture: Picture,
    pub(crate) rgb: Rgb,
}

impl Shot {
    pub(crate) fn read(images: &CameraImages, path: &Path) -> anyhow::Result<Self> {
        let rgb = images.read(path)?;
        let picture =
            Picture::new(&rgb, images.transfer, FLOOR).with_context(|| path.display().to_string())?;
        Ok(Self { picture, rgb })
    }
}

/// The place among the frames, and the image, of a camera's first image or of a frame that is asked for.
pub(crate) fn first_image<'a>(
    numbers: &[i64],
    images: &'a CameraImages,
    frame: Option<i64>,
) -> Option<(usize, &'a Path)> {
    let is_wanted = |index: &usize| frame.is_none_or(|frame| numbers[*index] == frame);
    let index = (0..numbers.len()).find(|index| is_wanted(index) && images.paths[*index].is_some())?;
    Some((index, images.paths[index].as_deref()?))
}
