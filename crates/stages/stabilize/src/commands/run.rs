//! Read, stabilize, write.

use super::{Arguments, input};
use anyhow::bail;
use artifact::{FrameRange, FrameWriter, HeadPose, HeadTrajectories, Unit};
use serde::Serialize;
use stabilize::{Params, Stabilized, stabilize};
use stage::Run;

/// What stands in the side-cars.
#[derive(Serialize)]
struct Parameters<'a> {
    #[serde(flatten)]
    params: &'a Params,
    /// As the user stated it; absent where the file's own word is taken.
    marker_unit: Option<Unit>,
    frames: String,
}

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    if arguments.out == arguments.pose {
        bail!("--out and --pose are both {}\n  to do: name two files", arguments.out.display());
    }
    run.check_folders(&[&arguments.out, &arguments.pose])?;
    let params = arguments.params();
    params.check()?;
    let frames = arguments.frames.unwrap_or(FrameRange::ALL);
    run.parameters(&Parameters {
        params: &params,
        marker_unit: arguments.marker_unit,
        frames: frames.to_string(),
    })?;
    let take = input::read(run, &arguments.markers, arguments.marker_unit, arguments.take.as_deref())?;
    run.check_outputs(&[&arguments.out, &arguments.pose])?;
    let stable = run.timed("stabilize", || stabilize(&take, &params));
    let stable = stable.map_err(|error| error.in_file(&arguments.markers))?;
    stable.report.warnings().into_iter().for_each(|warning| run.warn(warning));
    if stable.report.head_markers_chosen {
        run.say(&format!("head markers chosen: {}", stable.report.head_markers.join(", ")));
    }
    if let serde_json::Value::Object(results) = serde_json::to_value(&stable.report)? {
        results.into_iter().for_each(|(key, value)| run.result(&key, value));
    }
    write(run, &arguments, &stable)
}

fn write(run: &mut Run, arguments: &Arguments, stable: &Stabilized) -> anyhow::Result<()> {
    let range = arguments.frames.unwrap_or(FrameRange::ALL);
    if !stable.poses.iter().any(|pose| range.contains(pose.frame)) {
        bail!(
            "{}: has no frames in {range}\n  to do: choose --frames of the take",
            arguments.markers.display()
        );
    }
    let mut head = FrameWriter::<HeadTrajectories>::create(&arguments.out, stable.head.header.clone())?;
    for frame in stable.head.frames.iter().filter(|frame| range.contains(frame.frame)) {
        head.write(frame)?;
    }
    let mut pose = FrameWriter::<HeadPose>::create(&arguments.pose, stable.pose_header.clone())?;
    for frame in stable.poses.iter().filter(|frame| range.contains(frame.frame)) {
        pose.write(frame)?;
    }
    run.publish(vec![head.finish()?, pose.finish()?])
}
