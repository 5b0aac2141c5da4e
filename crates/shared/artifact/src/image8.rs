//! Colour images of 8 bits, as stages search and measure them.

/// A colour image of 8 bits; row 0 is the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image8 {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of each pixel, row after row.
    pub rgb: Vec<u8>,
}

impl Image8 {
    /// To look at.
    #[must_use]
    pub fn picture(&self) -> Picture<'_> {
        Picture { width: self.width, height: self.height, rgb: &self.rgb }
    }
}

/// Values that make no picture.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{values} values make no picture of {} × {} pixels", .size[0], .size[1])]
pub struct NoPicture {
    /// Width, height.
    pub size: [usize; 2],
    /// How many values there are.
    pub values: usize,
}

/// A colour image of 8 bits, borrowed; row 0 is the top, pixel (0, 0) is the centre of the top-left pixel.
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
    /// [`NoPicture`] if the values make none of that size.
    pub fn new(width: usize, height: usize, rgb: &'a [u8]) -> Result<Self, NoPicture> {
        match width > 0 && height > 0 && width.checked_mul(height).is_some_and(|n| 3 * n == rgb.len()) {
            true => Ok(Self { width, height, rgb }),
            false => Err(NoPicture { size: [width, height], values: rgb.len() }),
        }
    }

    /// Red, green and blue of a pixel.
    ///
    /// # Panics
    /// If it lies outside the picture.
    #[must_use]
    #[inline(always)]
    pub fn at(&self, x: usize, y: usize) -> [u8; 3] {
        let first = 3 * (y * self.width + x);
        [self.rgb[first], self.rgb[first + 1], self.rgb[first + 2]]
    }

    /// Whether a place lies on the image: within half a pixel of a pixel's centre.
    #[must_use]
    pub fn contains(&self, at: [f64; 2]) -> bool {
        (-0.5..self.width as f64 - 0.5).contains(&at[0]) && (-0.5..self.height as f64 - 0.5).contains(&at[1])
    }
}
