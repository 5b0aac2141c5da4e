//! Bundle adjustments of a waved point, with ever more of the lens set free.

use super::{Error, Params, Sightings};
use crate::bundle::{self, Element, Focal, Free, Loss, Observation, Scene, adjust};
use artifact::CameraDeviation;
use camera::Camera;
use nalgebra::{Point3, Vector2, Vector3};

/// Cameras and points as far as they are known.
#[derive(Debug, Clone)]
pub(super) struct State {
    pub(super) cameras: Vec<Camera>,
    /// Per frame the point.
    pub(super) points: Vec<Option<Point3<f64>>>,
    /// Per camera and frame whether the sighting is believed.
    pub(super) kept: Vec<Vec<bool>>,
    pub(super) rms_px: Vec<f64>,
    pub(super) deviations: Option<Vec<CameraDeviation>>,
}

/// Steps in which candidates compete.
const TRIAL_STEPS: usize = 40;
/// Rounds in which sightings are taken out and let in again.
const ROUNDS: usize = 6;
/// A residual below this is never an outlier, px: cameras may agree better than any sensor can.
const FLOOR_PX: f64 = 0.25;
/// Standard deviation of one coordinate in the median length of a residual of two.
const RAYLEIGH_MEDIAN: f64 = 1.1774;

/// The best of the candidates, with the lenses that the parameters ask for.
pub(super) fn best(sightings: &Sightings, candidates: Vec<State>, params: &Params) -> Result<State, Error> {
    let coarse = coarse_px(sightings, params);
    let is_held = params.free.focal == Focal::Held;
    let first = Free { focal: if is_held { Focal::Held } else { Focal::Tied }, ..Free::POSE };
    let loss = Loss::Huber { scale_px: 0.25 * coarse };
    let mut best: Option<(f64, State)> = None;
    for mut state in candidates {
        state.face(sightings);
        let Ok(adjusted) = state.adjusted(sightings, first, loss, TRIAL_STEPS) else { continue };
        let cost: f64 = adjusted.residuals.iter().map(|r| loss.cost(r.norm_squared())).sum();
        let mean = cost / adjusted.residuals.len() as f64;
        let focals = adjusted.cameras.iter().zip(&sightings.cameras);
        let is_sane = focals.clone().all(|(camera, seen)| {
            let [width, height] = seen.image_size.map(f64::from);
            let share = camera.lens.focal_px.x / (0.5 * width.hypot(height));
            share > 0.5 * params.focal_range[0] && share < 2.0 * params.focal_range[1]
        });
        if is_sane && best.as_ref().is_none_or(|(least, _)| mean < *least) {
            state.take(&adjusted);
            best = Some((mean, state));
        }
    }
    let (_, mut state) = best.ok_or(Error::NoMetric)?;
    for free in ladder(first, params.free) {
        let adjusted = state.adjusted(sightings, free, loss, 100)?;
        state.take(&adjusted);
    }
    settle(sightings, state, params)
}

/// How far off a sighting may be before the lens is known, px, in the smallest image.
fn coarse_px(sightings: &Sightings, params: &Params) -> f64 {
    let diagonals = sightings.cameras.iter().map(|camera| {
        let [width, height] = camera.image_size.map(f64::from);
        width.hypot(height)
    });
    0.5 * params.coarse * diagonals.fold(f64::INFINITY, f64::min)
}

/// What is set free, step by step: the strongest distortion first, the principal point last, since it can stand in for a turn.
fn ladder(first: Free, last: Free) -> Vec<Free> {
    let mut radial = first;
    radial.distortion[0] = last.distortion[0];
    let mut lens = radial;
    lens.distortion[1] = last.distortion[1];
    vec![radial, lens, last]
}

/// Takes out sightings that are far off for their camera, lets in those that are not, and adjusts again until none changes.
fn settle(sightings: &Sightings, mut state: State, params: &Params) -> Result<State, Error> {
    for _ in 0..ROUNDS {
        let before = state.kept.clone();
        state.sort_out(sightings, params.reject);
        let adjusted = state.adjusted(sightings, params.free, Loss::Squares, 200)?;
        state.take(&adjusted);
        if state.kept == before {
            break;
        }
    }
    Ok(state)
}

impl State {
    pub(super) fn new(cameras: Vec<Camera>, points: Vec<Option<Point3<f64>>>, kept: Vec<Vec<bool>>) -> Self {
        let rms_px = vec![0.0; cameras.len()];
        Self { cameras, points, kept, rms_px, deviations: None }
    }

    /// Mean distance of the cameras from the middle of the points.
    pub(super) fn mean_distance(&self) -> f64 {
        let points: Vec<&Point3<f64>> = self.points.iter().flatten().collect();
        let middle = points.iter().map(|point| point.coords).sum::<Vector3<f64>>() / points.len() as f64;
        let distances = self.cameras.iter().map(|camera| (camera.eye_in_world().coords - middle).norm());
        distances.sum::<f64>() / self.cameras.len() as f64
    }

    /// Makes everything larger.
    pub(super) fn scale(&mut self, factor: f64) {
        self.cameras.iter_mut().for_each(|camera| camera.cam_from_world.translation.vector *= factor);
        self.points.iter_mut().flatten().for_each(|point| point.coords *= factor);
    }

    /// Takes out sightings of points that are not before their camera.
    fn face(&mut self, sightings: &Sightings) {
        for (c, camera) in self.cameras.iter().enumerate() {
            for frame in 0..sightings.frames.len() {
                let is_before = self.points[frame].is_some_and(|point| camera.project(&point).is_some());
                self.kept[c][frame] &= is_before;
            }
        }
    }

    /// Believed sightings of frames in which at least two cameras are believed: (camera, frame, pixel), frame after frame.
    fn views(&self, sightings: &Sightings) -> Vec<(usize, usize, Vector2<f64>)> {
        let mut views = Vec::new();
        for frame in 0..sightings.frames.len() {
            let start = views.len();
            for (c, camera) in sightings.cameras.iter().enumerate() {
                if let Some(pixel) = camera.track[frame].filter(|_| self.kept[c][frame]) {
                    views.push((c, frame, pixel));
                }
            }
            if views.len() < start + 2 || self.points[frame].is_none() {
                views.truncate(start);
            }
        }
        views
    }

    fn adjusted(
        &self,
        sightings: &Sightings,
        free: Free,
        loss: Loss,
        max_steps: usize,
    ) -> Result<bundle::Adjusted, Error> {
        let mut scene = Scene::new(self.cameras.clone(), vec![free; self.cameras.len()]);
        scene.structure =
            self.points.iter().map(|point| Element::Point(point.unwrap_or_else(Point3::origin))).collect();
        let observation = |(camera, element, pixel)| Observation { camera, element, point: 0, pixel };
        scene.observations = self.views(sightings).into_iter().map(observation).collect();
        Ok(adjust(&scene, &bundle::Params { loss, structure_moves: true, max_steps })?)
    }

    fn take(&mut self, adjusted: &bundle::Adjusted) {
        self.cameras.clone_from(&adjusted.cameras);
        self.rms_px = adjusted.camera_rms_px.iter().map(|rms| rms.unwrap_or(0.0)).collect();
        self.deviations.clone_from(&adjusted.deviations);
        for (point, element) in self.points.iter_mut().zip(&adjusted.structure) {
            if let (Some(point), Element::Point(place)) = (point, element) {
                *point = *place;
            }
        }
    }

    /// Places every point anew from the sightings that agree, and believes those that are not far off for their camera.
    fn sort_out(&mut self, sightings: &Sightings, reject: f64) {
        let spreads: Vec<f64> = (0..self.cameras.len()).map(|c| self.spread(sightings, c)).collect();
        let limit = |c: usize| (reject * spreads[c]).max(FLOOR_PX);
        for frame in 0..sightings.frames.len() {
            let seen: Vec<(usize, Vector2<f64>)> = sightings
                .cameras
                .iter()
                .enumerate()
                .filter_map(|(c, camera)| Some((c, camera.track[frame]?)))
                .collect();
            let (point, agree) = agreed(&self.cameras, &seen, &limit);
            self.points[frame] = point;
            (0..self.cameras.len()).for_each(|c| self.kept[c][frame] = agree.contains(&c));
        }
    }

    /// Standard deviation of a camera's residuals in one coordinate, by their median length.
    fn spread(&self, sightings: &Sightings, camera: usize) -> f64 {
        let track = &sightings.cameras[camera].track;
        let mut lengths: Vec<f64> = (0..track.len())
            .filter(|&frame| self.kept[camera][frame])
            .filter_map(|frame| {
                Some((self.cameras[camera].project(&self.points[frame]?)? - track[frame]?).norm())
            })
            .collect();
        lengths.sort_by(f64::total_cmp);
        lengths.get(lengths.len() / 2).map_or(0.0, |median| median / RAYLEIGH_MEDIAN)
    }
}

/// The point that most sightings agree on, and who they are: without the worst, until all are within their limits.
fn agreed(
    cameras: &[Camera],
    seen: &[(usize, Vector2<f64>)],
    limit: &dyn Fn(usize) -> f64,
) -> (Option<Point3<f64>>, Vec<usize>) {
    let mut left = seen.to_vec();
    while left.len() >= 2 {
        let point = Camera::nearest_to_rays(left.iter().map(|(c, pixel)| (&cameras[*c], *pixel)));
        let excess = |(c, pixel): &(usize, Vector2<f64>)| {
            let projected = point.and_then(|point| cameras[*c].project(&point));
            projected.map_or(f64::INFINITY, |projected| (projected - pixel).norm() / limit(*c))
        };
        let excesses: Vec<f64> = left.iter().map(excess).collect();
        let worst = (0..left.len()).max_by(|&a, &b| excesses[a].total_cmp(&excesses[b])).unwrap_or(0);
        if excesses[worst] <= 1.0 {
            return (point, left.into_iter().map(|(c, _)| c).collect());
        }
        left.remove(worst);
    }
    (None, Vec::new())
}
