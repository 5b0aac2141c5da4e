//! The scale: the one thing that a waved point does not tell.

use super::polish::State;
use super::{Error, Sightings, Wand};
use camera::Camera;
use nalgebra::{Isometry3, Point3};
use serde::Serialize;

/// Where the scale comes from.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// From nowhere: the cameras' mean distance from the wand is set to 1000 mm.
    Unknown,
    /// The cameras' mean distance from the middle of the wand's path, mm.
    Distance(f64),
    /// Known lengths; where there are several, the scale with the least squared error.
    Lengths(Vec<Length>),
}

/// A known length.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Length {
    /// Between what.
    pub ends: Ends,
    /// mm
    pub mm: f64,
}

/// Between what a length was measured.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ends {
    /// The places of the point in two frames.
    Frames(i64, i64),
    /// The centres of projection of two cameras.
    Cameras(String, String),
}

/// A known length, and what it is in the reconstruction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measured {
    /// What was stated.
    pub length: Length,
    /// What it is after scaling, mm.
    pub mm: f64,
}

/// As a user states it.
impl std::fmt::Display for Ends {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Frames(a, b) => write!(f, "{a}:{b}"),
            Self::Cameras(a, b) => write!(f, "{a}:{b}"),
        }
    }
}

/// A length as a user states it.
pub(super) fn named(length: &Length) -> String {
    format!("{}={}", length.ends, length.mm)
}

/// Distance of the cameras from the wand where nothing is known, mm.
const UNKNOWN_MM: f64 = 1000.0;

/// The finished calibration in millimetres, in the first camera's space.
pub(super) fn scaled(sightings: &Sightings, mut state: State, scale: &Scale) -> Result<Wand, Error> {
    let mut lengths = Vec::new();
    let factor = match scale {
        Scale::Unknown => UNKNOWN_MM / state.mean_distance(),
        Scale::Distance(mm) if *mm > 0.0 && mm.is_finite() => mm / state.mean_distance(),
        Scale::Distance(mm) => return Err(Error::Parameter { name: "scale", value: *mm }),
        Scale::Lengths(known) => {
            for length in known {
                lengths.push(Measured { mm: measured(sightings, &state, length)?, length: length.clone() });
            }
            let sum = |of: &dyn Fn(&Measured) -> f64| lengths.iter().map(of).sum::<f64>();
            sum(&|one| one.length.mm * one.mm) / sum(&|one| one.mm * one.mm)
        }
    };
    lengths.iter_mut().for_each(|one| one.mm *= factor);
    agree(&lengths)?;
    state.scale(factor);
    let world_from_first = state.cameras[0].cam_from_world;
    state.cameras.iter_mut().for_each(|camera| camera.cam_from_world *= world_from_first.inverse());
    state.cameras[0].cam_from_world = Isometry3::identity();
    state.points.iter_mut().flatten().for_each(|point| *point = world_from_first * *point);
    let shift_factor = |mut deviation: artifact::CameraDeviation| {
        deviation.translation_mm = deviation.translation_mm.map(|mm| mm * factor);
        deviation
    };
    let deviations = state.deviations.map(|all| all.into_iter().map(shift_factor).collect());
    let count = |camera: usize, kept: bool| {
        let seen = sightings.cameras[camera].track.iter().zip(&state.kept[camera]);
        seen.filter(|(seen, is_kept)| seen.is_some() && **is_kept == kept).count()
    };
    Ok(Wand {
        used: (0..state.cameras.len()).map(|c| count(c, true)).collect(),
        rejected: (0..state.cameras.len()).map(|c| count(c, false)).collect(),
        rms_px: state.rms_px,
        cameras: state.cameras,
        deviations,
        points: state.points,
        lengths,
    })
}

/// How far off the others a known length may come out, as a share: more is no error of measuring with a rule.
pub(super) const LENGTHS_AGREE: f64 = 0.02;

/// Refuses lengths that no scale fits.
fn agree(lengths: &[Measured]) -> Result<(), Error> {
    let off = |one: &Measured| (one.mm / one.length.mm - 1.0).abs();
    match lengths.iter().max_by(|a, b| off(a).total_cmp(&off(b))) {
        Some(worst) if off(worst) > LENGTHS_AGREE => {
            Err(Error::Contradiction { length: worst.length.clone(), mm: worst.mm })
        }
        _ => Ok(()),
    }
}

/// A length in the reconstruction, before scaling.
fn measured(sightings: &Sightings, state: &State, length: &Length) -> Result<f64, Error> {
    let refuse = |what: String| Error::Length { length: length.clone(), what };
    let frame = |number: i64| -> Result<Point3<f64>, Error> {
        let place = sightings.frames.iter().position(|frame| *frame == number);
        let place = place.ok_or_else(|| refuse(format!("there is no frame {number}")))?;
        state.points[place].ok_or_else(|| refuse(format!("too few cameras see the point in frame {number}")))
    };
    let eye = |id: &str| -> Result<Point3<f64>, Error> {
        let place = sightings.cameras.iter().position(|camera| camera.id == id);
        let place = place.ok_or_else(|| refuse(format!("there is no camera {id}")))?;
        Ok(Camera::eye_in_world(&state.cameras[place]))
    };
    let [a, b] = match &length.ends {
        Ends::Frames(a, b) => [frame(*a)?, frame(*b)?],
        Ends::Cameras(a, b) => [eye(a)?, eye(b)?],
    };
    match (a - b).norm() {
        _ if !(length.mm > 0.0 && length.mm.is_finite()) => Err(refuse("is not positive".into())),
        0.0 => Err(refuse("its ends are one and the same".into())),
        found => Ok(found),
    }
}
