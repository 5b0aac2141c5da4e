//! Images as they are measured.

use artifact::picture::Rgb;
use cross_section::Picture;
use stage::CameraImages;
use std::path::Path;

/// An image in 8 bits.
pub(crate) struct Image {
    width: usize,
    height: usize,
    codes: Vec<u8>,
}

impl Image {
    /// Reads an image, which must have the size that is stated.
    pub(crate) fn read(images: &CameraImages, path: &Path) -> anyhow::Result<Self> {
        let Rgb { width, height, codes } = images.read(path)?;
        let codes = match codes {
            artifact::picture::Codes::Bits8(codes) => codes,
            codes => Rgb { width, height, codes }.to_8_bits(),
        };
        Ok(Self { width, height, codes })
    }

    pub(crate) fn picture(&self) -> Result<Picture<'_>, cross_section::Error> {
        Picture::new(self.width, self.height, &self.codes)
    }
}
