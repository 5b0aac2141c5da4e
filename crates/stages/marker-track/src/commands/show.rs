//! `marker-track show`.

use anyhow::bail;
use artifact::picture::write_rgb8;
use artifact::{FrameRange, FrameReader, TrackState, Tracks2d, Tracks2dFrame};
use marker_track::Canvas;
use stage::{CameraImages, Footage, ImageSource, Run};
use std::path::{Path, PathBuf};

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
    source: ImageSource,
    /// Tracks to draw (tracks-2d)
    #[arg(long, value_name = "FILE")]
    tracks: PathBuf,
    /// Cameras whose images are drawn [default: all that have tracks]
    #[arg(long, value_name = "ID,...", value_delimiter = ',')]
    camera: Vec<String>,
    /// Frames to draw
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    range: Option<FrameRange>,
    /// Frames that a tail goes back
    #[arg(long, value_name = "N", default_value_t = 10)]
    tail: usize,
    /// Enlargement of the pictures in the folder
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=8))]
    scale: u8,
    /// Folder to write into, one PNG per camera and frame; must not exist, or be empty
    #[arg(long, value_name = "FOLDER", required_unless_present = "sheet")]
    out: Option<PathBuf>,
    /// One picture of it all: a row per camera, frames spread over the range
    #[arg(long, value_name = "FILE")]
    sheet: Option<PathBuf>,
    /// Frames on the sheet
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=100))]
    columns: u16,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("show");
    let footage = arguments.source.open(run)?;
    let reader = FrameReader::<Tracks2d>::open(&arguments.tracks)?;
    run.input("tracks", &arguments.tracks)?;
    let tracked = reader.header().cameras.clone();
    if let Some(id) = arguments.camera.iter().find(|id| !tracked.contains(id)) {
        bail!("{}: has no camera {id}; it has {}", arguments.tracks.display(), tracked.join(", "));
    }
    let tracks = Tracks { frames: reader.collect::<artifact::Result<Vec<_>>>()?, tail: arguments.tail };
    if let Some(folder) = &arguments.out {
        artifact::require_new_folder(folder)?;
    }
    let (mut outputs, mut strips) = (Vec::new(), Vec::new());
    for (camera, id) in tracked.iter().enumerate() {
        if !arguments.camera.is_empty() && !arguments.camera.contains(id) {
            continue;
        }
        let seen = Seen { camera, images: footage.camera(id)?, footage: &footage, tracks: &tracks };
        let shown = seen.shown(arguments.range.unwrap_or(FrameRange::ALL));
        if shown.is_empty() {
            bail!("{}, camera {id}: none of the frames has an image and tracks", arguments.tracks.display());
        }
        for (place, path) in shown.iter().filter(|_| arguments.out.is_some()) {
            let canvas = seen.drawn(*place, path, arguments.scale)?;
            let name = format!("{id}/{:06}.png", tracks.frames[*place].frame);
            let name = arguments.out.as_deref().unwrap_or(Path::new("")).join(name);
            outputs.push(write_rgb8(&name, canvas.width, canvas.height, &canvas.rgb)?);
        }
        if arguments.sheet.is_some() {
            let spread = spread(shown.len(), arguments.columns.into()).map(|i| shown[i]);
            let strip = spread.map(|(place, path)| seen.drawn(place, path, 1));
            strips.push(strip.collect::<anyhow::Result<Vec<_>>>()?);
        }
    }
    if let Some(path) = &arguments.sheet {
        let sheet = Canvas::sheet(&strips);
        outputs.push(write_rgb8(path, sheet.width, sheet.height, &sheet.rgb)?);
    }
    run.result("pictures", outputs.len());
    outputs.into_iter().try_for_each(|output| Ok(output.publish()?))
}

/// At most `count` of the numbers below `len`, spread from the first to the last.
fn spread(len: usize, count: usize) -> impl Iterator<Item = usize> {
    let count = count.min(len);
    (0..count).map(move |i| i * (len - 1) / (count - 1).max(1))
}

/// All tracks, in the order of frames.
struct Tracks {
    frames: Vec<Tracks2dFrame>,
    tail: usize,
}

/// What a camera saw, and where the tracks are in it.
struct Seen<'a> {
    camera: usize,
    images: CameraImages,
    footage: &'a Footage,
    tracks: &'a Tracks,
}

impl Seen<'_> {
    /// The frames of a range that have tracks (where among them) and an image.
    fn shown(&self, range: FrameRange) -> Vec<(usize, &PathBuf)> {
        let frames = &self.tracks.frames;
        let images = self.footage.numbers().into_iter().zip(&self.images.paths);
        let wanted = images.filter(|(number, _)| range.contains(*number));
        wanted
            .filter_map(|(number, path)| {
                Some((frames.binary_search_by_key(&number, |frame| frame.frame).ok()?, path.as_ref()?))
            })
            .collect()
    }

    fn drawn(&self, place: usize, path: &Path, scale: u8) -> anyhow::Result<Canvas> {
        let image = self.images.read_8_bits(path)?;
        let mut canvas = Canvas::enlarged(&image.picture(), scale.into());
        draw(&mut canvas, &self.tracks.frames[place.saturating_sub(self.tracks.tail)..=place], self.camera);
        Ok(canvas)
    }
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
