//! Pictures to look at: dots with numbers, tracks with tails.

use crate::{Error, Picture};
use artifact::canvas;

/// Width and height of a digit's ground, px.
const DIGIT: [usize; 2] = [7, 14];
/// Brightness of the ground of numbers, code.
const DARK: u8 = 20;
/// A number begins so far right of its place, px.
const NUMBER_BESIDE: i64 = 5;

/// A picture to draw on: an image, enlarged.
#[derive(Debug, Clone)]
pub struct Canvas {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of each pixel.
    pub rgb: Vec<u8>,
    scale: usize,
}

impl Canvas {
    /// An image, each of its pixels `scale` × `scale` large.
    #[must_use]
    pub fn enlarged(picture: &Picture, scale: usize) -> Self {
        let scale = scale.max(1);
        let (width, height) = (picture.width * scale, picture.height * scale);
        let mut rgb = Vec::with_capacity(3 * width * height);
        for y in 0..height {
            rgb.extend((0..width).flat_map(|x| picture.at(x / scale, y / scale)));
        }
        Self { width, height, rgb, scale }
    }

    /// Canvases in rows, one below the other; the ground where they leave room is dark.
    #[must_use]
    pub fn sheet(rows: &[Vec<Self>]) -> Self {
        let width = rows.iter().map(|row| row.iter().map(|tile| tile.width).sum()).max().unwrap_or(0);
        let heights: Vec<usize> =
            rows.iter().map(|row| row.iter().map(|tile| tile.height).max().unwrap_or(0)).collect();
        let height = heights.iter().sum();
        let mut sheet = Self { width, height, rgb: vec![24; 3 * width * height], scale: 1 };
        let mut top = 0;
        for (row, row_height) in rows.iter().zip(heights) {
            let mut left = 0;
            for tile in row {
                for (y, line) in tile.rgb.chunks_exact(3 * tile.width).enumerate() {
                    let first = 3 * ((top + y) * width + left);
                    sheet.rgb[first..first + line.len()].copy_from_slice(line);
                }
                left += tile.width;
            }
            top += row_height;
        }
        sheet
    }

    /// A place of the image on the canvas.
    fn place(&self, at: [f64; 2]) -> [f64; 2] {
        at.map(|x| (x + 0.5) * self.scale as f64 - 0.5)
    }

    fn set(&mut self, x: i64, y: i64, color: [u8; 3]) {
        if (0..self.width as i64).contains(&x) && (0..self.height as i64).contains(&y) {
            let first = 3 * (y as usize * self.width + x as usize);
            self.rgb[first..first + 3].copy_from_slice(&color);
        }
    }

    /// A line between two places of the image.
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], color: [u8; 3]) {
        let (from, to) = (self.place(from), self.place(to));
        let steps = (to[0] - from[0]).abs().max((to[1] - from[1]).abs()).ceil().clamp(1.0, 1e5);
        for step in 0..=steps as usize {
            let share = step as f64 / steps;
            let [x, y] = [0, 1].map(|k| (from[k] + share * (to[k] - from[k])).round() as i64);
            self.set(x, y, color);
        }
    }

    /// A cross of `half` canvas pixels to each side.
    pub fn cross(&mut self, at: [f64; 2], half: i64, color: [u8; 3]) {
        let [x, y] = self.place(at).map(|x| x.round() as i64);
        for step in -half..=half {
            self.set(x + step, y, color);
            self.set(x, y + step, color);
        }
    }

    /// A number beside a place of the image, on a dark ground.
    ///
    /// # Errors
    /// [`Error::Font`] if the built-in font is damaged.
    pub fn number(&mut self, at: [f64; 2], number: usize, color: [u8; 3]) -> Result<(), Error> {
        let [x, y] = self.place(at).map(|x| x.round() as i64 + NUMBER_BESIDE);
        let text = number.to_string();
        let mut label = canvas::Canvas::new(DIGIT[0] * text.len() + 2, DIGIT[1])?;
        label.rgb.fill(DARK);
        label.write(&text, [1, 0], color);
        for (index, pixel) in label.rgb.chunks_exact(3).enumerate() {
            let [column, row] = [index % label.width, index / label.width].map(|k| k as i64);
            self.set(x + column, y + row - DIGIT[1] as i64 - NUMBER_BESIDE, [pixel[0], pixel[1], pixel[2]]);
        }
        Ok(())
    }
}
