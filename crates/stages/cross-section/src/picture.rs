//! The images that are searched.

use crate::Error;

/// An 8-bit colour image, borrowed; row 0 is the top, pixel (0, 0) is the centre of the top-left pixel.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of each pixel, row after row.
    pub rgb: &'a [u8],
}

impl<'a> Picture<'a> {
    /// # Errors
    /// [`Error::Pixels`] if the values make no picture of that size.
    pub fn new(width: usize, height: usize, rgb: &'a [u8]) -> Result<Self, Error> {
        match width > 0 && height > 0 && width.checked_mul(height).is_some_and(|n| 3 * n == rgb.len()) {
            true => Ok(Self { width, height, rgb }),
            false => Err(Error::Pixels { size: [width, height], values: rgb.len() }),
        }
    }

    #[inline(always)]
    pub(crate) fn at(&self, x: usize, y: usize) -> [u8; 3] {
        let first = 3 * (y * self.width + x);
        [self.rgb[first], self.rgb[first + 1], self.rgb[first + 2]]
    }

    /// Whether a place lies on the image: within half a pixel of a pixel's centre.
    #[must_use]
    pub fn contains(&self, at: [f64; 2]) -> bool {
        (-0.5..self.width as f64 - 0.5).contains(&at[0]) && (-0.5..self.height as f64 - 0.5).contains(&at[1])
    }
}
