//! PNG pictures, in.

use crate::source::read_bytes;
use crate::{Error, Result};
use std::path::Path;

/// A grey picture; row 0 is the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Gray {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Code values as a share of white, 0–1, row after row.
    pub pixels: Vec<f64>,
}

/// Reads a PNG of 8 or 16 bits as grey values; colours become their luma, transparency is ignored.
///
/// # Errors
/// If the file cannot be read or is no whole PNG.
pub fn read_gray(path: &Path) -> Result<Gray> {
    let bytes = read_bytes(path)?;
    let picture = image::load_from_memory_with_format(&bytes, image::ImageFormat::Png)
        .map_err(|error| {
            Error::new(path, format!("is not a PNG picture: {error}"))
                .fix("check that this is the right file and that it was not cut; save it as PNG again")
        })?
        .into_luma16();
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let pixels = picture.into_raw().into_iter().map(|value| f64::from(value) / f64::from(u16::MAX)).collect();
    Ok(Gray { width, height, pixels })
}
