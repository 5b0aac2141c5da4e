//! Captions, in Ubuntu Light (Ubuntu Font Licence 1.0, which allows a program to carry the font).

use crate::Error;
use crate::dots::blend;
use ab_glyph::{Font, FontRef, ScaleFont, point};
use image::RgbImage;

/// Writes text into pictures.
pub struct Pen {
    font: FontRef<'static>,
}

impl Pen {
    /// A pen with the built-in font.
    ///
    /// # Errors
    /// [`Error::Font`] if the font is damaged.
    pub fn new() -> Result<Self, Error> {
        let font = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).map_err(|_| Error::Font)?;
        Ok(Self { font })
    }

    /// Width of a text whose lines are `height` pixels high.
    #[must_use]
    pub fn width(&self, text: &str, height: f32) -> f32 {
        self.lay(text, height, |_, _| {})
    }

    /// Writes a text from its upper left corner on, lines `height` pixels high.
    pub fn write(&self, picture: &mut RgbImage, text: &str, at: [f32; 2], height: f32, color: [u8; 3]) {
        let scaled = self.font.as_scaled(height);
        let baseline = at[1] + scaled.ascent();
        self.lay(text, height, |glyph, advance| {
            let placed = glyph.with_scale_and_position(height, point(at[0] + advance, baseline));
            let Some(outline) = self.font.outline_glyph(placed) else { return };
            let corner = outline.px_bounds().min;
            outline.draw(|x, y, cover| {
                let (x, y) = (x as i64 + corner.x as i64, y as i64 + corner.y as i64);
                let inside = x >= 0 && y >= 0 && x < picture.width().into() && y < picture.height().into();
                if inside {
                    blend(picture.get_pixel_mut(x as u32, y as u32), color, f64::from(cover).clamp(0.0, 1.0));
                }
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
    fn lay(&self, text: &str, height: f32, mut place: impl FnMut(ab_glyph::GlyphId, f32)) -> f32 {
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
