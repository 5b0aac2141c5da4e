//! Kinds with frames that fit into memory, and cameras.

use super::comparison::Comparison;
use artifact::{
    CameraRig, MarkerFrame, MarkerHeader, Stream, Tracks2d, Trajectories, Trajectories3d, read_document,
};
use virtual_rig::score::{self, Metric, ScoreError, seen_by_two};

/// Header and frames of a stream.
type Borrowed<'a, S> = (&'a <S as Stream>::Header, &'a [<S as Stream>::Frame]);

/// Compares a stream with one of the truth.
pub(super) fn score<T: Stream, R: Stream>(
    comparison: &mut Comparison,
    name: &str,
    score: impl for<'t, 'r> FnOnce(Borrowed<'t, T>, Borrowed<'r, R>) -> Result<Vec<Metric>, ScoreError>,
) -> anyhow::Result<Vec<Metric>> {
    let truth = comparison.true_stream::<T>(name)?;
    let result = comparison.result_stream::<R>()?;
    comparison.check_named(&truth.0, &result.0);
    Ok(score((&truth.0, &truth.1), (&result.0, &result.1))?)
}

/// Compares markers in 3D.
///
/// What fewer than two cameras see, nobody can measure, so it counts neither as missing nor in the errors; what is filled in
/// lies just there, so `filled_rms_mm` is over all markers. `rms_all_mm` is over everything that the result says to be measured.
pub(super) fn markers<S: Stream<Header = MarkerHeader, Frame = MarkerFrame>>(
    comparison: &mut Comparison,
    name: &str,
    score: impl Fn(&Trajectories, &Trajectories) -> Result<Vec<Metric>, ScoreError>,
) -> anyhow::Result<Vec<Metric>> {
    let truth = whole(comparison.true_stream::<S>(name)?);
    let (header, frames) = comparison.true_stream::<Tracks2d>("tracks-2d.jsonl")?;
    let mut result = comparison.run.markers::<S>(comparison.result, comparison.unit)?;
    comparison.run.input("result", comparison.result)?;
    result.frames.retain(|frame| comparison.frames.contains(frame.frame));
    comparison.check_named(&truth.header, &result.header);
    let mut metrics = score(&seen_by_two(&truth, (&header, &frames)), &result)?;
    for of_all in score(&truth, &result)? {
        match of_all.name {
            "filled_rms_mm" => {
                metrics.iter_mut().filter(|metric| metric.name == of_all.name).for_each(|metric| {
                    *metric = of_all.clone();
                });
            }
            "rms_mm" => metrics.push(Metric { name: "rms_all_mm", ..of_all }),
            _ => {}
        }
    }
    Ok(metrics)
}

/// Compares calibrated cameras with those that were calibrated, by what they make of the take's markers.
pub(super) fn cameras(comparison: &mut Comparison) -> anyhow::Result<Vec<Metric>> {
    let path = match comparison.against {
        Some(path) => path.to_path_buf(),
        None => comparison.truth.file("cameras-calibrated.json")?,
    };
    comparison.run.input("true cameras", &path)?;
    let truth: CameraRig = read_document(&path)?;
    let result: CameraRig = read_document(comparison.result)?;
    comparison.run.input("result", comparison.result)?;
    let markers = whole(comparison.true_stream::<Trajectories3d>("markers.jsonl")?);
    let (header, frames) = comparison.true_stream::<Tracks2d>("tracks-2d.jsonl")?;
    // Many takes share a calibration, so one that names no take is nothing to warn of.
    Ok(score::cameras(&truth, &result, &markers, Some((&header, &frames)))?)
}

fn whole((header, frames): (MarkerHeader, Vec<MarkerFrame>)) -> Trajectories {
    Trajectories { header, frames }
}
