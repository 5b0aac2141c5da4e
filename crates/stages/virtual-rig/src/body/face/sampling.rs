//! Points on the face: contours first, then blue noise in between, denser at eyes and mouth.

use crate::body::face::outline::{Contour, EYE_HALF_WIDTH, eye_center, mouth_line};
use crate::body::face::person::Person;
use crate::body::face::profile::smooth_step;
use crate::body::face::surface;
use nalgebra::{Point2, Point3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::HashMap;

/// Points of the domain, and the contours among them.
pub(crate) struct Samples {
    /// Contour points first.
    pub(crate) domain: Vec<Point2<f64>>,
    pub(crate) space: Vec<Point3<f64>>,
    /// Per contour the indices of its points, in order around it.
    pub(crate) loops: Vec<Vec<usize>>,
}

/// Spacing of the points relative to the mean: fine around eyes and mouth, coarse on forehead and cheeks.
fn spacing(person: &Person, at: Point2<f64>) -> f64 {
    let eye = at - eye_center(person, at.x.signum());
    let from_eye = (eye.x.abs() - EYE_HALF_WIDTH).max(0.0).hypot((eye.y.abs() - 5.0).max(0.0));
    let from_mouth = (at.x.abs() - person.mouth_half_width).max(0.0).hypot(at.y - mouth_line(at.x));
    let from_nose = at.x.abs().max((at.y - 2.0).abs() * 1.4);
    let near = |distance: f64, reach: f64| 1.0 - smooth_step(distance / reach);
    1.25 - 0.75 * near(from_eye.min(from_mouth), 24.0).max(0.7 * near(from_nose, 30.0))
}

/// Cells of the domain (1 mm), to draw candidates where the points shall be dense.
struct Density {
    corners: Vec<Point2<f64>>,
    cumulative: Vec<f64>,
}

impl Density {
    fn of(person: &Person, inside: impl Fn(Point2<f64>) -> bool) -> Self {
        let (mut corners, mut cumulative, mut total) = (Vec::new(), Vec::new(), 0.0);
        for row in -96..118 {
            for column in -97..97 {
                let corner = Point2::new(f64::from(column), f64::from(row));
                let middle = corner + nalgebra::Vector2::new(0.5, 0.5);
                if !inside(middle) {
                    continue;
                }
                total += area_element(person, middle) / spacing(person, middle).powi(2);
                corners.push(corner);
                cumulative.push(total);
            }
        }
        Self { corners, cumulative }
    }

    fn total(&self) -> f64 {
        self.cumulative.last().copied().unwrap_or(0.0)
    }

    fn draw(&self, rng: &mut ChaCha8Rng) -> Point2<f64> {
        let level = rng.random_range(0.0..self.total());
        let cell = self.cumulative.partition_point(|&sum| sum <= level).min(self.corners.len() - 1);
        self.corners[cell] + nalgebra::Vector2::new(rng.random::<f64>(), rng.random::<f64>())
    }
}

/// Area on the surface of a square millimetre of the domain.
fn area_element(person: &Person, at: Point2<f64>) -> f64 {
    let here = surface::point(person, at);
    let along_s = surface::point(person, at + nalgebra::Vector2::new(0.1, 0.0)) - here;
    let along_t = surface::point(person, at + nalgebra::Vector2::new(0.0, 0.1)) - here;
    along_s.cross(&along_t).norm() / 0.01
}

/// Points kept apart from each other in space.
struct Apart {
    cell_size: f64,
    cells: HashMap<[i32; 3], Vec<(Point3<f64>, f64)>>,
}

impl Apart {
    fn cell(&self, point: Point3<f64>) -> [i32; 3] {
        std::array::from_fn(|axis| (point[axis] / self.cell_size).floor() as i32)
    }

    fn insert(&mut self, point: Point3<f64>, radius: f64) {
        self.cells.entry(self.cell(point)).or_default().push((point, radius));
    }

    /// Whether a point may stand here: no other within the mean of their two radii.
    fn is_free(&self, point: Point3<f64>, radius: f64) -> bool {
        let [x, y, z] = self.cell(point);
        let near =
            (-1..=1).flat_map(|i| (-1..=1).flat_map(move |j| (-1..=1).map(move |k| [x + i, y + j, z + k])));
        let mut others = near.filter_map(|cell| self.cells.get(&cell)).flatten();
        others.all(|(other, its)| (point - other).norm() >= 0.5 * (radius + its))
    }
}

/// Candidates per wanted point; more hardly add points.
const CANDIDATES: usize = 18;
/// Points that so many candidates leave, per square of the radius and unit of area (measured).
const PACKING: f64 = 0.61;
/// Spacing of contour points in radii: with 1 the points behind them would be crowded out.
const CONTOUR_STEP: f64 = 1.15;

/// Draws about `count` points.
pub(crate) fn sample(person: &Person, seed: u64, count: usize) -> Samples {
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x5eed_face);
    let outlines: Vec<Vec<Point2<f64>>> = Contour::ALL
        .iter()
        .map(|contour| (0..720).map(|i| contour.at(person, f64::from(i) / 720.0)).collect())
        .collect();
    let inside =
        |at: Point2<f64>| contains(&outlines[0], at) && !outlines[1..].iter().any(|hole| contains(hole, at));
    let density = Density::of(person, inside);
    let radius = (PACKING * density.total() / count as f64).sqrt();
    let mut samples = contour_points(person, radius);
    let mut apart = Apart { cell_size: 1.3 * radius, cells: HashMap::new() };
    for (domain, space) in samples.domain.iter().zip(&samples.space) {
        apart.insert(*space, radius * spacing(person, *domain));
    }
    for _ in 0..CANDIDATES * count {
        let at = density.draw(&mut rng);
        let (point, own) = (surface::point(person, at), radius * spacing(person, at));
        if apart.is_free(point, own) && inside(at) {
            apart.insert(point, own);
            samples.domain.push(at);
            samples.space.push(point);
        }
    }
    samples
}

/// Points on the contours, evenly spaced in space between the corners.
fn contour_points(person: &Person, radius: f64) -> Samples {
    let mut samples = Samples { domain: Vec::new(), space: Vec::new(), loops: Vec::new() };
    for contour in Contour::ALL {
        let first = samples.domain.len();
        let corners = contour.corners();
        for (i, &from) in corners.iter().enumerate() {
            let to = corners.get(i + 1).copied().unwrap_or(1.0);
            samples.domain.extend(even_steps(person, &contour, from, to, CONTOUR_STEP * radius));
        }
        samples.loops.push((first..samples.domain.len()).collect());
    }
    samples.space = samples.domain.iter().map(|&at| surface::point(person, at)).collect();
    samples
}

/// Points of a contour from parameter `from` on, up to but without `to`.
fn even_steps(person: &Person, contour: &Contour, from: f64, to: f64, step: f64) -> Vec<Point2<f64>> {
    const FINE: usize = 2000;
    let between = |x: f64| contour.at(person, from + (to - from) * x / FINE as f64);
    let at = |i: usize| between(i as f64);
    let mut steps = vec![0.0];
    for i in 0..FINE {
        let length = (surface::point(person, at(i + 1)) - surface::point(person, at(i))).norm();
        steps.push(steps[i] + length / (step * spacing(person, at(i))));
    }
    let count = steps[FINE].round().max(4.0);
    let place = |k: usize| {
        let sum = steps[FINE] * k as f64 / count;
        let next = steps.partition_point(|&step| step <= sum).clamp(1, FINE);
        let (low, high) = (steps[next - 1], steps[next]);
        between((next - 1) as f64 + (sum - low) / (high - low))
    };
    (0..count as usize).map(place).collect()
}

/// Whether a closed polygon contains a point.
pub(crate) fn contains(polygon: &[Point2<f64>], at: Point2<f64>) -> bool {
    let mut inside = false;
    for (i, a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        if (a.y > at.y) != (b.y > at.y) && at.x < a.x + (b.x - a.x) * (at.y - a.y) / (b.y - a.y) {
            inside = !inside;
        }
    }
    inside
}
