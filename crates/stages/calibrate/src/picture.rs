//! A picture of a calibration: per camera where corners were seen, how far each is off, and what of the image was never shown.

use crate::Residual;
use crate::report::{CELLS, cell};
use ab_glyph::{Font, FontRef, ScaleFont, point};
use artifact::{CameraRig, RigCamera};

/// A picture of 8 bits.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Sheet {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of each pixel, row after row from the top.
    pub rgb: Vec<u8>,
}

/// The built-in font is damaged.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the built-in font is damaged")]
pub struct FontError;

/// Width of a camera's panel.
const PANEL_PX: usize = 460;
const MARGIN_PX: usize = 16;
const CAPTION_PX: usize = 26;
const TEXT_PX: f32 = 18.0;
/// Length in the picture of a residual as long as the rig's RMS, px.
const ARROW_PX: f64 = 12.0;
/// The longest arrow: gross errors would hide all else.
const LONGEST_PX: f64 = 60.0;

const PAPER: [u8; 3] = [255, 255, 255];
const INK: [u8; 3] = [40, 44, 52];
const COVERED: [u8; 3] = [231, 239, 246];
const EMPTY: [u8; 3] = [247, 222, 205];
const ARROW: [u8; 3] = [31, 95, 153];
const OUTLIER: [u8; 3] = [206, 40, 40];
/// Weight under which an arrow has the outliers' colour.
const OUTLIER_WEIGHT: f64 = 0.5;

/// Per camera its image with the cells that no corner fell into tinted, and at each corner an arrow along its residual; how
/// much arrows are enlarged stands below. Outliers are red.
///
/// # Errors
/// If the font is damaged.
pub fn draw(rig: &CameraRig, residuals: &[Residual]) -> Result<Sheet, FontError> {
    let font = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT).map_err(|_| FontError)?;
    let columns = rig.cameras.len().clamp(1, 4);
    let rows = rig.cameras.len().div_ceil(columns).max(1);
    let tallest =
        rig.cameras.values().map(|camera| panel_height(camera.camera.image_size)).max().unwrap_or(0);
    let cell = [PANEL_PX + MARGIN_PX, tallest + CAPTION_PX + MARGIN_PX];
    let size = [columns * cell[0] + MARGIN_PX, rows * cell[1] + MARGIN_PX + CAPTION_PX];
    let mut sheet = Sheet { width: size[0], height: size[1], rgb: PAPER.repeat(size[0] * size[1]) };
    let squares: f64 = residuals.iter().map(|residual| residual.error.norm_squared()).sum();
    let rms = (squares / residuals.len().max(1) as f64).sqrt().max(f64::MIN_POSITIVE);
    for (i, (id, camera)) in rig.cameras.iter().enumerate() {
        let at = [MARGIN_PX + i % columns * cell[0], MARGIN_PX + i / columns * cell[1]];
        let own: Vec<&Residual> = residuals.iter().filter(|residual| residual.camera == *id).collect();
        sheet.panel(camera, &own, [at[0], at[1] + CAPTION_PX], ARROW_PX / rms);
        let rms_px = camera.rms_px.map_or("nothing seen".to_string(), |rms| format!("rms {rms:.3} px"));
        sheet.text(&font, &format!("{id}: {rms_px}, {} corners", own.len()), [at[0] as f32, at[1] as f32]);
    }
    let legend = format!(
        "an arrow of {ARROW_PX} px is {rms:.3} px long in the image; red: outliers; tinted: no corner was here"
    );
    sheet.text(&font, &legend, [MARGIN_PX as f32, (size[1] - CAPTION_PX) as f32]);
    Ok(sheet)
}

fn panel_height([width, height]: [u32; 2]) -> usize {
    PANEL_PX * height as usize / width.max(1) as usize
}

impl Sheet {
    fn panel(&mut self, rig: &RigCamera, own: &[&Residual], at: [usize; 2], arrow_scale: f64) {
        let image_size = rig.camera.image_size;
        let scale = PANEL_PX as f64 / f64::from(image_size[0]);
        let height = panel_height(image_size);
        let covered: std::collections::BTreeSet<[usize; 2]> =
            own.iter().filter_map(|residual| cell(image_size, residual)).collect();
        for y in 0..height {
            for x in 0..PANEL_PX {
                let cell = [x * CELLS[0] / PANEL_PX, y * CELLS[1] / height.max(1)];
                let color = if covered.contains(&cell) { COVERED } else { EMPTY };
                self.blend([at[0] + x, at[1] + y], color, 1.0);
            }
        }
        for residual in own {
            let from = (residual.pixel.add_scalar(0.5) * scale).add_scalar(-0.5);
            let arrow = residual.error * arrow_scale;
            let arrow = arrow * (LONGEST_PX / arrow.norm().max(LONGEST_PX));
            let start = [at[0] as f64 + from.x, at[1] as f64 + from.y];
            let color = if residual.weight < OUTLIER_WEIGHT { OUTLIER } else { ARROW };
            self.line(start, [start[0] + arrow.x, start[1] + arrow.y], color);
            self.blend([start[0].round().max(0.0) as usize, start[1].round().max(0.0) as usize], INK, 1.0);
        }
    }

    fn blend(&mut self, [x, y]: [usize; 2], color: [u8; 3], share: f64) {
        if x >= self.width || y >= self.height {
            return;
        }
        let first = 3 * (y * self.width + x);
        for (below, above) in self.rgb[first..first + 3].iter_mut().zip(color) {
            *below = (f64::from(*below) + share * (f64::from(above) - f64::from(*below))).round() as u8;
        }
    }

    /// A thin line, by steps of half a pixel that each cover the pixels around them by their distance.
    fn line(&mut self, from: [f64; 2], to: [f64; 2], color: [u8; 3]) {
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let steps = (2.0 * length).ceil().max(1.0) as usize;
        for step in 0..=steps {
            let share = step as f64 / steps as f64;
            let at = [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
            for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let (x, y) = (at[0].floor() + f64::from(dx), at[1].floor() + f64::from(dy));
                let cover = (1.0 - (at[0] - x).abs()).max(0.0) * (1.0 - (at[1] - y).abs()).max(0.0);
                if x >= 0.0 && y >= 0.0 {
                    self.blend([x as usize, y as usize], color, 0.7 * cover);
                }
            }
        }
    }

    fn text(&mut self, font: &FontRef, text: &str, at: [f32; 2]) {
        let scaled = font.as_scaled(TEXT_PX);
        let baseline = at[1] + scaled.ascent();
        let mut advance = at[0];
        for letter in text.chars() {
            let glyph = scaled.glyph_id(letter);
            let placed = glyph.with_scale_and_position(TEXT_PX, point(advance, baseline));
            advance += scaled.h_advance(glyph);
            let Some(outline) = font.outline_glyph(placed) else { continue };
            let corner = outline.px_bounds().min;
            outline.draw(|x, y, cover| {
                let (x, y) = (f64::from(corner.x) + f64::from(x), f64::from(corner.y) + f64::from(y));
                if x >= 0.0 && y >= 0.0 {
                    self.blend([x as usize, y as usize], INK, f64::from(cover).clamp(0.0, 1.0));
                }
            });
        }
    }
}
