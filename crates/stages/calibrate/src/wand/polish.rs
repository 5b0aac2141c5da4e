//! Bundle adjustments of a waved point, with ever more of the lens set free.

use super::agree::agreed;
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
const ROUNDS: usize = 12;
/// In the first rounds limits are wider, by half as much in each.
const WIDE_ROUNDS: i32 = 4;
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
    let (_, state) = best.ok_or(Error::NoMetric)?;
    let models = models(sightings, state, first, params, loss)?;
    simplest(sightings, models, params)
}

/// How far off a sighting may be before the lens is known, px, in the smallest image.
fn coarse_px(sightings: &Sightings, params: &Params) -> f64 {
    let diagonals = sightings.cameras.iter().map(|camera| {
        let [width, height] = camera.image_size.map(f64::from);
        width.hypot(height)
    });
    0.5 * params.coarse * diagonals.fold(f64::INFINITY, f64::min)
}

/// A state with what is free in it.
type Model = (Free, State);

/// The lens models from the simplest to the fullest that is asked for, each started from a simpler one: more and more distortion
/// with the principal points held, then the same with them free.
fn models(
    sightings: &Sightings,
    start: State,
    first: Free,
    params: &Params,
    loss: Loss,
) -> Result<Vec<Model>, Error> {
    let mut models: Vec<Model> = Vec::new();
    let mut state = start;
    for distortion in levels(params.free.distortion) {
        let free = Free { distortion, ..first };
        let adjusted = state.adjusted(sightings, free, loss, 100)?;
        state.take(&adjusted);
        models.push((free, state.clone()));
    }
    if params.free.center {
        for (free, mut state) in models.clone() {
            let free = Free { center: true, ..free };
            let adjusted = state.adjusted(sightings, free, loss, 100)?;
            state.take(&adjusted);
            models.push((free, state));
        }
    }
    Ok(models)
}

/// None of the terms, k₁, k₂ too, and all that are asked for.
fn levels(asked: [bool; 5]) -> Vec<[bool; 5]> {
    let [k1, k2, ..] = asked;
    let mut levels = vec![[false; 5], [k1, false, false, false, false], [k1, k2, false, false, false], asked];
    levels.dedup();
    levels
}

/// The model with the least information criterion [Schwarz1978]: terms of the lens that the sightings hardly tell would run
/// wild outside of what the point has covered, where the lens is used all the same.
fn simplest(sightings: &Sightings, mut models: Vec<Model>, params: &Params) -> Result<State, Error> {
    let Some((free, fullest)) = models.pop() else { return Err(Error::NoMetric) };
    let settled = settle(sightings, fullest, free, params)?;
    let kept = settled.kept.clone();
    let mut best = (settled.criterion(sightings, free), free, settled);
    for (free, mut state) in models {
        state.kept.clone_from(&kept);
        state.points = (0..kept[0].len()).map(|frame| state.nearest(sightings, frame)).collect();
        let Ok(adjusted) = state.adjusted(sightings, free, Loss::Squares, 200) else { continue };
        state.take(&adjusted);
        let criterion = state.criterion(sightings, free);
        if criterion < best.0 {
            best = (criterion, free, state);
        }
    }
    let (_, free, state) = best;
    settle(sightings, state, free, params)
}

/// Takes out sightings that are far off for their camera, lets in those that are not, and adjusts again until none changes. The
/// limits close in: at first a camera may be off because of what others saw wrongly.
fn settle(sightings: &Sightings, mut state: State, free: Free, params: &Params) -> Result<State, Error> {
    for round in 0..ROUNDS {
        let before = state.kept.clone();
        let slack = 0.5_f64.powi(round as i32 - WIDE_ROUNDS).max(1.0);
        let typical = state.sort_out(sightings, params.reject * slack);
        let loss = if slack > 1.0 { Loss::Huber { scale_px: 2.0 * typical } } else { Loss::Squares };
        let adjusted = state.adjusted(sightings, free, loss, 200)?;
        state.take(&adjusted);
        if slack <= 1.0 && state.kept == before {
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

    /// n ln(residual variance) + k ln n, over n coordinates and the lenses' k free parameters.
    fn criterion(&self, sightings: &Sightings, free: Free) -> f64 {
        let views = self.views(sightings);
        let squares = views.iter().filter_map(|&(c, frame, pixel)| {
            Some((self.cameras[c].project(&self.points[frame]?)? - pixel).norm_squared())
        });
        let count = 2.0 * views.len() as f64;
        let terms = free.distortion.iter().filter(|term| **term).count() + if free.center { 2 } else { 0 };
        count * (squares.sum::<f64>() / count).ln() + (terms * self.cameras.len()) as f64 * count.ln()
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

    /// Places every point anew from the sightings that agree, and believes those that are not far off for their camera. Returns the
    /// cameras' middle standard deviation, px.
    fn sort_out(&mut self, sightings: &Sightings, reject: f64) -> f64 {
        let points: Vec<Option<Point3<f64>>> =
            (0..sightings.frames.len()).map(|frame| self.nearest(sightings, frame)).collect();
        let spreads: Vec<f64> = (0..self.cameras.len()).map(|c| self.spread(sightings, &points, c)).collect();
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
        let mut sorted = spreads;
        sorted.sort_by(f64::total_cmp);
        sorted[sorted.len() / 2].max(FLOOR_PX / reject)
    }

    /// The point nearest to the rays of those who are believed. Sightings are sorted out by it, so that spreads are those about it,
    /// too: it weighs millimetres, and lies farther from a long lens's pixels than the bundle adjustment's point.
    fn nearest(&self, sightings: &Sightings, frame: usize) -> Option<Point3<f64>> {
        let views = self.cameras.iter().zip(&sightings.cameras).zip(&self.kept);
        let believed = views
            .filter_map(|((camera, seen), kept)| Some((camera, seen.track[frame].filter(|_| kept[frame])?)));
        Camera::nearest_to_rays(believed.collect::<Vec<_>>())
    }

    /// Standard deviation of a camera's residuals in one coordinate, by their median length.
    fn spread(&self, sightings: &Sightings, points: &[Option<Point3<f64>>], camera: usize) -> f64 {
        let track = &sightings.cameras[camera].track;
        let off =
            |frame: usize| Some((self.cameras[camera].project(&points[frame]?)? - track[frame]?).norm());
        let kept = (0..track.len()).filter(|&frame| self.kept[camera][frame]);
        let mut lengths: Vec<f64> = kept.filter_map(off).collect();
        lengths.sort_by(f64::total_cmp);
        lengths.get(lengths.len() / 2).map_or(0.0, |median| median / RAYLEIGH_MEDIAN)
    }
}
