//! Read frame by frame, triangulate, write frame by frame.

use super::sync::Sync;
use super::{Arguments, chart, table};
use anyhow::{Context, bail};
use artifact::{
    CameraRig, Extent, FrameReader, FrameWriter, MarkerHeader, MeasuredFrame, MeasuredTrajectories, Staged,
    Tracks2d, Trajectories3d,
};
use stage::Run;
use std::path::Path;
use triangulate::{Outcome, Triangulator};

/// Frames without anything to each one that has something: more are a mistake.
const MOST_GAPS: u64 = 100;

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    let params = arguments.params();
    params.check()?;
    run.parameters(&params)?;
    let rig: CameraRig = artifact::read_document(&arguments.cameras)?;
    run.input("cameras", &arguments.cameras)?;
    run.input("tracks", &arguments.tracks)?;
    if let Some(sync) = &arguments.sync {
        run.input("sync", sync)?;
    }
    arguments.check_outputs(run)?;
    let tracks = FrameReader::<Tracks2d>::open(&arguments.tracks)?;
    let (cameras, markers) = (tracks.header().cameras.clone(), tracks.header().markers.clone());
    let sync = arguments.sync.as_deref().map(Sync::open).transpose()?;
    let base = sync.as_ref().map(|sync| sync.header().clone());
    let work = Triangulator::new(&rig, tracks.header(), base.as_ref(), &params)
        .map_err(|error| error.in_file(&arguments.tracks))?;
    let header = work.header().clone();
    if header.rate.is_none() && (arguments.c3d.is_some() || arguments.trc.is_some()) {
        bail!(
            "{}: states no frame rate, which C3D and TRC need\n  to do: give --sync, or leave --c3d and --trc out",
            arguments.tracks.display()
        );
    }
    let mut output = Output::create(&arguments.out, &header)?;
    let outcome = through(run, &arguments, tracks, sync, work, &mut output)?;
    let (trajectories, extent) = output.finish()?;
    if arguments.c3d.is_some() || arguments.trc.is_some() {
        check_gaps(&arguments.tracks, extent)?;
    }
    let mut staged = Vec::new();
    for path in [&arguments.c3d, &arguments.trc].into_iter().flatten() {
        staged.push(run.timed("write", || export(path, &trajectories, &header, extent))?);
    }
    if let Some(path) = &arguments.picture {
        staged.push(chart::write(path, &outcome.report, &outcome.timeline, &cameras, &markers)?);
    }
    staged.insert(0, trajectories);
    tell(run, &outcome)?;
    run.publish(staged)
}

/// All frames through the work, from the tracks to the output.
fn through(
    run: &mut Run,
    arguments: &Arguments,
    tracks: FrameReader<Tracks2d>,
    mut sync: Option<Sync>,
    mut work: Triangulator,
    output: &mut Output,
) -> anyhow::Result<Outcome> {
    let refuse = |error: triangulate::Error| error.in_file(&arguments.tracks);
    let mut progress = run.progress("triangulating, frames", None);
    for frame in tracks {
        let frame = frame?;
        let shown = sync.as_mut().map_or(Ok(None), |sync| sync.at(frame.frame))?;
        let done = run.timed("triangulate", || work.push(frame, shown.as_ref())).map_err(refuse)?;
        run.timed("write", || output.write(&done))?;
        progress.step();
    }
    let outcome = run.timed("triangulate", || work.finish()).map_err(refuse)?;
    output.write(&outcome.frames)?;
    Ok(outcome)
}

/// The trajectories that are being written, and which frames they hold.
struct Output {
    writer: FrameWriter<MeasuredTrajectories>,
    extent: Option<Extent>,
}

impl Output {
    fn create(path: &Path, header: &MarkerHeader) -> anyhow::Result<Self> {
        Ok(Self { writer: FrameWriter::create(path, header.clone())?, extent: None })
    }

    fn write(&mut self, frames: &[MeasuredFrame]) -> artifact::Result<()> {
        for frame in frames {
            self.writer.write(frame)?;
            let last = frame.markers.frame;
            let extent = self.extent.get_or_insert(Extent { first: last, last, count: 0 });
            (extent.last, extent.count) = (last, extent.count + 1);
        }
        Ok(())
    }

    fn finish(self) -> anyhow::Result<(Staged, Extent)> {
        Ok((self.writer.finish()?, self.extent.unwrap_or(Extent { first: 0, last: 0, count: 0 })))
    }
}

/// Refuses tracks with gaps that would fill the disk: C3D and TRC hold every frame from the first to the last.
fn check_gaps(tracks: &Path, extent: Extent) -> anyhow::Result<()> {
    let all = extent.last.abs_diff(extent.first) + 1;
    if all > MOST_GAPS * extent.count as u64 + MOST_GAPS {
        bail!(
            "{}: has {} frames between {} and {}; C3D and TRC would hold {all}\n  to do: correct the frame numbers, or leave --c3d and --trc out",
            tracks.display(),
            extent.count,
            extent.first,
            extent.last
        );
    }
    Ok(())
}

/// The same in another format. These count frames in their header, so they are made when all are written: from the
/// trajectories, frame by frame.
fn export(path: &Path, from: &Staged, header: &MarkerHeader, extent: Extent) -> anyhow::Result<Staged> {
    let written = from.temporary().context("trajectories on standard output cannot be read again")?;
    let frames = FrameReader::<Trajectories3d>::open(written)?;
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    Ok(match ending.as_deref() {
        Some("trc") => artifact::trc::write_frames(path, header, extent, frames)?,
        _ => artifact::c3d::write_frames(path, header, extent, frames)?,
    })
}

fn tell(run: &mut Run, outcome: &Outcome) -> anyhow::Result<()> {
    run.say(&table::table(&outcome.report));
    outcome.report.warnings().into_iter().for_each(|warning| run.warn(warning));
    if let serde_json::Value::Object(results) = serde_json::to_value(&outcome.report)? {
        results.into_iter().for_each(|(key, value)| run.result(&key, value));
    }
    Ok(())
}
