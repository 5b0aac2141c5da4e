//! Pictures for people: rectangles and captions on white, in Ubuntu Light (Ubuntu Font Licence 1.0, which allows a program to
//! carry the font). Behind the feature `canvas`.

use ab_glyph::{Font, FontRef, GlyphId, ScaleFont, point};

/// Red, green, blue.
pub type Color = [u8; 3];

/// The built-in font is damaged.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the built-in font is damaged")]
pub struct FontError;

/// Height of captions, px.
const CAPTION: f32 = 13.0;

/// Writes in the built-in font.
#[derive(Clone)]
pub struct Pen {
    font: FontRef<'static>,
}

impl Pen {
    /// A pen.
    ///
    /// # Errors
    /// If the font is damaged.
    pub fn new() -> Result<Self, FontError> {
        let font = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).map_err(|_| FontError)?;
        Ok(Self { font })
    }

    /// Width of a text whose lines are `height` pixels high.
    #[must_use]
    pub fn width(&self, text: &str, height: f32) -> f32 {
        self.lay(text, height, |_, _| {})
    }

    /// Writes a text from its upper left corner on, lines `height` pixels high: passes column, row and cover, 0 to 1, of each
    /// pixel that a letter touches, also of those beyond the upper left edge.
    pub fn write(&self, text: &str, at: [f32; 2], height: f32, mut ink: impl FnMut(i64, i64, f64)) {
        let baseline = at[1] + self.font.as_scaled(height).ascent();
        self.lay(text, height, |glyph, advance| {
            let placed = glyph.with_scale_and_position(height, point(at[0] + advance, baseline));
            let Some(outline) = self.font.outline_glyph(placed) else { return };
            let corner = outline.px_bounds().min;
            outline.draw(|x, y, cover| {
                let place = [x as i64 + corner.x as i64, y as i64 + corner.y as i64];
                ink(place[0], place[1], f64::from(cover).clamp(0.0, 1.0));
            });
        });
    }

    /// Shortens a text with an ellipsis until it fits.
    #[must_use]
    pub fn fitted(&self, text: &str, height: f32, room: f32) -> String {
        if self.width(text, height) <= room {
            return text.to_string();
        }
        let mut kept: Vec<char> = text.chars().collect();
        while kept.pop().is_some() {
            let shorter: String = kept.iter().collect::<String>() + "…";
            if self.width(&shorter, height) <= room {
                return shorter;
            }
        }
        String::new()
    }

    /// Passes each glyph with its distance from the start; returns the whole width.
    fn lay(&self, text: &str, height: f32, mut place: impl FnMut(GlyphId, f32)) -> f32 {
        let scaled = self.font.as_scaled(height);
        let mut advance = 0.0;
        let mut previous = None;
        for letter in text.chars() {
            let glyph = self.font.glyph_id(letter);
            advance += previous.map_or(0.0, |previous| scaled.kern(previous, glyph));
            place(glyph, advance);
            advance += scaled.h_advance(glyph);
            previous = Some(glyph);
        }
        advance
    }
}

/// A picture in the making.
pub struct Canvas {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of each pixel, row after row from the top.
    pub rgb: Vec<u8>,
    pen: Pen,
}

impl Canvas {
    /// A white picture.
    ///
    /// # Errors
    /// If the font is damaged.
    pub fn new(width: usize, height: usize) -> Result<Self, FontError> {
        Ok(Self { width, height, rgb: vec![255; 3 * width * height], pen: Pen::new()? })
    }

    /// Fills a rectangle; what lies outside the picture is cut off.
    pub fn fill(&mut self, [x, y]: [usize; 2], [width, height]: [usize; 2], color: Color) {
        for row in y..(y + height).min(self.height) {
            for column in x..(x + width).min(self.width) {
                self.blend([column, row], color, 1.0);
            }
        }
    }

    /// Writes a caption from its upper left corner on.
    pub fn write(&mut self, text: &str, at: [usize; 2], color: Color) {
        self.write_tall(text, at, CAPTION, color);
    }

    /// Writes a text from its upper left corner on, lines `height` pixels high.
    pub fn write_tall(&mut self, text: &str, [x, y]: [usize; 2], height: f32, color: Color) {
        let pen = self.pen.clone();
        pen.write(text, [x as f32, y as f32], height, |column, row, cover| {
            if let (Ok(column), Ok(row)) = (usize::try_from(column), usize::try_from(row)) {
                self.blend([column, row], color, cover);
            }
        });
    }

    /// Draws a thin line between two places: steps of half a pixel, each of which covers the pixels around it by their distance.
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], color: Color) {
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let steps = (2.0 * length).ceil().max(1.0) as usize;
        for step in 0..=steps {
            let share = step as f64 / steps as f64;
            let at = [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let (x, y) = (at[0].floor() + f64::from(dx), at[1].floor() + f64::from(dy));
                let cover = (1.0 - (at[0] - x).abs()).max(0.0) * (1.0 - (at[1] - y).abs()).max(0.0);
                if x >= 0.0 && y >= 0.0 {
                    self.blend([x as usize, y as usize], color, LINE * cover);
                }
            }
        }
    }

    /// Lays a colour over a pixel, 0: none of it, 1: nothing else; a pixel outside the picture is left out.
    pub fn blend(&mut self, [x, y]: [usize; 2], color: Color, share: f64) {
        if x >= self.width || y >= self.height {
            return;
        }
        let first = 3 * (y * self.width + x);
        for (old, new) in self.rgb[first..first + 3].iter_mut().zip(color) {
            *old = (f64::from(*old) * (1.0 - share) + f64::from(new) * share).round() as u8;
        }
    }
}

/// Cover of a line's step: about two of them lie in each pixel.
const LINE: f64 = 0.7;
