//! Pictures for people: rectangles and captions on white, in Ubuntu Light (Ubuntu Font Licence 1.0, which allows a program to
//! carry the font). Behind the feature `canvas`.

use ab_glyph::{Font, FontRef, ScaleFont, point};

/// Red, green, blue.
pub type Color = [u8; 3];

/// The built-in font is damaged.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the built-in font is damaged")]
pub struct FontError;

/// Height of captions, px.
const CAPTION: f32 = 13.0;

/// A picture in the making.
pub struct Canvas {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of each pixel, row after row from the top.
    pub rgb: Vec<u8>,
    font: FontRef<'static>,
}

impl Canvas {
    /// A white picture.
    ///
    /// # Errors
    /// If the font is damaged.
    pub fn new(width: usize, height: usize) -> Result<Self, FontError> {
        let font = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).map_err(|_| FontError)?;
        Ok(Self { width, height, rgb: vec![255; 3 * width * height], font })
    }

    /// Fills a rectangle; what lies outside the picture is cut off.
    pub fn fill(&mut self, [x, y]: [usize; 2], [width, height]: [usize; 2], color: Color) {
        for row in y..(y + height).min(self.height) {
            for column in x..(x + width).min(self.width) {
                self.blend([column, row], color, 1.0);
            }
        }
    }

    /// Writes a text from its upper left corner on.
    pub fn write(&mut self, text: &str, [x, y]: [usize; 2], color: Color) {
        let font = self.font.clone();
        let scaled = font.as_scaled(CAPTION);
        let (mut advance, baseline) = (x as f32, y as f32 + scaled.ascent());
        for letter in text.chars() {
            let glyph = font.glyph_id(letter);
            let placed = glyph.with_scale_and_position(CAPTION, point(advance, baseline));
            advance += scaled.h_advance(glyph);
            let Some(outline) = font.outline_glyph(placed) else { continue };
            let corner = outline.px_bounds().min;
            outline.draw(|dx, dy, cover| {
                let at = [corner.x + dx as f32, corner.y + dy as f32];
                let inside = at[0] >= 0.0 && at[1] >= 0.0;
                if inside && (at[0] as usize) < self.width && (at[1] as usize) < self.height {
                    self.blend(at.map(|x| x as usize), color, f64::from(cover).clamp(0.0, 1.0));
                }
            });
        }
    }

    fn blend(&mut self, [x, y]: [usize; 2], color: Color, share: f64) {
        let first = 3 * (y * self.width + x);
        for (old, new) in self.rgb[first..first + 3].iter_mut().zip(color) {
            *old = (f64::from(*old) * (1.0 - share) + f64::from(new) * share).round() as u8;
        }
    }
}
