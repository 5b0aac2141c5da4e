//! The head as a rigid body: the places of its markers over the whole take, and its pose in a frame.

use crate::Error;
use crate::robust::{huber_mean, huber_weight, median};
use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

/// All markers in one frame; `None` where one is missing.
pub(crate) type Row = [Option<Point3<f64>>];

/// Breadth over length of a set of points below which it counts as a line: its rotation about the line is then
/// known 30 times worse than the others.
const LINE_RATIO: f64 = 0.03;
/// A marker further from its place than this many times the usual distance has slipped or is another one …
const GATE_SCALES: f64 = 6.0;
/// … unless it is nearer than this, mm: skin under a head marker moves that much.
const GATE_FLOOR_MM: f64 = 3.0;
/// Huber's limit in multiples of the usual distance.
const HUBER_SCALES: f64 = 2.5;
/// A marker's deviation counts as at least this share of the usual one, so that none outvotes all others.
const STEADY_SHARE: f64 = 0.5;
/// Below this movement (mm) the places have converged.
const CONVERGED_MM: f64 = 1e-6;
/// Rounds of the places' estimation; real takes need about ten.
const ROUNDS: usize = 50;
/// Usual distance (mm) that noise-free data are granted, so that limits stay above rounding.
const SCALE_FLOOR_MM: f64 = 1e-3;

/// Markers that keep their distances.
#[derive(Debug, Clone)]
pub(crate) struct RigidBody {
    /// The take's markers that it is made of.
    pub(crate) markers: Vec<usize>,
    /// Their places in body space, mm.
    pub(crate) places: Vec<Point3<f64>>,
    /// Their weights in a fit, the steadier the more; the usual marker has 1.
    pub(crate) weights: Vec<f64>,
    /// Median distance of a sample from its place, mm.
    pub(crate) scale_mm: f64,
}

/// The body's pose in one frame.
#[derive(Debug, Clone)]
pub(crate) struct BodyFit {
    /// Body to world, mm.
    pub(crate) world_from_body: Isometry3<f64>,
    /// Per marker of the body whether it was used: seen, and near its place.
    pub(crate) used: Vec<bool>,
}

impl RigidBody {
    /// The body that fits the markers best over all frames: generalised Procrustes analysis [Gower1975] with
    /// missing samples. Each round fits the places to every frame [Horn1987] and moves each place to Huber's mean of
    /// its marker's samples carried back to body space. No frame is special, so a noisy one biases nothing.
    ///
    /// # Errors
    /// [`Error::NeverSeen`] if no frame shows three of the markers, [`Error::Collinear`] if they lie on a line.
    pub(crate) fn estimate(frames: &[&Row], markers: &[usize], ids: &[String]) -> Result<Self, Error> {
        let names = || markers.iter().map(|&m| ids[m].clone()).collect::<Vec<_>>();
        let seen = |row: &&&Row| markers.iter().filter(|&&m| row[m].is_some()).count();
        // The earliest of the fullest frames.
        let start = frames.iter().rev().max_by_key(seen).filter(|row| seen(row) >= 3);
        let start = start.ok_or_else(|| Error::NeverSeen(names()))?;
        let mut places: Vec<Option<Point3<f64>>> = markers.iter().map(|&m| start[m]).collect();
        let mut scale = f64::INFINITY;
        let mut weights = vec![1.0; places.len()];
        for _ in 0..ROUNDS {
            let samples = body_samples(frames, markers, &places, &weights, scale);
            let shift = move_places(&mut places, &samples, scale);
            let settled = (scale - median_distance(&places, &samples)).abs() < CONVERGED_MM;
            scale = median_distance(&places, &samples).max(SCALE_FLOOR_MM);
            weights = steadiness(&places, &samples);
            if shift < CONVERGED_MM && settled {
                break;
            }
        }
        // A marker without a place is never seen with three others: it takes no part.
        let placed: Vec<(usize, Point3<f64>, f64)> =
            (0..places.len()).filter_map(|i| Some((markers[i], places[i]?, weights[i]))).collect();
        let (markers, places): (Vec<usize>, Vec<Point3<f64>>) = placed.iter().map(|p| (p.0, p.1)).unzip();
        let weights = placed.iter().map(|p| p.2).collect();
        if is_line(&places) {
            return Err(Error::Collinear(names()));
        }
        Ok(Self { markers, places, weights, scale_mm: scale })
    }

    /// The pose in one frame, and which markers it rests on. A marker that is far from its place is left out, if the
    /// others agree without it. `None` if fewer than three are left or they disagree.
    pub(crate) fn fit(&self, row: &Row) -> Option<BodyFit> {
        self.fit_shape(&self.places, row)
    }

    /// As [`RigidBody::fit`], with the body in another shape.
    pub(crate) fn fit_shape(&self, places: &[Point3<f64>], row: &Row) -> Option<BodyFit> {
        let seen: Vec<_> = self.markers.iter().map(|&m| row[m]).collect();
        fit(places, &seen, &self.weights, self.scale_mm)
    }
}

/// Robust fit of places to what is seen of them.
fn fit(places: &[Point3<f64>], seen: &Row, weights: &[f64], scale: f64) -> Option<BodyFit> {
    let gate = (GATE_SCALES * scale).max(GATE_FLOOR_MM);
    let mut used: Vec<bool> = seen.iter().map(Option::is_some).collect();
    loop {
        let pose = fit_weighted(places, seen, weights, &used, scale)?;
        let worst = distances(&pose, places, seen, &used).into_iter().fold(0.0, f64::max);
        if worst <= gate {
            return Some(BodyFit { world_from_body: pose, used });
        }
        leave_one_out(places, seen, weights, &mut used)?;
    }
}

/// Takes out the marker without which the others agree best; `None` if only three are left: each could be wrong.
fn leave_one_out(places: &[Point3<f64>], seen: &Row, weights: &[f64], used: &mut [bool]) -> Option<()> {
    if used.iter().filter(|&&used| used).count() <= 3 {
        return None;
    }
    let mut best: Option<(f64, usize)> = None;
    for i in (0..used.len()).filter(|&i| used[i]).collect::<Vec<_>>() {
        used[i] = false;
        let pose = fit_weighted(places, seen, weights, used, f64::INFINITY);
        let square = pose.map(|pose| distances(&pose, places, seen, used).iter().map(|d| d * d).sum::<f64>());
        if let Some(square) = square.filter(|square| best.is_none_or(|(least, _)| *square < least)) {
            best = Some((square, i));
        }
        used[i] = true;
    }
    used[best?.1] = false;
    Some(())
}

/// The transform `seen_from_places`: weighted least squares [Horn1987], reweighted by Huber's rule [Huber1964] while
/// any distance passes 2.5 `scale`, mm. `None` where fewer than three are used, or they lie on a line.
pub(crate) fn fit_weighted(
    places: &[Point3<f64>],
    seen: &Row,
    weights: &[f64],
    used: &[bool],
    scale: f64,
) -> Option<Isometry3<f64>> {
    const REWEIGHTINGS: usize = 5;
    let seen_used = |i: &usize| used[*i] && seen[*i].is_some();
    let chosen: Vec<usize> = (0..places.len()).filter(seen_used).collect();
    let source: Vec<Point3<f64>> = chosen.iter().map(|&i| places[i]).collect();
    let target: Vec<Point3<f64>> = chosen.iter().filter_map(|&i| seen[i]).collect();
    if is_line(&source) {
        return None;
    }
    let steady: Vec<f64> = chosen.iter().map(|&i| weights[i]).collect();
    let mut pose = camera::fit_rigid(&source, &target, Some(&steady)).ok()?;
    for _ in 0..REWEIGHTINGS {
        let off = source.iter().zip(&target).map(|(from, to)| (pose * from - to).norm());
        let huber: Vec<f64> = off.map(|off| huber_weight(off, HUBER_SCALES * scale)).collect();
        if huber.iter().all(|weight| *weight == 1.0) {
            break;
        }
        let both: Vec<f64> = huber.iter().zip(&steady).map(|(huber, steady)| huber * steady).collect();
        pose = camera::fit_rigid(&source, &target, Some(&both)).ok()?;
    }
    Some(pose)
}

/// Per marker the inverse square of its median distance from its place, against the usual marker's.
fn steadiness(places: &[Option<Point3<f64>>], samples: &[Vec<Vector3<f64>>]) -> Vec<f64> {
    let deviation = |(place, samples): (&Option<Point3<f64>>, &Vec<Vector3<f64>>)| {
        place.map_or(0.0, |place| {
            median(&mut samples.iter().map(|sample| (sample - place.coords).norm()).collect::<Vec<_>>())
        })
    };
    let deviations: Vec<f64> = places.iter().zip(samples).map(deviation).collect();
    let usual = median(&mut deviations.clone()).max(SCALE_FLOOR_MM);
    deviations.iter().map(|deviation| (usual / deviation.max(STEADY_SHARE * usual)).powi(2)).collect()
}

fn distances(pose: &Isometry3<f64>, places: &[Point3<f64>], seen: &Row, used: &[bool]) -> Vec<f64> {
    places
        .iter()
        .zip(seen)
        .zip(used)
        .filter(|(_, used)| **used)
        .filter_map(|((place, seen), _)| seen.map(|seen| (pose * place - seen).norm()))
        .collect()
}

/// Per marker its samples in body space, from all frames that can be fitted.
fn body_samples(
    frames: &[&Row],
    markers: &[usize],
    places: &[Option<Point3<f64>>],
    weights: &[f64],
    scale: f64,
) -> Vec<Vec<Vector3<f64>>> {
    let known: Vec<usize> = (0..places.len()).filter(|&i| places[i].is_some()).collect();
    let known_places: Vec<Point3<f64>> = places.iter().flatten().copied().collect();
    let known_weights: Vec<f64> = known.iter().map(|&i| weights[i]).collect();
    let mut samples = vec![Vec::new(); places.len()];
    for row in frames {
        let seen: Vec<_> = known.iter().map(|&i| row[markers[i]]).collect();
        let Some(found) = fit(&known_places, &seen, &known_weights, scale) else { continue };
        let rejected = |i: usize| known.iter().position(|&k| k == i).is_some_and(|k| !found.used[k]);
        for (i, samples) in samples.iter_mut().enumerate() {
            if let Some(point) = row[markers[i]].filter(|_| !rejected(i)) {
                samples.push(found.world_from_body.inverse_transform_point(&point).coords);
            }
        }
    }
    samples
}

/// Moves each place to the middle of its samples; returns the largest step, mm.
fn move_places(places: &mut [Option<Point3<f64>>], samples: &[Vec<Vector3<f64>>], scale: f64) -> f64 {
    let mut largest: f64 = 0.0;
    for (place, samples) in places.iter_mut().zip(samples) {
        let Some(mean) = huber_mean(samples, scale) else { continue };
        let step = place.map_or(f64::INFINITY, |place| (place.coords - mean).norm());
        largest = largest.max(step);
        *place = Some(mean.into());
    }
    largest
}

fn median_distance(places: &[Option<Point3<f64>>], samples: &[Vec<Vector3<f64>>]) -> f64 {
    let mut distances: Vec<f64> = places
        .iter()
        .zip(samples)
        .filter_map(|(place, samples)| place.map(|place| (place, samples)))
        .flat_map(|(place, samples)| samples.iter().map(move |sample| (sample - place.coords).norm()))
        .collect();
    median(&mut distances)
}

/// Whether points are too narrow to fix a rotation: the second principal deviation against the first.
pub(crate) fn is_line(points: &[Point3<f64>]) -> bool {
    if points.len() < 3 {
        return true;
    }
    let mean = points.iter().map(|p| p.coords).sum::<Vector3<f64>>() / points.len() as f64;
    let spread: Matrix3<f64> = points.iter().map(|p| (p.coords - mean) * (p.coords - mean).transpose()).sum();
    let mut axes: [f64; 3] = spread.symmetric_eigenvalues().into();
    axes.sort_by(f64::total_cmp);
    axes[1].max(0.0).sqrt() <= LINE_RATIO * axes[2].max(0.0).sqrt()
}
