//! `wrinkle-track show`.

use super::shots::Shot;
use anyhow::bail;
use artifact::canvas::Canvas;
use artifact::picture::write_rgb8;
use artifact::{FrameRange, FrameReader, PaintModel, Wrinkles2d, Wrinkles2dFrame};
use stage::{CameraImages, Footage, ImageSource, Run};
use std::path::{Path, PathBuf};
use wrinkle_track::{Classifier, Drawing, TrackParams, tidied};

/// Draws valley curves and classified paint over the images; curves that are only kept from before are dashed
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: ImageSource,
    /// Curves to draw (wrinkles-2d)
    #[arg(long, value_name = "FILE")]
    curves: PathBuf,
    /// Outline what this model takes for paint (paint-model)
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Cameras whose images are drawn [default: all that have curves]
    #[arg(long, value_name = "ID,...", value_delimiter = ',')]
    camera: Vec<String>,
    /// Frames to draw
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    range: Option<FrameRange>,
    /// Size of the pictures, as a share of the images'
    #[arg(long, value_name = "SHARE", default_value_t = 1.0)]
    scale: f64,
    /// Folder to write into, <camera>/<frame>.png; must not exist, or be empty
    #[arg(long, value_name = "FOLDER", required_unless_present = "sheet")]
    out: Option<PathBuf>,
    /// One picture of it all: a row per camera, frames spread over the range
    #[arg(long, value_name = "FILE")]
    sheet: Option<PathBuf>,
    /// Frames on the sheet
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u16).range(1..=100))]
    columns: u16,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("show");
    if !(0.05..=8.0).contains(&arguments.scale) {
        bail!("--scale is {}: it must lie between 0.05 and 8", arguments.scale);
    }
    let footage = arguments.source.open(run)?;
    let reader = FrameReader::<Wrinkles2d>::open(&arguments.curves)?;
    run.input("curves", &arguments.curves)?;
    let known = reader.header().cameras.clone();
    if let Some(id) = arguments.camera.iter().find(|id| !known.contains(id)) {
        bail!("{}: has no camera {id}; it has {}", arguments.curves.display(), known.join(", "));
    }
    let frames = reader.collect::<artifact::Result<Vec<_>>>()?;
    let model: Option<PaintModel> = arguments.model.as_deref().map(artifact::read_document).transpose()?;
    if let Some(folder) = &arguments.out {
        artifact::require_new_folder(folder)?;
    }
    let cameras = known.iter().filter(|id| arguments.camera.is_empty() || arguments.camera.contains(id));
    let mut views = Vec::new();
    for id in cameras {
        let view = View::new(id, &footage, &frames, arguments.range.unwrap_or(FrameRange::ALL))?;
        if view.shown.is_empty() {
            bail!("{}, camera {id}: none of the frames has an image and curves", arguments.curves.display());
        }
        views.push(view);
    }
    let mut outputs = Vec::new();
    if let Some(folder) = &arguments.out {
        for view in &views {
            for (frame, path) in &view.shown {
                let canvas = view.picture(frame, path, model.as_ref(), arguments.scale)?;
                let name = folder.join(&view.id).join(format!("{:06}.png", frame.frame));
                outputs.push(write_rgb8(&name, canvas.width, canvas.height, &canvas.rgb)?);
            }
        }
    }
    if let Some(path) = &arguments.sheet {
        let canvas = sheet(&views, arguments.columns.into(), model.as_ref(), arguments.scale)?;
        outputs.push(write_rgb8(path, canvas.width, canvas.height, &canvas.rgb)?);
    }
    run.result("pictures", outputs.len());
    outputs.into_iter().try_for_each(|output| Ok(output.publish()?))
}

/// What a camera saw, and the curves in it.
struct View<'a> {
    id: String,
    images: CameraImages,
    shown: Vec<(&'a Wrinkles2dFrame, PathBuf)>,
}

impl<'a> View<'a> {
    fn new(
        id: &str,
        footage: &Footage,
        frames: &'a [Wrinkles2dFrame],
        range: FrameRange,
    ) -> anyhow::Result<Self> {
        let images = footage.camera(id)?;
        let wanted =
            footage.numbers().into_iter().zip(&images.paths).filter(|(number, _)| range.contains(*number));
        let shown = wanted
            .filter_map(|(number, path)| {
                let index = frames.binary_search_by_key(&number, |frame| frame.frame).ok()?;
                frames[index].curves.contains_key(id).then_some((&frames[index], path.clone()?))
            })
            .collect();
        Ok(Self { id: id.to_string(), images, shown })
    }

    /// Width, height of a picture.
    fn size(&self, scale: f64) -> [usize; 2] {
        self.images.size.map(|side| ((f64::from(side) * scale) as usize).max(1))
    }

    fn picture(
        &self,
        frame: &Wrinkles2dFrame,
        path: &Path,
        model: Option<&PaintModel>,
        scale: f64,
    ) -> anyhow::Result<Canvas> {
        let [width, height] = self.size(scale);
        let mut canvas = Drawing::sheet(width, height)?;
        self.draw(&mut Drawing { canvas: &mut canvas, corner: [0, 0], scale }, frame, path, model)?;
        Ok(canvas)
    }

    fn draw(
        &self,
        drawing: &mut Drawing,
        frame: &Wrinkles2dFrame,
        path: &Path,
        model: Option<&PaintModel>,
    ) -> anyhow::Result<()> {
        let shot = Shot::read(&self.images, path)?;
        drawing.image(&shot.picture, &shot.rgb.to_8_bits());
        if let Some(model) = model {
            let classified = Classifier::new(model)?.classify(&shot.picture);
            for paint in 0..model.paints.len() {
                let bits = classified.of_paint(paint as u8 + 1);
                drawing.outline(&tidied(&bits, TrackParams::default().tidy_px));
            }
        }
        for (id, curve) in frame.curves.get(&self.id).into_iter().flatten() {
            drawing.curve(id, curve);
        }
        drawing.write(&format!("{}, frame {}", self.id, frame.frame), [4, 4], [255; 3]);
        Ok(())
    }
}

/// A row per camera.
fn sheet(views: &[View], columns: usize, model: Option<&PaintModel>, scale: f64) -> anyhow::Result<Canvas> {
    let row_width = |view: &View| view.size(scale)[0] * columns.min(view.shown.len());
    let width = views.iter().map(row_width).max().unwrap_or(1);
    let height = views.iter().map(|view| view.size(scale)[1]).sum();
    let mut canvas = Drawing::sheet(width, height)?;
    let mut top = 0;
    for view in views {
        let count = columns.min(view.shown.len());
        for column in 0..count {
            let (frame, path) = &view.shown[column * (view.shown.len() - 1) / (count - 1).max(1)];
            let corner = [column * view.size(scale)[0], top];
            view.draw(&mut Drawing { canvas: &mut canvas, corner, scale }, frame, path, model)?;
        }
        top += view.size(scale)[1];
    }
    Ok(canvas)
}
