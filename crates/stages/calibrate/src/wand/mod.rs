//! Self-calibration from one waved point, after [Svoboda2005].
//!
//! A bright point is waved through the space that the cameras see. Where it is nobody knows; that all cameras see one and the same
//! point in every frame is enough to find them all, up to one length.
//!
//! 1. [`bright_point`] finds the point in every picture.
//! 2. Pairs of cameras tell outliers by their epipolar geometry; the scene grows camera by camera, and is then factorised as
//!    a whole into projective cameras and points. Cameras need not see the point in all frames.
//! 3. The focal lengths and the plane at infinity are searched for under the assumption of square pixels and a nearly central
//!    principal point; the best candidates compete in a bundle adjustment.
//! 4. Bundle adjustments with ever more of the lens set free, outliers taken out and let in again by their residuals; of the lens
//!    models the one with the least information criterion is kept.
//! 5. A known length, or several, gives the scale.

mod agree;
mod blob;
mod error;
mod metric;
mod pair;
mod polish;
mod projective;
mod ransac;
mod scale;
mod start;

pub use blob::{BlobParams, Luminance, Shown, bright_point};
pub use error::Error;
pub use scale::{Ends, Length, Measured, Scale};

use crate::bundle::{Focal, Free};
use artifact::CameraDeviation;
use camera::{Camera, Lens};
use nalgebra::{Point3, Vector2};
use polish::State;
use rayon::prelude::*;
use serde::Serialize;

/// Per frame where a camera sees the point, px; none where it does not.
pub type Track = Vec<Option<Vector2<f64>>>;

/// A camera that watched the wand.
#[derive(Debug, Clone, PartialEq)]
pub struct WandCamera {
    /// Its id.
    pub id: String,
    /// Image width, height, px.
    pub image_size: [u32; 2],
    /// What is known of its lens; without it the focal length is searched for.
    pub lens: Option<Lens>,
    /// What it saw, one entry per frame.
    pub track: Track,
}

/// A waved point.
#[derive(Debug, Clone, PartialEq)]
pub struct Sightings {
    /// Frame numbers.
    pub frames: Vec<i64>,
    /// What the cameras saw.
    pub cameras: Vec<WandCamera>,
}

/// How a waved point becomes cameras.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Params {
    /// Seed of the random samples.
    pub seed: u64,
    /// How far a sighting may be off before the lens is known, as a share of half the image's diagonal.
    pub coarse: f64,
    /// How far a sighting may be off in the end, in standard deviations of its camera's.
    pub reject: f64,
    /// Shortest and longest focal length that is tried, as shares of half the image's diagonal.
    pub focal_range: [f64; 2],
    /// What of the lenses is found, at most; terms that the sightings do not tell stay at zero or in the middle.
    pub free: Free,
    /// Where the scale comes from.
    pub scale: Scale,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            seed: 1,
            coarse: 0.01,
            reject: 5.0,
            focal_range: [0.5, 14.0],
            free: Free {
                pose: true,
                focal: Focal::Tied,
                center: true,
                distortion: [true, true, true, true, false],
            },
            scale: Scale::Unknown,
        }
    }
}

/// What a waved point tells.
#[derive(Debug, Clone)]
pub struct Wand {
    /// The cameras, in the order of the sightings. World space is the first one's: x right, y down, z forward, mm.
    pub cameras: Vec<Camera>,
    /// Per camera the root mean square residual, px.
    pub rms_px: Vec<f64>,
    /// Per camera how many sightings were used, and how many were not because they agree with nothing.
    pub used: Vec<usize>,
    /// See `used`.
    pub rejected: Vec<usize>,
    /// Standard deviations relative to the first camera; none where the sightings do not tell.
    pub deviations: Option<Vec<CameraDeviation>>,
    /// Per frame where the point was, mm.
    pub points: Vec<Option<Point3<f64>>>,
    /// The known lengths, and what they are now.
    pub lengths: Vec<Measured>,
}

/// The cameras that watched a waved point [Svoboda2005]; see the module's documentation for how.
///
/// Three cameras or more are needed, or two whose lenses are known. Without [`Scale`] the cameras are 1000 mm from the wand on
/// average. The same sightings, parameters and seed give the same bits.
///
/// # Errors
/// Too few cameras or sightings, cameras that share too few frames with the others, no metric reconstruction, or a length that is
/// not there.
pub fn calibrate(sightings: &Sightings, params: &Params) -> Result<Wand, Error> {
    check(sightings, params)?;
    match placed(sightings, params) {
        Ok(state) => scale::scaled(sightings, state, &params.scale),
        Err(error @ (Error::Bundle(_) | Error::NoMetric | Error::NoPair | Error::Rejected { .. })) => {
            Err(odd_one(sightings, params).map_or(error, Error::Apart))
        }
        Err(error) => Err(error),
    }
}

/// Cameras and points, of no certain scale.
fn placed(sightings: &Sightings, params: &Params) -> Result<State, Error> {
    let candidates = start::candidates(sightings, params)?;
    let state = polish::best(sightings, candidates, params)?;
    let pairs =
        sightings.cameras.iter().zip(&state.kept).flat_map(|(camera, kept)| camera.track.iter().zip(kept));
    let (mut seen, mut kept) = (0, 0);
    for (_, is_kept) in pairs.filter(|(seen, _)| seen.is_some()) {
        seen += 1;
        kept += usize::from(*is_kept);
    }
    match 2 * kept < seen {
        true => Err(Error::Rejected { rejected: seen - kept, seen }),
        false => Ok(state),
    }
}

/// Cameras that must stay when one is left out to see whether it is at fault.
const FEWEST_OTHERS: usize = 3;
/// The others must fit so many times better without it than without any other.
const CLEARLY: f64 = 2.0;

/// The one camera without which the others fit.
fn odd_one(sightings: &Sightings, params: &Params) -> Option<String> {
    let count = sightings.cameras.len();
    let without = |c: usize| {
        let mut others = sightings.clone();
        let left_out = others.cameras.remove(c);
        let state = placed(&others, params).ok()?;
        let rms = state.rms_px.iter().copied().fold(0.0, f64::max);
        Some((rms, left_out.id))
    };
    let enough = (count > FEWEST_OTHERS).then_some(count)?;
    let mut fits: Vec<(f64, String)> = (0..enough).into_par_iter().filter_map(without).collect();
    fits.sort_by(|a, b| a.0.total_cmp(&b.0));
    match fits.as_slice() {
        [(_, id)] => Some(id.clone()),
        [(best, id), (next, _), ..] if CLEARLY * best < *next => Some(id.clone()),
        _ => None,
    }
}

/// Frames in which a camera must see the point.
pub const LEAST_FRAMES: usize = 20;

fn check(sightings: &Sightings, params: &Params) -> Result<(), Error> {
    let known = sightings.cameras.iter().filter(|camera| camera.lens.is_some()).count();
    let count = sightings.cameras.len();
    if count < 2 || count < 3 && known < count {
        return Err(Error::TooFewCameras(count));
    }
    if known != 0 && known != count {
        let missing = sightings.cameras.iter().find(|camera| camera.lens.is_none());
        return Err(Error::LensMissing(missing.map(|camera| camera.id.clone()).unwrap_or_default()));
    }
    for camera in &sightings.cameras {
        assert_eq!(camera.track.len(), sightings.frames.len(), "one entry per frame");
        let seen = camera.track.iter().flatten().count();
        if seen < LEAST_FRAMES {
            return Err(Error::TooFewFrames { camera: camera.id.clone(), seen });
        }
    }
    let [short, long] = params.focal_range;
    let ranges =
        [("coarse", params.coarse, 0.5), ("reject", params.reject, 1e3), ("focal_range", long - short, 1e4)];
    match ranges.into_iter().find(|(_, value, most)| !(*value > 0.0 && value <= most)) {
        Some((name, value, _)) => Err(Error::Parameter { name, value }),
        None if short > 0.0 => Ok(()),
        None => Err(Error::Parameter { name: "focal_range", value: short }),
    }
}
