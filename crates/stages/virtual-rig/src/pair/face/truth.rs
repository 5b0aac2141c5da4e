//! What is true of the wrinkles.

use camera::Camera;
use mesh::vertex_normals;
use nalgebra::{Matrix3, Point3, Vector3};

/// A pose of the skin: without wrinkles, and with them.
pub(super) struct Folds<'a> {
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) large_scale: &'a [Point3<f64>],
    pub(super) wrinkled: &'a [Point3<f64>],
}

impl Folds<'_> {
    /// Per vertex the wrinkled surface's normal in the tangent space of the one without wrinkles: x along growing `u` of the
    /// material, y across it towards growing v, z outwards. As a renderer reads a normal map whose texture coordinates are `at`.
    pub(super) fn tangent_normals(&self, at: &[[f64; 2]]) -> Vec<Vector3<f64>> {
        let outwards = vertex_normals(self.large_scale, self.triangles);
        let wrinkled = vertex_normals(self.wrinkled, self.triangles);
        let along = self.along(at);
        (0..at.len())
            .map(|vertex| {
                let z = outwards[vertex];
                let level = along[vertex] - z * z.dot(&along[vertex]);
                let Some(x) = level.try_normalize(1e-12) else { return Vector3::z() };
                let frame = Matrix3::from_rows(&[x.transpose(), z.cross(&x).transpose(), z.transpose()]);
                (frame * wrinkled[vertex]).try_normalize(0.0).unwrap_or_else(Vector3::z)
            })
            .collect()
    }

    /// Per vertex the direction on the large-scale surface in which u grows and v stays.
    fn along(&self, at: &[[f64; 2]]) -> Vec<Vector3<f64>> {
        let mut sums = vec![Vector3::zeros(); at.len()];
        for triangle in self.triangles {
            let [a, b, c] = triangle.map(|vertex| self.large_scale[vertex as usize]);
            let [p, q, r] = triangle.map(|vertex| at[vertex as usize]);
            let (du, dv) = ([q[0] - p[0], r[0] - p[0]], [q[1] - p[1], r[1] - p[1]]);
            let area = du[0] * dv[1] - du[1] * dv[0];
            // Seen from behind, or from the side.
            if area <= 0.0 {
                continue;
            }
            let along = ((b - a) * dv[1] - (c - a) * dv[0]) / area;
            // Weighted by the area in the picture.
            triangle.iter().for_each(|vertex| sums[*vertex as usize] += along * area);
        }
        sums
    }
}

/// Where points lie in a picture, x right and *y up*, px; the middle of it where they lie behind the camera.
pub(super) fn places(camera: &Camera, points: &[Point3<f64>]) -> Vec<[f64; 2]> {
    let place = |point| camera.project(point).map_or([0.0; 2], |pixel| [pixel.x, -pixel.y]);
    points.iter().map(place).collect()
}

/// How much of an expression's wrinkles a pose shows: its slopes projected onto theirs, each vertex by a weight.
pub(super) fn shown(pose: &[Vector3<f64>], end: &[Vector3<f64>], weights: &[f64]) -> f64 {
    let slope = |normal: &Vector3<f64>| normal.xy() / normal.z.max(0.05);
    let (mut both, mut own) = (0.0, 1e-12);
    for ((pose, end), weight) in pose.iter().zip(end).zip(weights) {
        let (here, there) = (slope(pose), slope(end));
        both += weight * here.dot(&there);
        own += weight * there.norm_squared();
    }
    both / own
}

/// Per vertex its share of the picture in which triangles face the camera, px².
pub(super) fn picture_areas(triangles: &[[u32; 3]], at: &[[f64; 2]]) -> Vec<f64> {
    let mut areas = vec![0.0; at.len()];
    for triangle in triangles {
        let [p, q, r] = triangle.map(|vertex| at[vertex as usize]);
        let area = 0.5 * ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]));
        triangle.iter().for_each(|vertex| areas[*vertex as usize] += area.max(0.0) / 3.0);
    }
    areas
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points, triangles, and where the points lie in the picture.
    type Sheet = (Vec<Point3<f64>>, Vec<[u32; 3]>, Vec<[f64; 2]>);

    /// A sheet over x and y at a height, bent by a turn about y.
    fn sheet(height: impl Fn(f64) -> f64, turn: f64) -> Sheet {
        let turn = nalgebra::Rotation3::from_axis_angle(&Vector3::y_axis(), turn);
        let flat = |i: u32, j: u32| [f64::from(i) * 0.5 - 10.0, f64::from(j) * 0.5 - 10.0];
        let all = || (0..41).flat_map(|j| (0..41).map(move |i| (i, j)));
        let point = |(i, j)| {
            let [x, y] = flat(i, j);
            turn * Point3::new(x, y, height(x))
        };
        let quad = |i: u32, j: u32| {
            let a = j * 41 + i;
            [[a, a + 1, a + 42], [a, a + 42, a + 41]]
        };
        let triangles = (0..40).flat_map(|j| (0..40).flat_map(move |i| quad(i, j))).collect();
        (all().map(point).collect(), triangles, all().map(|(i, j)| flat(i, j)).collect())
    }

    #[test]
    fn a_slope_is_told_in_the_skin_s_own_frame_however_the_skin_is_turned() {
        for turn in [0.0, 0.5] {
            let (large_scale, triangles, at) = sheet(|_| 0.0, turn);
            let (wrinkled, ..) = sheet(|x| 0.3 * x, turn);
            let folds = Folds { triangles: &triangles, large_scale: &large_scale, wrinkled: &wrinkled };
            let normal = folds.tangent_normals(&at)[20 * 41 + 20];
            // It rises to the right, so it leans to the left.
            assert!((normal - Vector3::new(-0.3, 0.0, 1.0).normalize()).norm() < 1e-9, "{normal}");
        }
    }

    #[test]
    fn half_the_slopes_are_half_the_wrinkles() {
        let slopes =
            |part: f64| [0.4, -0.2, 0.0].map(|s: f64| Vector3::new(part * s, 0.1 * part, 1.0)).to_vec();
        assert!((shown(&slopes(0.5), &slopes(1.0), &[1.0, 2.0, 3.0]) - 0.5).abs() < 1e-9);
        assert_eq!(shown(&slopes(0.0), &slopes(1.0), &[1.0; 3]), 0.0);
    }
}
