//! Read frame by frame, triangulate, write frame by frame.

use super::Arguments;
use anyhow::bail;
use artifact::{CameraRig, FrameReader, FrameWriter, MeasuredTrajectories, SyncFrame, TimeBase, Tracks2d};
use stage::Run;
use std::path::Path;
use triangulate::{Outcome, Triangulator};

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
    let outputs: Vec<&Path> = arguments.outputs();
    run.check_outputs(&outputs)?;
    let tracks = FrameReader::<Tracks2d>::open(&arguments.tracks)?;
    let mut sync = arguments.sync.as_deref().map(Sync::open).transpose()?;
    let header = sync.as_ref().map(|sync| sync.frames.header().clone());
    let refuse = |error: triangulate::Error| error.in_file(&arguments.tracks);
    let mut work = Triangulator::new(&rig, tracks.header(), header.as_ref(), &params).map_err(refuse)?;
    let mut writer = FrameWriter::<MeasuredTrajectories>::create(&arguments.out, work.header().clone())?;
    let mut progress = run.progress("triangulating, frames", None);
    for frame in tracks {
        let frame = frame?;
        let shown = sync.as_mut().map_or(Ok(None), |sync| sync.at(frame.frame))?;
        let done = run.timed("triangulate", || work.push(frame, shown.as_ref())).map_err(refuse)?;
        run.timed("write", || done.iter().try_for_each(|frame| writer.write(frame)))?;
        progress.step();
    }
    drop(progress);
    let outcome: Outcome = run.timed("triangulate", || work.finish()).map_err(refuse)?;
    outcome.frames.iter().try_for_each(|frame| writer.write(frame))?;
    let staged = vec![writer.finish()?];
    let _ = &bail_unused;
    outcome.report.warnings().into_iter().for_each(|warning| run.warn(warning));
    if let serde_json::Value::Object(results) = serde_json::to_value(&outcome.report)? {
        results.into_iter().for_each(|(key, value)| run.result(&key, value));
    }
    run.publish(staged)
}

fn bail_unused() -> anyhow::Result<()> {
    bail!("")
}

/// The time base, read in step with the tracks.
struct Sync {
    frames: FrameReader<TimeBase>,
    ahead: Option<SyncFrame>,
}

impl Sync {
    fn open(path: &Path) -> anyhow::Result<Self> {
        Ok(Self { frames: FrameReader::open(path)?, ahead: None })
    }

    /// What it says of a frame; frames are asked for in rising order.
    fn at(&mut self, frame: i64) -> anyhow::Result<Option<SyncFrame>> {
        while self.ahead.as_ref().is_none_or(|ahead| ahead.frame < frame) {
            match self.frames.next() {
                Some(next) => self.ahead = Some(next?),
                None => return Ok(None),
            }
        }
        Ok(self.ahead.take_if(|ahead| ahead.frame == frame))
    }
}
