//! Which triangle every sample of the picture sees: a z-buffer in bands of rows.
//!
//! Vertices are snapped to a grid of fractions of a pixel, and edges are tested in whole numbers, so that neighbouring
//! triangles leave no crack and every machine sees the same.

use crate::Surface;
use camera::Pinhole;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Rows of a band: small enough to share the work out evenly, large enough to keep the lists short.
pub(crate) const BAND_ROWS: usize = 8;
/// A sample that sees nothing.
pub(crate) const NOTHING: u32 = u32::MAX;
/// Steps of the grid between neighbouring sample positions.
const STEPS: i64 = 256;
/// Vertices further from the picture than this many grid steps are not drawn; products of two still fit 64 bits.
const FAR: f64 = 1e9;

/// A point on the grid.
pub(crate) type GridPoint = [i64; 2];

/// The pattern of samples in a pixel: a square grid, turned so that no two samples share a row or a column.
pub(crate) struct Pattern {
    /// Grid steps along a pixel.
    pub(crate) pixel: i64,
    /// Samples, in grid steps from the pixel's corner.
    pub(crate) offsets: Vec<GridPoint>,
}

impl Pattern {
    pub(crate) fn new(per_side: u32) -> Self {
        let n = i64::from(per_side);
        let place = |cell: i64| cell * STEPS + STEPS / 2;
        let sample = |k: i64| {
            let (i, j) = (k % n, k / n);
            [place(n * i + (n - 1 - j)), place(n * j + i)]
        };
        Self { pixel: n * n * STEPS, offsets: (0..n * n).map(sample).collect() }
    }
}

/// The surface as the camera sees it.
pub(crate) struct Projected<'a> {
    pub(crate) surface: &'a Surface,
    pub(crate) pattern: Pattern,
    /// Per vertex its place on the grid; `None` behind the camera or far outside.
    places: Vec<Option<GridPoint>>,
    /// Per vertex its position in the camera's coordinates (x right, y down, z forward).
    pub(crate) points: Vec<Point3<f64>>,
    /// Per vertex its normal in the camera's coordinates.
    pub(crate) normals: Vec<Vector3<f32>>,
}

impl<'a> Projected<'a> {
    pub(crate) fn new(surface: &'a Surface, camera: &Pinhole, per_side: u32) -> Self {
        let pattern = Pattern::new(per_side);
        let unit = pattern.pixel as f64;
        let rotation = camera.cam_from_world.rotation;
        let points: Vec<Point3<f64>> =
            surface.positions.par_iter().map(|point| camera.cam_from_world * point).collect();
        let place = |point: &Point3<f64>| {
            let image = point.xy().coords / point.z * camera.focal_px + camera.center_px;
            let grid = [image.x, image.y].map(|x| ((x + 0.5) * unit).round());
            let near = point.z > 0.0 && grid.iter().all(|x| x.abs() < FAR);
            near.then(|| grid.map(|x| x as i64))
        };
        let places = points.par_iter().map(place).collect();
        let normals = surface.normals.par_iter().map(|normal| (rotation * normal).cast()).collect();
        Self { surface, pattern, places, points, normals }
    }

    /// The triangle on the grid, if all of it can be drawn and it has an area there.
    pub(crate) fn on_grid(&self, triangle: u32) -> Option<GridTriangle> {
        let corners = self.surface.triangles[triangle as usize].map(|vertex| self.places[vertex as usize]);
        GridTriangle::new([corners[0]?, corners[1]?, corners[2]?])
    }

    /// Per band of rows the triangles that touch it, in their order.
    pub(crate) fn bands(&self, height: usize) -> Vec<Vec<u32>> {
        let band_count = height.div_ceil(BAND_ROWS);
        let steps = self.pattern.pixel * BAND_ROWS as i64;
        let mut bands = vec![Vec::new(); band_count];
        for (index, triangle) in self.surface.triangles.iter().enumerate() {
            let [Some(a), Some(b), Some(c)] = triangle.map(|vertex| self.places[vertex as usize]) else {
                continue;
            };
            let low = a[1].min(b[1]).min(c[1]).div_euclid(steps).max(0);
            let high = a[1].max(b[1]).max(c[1]).div_euclid(steps).min(band_count as i64 - 1);
            for band in low..=high {
                bands[band as usize].push(index as u32);
            }
        }
        bands
    }

    /// Per sample of a band, pixel after pixel, the triangle that it sees.
    pub(crate) fn visible(&self, triangles: &[u32], width: usize, rows: std::ops::Range<usize>) -> Vec<u32> {
        let per_pixel = self.pattern.offsets.len();
        let mut buffer = Buffer {
            seen: vec![NOTHING; width * rows.len() * per_pixel],
            nearness: vec![0.0; width * rows.len() * per_pixel],
            width,
            rows,
        };
        for &index in triangles {
            if let Some(triangle) = self.on_grid(index) {
                let corners = self.surface.triangles[index as usize];
                let nearness = corners.map(|vertex| (1.0 / self.points[vertex as usize].z) as f32);
                buffer.draw(&self.pattern, &triangle, nearness, index);
            }
        }
        buffer.seen
    }
}

struct Buffer {
    seen: Vec<u32>,
    /// Inverse depth, which is linear in the picture.
    nearness: Vec<f32>,
    width: usize,
    rows: std::ops::Range<usize>,
}

impl Buffer {
    fn draw(&mut self, pattern: &Pattern, triangle: &GridTriangle, nearness: [f32; 3], index: u32) {
        let (low, high) = triangle.bounds();
        let first = |x: i64, least: usize| x.div_euclid(pattern.pixel).max(least as i64);
        let last = |x: i64, end: usize| x.div_euclid(pattern.pixel).min(end as i64 - 1);
        for row in first(low[1], self.rows.start)..=last(high[1], self.rows.end) {
            for column in first(low[0], 0)..=last(high[0], self.width) {
                let corner = [column * pattern.pixel, row * pattern.pixel];
                if triangle.misses(corner, pattern.pixel) {
                    continue;
                }
                let at =
                    ((row as usize - self.rows.start) * self.width + column as usize) * pattern.offsets.len();
                for (sample, offset) in pattern.offsets.iter().enumerate() {
                    let edges = triangle.edges_at([corner[0] + offset[0], corner[1] + offset[1]]);
                    if edges.iter().any(|&edge| edge < 0) {
                        continue;
                    }
                    let weights = triangle.weights(edges);
                    let near = weights[0] * nearness[0] + weights[1] * nearness[1] + weights[2] * nearness[2];
                    if near > self.nearness[at + sample] {
                        self.nearness[at + sample] = near;
                        self.seen[at + sample] = index;
                    }
                }
            }
        }
    }
}

/// A triangle on the grid, turned so that its inside is where all edge functions are positive.
pub(crate) struct GridTriangle {
    corners: [GridPoint; 3],
    /// 1 or −1, to turn the edge functions.
    sign: i64,
    inverse_area: f32,
    /// Whether the triangle's front is seen.
    pub(crate) is_front: bool,
}

impl GridTriangle {
    fn new(corners: [GridPoint; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        // Rows count downwards, so counter-clockwise comes out negative.
        (area != 0).then(|| Self {
            corners,
            sign: area.signum(),
            inverse_area: 1.0 / area.abs() as f32,
            is_front: area < 0,
        })
    }

    fn bounds(&self) -> (GridPoint, GridPoint) {
        let along = |i: usize| self.corners.map(|corner| corner[i]);
        let least = |i| along(i).into_iter().min().unwrap_or(0);
        let most = |i| along(i).into_iter().max().unwrap_or(0);
        ([least(0), least(1)], [most(0), most(1)])
    }

    /// Start and direction of the edge opposite a corner.
    fn edge(&self, opposite: usize) -> (GridPoint, GridPoint) {
        let (from, to) = (self.corners[(opposite + 1) % 3], self.corners[(opposite + 2) % 3]);
        (from, [(to[0] - from[0]) * self.sign, (to[1] - from[1]) * self.sign])
    }

    /// Per corner the edge function of the edge opposite to it: twice the area that the edge and the point span.
    pub(crate) fn edges_at(&self, point: GridPoint) -> [i64; 3] {
        std::array::from_fn(|corner| {
            let (from, along) = self.edge(corner);
            along[0] * (point[1] - from[1]) - along[1] * (point[0] - from[0])
        })
    }

    /// Whether a square pixel lies wholly outside one edge.
    fn misses(&self, corner: GridPoint, pixel: i64) -> bool {
        let half = pixel / 2;
        let middle = [corner[0] + half, corner[1] + half];
        let edges = self.edges_at(middle);
        (0..3).any(|i| {
            let along = self.edge(i).1;
            edges[i] + (along[0].abs() + along[1].abs()) * half < 0
        })
    }

    /// Shares of the corners in a point, linear in the picture.
    pub(crate) fn weights(&self, edges: [i64; 3]) -> [f32; 3] {
        edges.map(|edge| edge as f32 * self.inverse_area)
    }

    /// Distance from a point inside to the side that starts at a corner, in grid steps.
    pub(crate) fn distance_to_side(&self, edges: [i64; 3], side: usize) -> f32 {
        let opposite = (side + 2) % 3;
        let along = self.edge(opposite).1;
        edges[opposite] as f32 / (along[0] as f32).hypot(along[1] as f32)
    }
}
