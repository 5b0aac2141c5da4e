//! Keeping what is worn off the skin.

use mesh::vertex_normals;
use nalgebra::{Point3, Vector3};

/// Normals are averaged over this much beyond the nearest vertex, mm.
const AVERAGED_MM: f64 = 10.0;

/// A skin to wear things on.
pub(crate) struct Outside<'a> {
    points: &'a [Point3<f64>],
    normals: Vec<Vector3<f64>>,
}

impl<'a> Outside<'a> {
    /// `points`: #V × 3, mm; `triangles`: counter-clockwise seen from outside.
    pub(crate) fn of(points: &'a [Point3<f64>], triangles: &[[u32; 3]]) -> Self {
        Self { points, normals: vertex_normals(points, triangles) }
    }

    /// Outwards near a point: the mean normal of the skin nearest to it.
    pub(crate) fn outwards(&self, near: &Point3<f64>) -> Vector3<f64> {
        let square = |vertex: &Point3<f64>| (vertex - near).norm_squared();
        let nearest = self.points.iter().map(square).fold(f64::INFINITY, f64::min).sqrt();
        let within = (nearest + AVERAGED_MM).powi(2);
        let all = self.points.iter().zip(&self.normals).filter(|(vertex, _)| square(vertex) <= within);
        let sum: Vector3<f64> = all.map(|(_, normal)| normal).sum();
        sum.try_normalize(1e-9).unwrap_or_else(Vector3::z)
    }

    /// How high over the skin a point lies, mm along `outwards`: over the highest vertex within `radius` mm of the line
    /// through it; `None` without such a vertex.
    pub(crate) fn height(&self, point: &Point3<f64>, outwards: &Vector3<f64>, radius: f64) -> Option<f64> {
        let of = |vertex: &Point3<f64>| {
            let way = point - vertex;
            let height = way.dot(outwards);
            (way.norm_squared() - height * height <= radius * radius).then_some(height)
        };
        self.points.iter().filter_map(of).min_by(f64::total_cmp)
    }

    /// The point moved outwards to at least `least` mm over the skin.
    pub(crate) fn lifted(&self, point: &Point3<f64>, least: f64, radius: f64) -> Point3<f64> {
        let outwards = self.outwards(point);
        let height = self.height(point, &outwards, radius).unwrap_or(least);
        point + outwards * (least - height).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a ball of 80 mm and its normals.
    fn ball() -> Vec<Point3<f64>> {
        let turn = std::f64::consts::PI * (3.0 - 5.0f64.sqrt());
        let at = |i: i32| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 20_000.0;
            let (sin, cos) = (turn * f64::from(i)).sin_cos();
            Point3::from(Vector3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z) * 80.0)
        };
        (0..20_000).map(at).collect()
    }

    #[test]
    fn what_is_sunk_in_comes_out_and_the_rest_stays() {
        let points = ball();
        let normals = points.iter().map(|point| point.coords.normalize()).collect();
        let skin = Outside { points: &points, normals };
        for depth in [-4.0, 0.0, 9.0] {
            let lifted = skin.lifted(&Point3::new(0.0, 0.6, 0.8).coords.scale(80.0 - depth).into(), 5.0, 5.0);
            assert!((lifted.coords.norm() - 85.0).abs() < 0.3, "{lifted}");
        }
        let above = Point3::new(0.0, 90.0, 0.0);
        assert_eq!(skin.lifted(&above, 5.0, 5.0), above);
    }
}
