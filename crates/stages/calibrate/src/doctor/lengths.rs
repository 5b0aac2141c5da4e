//! Lengths that are known: what all cameras may have wrong together.

use super::{Evidence, Examination, Finding, Kind, Params};
use nalgebra::Point3;

/// A length that is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownLength {
    /// What is at its ends.
    pub ends: LengthEnds,
    /// mm
    pub mm: f64,
}

/// What a known length lies between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LengthEnds {
    /// Two sightings, by their indices.
    Sightings([usize; 2]),
    /// The centres of projection of two cameras, by their indices.
    Cameras([usize; 2]),
}

/// Standard errors that a mean must be off.
const SURE: f64 = 5.0;

pub(super) fn examine(
    evidence: &Evidence,
    points: &[Option<Point3<f64>>],
    params: &Params,
    examination: &mut Examination,
) {
    let ratio = |length: &KnownLength| {
        let [a, b] = match length.ends {
            LengthEnds::Sightings(ends) => ends.map(|end| points.get(end).copied().flatten()),
            LengthEnds::Cameras(ends) => {
                ends.map(|end| evidence.patients.get(end).map(|patient| patient.camera.eye_in_world()))
            }
        };
        Some((a? - b?).norm() / length.mm)
    };
    let mut ratios: Vec<f64> = evidence.lengths.iter().filter_map(ratio).collect();
    if ratios.is_empty() {
        examination
            .unchecked
            .push("known lengths: there are none between points that two cameras see".into());
        return;
    }
    ratios.sort_by(f64::total_cmp);
    // The worst ends may be mislabelled corners.
    let tenth = ratios.len() / 10;
    let kept = &ratios[tenth..ratios.len() - tenth];
    let count = kept.len() as f64;
    let mean = kept.iter().sum::<f64>() / count;
    let spread =
        (kept.iter().map(|ratio| (ratio - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0)).sqrt();
    examination.length_ratio = Some(mean);
    let off = mean - 1.0;
    if off.abs() > params.length && off.abs() > SURE * spread / count.sqrt() {
        let kind = Kind::Length;
        examination.findings.push(Finding {
            camera: None,
            kind,
            number: off,
            unit: "share",
            what: format!("{} known lengths come out {:+.2} % off in the mean", ratios.len(), 100.0 * off),
            advice: kind.advice(),
        });
    }
}
