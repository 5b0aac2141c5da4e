//! What is kept of an image to find its time: its light, a coarse picture, a fingerprint.

use artifact::Transfer;
use std::sync::LazyLock;

/// Columns and rows of the coarse picture.
const GRID: [usize; 2] = [16, 12];
/// Cells of the coarse picture.
pub const CELL_COUNT: usize = GRID[0] * GRID[1];

/// What is kept of an image.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Mean light, linear, as a share of white.
    pub light: f64,
    /// Mean code value of 16 × 12 cells, as a share of white, row after row.
    pub cells: Vec<f32>,
    /// Equal for images of equal pixels.
    pub fingerprint: u64,
}

impl Reading {
    /// Reads an image: `rgb` holds red, green, blue of each pixel, row after row.
    ///
    /// # Panics
    /// If the number of values is not that of the size.
    #[must_use]
    pub fn of(width: usize, height: usize, rgb: &[u8]) -> Self {
        assert_eq!(rgb.len(), 3 * width * height, "an image has 3 × width × height values");
        let (mut light, mut fingerprint) = (0.0, 0xcbf2_9ce4_8422_2325_u64);
        let (mut sums, mut counts) = (vec![0_u64; CELL_COUNT], vec![0_u64; CELL_COUNT]);
        for (row, pixels) in rgb.chunks_exact((3 * width).max(1)).enumerate() {
            let first = row * GRID[1] / height * GRID[0];
            for (column, pixel) in pixels.chunks_exact(3).enumerate() {
                let cell = first + column * GRID[0] / width;
                sums[cell] += pixel.iter().map(|&code| u64::from(code)).sum::<u64>();
                counts[cell] += 3;
                light += LINEAR[usize::from(pixel[1])];
                let word = u64::from(pixel[0]) | u64::from(pixel[1]) << 8 | u64::from(pixel[2]) << 16;
                // FNV-1a, a pixel at a time.
                fingerprint = (fingerprint ^ word).wrapping_mul(0x0100_0000_01b3);
            }
        }
        let mean = |(sum, count): (u64, u64)| sum as f32 / (255 * count.max(1)) as f32;
        let cells = sums.into_iter().zip(counts).map(mean).collect();
        Self { light: light / (width * height).max(1) as f64, cells, fingerprint }
    }

    /// Root mean square difference of the coarse pictures.
    #[must_use]
    pub fn distance(&self, other: &Self) -> f64 {
        let squares = self.cells.iter().zip(&other.cells).map(|(a, b)| f64::from(a - b).powi(2));
        (squares.sum::<f64>() / CELL_COUNT as f64).sqrt()
    }
}

/// Light of each 8-bit code by sRGB's curve: exact for sRGB, near enough for its kin to see a flash.
static LINEAR: LazyLock<[f64; 256]> = LazyLock::new(|| Transfer::Srgb.light_of_codes());
