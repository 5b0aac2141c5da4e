//! Pictures to look at: classified pixels and curves over the image.

use crate::bits::Bits;
use crate::light::Picture;
use artifact::canvas::{Canvas, FontError};
use artifact::{Curve2d, CurveState};

/// An image to draw on, in a picture that may hold several.
pub struct Drawing<'a> {
    /// The picture.
    pub canvas: &'a mut Canvas,
    /// Its place in the picture, px.
    pub corner: [usize; 2],
    /// Size of an image's pixel in the picture.
    pub scale: f64,
}

const EDGE: [u8; 3] = [255, 255, 255];
const PAPER: [u8; 3] = [24, 24, 24];

impl Drawing<'_> {
    /// Puts in an image.
    pub fn image(&mut self, picture: &Picture, codes: &[u8]) {
        let size = self.size(picture);
        for y in 0..size[1] {
            for x in 0..size[0] {
                let [column, row] = [(x, picture.width), (y, picture.height)]
                    .map(|(at, most)| ((at as f64 / self.scale) as usize).min(most - 1));
                let first = 3 * (row * picture.width + column);
                self.set([x, y], [codes[first], codes[first + 1], codes[first + 2]]);
            }
        }
    }

    /// How large an image is in the picture, px.
    #[must_use]
    pub fn size(&self, picture: &Picture) -> [usize; 2] {
        [picture.width, picture.height].map(|side| (side as f64 * self.scale) as usize)
    }

    /// The outline of some pixels.
    pub fn outline(&mut self, bits: &Bits) {
        let inner = bits.eroded();
        for row in 0..bits.height {
            for column in 0..bits.width {
                let at = [column as i64, row as i64];
                if bits.get(at[0], at[1]) && !inner.get(at[0], at[1]) {
                    self.dot([column as f64, row as f64], EDGE);
                }
            }
        }
    }

    /// A curve with its id; thin where it is only held.
    pub fn curve(&mut self, id: &str, curve: &Curve2d) {
        let controls: Vec<crate::Place> = curve.controls.iter().map(|at| (*at).into()).collect();
        let color = tint(id);
        let steps = 1 + (64.0 * self.scale.max(1.0)) as usize * controls.len();
        let places = crate::spline::sampled(&controls, steps);
        for (index, place) in places.iter().enumerate() {
            // Dashes say that a curve was kept from before.
            if curve.state == CurveState::Held && index / 48 % 2 == 1 {
                continue;
            }
            self.dot([place.x, place.y], color);
            self.dot([place.x, place.y + 1.0 / self.scale], color);
        }
        let end = places[places.len() - 1];
        let at = [end.x, end.y].map(|x| (x * self.scale).max(0.0) as usize + 3);
        self.write(id, at, color);
    }

    /// A text on dark ground, at a place in the image's part of the picture.
    pub fn write(&mut self, text: &str, [x, y]: [usize; 2], color: [u8; 3]) {
        let width = 7 * text.chars().count() + 4;
        let x = x.min(self.canvas.width.saturating_sub(self.corner[0] + width));
        let y = y.min(self.canvas.height.saturating_sub(self.corner[1] + 17));
        let at = [self.corner[0] + x, self.corner[1] + y];
        self.canvas.fill(at, [width, 16], PAPER);
        self.canvas.write(text, [at[0] + 2, at[1]], color);
    }

    fn dot(&mut self, at: [f64; 2], color: [u8; 3]) {
        let place = at.map(|x| (x + 0.5) * self.scale);
        if place.iter().all(|x| *x >= 0.0) {
            self.set(place.map(|x| x as usize), color);
        }
    }

    fn set(&mut self, [x, y]: [usize; 2], color: [u8; 3]) {
        self.canvas.fill([self.corner[0] + x, self.corner[1] + y], [1, 1], color);
    }
}

impl Drawing<'_> {
    /// An empty dark picture.
    ///
    /// # Errors
    /// If the font is damaged.
    pub fn sheet(width: usize, height: usize) -> Result<Canvas, FontError> {
        let mut canvas = Canvas::new(width, height)?;
        canvas.fill([0, 0], [width, height], PAPER);
        Ok(canvas)
    }
}

/// A bright colour that an id always has.
#[must_use]
pub fn tint(id: &str) -> [u8; 3] {
    let number = id.bytes().fold(17_u64, |sum, byte| sum.wrapping_mul(31).wrapping_add(byte.into()));
    let hue = (number.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / f64::from(1 << 24) * 6.0;
    [0.0, 4.0, 2.0].map(|turn| {
        let share = (((hue + turn) % 6.0) - 3.0).abs() - 1.0;
        (90.0 + 165.0 * share.clamp(0.0, 1.0)) as u8
    })
}
