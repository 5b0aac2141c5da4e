//! `cross-section show`.

use super::options::Options;
use anyhow::bail;
use artifact::canvas::{Canvas, Color};
use artifact::picture::write_rgb8;
use artifact::{Curve2d, Section, SectionState};
use cross_section::{ImageSections, Measured, Painted};
use stage::Run;
use std::path::PathBuf;

const MEASURED: Color = [90, 255, 90];
const FLAT: Color = [255, 220, 60];
const FAILED: Color = [255, 70, 60];
const DATA: Color = [60, 110, 190];
const MODEL: Color = [220, 60, 40];
const INK: Color = [70, 70, 70];
const AXIS: Color = [215, 215, 215];
/// Size of a chart, px, and the room for its caption.
const CHART: [usize; 2] = [300, 190];
const CAPTION: usize = 20;
/// Charts in a row, at these shares of the wrinkle's length; each shows this share of it to both sides.
const PLACES: [f64; 3] = [0.25, 0.5, 0.75];
const NEAR_PX: f64 = 4.0;

/// Draws the sections of an image over it, and charts of measured and fitted light across the wrinkles
///
/// Measured sections are green, from rim to rim; flat ones yellow; failed ones red.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    options: Options,
    /// Camera whose image is drawn
    #[arg(long, value_name = "ID")]
    camera: String,
    /// Frame to draw
    #[arg(long, value_name = "FRAME", allow_negative_numbers = true)]
    frame: i64,
    /// Enlargement of the image
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=8))]
    scale: u8,
    /// Picture of the sections over the image, PNG
    #[arg(long, value_name = "FILE", required_unless_present = "profiles")]
    out: Option<PathBuf>,
    /// Picture of the light across the wrinkles, PNG: measured blue, fitted red
    #[arg(long, value_name = "FILE")]
    profiles: Option<PathBuf>,
}

/// A wrinkle to draw.
struct Shown {
    id: String,
    painted: Painted,
    measured: Measured,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("show");
    let material = arguments.options.read(run)?;
    let (id, number) = (&arguments.camera, arguments.frame);
    let Some(view) = material.views.get(id) else {
        bail!("no camera is called {id}\n  to do: name one of {}", material.header.cameras.join(", "));
    };
    let curves =
        material.frames.iter().find(|frame| frame.frame == number).and_then(|frame| frame.curves.get(id));
    let (Some(curves), Some(path)) = (curves, view.images.get(&number)) else {
        bail!("camera {id} has no image or no curves of frame {number}");
    };
    let image = view.camera.read_8_bits(path)?;
    let picture = image.picture();
    let light = view.camera.transfer.light_of_codes();
    let paths: Vec<&Curve2d> = curves.values().collect();
    let face = match &material.geometry {
        Some(geometry) => geometry.face(geometry.cursor()?.as_mut(), number)?.map(|face| (geometry, face)),
        None => None,
    };
    let surface = face.as_ref().and_then(|(geometry, face)| geometry.surface(id, face));
    let found = ImageSections::of(&picture, &light, &paths, surface.as_ref(), &material.params);
    let albedo = found.albedo;
    let all: Vec<Section> = found.wrinkles.iter().flat_map(|wrinkle| &wrinkle.sections).copied().collect();
    let shown = curves.keys().zip(found.wrinkles).filter_map(|(id, wrinkle)| {
        let (painted, measured) = wrinkle.paint?;
        Some(Shown { id: id.clone(), painted, measured })
    });
    let shown: Vec<Shown> = shown.collect();
    let mut outputs = Vec::new();
    if let Some(path) = &arguments.out {
        let mut canvas = enlarged(&picture, arguments.scale.into())?;
        for section in &all {
            draw_section(&mut canvas, section, arguments.scale.into());
        }
        outputs.push(write_rgb8(path, canvas.width, canvas.height, &canvas.rgb)?);
    }
    if let Some(path) = &arguments.profiles {
        let canvas = sheet(&shown)?;
        outputs.push(write_rgb8(path, canvas.width, canvas.height, &canvas.rgb)?);
    }
    run.result("wrinkles", shown.len());
    run.result("albedo", albedo);
    run.publish(outputs)
}

fn enlarged(picture: &cross_section::Picture<'_>, scale: usize) -> anyhow::Result<Canvas> {
    let mut canvas = Canvas::new(picture.width * scale, picture.height * scale)?;
    for y in 0..picture.height {
        for x in 0..picture.width {
            let first = 3 * (y * picture.width + x);
            let color = [picture.rgb[first], picture.rgb[first + 1], picture.rgb[first + 2]];
            canvas.fill([x * scale, y * scale], [scale, scale], color);
        }
    }
    Ok(canvas)
}

fn draw_section(canvas: &mut Canvas, section: &Section, scale: f64) {
    let place = |p: f64| [0, 1].map(|k| (section.at[k] + p * section.normal[k] + 0.5) * scale - 0.5);
    let (color, half) = match section.state {
        SectionState::Failed => (FAILED, 0.0),
        SectionState::Flat => (FLAT, 0.0),
        SectionState::Measured | SectionState::Edited => (MEASURED, section.w_px),
    };
    if half > 0.0 {
        line(canvas, place(-half), place(half), color);
    }
    dot(canvas, place(0.0), 2, if half > 0.0 { [255, 255, 255] } else { color });
}

fn dot(canvas: &mut Canvas, at: [f64; 2], size: usize, color: Color) {
    if at.iter().all(|x| *x >= 0.0) {
        canvas.fill(at.map(|x| x.round() as usize), [size, size], color);
    }
}

fn line(canvas: &mut Canvas, from: [f64; 2], to: [f64; 2], color: Color) {
    let steps = (to[0] - from[0]).abs().max((to[1] - from[1]).abs()).ceil().clamp(1.0, 1e5);
    for step in 0..=steps as usize {
        let share = step as f64 / steps;
        dot(canvas, [0, 1].map(|k| from[k] + share * (to[k] - from[k])), 1, color);
    }
}

/// A row of charts per wrinkle.
fn sheet(shown: &[Shown]) -> anyhow::Result<Canvas> {
    let row = CHART[1] + CAPTION;
    let mut canvas = Canvas::new(PLACES.len() * CHART[0], shown.len().max(1) * row)?;
    for (number, shown) in shown.iter().enumerate() {
        for (column, place) in PLACES.into_iter().enumerate() {
            chart(&mut canvas, shown, place, [column * CHART[0], number * row]);
        }
    }
    Ok(canvas)
}

fn chart(canvas: &mut Canvas, shown: &Shown, place: f64, corner: [usize; 2]) {
    let Shown { id, painted: Painted { curve, band, .. }, measured } = shown;
    let x = place * curve.len();
    let at = ((measured.sections.len() - 1) as f64 * place).round() as usize;
    let section = &measured.sections[at];
    let caption = match section.state {
        SectionState::Measured => {
            format!("{id}: w {:.1} px, d/w {:.2}", section.w_px, section.d_px / section.w_px)
        }
        SectionState::Flat => format!("{id}: flat"),
        SectionState::Failed | SectionState::Edited => format!("{id}: failed"),
    };
    canvas.write(&caption, [corner[0] + 8, corner[1] + 2], INK);
    let near: Vec<usize> =
        (0..band.pixels.len()).filter(|&i| (band.pixels[i].x - x).abs() < NEAR_PX).collect();
    let reach = near.iter().map(|&i| band.pixels[i].p.abs()).fold(5.0, f64::max);
    let lights = near.iter().flat_map(|&i| [band.pixels[i].light, measured.model[i]]);
    let (low, high) = lights.fold((0.95f64, 1.02f64), |(low, high), light| (low.min(light), high.max(light)));
    let [width, height] = CHART.map(|side| side as f64 - 20.0);
    let spot = |p: f64, light: f64| {
        let share = [0.5 + 0.5 * p / reach, (high - light) / (high - low)];
        [
            corner[0] as f64 + 10.0 + share[0] * width,
            corner[1] as f64 + CAPTION as f64 + 5.0 + share[1] * height,
        ]
    };
    line(canvas, spot(0.0, low), spot(0.0, high), AXIS);
    line(canvas, spot(-reach, 1.0), spot(reach, 1.0), AXIS);
    for &i in &near {
        dot(canvas, spot(band.pixels[i].p, band.pixels[i].light), 2, DATA);
    }
    for &i in &near {
        dot(canvas, spot(band.pixels[i].p, measured.model[i]), 2, MODEL);
    }
}
