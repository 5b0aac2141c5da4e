//! `marker-track track`.

use super::follow::{Camera, Plan, follow};
use super::guide::Guide;
use super::start::{Start, check_ids};
use anyhow::{Context, bail};
use artifact::{FrameWriter, Labels, TrackState, Tracks2d, Tracks2dFrame, Tracks2dHeader};
use marker_track::{Edits, GuideHits, Params, Strays, drop_misfits, drop_passing, name_strays};
use serde::Serialize;
use stage::{ImageSource, Run, check_take};
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// With a larger share of guided markers that have no dot, something is off: on hard takes hair, lips and the nose hide a quarter.
const MISSED: f64 = 0.4;

/// Follows the labelled markers through all images, from the labelled frame to both ends of the take
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: ImageSource,
    /// Markers labelled in one frame (labels); the cameras that have labels are tracked; with --guide, others of their image size too
    #[arg(long, value_name = "FILE")]
    labels: PathBuf,
    /// 3D markers of a first pass (trajectories-3d), to look for markers where they must be; needs --cameras
    #[arg(long, value_name = "FILE", requires = "cameras")]
    guide: Option<PathBuf>,
    /// Calibrated cameras (cameras), to project the guide with
    #[arg(long, value_name = "FILE", requires = "guide")]
    cameras: Option<PathBuf>,
    /// Corrections by hand, replayed on the tracks: lines `relabel FRAME CAMERA A B`, `split FRAME CAMERA MARKER`,
    /// `fill FRAME CAMERA MARKER X Y`, `fill A-B CAMERA MARKER`
    #[arg(long, value_name = "FILE")]
    edits: Option<PathBuf>,
    /// Share of a pixel that must be paint
    #[arg(long, value_name = "SHARE", default_value_t = Params::default().least_coverage)]
    least_coverage: f64,
    /// Share of a dot's usual area below which it counts as hidden
    #[arg(long, value_name = "SHARE", default_value_t = Params::default().least_share)]
    least_share: f64,
    /// Distance from its prediction within which a marker is looked for, as a share of that to its neighbour
    #[arg(long, value_name = "SHARE", default_value_t = Params::default().gate)]
    gate: f64,
    /// Least such distance, px
    #[arg(long, value_name = "PX", default_value_t = Params::default().least_gate_px)]
    least_gate_px: f64,
    /// Largest such distance, px
    #[arg(long, value_name = "PX", default_value_t = Params::default().most_gate_px)]
    most_gate_px: f64,
    /// Distance from the guide within which a marker is looked for, px
    #[arg(long, value_name = "PX", default_value_t = Params::default().guide_gate_px)]
    guide_gate_px: f64,
    /// Tracks to write (tracks-2d; - for standard output)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

impl Arguments {
    fn params(&self) -> Params {
        Params {
            least_coverage: self.least_coverage,
            least_share: self.least_share,
            gate: self.gate,
            least_gate_px: self.least_gate_px,
            most_gate_px: self.most_gate_px,
            guide_gate_px: self.guide_gate_px,
        }
    }
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("track");
    let params = arguments.params();
    params.check()?;
    run.parameters(&params)?;
    let labels: Labels = artifact::read_document(&arguments.labels)?;
    run.input("labels", &arguments.labels)?;
    let footage = arguments.source.open(run)?;
    check_take(run, &arguments.labels, labels.take.as_ref(), footage.take.as_ref())?;
    check_ids(&arguments.labels, &labels)?;
    let guide = match (&arguments.guide, &arguments.cameras) {
        (Some(guide), Some(cameras)) => {
            Some(Guide::read(run, guide, cameras, footage.take.as_ref(), params.guide_gate_px)?)
        }
        _ => None,
    };
    let numbers = footage.numbers();
    guide.as_ref().map_or(Ok(()), |guide| guide.check_overlap(&numbers))?;
    let named = labels.cameras.values().flat_map(BTreeMap::keys);
    let markers: BTreeSet<&String> = named.chain(guide.iter().flat_map(|guide| guide.markers())).collect();
    let markers: Vec<String> = markers.into_iter().cloned().collect();
    let Some(first) = numbers.iter().position(|&number| number == labels.frame) else {
        let file = arguments.labels.display();
        bail!(
            "{file}: labels frame {}, which the take has not\n  to do: label a frame of the take",
            labels.frame
        );
    };
    let start = Start { file: &arguments.labels, params: &params, labels: &labels, markers: &markers, first };
    let mut cameras = start.cameras(run, &footage, guide.as_ref())?;
    let header = Tracks2dHeader {
        cameras: cameras.iter().map(|camera| camera.id.clone()).collect(),
        markers,
        rate: Some(footage.rate),
        take: footage.take.clone(),
    };
    let edits = read_edits(run, arguments, &header, &cameras)?;
    let plan = Plan { numbers: &numbers, markers: &header.markers, guide: guide.as_ref() };
    follow(run, &mut cameras, &plan, first)?;
    let (mut frames, strays) = gather(&mut cameras, &numbers);
    compare(run, &mut frames, &strays);
    if let Some(guide) = &guide {
        drop_unsure(run, &header, &mut frames, guide, first);
        report_guide(run, &cameras);
    }
    if let (Some(edits), Some(path)) = (edits, &arguments.edits) {
        edits.apply(&mut frames).with_context(|| path.display().to_string())?;
        run.result("edits", edits.count());
    }
    report(run, &header, &frames);
    write(run, arguments, header, &frames)
}

/// Frame by frame what the cameras have, and the dots that no marker has.
fn gather(cameras: &mut [Camera], numbers: &[i64]) -> (Vec<Tracks2dFrame>, Strays) {
    let mut frames: Vec<Tracks2dFrame> = Vec::with_capacity(numbers.len());
    for (index, &frame) in numbers.iter().enumerate() {
        let samples = cameras.iter_mut().map(|camera| camera.samples[index].take()).collect();
        frames.push(Tracks2dFrame { frame, cameras: samples });
    }
    let strays: Strays = (0..numbers.len())
        .map(|index| cameras.iter_mut().map(|camera| std::mem::take(&mut camera.strays[index])).collect())
        .collect();
    (frames, strays)
}

/// What the cameras say of each other's samples.
fn compare(run: &mut Run, frames: &mut [Tracks2dFrame], strays: &Strays) {
    let misfits = run.timed("name", || drop_misfits(frames));
    run.result("misfits", misfits);
    let named = run.timed("name", || name_strays(frames, strays));
    run.result("named", named);
}

/// What images say of those around them, and the guide of what other cameras saw.
fn drop_unsure(
    run: &mut Run,
    header: &Tracks2dHeader,
    frames: &mut [Tracks2dFrame],
    guide: &Guide,
    labelled: usize,
) {
    let passing = run.timed("name", || drop_passing(frames));
    run.result("passing", passing);
    let untied = run.timed("name", || guide.drop_untied(header, frames, labelled));
    run.result("untied", untied);
}

fn read_edits(
    run: &mut Run,
    arguments: &Arguments,
    header: &Tracks2dHeader,
    cameras: &[Camera],
) -> anyhow::Result<Option<Edits>> {
    let Some(path) = &arguments.edits else { return Ok(None) };
    let text = artifact::read_text(path)?;
    let sizes: Vec<[u32; 2]> = cameras.iter().map(|camera| camera.images.size).collect();
    run.input("edits", path)?;
    let edits = Edits::parse(&text, header, &sizes).with_context(|| path.display().to_string())?;
    Ok(Some(edits))
}

/// Says how many of the markers that the guide says can be seen have a dot there.
fn report_guide(run: &mut Run, cameras: &[Camera]) {
    let mut all = GuideHits::default();
    for Camera { id, guided, .. } in cameras {
        all += *guided;
        let missed = 1.0 - guided.found as f64 / guided.wanted.max(1) as f64;
        if guided.wanted > 0 && missed > MISSED {
            run.warn(format!(
                "camera {id}: {:.0} % of the markers that the guide says can be seen have no dot there; is the guide of this take, and the camera as it was calibrated?",
                100.0 * missed
            ));
        }
    }
    run.result("guide_wanted", all.wanted);
    run.result("guide_found", all.found);
}

/// What became of a camera's markers.
#[derive(Debug, Default, Serialize)]
struct Tally {
    images: usize,
    seen: usize,
    predicted: usize,
    edited: usize,
}

fn report(run: &mut Run, header: &Tracks2dHeader, frames: &[Tracks2dFrame]) {
    let mut whole = Tally::default();
    let mut per_camera = BTreeMap::new();
    for (index, id) in header.cameras.iter().enumerate() {
        let mut tally = Tally::default();
        for samples in frames.iter().filter_map(|frame| frame.cameras[index].as_ref()) {
            tally.images += 1;
            for sample in samples.iter().flatten() {
                match sample.state {
                    TrackState::Seen => tally.seen += 1,
                    TrackState::Predicted => tally.predicted += 1,
                    TrackState::Edited => tally.edited += 1,
                }
            }
        }
        if tally.seen == 0 {
            run.warn(format!("camera {id} sees no marker in any image"));
        }
        whole.images += tally.images;
        whole.seen += tally.seen;
        whole.predicted += tally.predicted;
        whole.edited += tally.edited;
        per_camera.insert(id.clone(), tally);
    }
    run.result("images", whole.images);
    run.result("seen", whole.seen);
    run.result("predicted", whole.predicted);
    run.result("edited", whole.edited);
    run.result("cameras", per_camera);
}

fn write(
    run: &mut Run,
    arguments: &Arguments,
    header: Tracks2dHeader,
    frames: &[Tracks2dFrame],
) -> anyhow::Result<()> {
    let mut writer = FrameWriter::<Tracks2d>::create(&arguments.out, header)?;
    for frame in frames {
        writer.write(frame)?;
    }
    run.publish(vec![writer.finish()?])
}
