//! From sightings to first guesses of all cameras.

use super::metric::{FocalRange, Metric, metric_candidates};
use super::pair::{Pair, pair};
use super::polish::State;
use super::projective::Projective;
use super::{Error, Params, Sightings, Track, WandCamera};
use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Matrix3, Point3, Vector2, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// How many reconstructions compete.
const CANDIDATES: usize = 8;
/// Rounds of the factorisation.
const ROUNDS: usize = 60;
/// Focal lengths that are tried for each of two cameras.
const FOCAL_STEPS: usize = 36;

/// Reconstructions that may be right, the likeliest first.
pub(super) fn candidates(sightings: &Sightings, params: &Params) -> Result<Vec<State>, Error> {
    let mut tracks: Vec<Track> = sightings.cameras.iter().map(normalised).collect();
    let limit = params.coarse;
    let mut rng = ChaCha8Rng::seed_from_u64(params.seed);
    let pairs = pairs(&tracks, limit, &mut rng);
    drop_outliers(&mut tracks, &pairs);
    let start = pairs.iter().max_by_key(|pair| pair.agree.len()).ok_or(Error::NoPair)?;
    let mut scene = Projective::grow(&tracks, start, limit, &mut rng).ok_or(Error::NoPair)?;
    if let Some(apart) = scene.cameras.iter().position(Option::is_none) {
        return Err(Error::Apart(sightings.cameras[apart].id.clone()));
    }
    drop_far(&mut tracks, &scene, limit);
    scene.factorise(&tracks, ROUNDS);
    let lenses: Option<Vec<Lens>> = sightings.cameras.iter().map(|camera| camera.lens).collect();
    let found = match lenses {
        Some(lenses) => known_lenses(sightings, scene, &lenses),
        None => metric_candidates(
            &scene,
            &FocalRange { ends: params.focal_range, steps: FOCAL_STEPS },
            CANDIDATES,
        ),
    };
    let found = found.map_err(|behind| astray(sightings, &behind))?;
    let kept: Vec<Vec<bool>> =
        tracks.iter().map(|track| track.iter().map(Option::is_some).collect()).collect();
    Ok(found.into_iter().map(|metric| state(sightings, metric, &kept)).collect())
}

/// Half the diagonal of an image, px: the unit of normalised images.
fn unit(image_size: [u32; 2]) -> f64 {
    let [width, height] = image_size.map(f64::from);
    0.5 * width.hypot(height)
}

fn middle(image_size: [u32; 2]) -> Vector2<f64> {
    Vector2::from(image_size.map(|side| 0.5 * (f64::from(side) - 1.0)))
}

/// A camera's track around the principal point, in half diagonals; without distortion where the lens is known.
fn normalised(camera: &WandCamera) -> Track {
    let unit = unit(camera.image_size);
    let place = |pixel: Vector2<f64>| match &camera.lens {
        Some(lens) => Some(lens.unproject(pixel)?.xy().component_mul(&lens.focal_px) / unit),
        None => Some((pixel - middle(camera.image_size)) / unit),
    };
    camera.track.iter().map(|seen| seen.and_then(place)).collect()
}

fn pairs(tracks: &[Track], limit: f64, rng: &mut ChaCha8Rng) -> Vec<Pair> {
    let all = (0..tracks.len()).flat_map(|a| (a + 1..tracks.len()).map(move |b| [a, b]));
    all.filter_map(|cameras| pair(tracks, cameras, limit, rng)).collect()
}

/// Takes out sightings that differ with more cameras than they agree with.
fn drop_outliers(tracks: &mut [Track], pairs: &[Pair]) {
    let mut votes = vec![vec![0_i32; tracks.first().map_or(0, Vec::len)]; tracks.len()];
    for pair in pairs {
        for camera in pair.cameras {
            pair.agree.iter().for_each(|&frame| votes[camera][frame] += 1);
            pair.differ.iter().for_each(|&frame| votes[camera][frame] -= 1);
        }
    }
    for (track, votes) in tracks.iter_mut().zip(votes) {
        track.iter_mut().zip(votes).filter(|(_, votes)| *votes < 0).for_each(|(seen, _)| *seen = None);
    }
}

/// Takes out sightings that are far from their points, and all of a frame without a point.
fn drop_far(tracks: &mut [Track], scene: &Projective, limit: f64) {
    for (camera, frame, error) in scene.errors(tracks) {
        if error >= limit {
            tracks[camera][frame] = None;
        }
    }
    for track in tracks {
        track
            .iter_mut()
            .zip(&scene.points)
            .filter(|(_, point)| point.is_none())
            .for_each(|(seen, _)| *seen = None);
    }
}

/// What cameras are whose points lie behind them.
fn astray(sightings: &Sightings, behind: &[usize]) -> Error {
    match 2 * behind.len() < sightings.cameras.len() {
        true => Error::Mirrored(behind.iter().map(|&c| sightings.cameras[c].id.clone()).collect()),
        false => Error::NoMetric,
    }
}

/// The reconstruction with focal lengths that are known.
fn known_lenses(
    sightings: &Sightings,
    mut scene: Projective,
    lenses: &[Lens],
) -> Result<Vec<Metric>, Vec<usize>> {
    let focal = |c: usize| lenses[c].focal_px / unit(sightings.cameras[c].image_size);
    for (c, camera) in scene.cameras.iter_mut().enumerate() {
        let inverse = Matrix3::from_diagonal(&Vector3::new(1.0 / focal(c).x, 1.0 / focal(c).y, 1.0));
        *camera = camera.map(|camera| inverse * camera);
    }
    let mut found = metric_candidates(&scene, &FocalRange { ends: [1.0, 1.0], steps: 1 }, CANDIDATES)?;
    for metric in &mut found {
        metric.cameras.iter_mut().enumerate().for_each(|(c, (found, _))| *found = focal(c).x);
    }
    Ok(found)
}

/// Cameras in pixels, with the points about 1000 mm away.
fn state(sightings: &Sightings, metric: Metric, kept: &[Vec<bool>]) -> State {
    let camera = |(camera, (focal, pose)): (&WandCamera, &(f64, nalgebra::Isometry3<f64>))| {
        let lens = camera.lens.unwrap_or(Lens {
            focal_px: Vector2::repeat(focal * unit(camera.image_size)),
            center_px: middle(camera.image_size),
            distortion: BrownConrady::default(),
        });
        Camera { image_size: camera.image_size, lens, cam_from_world: *pose }
    };
    let cameras = sightings.cameras.iter().zip(&metric.cameras).map(camera).collect();
    let points: Vec<Option<Point3<f64>>> = metric.points;
    let mut state = State::new(cameras, points, kept.to_vec());
    state.scale(1000.0 / state.mean_distance());
    state
}
