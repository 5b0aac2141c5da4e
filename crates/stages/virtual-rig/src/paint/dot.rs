//! A dot of paint.

use super::edge::{Edge, Softness, Spot};
use super::{BLUE, Paint};
use nalgebra::{Point3, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// The lowest order of the harmonics of an outline; order 1 would only shift the dot.
const FIRST_ORDER: usize = 2;
/// Places at which the largest deviation is looked for.
const OUTLINE_STEPS: usize = 720;

/// The outline of a dot: radius(φ) = r (1 + Σ cₖ cos kφ + sₖ sin kφ), k = 2, 3, 4.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outline {
    /// r, mm.
    pub radius_mm: f64,
    /// (cₖ, sₖ) of the orders 2, 3, 4, shares of r.
    pub harmonics: [[f64; 2]; 3],
}

impl Outline {
    /// A circle.
    #[must_use]
    pub fn round(radius_mm: f64) -> Self {
        Self { radius_mm, harmonics: [[0.0; 2]; 3] }
    }

    /// A random outline whose largest deviation from the circle is `share` of the radius (0.15 = 15 %).
    #[must_use]
    pub fn out_of_round(radius_mm: f64, share: f64, seed: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let harmonics = std::array::from_fn(|index| {
            let falloff = 1.0 / (index + FIRST_ORDER) as f64;
            [0, 1].map(|_| falloff * random.random_range(-1.0..1.0))
        });
        let wild = Self { radius_mm: 1.0, harmonics };
        let largest = (0..OUTLINE_STEPS)
            .map(|step| (wild.radius(TAU * step as f64 / OUTLINE_STEPS as f64) - 1.0).abs())
            .fold(f64::MIN_POSITIVE, f64::max);
        Self { radius_mm, harmonics: harmonics.map(|pair| pair.map(|x| x * share / largest)) }
    }

    /// The radius in a direction, mm.
    #[must_use]
    pub fn radius(&self, angle_rad: f64) -> f64 {
        self.radius_and_slope([angle_rad.cos(), angle_rad.sin()])[0]
    }

    /// No point of the outline lies farther from the centre, mm.
    #[must_use]
    pub fn largest_radius(&self) -> f64 {
        self.radius_mm * (1.0 + self.harmonics.iter().map(|[c, s]| c.hypot(*s)).sum::<f64>())
    }

    /// Radius and its derivative by the angle, in the direction (cos φ, sin φ); without trigonometry, since it is asked per
    /// sample.
    fn radius_and_slope(&self, [cos, sin]: [f64; 2]) -> [f64; 2] {
        let (mut c, mut s) = (cos, sin);
        let (mut radius, mut slope) = (1.0, 0.0);
        for (index, [even, odd]) in self.harmonics.iter().enumerate() {
            (c, s) = (c * cos - s * sin, s * cos + c * sin);
            radius += even * c + odd * s;
            slope += (index + FIRST_ORDER) as f64 * (odd * c - even * s);
        }
        [self.radius_mm * radius, self.radius_mm * slope]
    }

    /// How far inside the outline a spot lies, along the radius.
    pub(super) fn edge(&self, spot: &Spot) -> Edge {
        let [a, b] = spot.at;
        let distance = a.hypot(b).max(1e-9);
        let direction = [a / distance, b / distance];
        let [radius, slope] = self.radius_and_slope(direction);
        let turn = slope / distance;
        let gradient = [-direction[1] * turn - direction[0], direction[0] * turn - direction[1]];
        Edge {
            inside_mm: radius - distance,
            slope_mm_per_px: spot.chain(gradient),
            curvature_per_mm: radius.recip(),
        }
    }
}

/// A painted marker.
#[derive(Debug, Clone, PartialEq)]
pub struct Dot {
    /// Name of the marker.
    pub id: String,
    /// The triangle that its centre lies in.
    pub triangle: u32,
    /// Its centre on the skin at rest, mm.
    pub center: Point3<f64>,
    /// The skin's normal there, of unit length.
    pub normal: Vector3<f64>,
    /// Its outline in the tangent plane.
    pub outline: Outline,
    /// Its paint.
    pub paint: Paint,
}

impl Dot {
    /// A blue dot at a place of the surface: a triangle and the weights of its corners.
    ///
    /// `rest`: #V × 3, mm; `normals`: #V × 3.
    #[must_use]
    pub fn at(
        id: &str,
        outline: Outline,
        (triangle, weights): (u32, [f64; 3]),
        triangles: &[[u32; 3]],
        rest: &[Point3<f64>],
        normals: &[Vector3<f64>],
    ) -> Self {
        let corners = triangles[triangle as usize].map(|vertex| vertex as usize);
        let mut center = Vector3::zeros();
        let mut normal = Vector3::zeros();
        for (vertex, weight) in corners.into_iter().zip(weights) {
            center += weight * rest[vertex].coords;
            normal += weight * normals[vertex];
        }
        Self {
            id: id.to_string(),
            triangle,
            center: center.into(),
            normal: normal.normalize(),
            outline,
            paint: BLUE,
        }
    }

    /// The axes of the dot's coordinates: a, then b, so that (a, b, normal) is right-handed. Where the face looks along z,
    /// a runs along x.
    pub(super) fn axes(&self) -> [Vector3<f64>; 2] {
        let most_across = if self.normal.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
        let a = (most_across - self.normal * self.normal.dot(&most_across)).normalize();
        [a, self.normal.cross(&a)]
    }

    /// The coordinates (a, b) of a point near the dot: its projection into the tangent plane, pushed outwards until it is as
    /// far from the centre as the point itself, mm.
    pub(super) fn coordinates(&self, point: &Point3<f64>, axes: &[Vector3<f64>; 2]) -> [f64; 2] {
        let arm = point - self.center;
        let flat = [arm.dot(&axes[0]), arm.dot(&axes[1])];
        let length = flat[0].hypot(flat[1]);
        let stretch = if length > 0.0 { arm.norm() / length } else { 0.0 };
        flat.map(|x| x * stretch)
    }

    /// The share of a sample's footprint that the dot covers; `ramp_px` is the footprint's width.
    pub(crate) fn share(&self, spot: &Spot, ramp_px: f64) -> f64 {
        self.outline.edge(spot).share(Softness { ramp_px, smear_mm: 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outline_deviates_as_much_as_asked_and_is_a_function_of_the_seed() {
        let outline = Outline::out_of_round(1.5, 0.15, 7);
        let largest = (0..3600)
            .map(|i| (outline.radius(TAU * f64::from(i) / 3600.0) / 1.5 - 1.0).abs())
            .fold(0.0, f64::max);
        assert!((largest - 0.15).abs() < 1e-4, "{largest}");
        assert!(outline.largest_radius() >= 1.15 * 1.5 - 1e-3);
        assert_eq!(outline, Outline::out_of_round(1.5, 0.15, 7));
        assert_ne!(outline, Outline::out_of_round(1.5, 0.15, 8));
    }

    #[test]
    fn the_slope_of_the_edge_is_that_of_finite_differences() {
        let outline = Outline::out_of_round(1.5, 0.15, 3);
        let edge = |a: f64, b: f64| outline.edge(&Spot { at: [a, b], per_px: [[1.0, 0.0], [0.0, 1.0]] });
        let (a, b, step) = (0.9, -1.1, 1e-6);
        let along = |da: f64, db: f64| {
            (edge(a + da, b + db).inside_mm - edge(a - da, b - db).inside_mm) / (2.0 * step)
        };
        let [x, y] = edge(a, b).slope_mm_per_px;
        assert!((x - along(step, 0.0)).abs() < 1e-8 && (y - along(0.0, step)).abs() < 1e-8);
    }

    #[test]
    fn coordinates_keep_the_distance_to_the_centre() {
        let dot = Dot {
            id: "m".to_string(),
            triangle: 0,
            center: Point3::new(1.0, 2.0, 3.0),
            normal: Vector3::new(1.0, 2.0, 2.0) / 3.0,
            outline: Outline::round(1.0),
            paint: BLUE,
        };
        let axes = dot.axes();
        assert!((axes[0].cross(&axes[1]) - dot.normal).norm() < 1e-12);
        let point = Point3::new(1.6, 2.5, 2.1);
        let [a, b] = dot.coordinates(&point, &axes);
        assert!((a.hypot(b) - (point - dot.center).norm()).abs() < 1e-12);
        assert_eq!(dot.coordinates(&dot.center.clone(), &axes), [0.0, 0.0]);
    }
}
