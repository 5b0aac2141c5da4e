//! The face from one side: which triangle each pixel sees, and which vertices are in view.

use crate::Frame;
use nalgebra::{Point3, Rotation3, Vector3};

/// A direction to look at the face from, straight on (no perspective).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Turn around the vertical, rad; positive shows the face's own left side.
    pub yaw_rad: f64,
    /// Turn around the horizontal, rad; positive looks from above.
    pub pitch_rad: f64,
}

impl View {
    /// From degrees.
    #[must_use]
    pub fn degrees(yaw: f64, pitch: f64) -> Self {
        Self { yaw_rad: yaw.to_radians(), pitch_rad: pitch.to_radians() }
    }

    fn rotation(&self) -> Rotation3<f64> {
        Rotation3::from_axis_angle(&Vector3::x_axis(), self.pitch_rad)
            * Rotation3::from_axis_angle(&Vector3::y_axis(), -self.yaw_rad)
    }
}

/// A pixel that sees nothing.
pub const NOTHING: u32 = u32::MAX;
/// A vertex is in view if nothing lies further before it than this, mm, …
const BIAS_MM: f64 = 0.6;
/// … and, on a slope, than what the surface itself rises over this many pixels.
const SLOPE_PIXELS: f64 = 1.5;

/// A view of the face, as pixels.
pub struct Raster {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Triangle that each pixel sees, row after row from the top, or [`NOTHING`].
    pub triangles: Vec<u32>,
    /// Per vertex its place: column, row (fractions of pixels), and height towards the viewer, mm.
    pub places: Vec<Vector3<f64>>,
    nearness: Vec<f64>,
    rotation: Rotation3<f64>,
    pixel_mm: f64,
}

impl Raster {
    /// Looks at a face; the picture reaches from `low` to `high` (x, y of the turned frame, mm).
    #[must_use]
    pub fn new(
        points: &[Point3<f64>],
        triangles: &[[u32; 3]],
        frame: &Frame,
        view: View,
        [low, high]: [[f64; 2]; 2],
        pixel_mm: f64,
    ) -> Self {
        let rotation = view.rotation();
        let place = |point: &Point3<f64>| {
            let turned = rotation * frame.place(point);
            Vector3::new((turned.x - low[0]) / pixel_mm, (high[1] - turned.y) / pixel_mm, turned.z)
        };
        let size = |axis: usize| ((high[axis] - low[axis]) / pixel_mm).ceil().max(1.0) as usize;
        let (width, height) = (size(0), size(1));
        let mut raster = Self {
            width,
            height,
            triangles: vec![NOTHING; width * height],
            places: points.iter().map(place).collect(),
            nearness: vec![f64::NEG_INFINITY; width * height],
            rotation,
            pixel_mm,
        };
        triangles.iter().enumerate().for_each(|(number, triangle)| raster.draw(number as u32, *triangle));
        raster
    }

    fn draw(&mut self, number: u32, triangle: [u32; 3]) {
        let [a, b, c] = triangle.map(|vertex| self.places[vertex as usize]);
        let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if area == 0.0 {
            return;
        }
        let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
        let range = |low: f64, high: f64, size: usize| {
            (low - 0.5).ceil().max(0.0) as usize..((high + 0.5).floor().max(0.0) as usize).min(size)
        };
        for row in range(low.y, high.y, self.height) {
            for column in range(low.x, high.x, self.width) {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let share =
                    |p: Vector3<f64>, q: Vector3<f64>| ((p.x - x) * (q.y - y) - (p.y - y) * (q.x - x)) / area;
                let shares = [share(b, c), share(c, a), share(a, b)];
                if shares.iter().all(|&share| share >= 0.0) {
                    let near = shares[0] * a.z + shares[1] * b.z + shares[2] * c.z;
                    let at = row * self.width + column;
                    if near > self.nearness[at] {
                        self.nearness[at] = near;
                        self.triangles[at] = number;
                    }
                }
            }
        }
    }

    /// Cosine of the angle between a normal, in the face's coordinates, and the view.
    #[must_use]
    pub fn facing(&self, normal: &Vector3<f64>) -> f64 {
        (self.rotation * normal).z
    }

    /// A direction of the face as this view sees it: x right, y up, z towards the viewer.
    #[must_use]
    pub fn turn(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.rotation * direction
    }

    /// Whether nothing lies before a vertex whose normal (in the face's coordinates) is given; outside the picture nothing is seen.
    #[must_use]
    pub fn sees(&self, vertex: u32, normal: &Vector3<f64>) -> bool {
        let place = self.places[vertex as usize];
        if !(place.x >= 0.0 && place.y >= 0.0 && place.x < self.width as f64 && place.y < self.height as f64)
        {
            return false;
        }
        let facing = self.facing(normal);
        if facing <= 0.0 {
            return false;
        }
        let rise = (1.0 - facing * facing).max(0.0).sqrt() / facing.max(0.1) * self.pixel_mm * SLOPE_PIXELS;
        self.nearness[place.y as usize * self.width + place.x as usize] <= place.z + BIAS_MM + rise
    }
}
