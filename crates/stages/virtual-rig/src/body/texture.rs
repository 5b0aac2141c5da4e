//! Reflectance of a scan's vertices, from its picture.

use mesh::{Mesh, NO_UV};
use nalgebra::Vector2;

/// Linear reflectance of skin where a scan has no picture.
pub const SKIN: [f32; 3] = [0.50, 0.36, 0.29];

/// A decoded picture, in linear light.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    width: usize,
    height: usize,
    linear: Vec<[f32; 3]>,
}

/// A picture whose bytes do not make one.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("a picture of {width} × {height} pixels takes {} bytes of RGB, not {bytes}", 3 * width * height)]
pub struct TextureError {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Bytes given.
    pub bytes: usize,
}

impl Texture {
    /// A picture from its sRGB bytes: three per pixel, rows from the top.
    ///
    /// # Errors
    /// If the bytes do not fill the picture, or it is empty.
    pub fn from_srgb(width: usize, height: usize, rgb: &[u8]) -> Result<Self, TextureError> {
        if rgb.is_empty() || rgb.len() != 3 * width * height {
            return Err(TextureError { width, height, bytes: rgb.len() });
        }
        let table: Vec<f32> = (0..=255).map(linear_from_srgb).collect();
        let pixel = |pixel: &[u8]| [0, 1, 2].map(|channel| table[usize::from(pixel[channel])]);
        Ok(Self { width, height, linear: rgb.chunks_exact(3).map(pixel).collect() })
    }

    /// The linear colour at a texture coordinate (v up), bilinear between the centres of pixels. Every UDIM tile shows
    /// the picture anew; beyond the outermost centres the colour stays.
    #[must_use]
    pub fn at(&self, uv: Vector2<f64>) -> [f32; 3] {
        let (x, right, left_share) = neighbours(within_tile(uv.x), self.width);
        let (y, below, upper_share) = neighbours(1.0 - within_tile(uv.y), self.height);
        let pixel = |x: usize, y: usize| self.linear[y * self.width + x];
        std::array::from_fn(|channel| {
            let row =
                |y: usize| left_share * pixel(x, y)[channel] + (1.0 - left_share) * pixel(right, y)[channel];
            upper_share * row(y) + (1.0 - upper_share) * row(below)
        })
    }

    /// Linear reflectance per vertex: the mean over the texture coordinates of its corners, so that both sides of a
    /// seam count; [`SKIN`] where a vertex has none.
    #[must_use]
    pub fn albedo(&self, mesh: &Mesh) -> Vec<[f32; 3]> {
        let mut sums = vec![([0.0f32; 3], 0u16); mesh.positions.len()];
        for (&vertex, &uv) in mesh.polygons.corners().iter().zip(&mesh.corner_uvs) {
            if uv != NO_UV {
                let (sum, count) = &mut sums[vertex as usize];
                let color = self.at(mesh.uvs[uv as usize]);
                (0..3).for_each(|channel| sum[channel] += color[channel]);
                *count += 1;
            }
        }
        let mean = |(sum, count): ([f32; 3], u16)| match count {
            0 => SKIN,
            count => sum.map(|channel| channel / f32::from(count)),
        };
        sums.into_iter().map(mean).collect()
    }
}

/// IEC 61966-2-1.
fn linear_from_srgb(byte: u8) -> f32 {
    let x = f64::from(byte) / 255.0;
    (if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }) as f32
}

/// A coordinate within its tile; the upper edge of a tile belongs to it.
fn within_tile(x: f64) -> f64 {
    if x <= 0.0 { x - x.floor() } else { x - (x.ceil() - 1.0) }
}

/// The pixels on both sides of a place (0 to 1), and the share of the first.
fn neighbours(at: f64, count: usize) -> (usize, usize, f32) {
    let pixel = (at * count as f64 - 0.5).clamp(0.0, (count - 1) as f64);
    let first = pixel.floor();
    (first as usize, (first as usize + 1).min(count - 1), (1.0 - (pixel - first)) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Red, green / blue, white.
    fn four() -> Texture {
        Texture::from_srgb(2, 2, &[255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255]).expect("four pixels")
    }

    #[test]
    fn v_runs_up_and_tiles_repeat() {
        assert_eq!(four().at(Vector2::new(0.25, 0.75)), [1.0, 0.0, 0.0]);
        assert_eq!(four().at(Vector2::new(0.25, 0.25)), [0.0, 0.0, 1.0]);
        assert_eq!(four().at(Vector2::new(1.75, 0.75)), [0.0, 1.0, 0.0]);
        assert_eq!(four().at(Vector2::new(1.0, 1.0)), [0.0, 1.0, 0.0], "the corner belongs to its tile");
    }

    #[test]
    fn colours_mix_in_linear_light() {
        let grey = Texture::from_srgb(2, 1, &[0, 0, 0, 255, 255, 255]).expect("two pixels");
        assert_eq!(grey.at(Vector2::new(0.5, 0.5)), [0.5; 3]);
        let one = Texture::from_srgb(1, 1, &[188, 188, 188]).expect("a pixel");
        assert!((one.at(Vector2::zeros())[0] - 0.5029).abs() < 1e-3);
    }

    #[test]
    fn bytes_must_fill_the_picture() {
        let error = Texture::from_srgb(2, 2, &[0; 11]).expect_err("one byte is missing");
        assert_eq!(error.to_string(), "a picture of 2 × 2 pixels takes 12 bytes of RGB, not 11");
    }
}
