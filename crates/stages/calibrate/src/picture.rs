//! A picture of a calibration: per camera where corners were seen, how far each is off, and what of the image was never shown.

use crate::Residual;
use crate::report::{CELLS, cell};
use artifact::canvas::{Canvas, Color, FontError};
use artifact::{CameraRig, RigCamera};

/// Width of a camera's panel.
const PANEL_PX: usize = 460;
const MARGIN_PX: usize = 16;
const CAPTION_PX: usize = 26;
const TEXT_PX: f32 = 18.0;
/// Length in the picture of a residual as long as the rig's RMS, px.
const ARROW_PX: f64 = 12.0;
/// The longest arrow: gross errors would hide all else.
const LONGEST_PX: f64 = 60.0;

const INK: Color = [40, 44, 52];
const COVERED: Color = [231, 239, 246];
const EMPTY: Color = [247, 222, 205];
const ARROW: Color = [31, 95, 153];
const OUTLIER: Color = [206, 40, 40];
/// Weight under which an arrow has the outliers' colour.
const OUTLIER_WEIGHT: f64 = 0.5;

/// Per camera its image with the cells that no corner fell into tinted, and at each corner an arrow along its residual; how
/// much arrows are enlarged stands below. Outliers are red.
///
/// # Errors
/// If the font is damaged.
pub fn draw(rig: &CameraRig, residuals: &[Residual]) -> Result<Canvas, FontError> {
    let columns = rig.cameras.len().clamp(1, 4);
    let rows = rig.cameras.len().div_ceil(columns).max(1);
    let tallest =
        rig.cameras.values().map(|camera| panel_height(camera.camera.image_size)).max().unwrap_or(0);
    let cell = [PANEL_PX + MARGIN_PX, tallest + CAPTION_PX + MARGIN_PX];
    let size = [columns * cell[0] + MARGIN_PX, rows * cell[1] + MARGIN_PX + CAPTION_PX];
    let mut sheet = Canvas::new(size[0], size[1])?;
    let squares: f64 = residuals.iter().map(|residual| residual.error.norm_squared()).sum();
    let rms = (squares / residuals.len().max(1) as f64).sqrt().max(f64::MIN_POSITIVE);
    for (i, (id, camera)) in rig.cameras.iter().enumerate() {
        let at = [MARGIN_PX + i % columns * cell[0], MARGIN_PX + i / columns * cell[1]];
        let own: Vec<&Residual> = residuals.iter().filter(|residual| residual.camera == *id).collect();
        panel(&mut sheet, camera, &own, [at[0], at[1] + CAPTION_PX], ARROW_PX / rms);
        let rms_px = camera.rms_px.map_or("nothing seen".to_string(), |rms| format!("rms {rms:.3} px"));
        sheet.write_tall(&format!("{id}: {rms_px}, {} corners", own.len()), at, TEXT_PX, INK);
    }
    let legend = format!(
        "an arrow of {ARROW_PX} px is {rms:.3} px long in the image; red: outliers; tinted: no corner was here"
    );
    sheet.write_tall(&legend, [MARGIN_PX, size[1] - CAPTION_PX], TEXT_PX, INK);
    Ok(sheet)
}

fn panel_height([width, height]: [u32; 2]) -> usize {
    PANEL_PX * height as usize / width.max(1) as usize
}

fn panel(sheet: &mut Canvas, rig: &RigCamera, own: &[&Residual], at: [usize; 2], arrow_scale: f64) {
    let image_size = rig.camera.image_size;
    let scale = PANEL_PX as f64 / f64::from(image_size[0]);
    let height = panel_height(image_size);
    let covered: std::collections::BTreeSet<[usize; 2]> =
        own.iter().filter_map(|residual| cell(image_size, residual)).collect();
    for y in 0..height {
        for x in 0..PANEL_PX {
            let cell = [x * CELLS[0] / PANEL_PX, y * CELLS[1] / height.max(1)];
            let color = if covered.contains(&cell) { COVERED } else { EMPTY };
            sheet.blend([at[0] + x, at[1] + y], color, 1.0);
        }
    }
    for residual in own {
        let from = (residual.pixel.add_scalar(0.5) * scale).add_scalar(-0.5);
        let arrow = residual.error * arrow_scale;
        let arrow = arrow * (LONGEST_PX / arrow.norm().max(LONGEST_PX));
        let start = [at[0] as f64 + from.x, at[1] as f64 + from.y];
        let color = if residual.weight < OUTLIER_WEIGHT { OUTLIER } else { ARROW };
        sheet.line(start, [start[0] + arrow.x, start[1] + arrow.y], color);
        sheet.blend(start.map(|x| x.round().max(0.0) as usize), INK, 1.0);
    }
}
