//! Balls on a headband: they move with the head only.

use crate::body::{Body, Outside};
use crate::scenario::Scenario;
use crate::take::shapes::{ball, strip};
use mesh::Mesh;
use nalgebra::{Point3, Vector3};

/// A headband with blue balls.
pub(super) struct Headband {
    balls: Vec<(String, Point3<f64>)>,
    /// Band and balls, in the space of the resting face, with their reflectance.
    pub(super) mesh: Mesh,
    pub(super) albedo: Vec<[f32; 3]>,
}

/// Radius of a ball, mm.
pub(super) const BALL_MM: f64 = 1.8;
/// Height of the band, mm.
const BAND_MM: f64 = 7.0;
/// The band is at least this high over the skin, mm.
const OVER_SKIN_MM: f64 = 1.2;
/// The band goes on so far behind its outer balls, mm.
const OVERHANG_MM: f64 = 16.0;
const BAND_ALBEDO: [f32; 3] = [0.09, 0.09, 0.10];

impl Headband {
    pub(super) fn of(body: &Body, scenario: &Scenario) -> Self {
        let balls = body.headband();
        let mut points = Vec::new();
        let mut triangles: Vec<[u32; 3]> = Vec::new();
        let mut albedo = Vec::new();
        let mut add = |(positions, faces): (Vec<Point3<f64>>, Vec<[u32; 3]>), color: [f32; 3]| {
            let first = points.len() as u32;
            albedo.extend(std::iter::repeat_n(color, positions.len()));
            points.extend(positions.into_iter().map(|point| [point.x, point.y, point.z]));
            triangles.extend(faces.into_iter().map(|face| face.map(|corner| first + corner)));
        };
        for (_, center) in &balls {
            add(ball(center, BALL_MM), scenario.paint.dot_color);
        }
        let skin = body.outside();
        add(strip(&band(&skin, &balls), BAND_MM), BAND_ALBEDO);
        let mesh = Mesh::from_triangles(points, &triangles);
        Self { balls, mesh, albedo }
    }

    /// Ids of the balls.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.balls.iter().map(|(name, _)| name.as_str())
    }

    /// Centres of the balls, in the space of the resting face, mm.
    pub(super) fn centers(&self) -> impl Iterator<Item = Point3<f64>> {
        self.balls.iter().map(|(_, center)| *center)
    }
}

/// The band's middle line with the direction in which it is wide. It runs behind the balls, so that nothing of them
/// sinks into it, and lies against the skin without cutting into it.
fn band(skin: &Outside, balls: &[(String, Point3<f64>)]) -> Vec<(Point3<f64>, Vector3<f64>)> {
    let behind = |at: &Point3<f64>| at - skin.outwards(at) * (BALL_MM + 0.6);
    let line: Vec<Point3<f64>> = balls.iter().map(|(_, at)| behind(at)).collect();
    let curve: Vec<Point3<f64>> =
        smooth(&line).iter().map(|at| skin.lifted(at, OVER_SKIN_MM, 0.5 * BAND_MM + 1.0)).collect();
    let last = curve.len().saturating_sub(1);
    let wide = |i: usize| {
        let along = curve[(i + 1).min(last)] - curve[i.saturating_sub(1)];
        skin.outwards(&curve[i]).cross(&along).try_normalize(1e-9).unwrap_or_else(Vector3::y)
    };
    (0..curve.len()).map(|i| (curve[i], wide(i))).collect()
}

/// Pieces of the band between two balls.
const PIECES: usize = 10;

/// A curve through points (Catmull–Rom).
fn smooth(line: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let last = line.len().saturating_sub(1);
    let mut curve: Vec<Point3<f64>> = Vec::new();
    for i in 0..last {
        let (a, b) = (line[i].coords, line[i + 1].coords);
        let (before, after) = (line[i.saturating_sub(1)].coords, line[(i + 2).min(last)].coords);
        let (from, to) = (0.5 * (b - before), 0.5 * (after - a));
        for piece in 0..PIECES {
            let u = piece as f64 / PIECES as f64;
            let (u2, u3) = (u * u, u * u * u);
            let point = a * (2.0 * u3 - 3.0 * u2 + 1.0)
                + from * (u3 - 2.0 * u2 + u)
                + b * (3.0 * u2 - 2.0 * u3)
                + to * (u3 - u2);
            curve.push(point.into());
        }
    }
    curve.extend(line.last());
    // A band does not end at its last ball.
    if let [first, second, .., before, end] = curve[..] {
        let beyond = |from: Point3<f64>, way: Vector3<f64>| {
            (1..=4).map(move |piece| from + way.normalize() * (OVERHANG_MM * f64::from(piece) / 4.0))
        };
        curve.splice(0..0, beyond(first, first - second).collect::<Vec<_>>().into_iter().rev());
        curve.extend(beyond(end, end - before));
    }
    curve
}
