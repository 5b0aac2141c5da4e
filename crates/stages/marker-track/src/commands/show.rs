//! `marker-track show`.

use super::footage::{Image, Source};
use anyhow::bail;
use artifact::picture::write_rgb8;
use artifact::{FrameRange, FrameReader, TrackState, Tracks2d, Tracks2dFrame};
use marker_track::Canvas;
use stage::Run;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Colours of seen, predicted and edited samples.
const SEEN: [u8; 3] = [90, 255, 90];
const UNSURE: [u8; 3] = [255, 220, 60];
const PREDICTED: [u8; 3] = [255, 70, 60];
const EDITED: [u8; 3] = [90, 220, 255];
const TAIL: [u8; 3] = [255, 255, 255];
/// Below this confidence a seen marker is drawn as unsure.
const SURE: f64 = 0.6;

/// Draws tracks over the images: seen green, unsure yellow, predicted red, edited blue, with their tails
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// Tracks to draw (tracks-2d)
    #[arg(long, value_name = "FILE")]
    tracks: PathBuf,
    /// Camera whose images are drawn
    #[arg(long, value_name = "ID")]
    camera: String,
    /// Frames to draw
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    range: Option<FrameRange>,
    /// Frames that a tail goes back
    #[arg(long, value_name = "N", default_value_t = 10)]
    tail: usize,
    /// Enlargement
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=8))]
    scale: u8,
    /// Folder to write into, one PNG per frame; must not exist, or be empty
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("show");
    let footage = arguments.source.open(run)?;
    let images = footage.camera(&arguments.camera)?;
    let reader = FrameReader::<Tracks2d>::open(&arguments.tracks)?;
    run.input("tracks", &arguments.tracks)?;
    let camera = reader.header().cameras.iter().position(|id| *id == arguments.camera);
    let Some(camera) = camera else {
        bail!("{}: has no camera {}", arguments.tracks.display(), arguments.camera);
    };
    let tracks = reader.collect::<artifact::Result<Vec<_>>>()?;
    let places: BTreeMap<i64, usize> = tracks.iter().enumerate().map(|(i, f)| (f.frame, i)).collect();
    artifact::require_new_folder(&arguments.out)?;
    let range = arguments.range.unwrap_or(FrameRange::ALL);
    let mut outputs = Vec::new();
    for (number, path) in footage.numbers().into_iter().zip(&images.paths) {
        let (Some(path), Some(&place)) = (path, places.get(&number)) else { continue };
        if !range.contains(number) {
            continue;
        }
        let image = Image::read(path, images.size)?;
        let mut canvas = Canvas::enlarged(&image.picture()?, arguments.scale.into());
        let tail = &tracks[place.saturating_sub(arguments.tail)..=place];
        draw(&mut canvas, tail, camera);
        let name = arguments.out.join(format!("{number:06}.png"));
        outputs.push(write_rgb8(&name, canvas.width, canvas.height, &canvas.rgb)?);
    }
    if outputs.is_empty() {
        bail!("{}: no frame in {range} has an image and tracks", arguments.tracks.display());
    }
    run.result("pictures", outputs.len());
    outputs.into_iter().try_for_each(|output| Ok(output.publish()?))
}

/// Draws the last of some frames, with tails through those before it.
fn draw(canvas: &mut Canvas, frames: &[Tracks2dFrame], camera: usize) {
    let samples: Vec<_> = frames.iter().filter_map(|frame| frame.cameras[camera].as_ref()).collect();
    let Some(now) = frames.last().and_then(|frame| frame.cameras[camera].as_ref()) else { return };
    for (marker, sample) in now.iter().enumerate() {
        let Some(sample) = sample else { continue };
        for pair in samples.windows(2) {
            if let [Some(from), Some(to)] = [pair[0][marker], pair[1][marker]] {
                canvas.line(from.at.into(), to.at.into(), TAIL);
            }
        }
        let color = match sample.state {
            TrackState::Seen if sample.confidence >= SURE => SEEN,
            TrackState::Seen => UNSURE,
            TrackState::Predicted => PREDICTED,
            TrackState::Edited => EDITED,
        };
        canvas.cross(sample.at.into(), 3, color);
    }
}
