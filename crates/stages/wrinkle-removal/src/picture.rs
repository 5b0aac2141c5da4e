//! A picture to judge by: the scan, the region on it, and the result, side by side under a grazing light.

use mesh::Mesh;
use nalgebra::{Point3, Vector3};

/// Red, green and blue of each pixel, row after row from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// 3 × width × height code values (sRGB).
    pub rgb: Vec<u8>,
}

/// Height of each of the three views, px.
const ROWS: usize = 720;
/// Share of the region's extent that is shown around it.
const MARGIN: f64 = 0.15;
/// Samples a pixel and axis.
const SAMPLES: usize = 2;
const SKIN: [f64; 3] = [0.80, 0.66, 0.58];
const PAINT: [f64; 3] = [0.25, 0.55, 0.95];
const GROUND: [f64; 3] = [0.93, 0.93, 0.93];

/// Draws the region of a scan before, with its weights in blue, and after; seen along the region's mean normal, the mesh's +y
/// upwards. The light comes from the upper left, low, so that relief shows.
///
/// `after`: #V positions, mm; `weights`: #V.
#[must_use]
pub fn draw(before: &Mesh, after: &[Point3<f64>], weights: &[f64]) -> Picture {
    let triangles = before.triangles();
    let normals = [&before.positions[..], after].map(|points| mesh::vertex_normals(points, &triangles));
    let view = View::of(&before.positions, &normals[0], weights);
    let plain = vec![0.0; weights.len()];
    let views = [
        view.draw(&before.positions, &normals[0], &triangles, &plain),
        view.draw(&before.positions, &normals[0], &triangles, weights),
        view.draw(after, &normals[1], &triangles, &plain),
    ];
    let rgb = (0..ROWS).flat_map(|row| {
        let of =
            move |view: &Vec<u8>| view[3 * row * view.len() / (3 * ROWS)..][..view.len() / ROWS].to_vec();
        views.iter().flat_map(of).collect::<Vec<u8>>()
    });
    Picture { width: 3 * view.columns, height: ROWS, rgb: rgb.collect() }
}

/// An orthographic view: axes to the right, down and away, mm; pixels from the upper left corner.
struct View {
    axes: [Vector3<f64>; 3],
    corner: [f64; 2],
    pixels_per_mm: f64,
    columns: usize,
}

impl View {
    fn of(points: &[Point3<f64>], normals: &[Vector3<f64>], weights: &[f64]) -> Self {
        let mean: Vector3<f64> = normals.iter().zip(weights).map(|(normal, &weight)| weight * normal).sum();
        let away = -mean.try_normalize(1e-9).unwrap_or_else(Vector3::z);
        let up = if away.y.abs() > 0.95 { Vector3::z() } else { Vector3::y() };
        let right = away.cross(&up).normalize();
        let axes = [right, away.cross(&right), away];
        let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
        for (point, _) in points.iter().zip(weights).filter(|(_, weight)| **weight > 0.0) {
            for axis in 0..2 {
                let place = axes[axis].dot(&point.coords);
                bounds[0][axis] = bounds[0][axis].min(place);
                bounds[1][axis] = bounds[1][axis].max(place);
            }
        }
        let size = [0, 1].map(|axis| (bounds[1][axis] - bounds[0][axis]).max(1.0));
        let margin = MARGIN * size[0].max(size[1]);
        let pixels_per_mm = ROWS as f64 / (size[1] + 2.0 * margin);
        let columns =
            (pixels_per_mm * (size[0] + 2.0 * margin)).clamp(ROWS as f64 / 3.0, 2.0 * ROWS as f64) as usize;
        let middle = 0.5 * (bounds[0][0] + bounds[1][0]) - 0.5 * columns as f64 / pixels_per_mm;
        Self { axes, corner: [middle, bounds[0][1] - margin], pixels_per_mm, columns }
    }

    /// Column, row and depth of a point, in samples and mm.
    fn place(&self, point: &Point3<f64>) -> [f64; 3] {
        let scale = self.pixels_per_mm * SAMPLES as f64;
        let along = |axis: usize| (self.axes[axis].dot(&point.coords) - self.corner[axis]) * scale;
        [along(0), along(1), self.axes[2].dot(&point.coords)]
    }

    fn draw(
        &self,
        points: &[Point3<f64>],
        normals: &[Vector3<f64>],
        triangles: &[[u32; 3]],
        paint: &[f64],
    ) -> Vec<u8> {
        let (width, height) = (self.columns * SAMPLES, ROWS * SAMPLES);
        let mut depth = vec![f64::INFINITY; width * height];
        let mut color = vec![GROUND; width * height];
        for triangle in triangles {
            let corner = triangle.map(|vertex| self.place(&points[vertex as usize]));
            let shade = triangle.map(|vertex| self.shade(&normals[vertex as usize], paint[vertex as usize]));
            fill(corner, [width, height], |sample, at, shares| {
                if at < depth[sample] {
                    depth[sample] = at;
                    color[sample] = std::array::from_fn(|c| (0..3).map(|i| shares[i] * shade[i][c]).sum());
                }
            });
        }
        let mut rgb = Vec::with_capacity(3 * self.columns * ROWS);
        for (row, column) in (0..ROWS).flat_map(|row| (0..self.columns).map(move |column| (row, column))) {
            for channel in 0..3 {
                let sample =
                    |i: usize| (row * SAMPLES + i / SAMPLES) * width + column * SAMPLES + i % SAMPLES;
                let sum: f64 = (0..SAMPLES * SAMPLES).map(|i| color[sample(i)][channel]).sum();
                rgb.push((255.0 * (sum / (SAMPLES * SAMPLES) as f64).clamp(0.0, 1.0).powf(1.0 / 2.2)) as u8);
            }
        }
        rgb
    }

    fn shade(&self, normal: &Vector3<f64>, paint: f64) -> [f64; 3] {
        let in_view = [0, 1, 2].map(|axis| self.axes[axis].dot(normal));
        let light = Vector3::new(-0.75, -0.45, -0.5).normalize();
        let toward = in_view[0] * light.x + in_view[1] * light.y + in_view[2] * light.z;
        // Wrapped around a little, so that the side in shade keeps its relief.
        let lit = 0.08 + 0.8 * ((toward + 0.35) / 1.35).max(0.0);
        let share = 0.5 * paint.min(1.0);
        std::array::from_fn(|c| lit * ((1.0 - share) * SKIN[c] + share * PAINT[c]))
    }
}

/// Visits the samples inside a triangle with their depth and the shares of its corners.
fn fill(corner: [[f64; 3]; 3], [width, height]: [usize; 2], mut visit: impl FnMut(usize, f64, [f64; 3])) {
    let [a, b, c] = corner;
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    // Counter-clockwise faces turn clockwise where rows go down; the others are seen from behind.
    if area >= 0.0 || !area.is_finite() {
        return;
    }
    let range = |axis: usize, count: usize| {
        let low = a[axis].min(b[axis]).min(c[axis]).ceil().max(0.0) as usize;
        let high = a[axis].max(b[axis]).max(c[axis]).floor().min(count as f64 - 1.0);
        low..(high + 1.0).max(0.0) as usize
    };
    for y in range(1, height) {
        for x in range(0, width) {
            let (px, py) = (x as f64, y as f64);
            let one = ((b[0] - px) * (c[1] - py) - (b[1] - py) * (c[0] - px)) / area;
            let two = ((c[0] - px) * (a[1] - py) - (c[1] - py) * (a[0] - px)) / area;
            let shares = [one, two, 1.0 - one - two];
            if shares.iter().all(|share| *share >= 0.0) {
                visit(y * width + x, shares[0] * a[2] + shares[1] * b[2] + shares[2] * c[2], shares);
            }
        }
    }
}
