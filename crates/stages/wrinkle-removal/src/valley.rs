//! Regions along valley curves that were measured.

use crate::Error;
use artifact::{ValleyPoint, ValleysFrame};
use mesh::Mesh;
use nalgebra::Point3;

/// How far a region reaches from a valley by default, in widths: the profile of a wrinkle [BickelBotsch2007, Eq. 6] has fallen to
/// 1 % of its depth there. At 4 widths, what is left of its flanks would tilt the surface that fills the region.
pub const DEFAULT_REACH: f64 = 6.0;

/// Weights of the region within `reach` widths of the valleys of a frame, |p| < reach · w: 1 in it, 0 outside. Only what hangs
/// together with a valley within the reach belongs to it: not the other lip.
///
/// The valleys lie on the scan by face and barycentric coordinates; points of no depth are passed over.
///
/// # Errors
/// [`Error::UnknownFace`] where a valley lies on another mesh; [`Error::Parameter`]; [`Error::EmptyRegion`] where no valley has
/// a depth.
pub fn along_valleys(mesh: &Mesh, frame: &ValleysFrame, reach: f64) -> Result<Vec<f64>, Error> {
    if !(reach.is_finite() && reach > 0.0) {
        return Err(Error::Parameter { name: "reach in widths", value: reach, range: "a positive number" });
    }
    let triangles = mesh.triangles();
    let mut weights = vec![0.0; mesh.positions.len()];
    for (wrinkle, points) in &frame.valleys {
        if let Some(point) = points.iter().find(|point| point.face as usize >= triangles.len()) {
            let (wrinkle, face, face_count) = (wrinkle.clone(), point.face, triangles.len());
            return Err(Error::UnknownFace { wrinkle, face, face_count });
        }
        for run in points.split(|point| point.d_mm <= 0.0).filter(|run| !run.is_empty()) {
            let curve = Curve::of(mesh, &triangles, run, reach);
            curve.flood(mesh, &triangles, run, &mut weights);
        }
    }
    match weights.iter().any(|&weight| weight > 0.0) {
        true => Ok(weights),
        false => Err(Error::EmptyRegion { why: "no valley of the frame has a depth" }),
    }
}

/// A polyline on the scan with the reach at its points, mm.
struct Curve {
    points: Vec<Point3<f64>>,
    reach: Vec<f64>,
    low: Point3<f64>,
    high: Point3<f64>,
}

impl Curve {
    fn of(mesh: &Mesh, triangles: &[[u32; 3]], run: &[ValleyPoint], reach: f64) -> Self {
        let at = |point: &ValleyPoint| {
            let corners = triangles[point.face as usize].map(|vertex| mesh.positions[vertex as usize].coords);
            let [a, b, c] = point.barycentric;
            Point3::from(a * corners[0] + b * corners[1] + c * corners[2])
        };
        let points: Vec<Point3<f64>> = run.iter().map(at).collect();
        let reach: Vec<f64> = run.iter().map(|point| reach * point.w_mm).collect();
        let widest = reach.iter().copied().fold(0.0, f64::max);
        let (low, high) = mesh::bounding_box(&points);
        let (low, high) = (low.map(|x| x - widest), high.map(|x| x + widest));
        Self { points, reach, low, high }
    }

    /// Whether a place is within the reach of some segment.
    fn reaches(&self, place: &Point3<f64>) -> bool {
        if (0..3).any(|axis| place[axis] < self.low[axis] || place[axis] > self.high[axis]) {
            return false;
        }
        let last = self.points.len() - 1;
        (0..self.points.len()).any(|i| {
            let (from, to) = (self.points[i], self.points[last.min(i + 1)]);
            let side = to - from;
            let share = (place - from).dot(&side) / side.norm_squared().max(f64::MIN_POSITIVE);
            let share = share.clamp(0.0, 1.0);
            let reach = (1.0 - share) * self.reach[i] + share * self.reach[last.min(i + 1)];
            (place - (from + share * side)).norm() < reach
        })
    }

    /// Gives a weight to what hangs together with the faces under the curve.
    fn flood(&self, mesh: &Mesh, triangles: &[[u32; 3]], run: &[ValleyPoint], weights: &mut [f64]) {
        let inside: Vec<bool> = mesh.positions.iter().map(|place| self.reaches(place)).collect();
        let mut reached = vec![false; inside.len()];
        let seeds = run.iter().flat_map(|point| triangles[point.face as usize]);
        seeds.filter(|&v| inside[v as usize]).for_each(|vertex| reached[vertex as usize] = true);
        let mut open: Vec<[u32; 3]> =
            triangles.iter().filter(|t| t.iter().any(|&v| inside[v as usize])).copied().collect();
        let mut before = usize::MAX;
        while open.len() < before {
            before = open.len();
            open.retain(|triangle| {
                let joins = triangle.iter().any(|&v| reached[v as usize]);
                let joined = triangle.iter().filter(|_| joins).filter(|&&v| inside[v as usize]);
                joined.for_each(|&v| reached[v as usize] = true);
                !joins
            });
        }
        weights.iter_mut().zip(reached).filter(|(_, reached)| *reached).for_each(|(weight, _)| *weight = 1.0);
    }
}
