//! The images whose paint somebody marked.

use super::shots::{Shot, first_image};
use anyhow::{Context, bail};
use artifact::picture::{Marked, is_subsampled, read_marked};
use stage::{CameraImages, Footage, Run};
use std::path::{Path, PathBuf};
use wrinkle_track::{Error, MarkedPaint, labels, marked_paints};

/// Arguments that name marked images.
#[derive(clap::Args)]
pub(crate) struct MaskSource {
    /// Folder with a PNG per camera, <camera>.png: the paint of one image marked in a colour per paint, on black or transparent
    /// ground
    #[arg(long, value_name = "FOLDER")]
    masks: PathBuf,
    /// Frame whose images are marked [default: the first image of each camera]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    mask_frame: Option<i64>,
}

/// A marked image.
pub(crate) struct MaskedShot {
    pub(crate) camera: String,
    pub(crate) images: CameraImages,
    /// Place of the frame among all.
    pub(crate) index: usize,
    pub(crate) shot: Shot,
    pub(crate) mask: Marked,
    pub(crate) mask_path: PathBuf,
}

impl MaskedShot {
    pub(crate) fn labels(&self, paints: &[MarkedPaint]) -> Vec<u8> {
        labels(&self.mask, paints)
    }
}

impl MaskSource {
    pub(crate) fn folder(&self) -> &Path {
        &self.masks
    }

    /// The marked images, by camera.
    pub(crate) fn read(&self, run: &mut Run, footage: &Footage) -> anyhow::Result<Vec<MaskedShot>> {
        let mut shots = Vec::new();
        for name in artifact::files(&self.masks)? {
            let Some(camera) = name.strip_suffix(".png") else { continue };
            let path = self.masks.join(&name);
            let images = footage
                .camera(camera)
                .with_context(|| format!("{}: is named after no camera of the images", path.display()))?;
            shots.push(self.shot(run, footage, camera, images, path)?);
        }
        if shots.is_empty() {
            bail!(
                "{}: has no <camera>.png\n  to do: save a marked image per camera there, for {}",
                self.masks.display(),
                footage.ids().into_iter().cloned().collect::<Vec<_>>().join(", ")
            );
        }
        Ok(shots)
    }

    fn shot(
        &self,
        run: &mut Run,
        footage: &Footage,
        camera: &str,
        images: CameraImages,
        path: PathBuf,
    ) -> anyhow::Result<MaskedShot> {
        let mask = read_marked(&path)?;
        run.input(&format!("mask {camera}"), &path)?;
        let Some((index, image)) = first_image(&footage.numbers(), &images, self.mask_frame) else {
            let frame = self.mask_frame.map_or("any frame".to_string(), |frame| format!("frame {frame}"));
            bail!("{}, camera {camera}: has no image of {frame}", footage.path().display());
        };
        let shot = Shot::read(&images, image)?;
        run.input(&format!("image {camera}"), image)?;
        let (mask_size, size) = ([mask.width, mask.height], [shot.picture.width, shot.picture.height]);
        if mask_size != size {
            return Err(Error::MaskSize { mask: mask_size, image: size })
                .with_context(|| path.display().to_string());
        }
        if mask.marks.iter().all(Option::is_none) {
            return Err(Error::EmptyMask).with_context(|| path.display().to_string());
        }
        if is_subsampled(shot.picture.width, shot.picture.levels.as_flattened()) == Some(true) {
            run.warn(format!(
                "camera {camera}: colours look as if they were stored at half the size of the image (4:2:0 or 4:2:2), which blurs the edges of paint; film or export without chroma subsampling"
            ));
        }
        Ok(MaskedShot { camera: camera.to_string(), images, index, shot, mask, mask_path: path })
    }
}

/// The paints of all masks.
pub(crate) fn paints_of(
    shots: &[MaskedShot],
    named: &[MarkedPaint],
    folder: &Path,
) -> anyhow::Result<Vec<MarkedPaint>> {
    let masks: Vec<Marked> = shots.iter().map(|shot| shot.mask.clone()).collect();
    marked_paints(&masks, named).with_context(|| folder.display().to_string())
}
