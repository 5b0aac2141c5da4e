//! The skin around a wrinkle as the geometry knows it: how the camera leans over it, and how it bends.

use crate::curve::Curve;
use crate::relief::Relief;
use crate::walls::{SECTORS, Skyline};
use camera::Camera;
use nalgebra::{Matrix3, Point3, Vector2, Vector3};

/// Size of the cells in which triangles are looked up, px.
const CELL: f64 = 8.0;
/// Places across a section at which the surface is looked at, to each side.
const ACROSS: i32 = 6;
/// How far along the curve its direction is taken from, px.
const ALONG_PX: f64 = 6.0;
/// A fit of a parabola needs so many places …
const LEAST_PLACES: usize = 7;
/// … within so far of each other in depth, as share of the section's length: beyond, another part of the face begins.
const LEAP: f64 = 3.0;

/// Places to each side of a curve at which its relief is looked at.
const WIDE_PLACES: i32 = 20;

/// So many of the surface's points are asked whether they hide the sky …
const FAR_POINTS: usize = 4000;
/// … those that rise by less per length do not.
const LEAST_RISE: f64 = 0.03;

/// How a camera sees a place of the skin without its wrinkle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Angle by which the camera leans off the skin's normal, across the wrinkle and towards its right, rad.
    pub tilt_rad: f64,
    /// Curvature across the wrinkle, 1/px of the image there; positive where the skin is hollow.
    pub bend_per_px: f64,
    /// Slopes of the horizon that the rest of the face makes, left and right of the wrinkle, by azimuth.
    pub(crate) skyline: Skyline,
    /// How the skin runs across the wrinkle.
    pub(crate) relief: Option<Relief>,
}

impl Ground {
    /// A bent strip of skin under the open sky.
    #[must_use]
    pub fn strip(tilt_rad: f64, bend_per_px: f64) -> Self {
        Self { tilt_rad, bend_per_px, skyline: Skyline::default(), relief: None }
    }
}

/// A surface without wrinkles as a camera sees it, near some curves.
pub struct Surface<'a> {
    camera: &'a Camera,
    points: &'a [Point3<f64>],
    normals: &'a [Vector3<f64>],
    triangles: &'a [[u32; 3]],
    pixels: Vec<Vector2<f64>>,
    columns: usize,
    /// Per cell its triangles.
    cells: Vec<Vec<u32>>,
    /// Some of the points: what hides the sky from afar.
    far: Vec<Point3<f64>>,
}

/// A place on the surface.
#[derive(Clone, Copy)]
struct Hit {
    point: Point3<f64>,
    normal: Vector3<f64>,
}

impl<'a> Surface<'a> {
    /// `points`: #V × 3, world, mm; `normals`: #V × 3, outwards; `triangles`: #F × 3.
    ///
    /// # Panics
    /// If the lengths differ: that is a bug of the caller.
    #[must_use]
    pub fn new(
        camera: &'a Camera,
        points: &'a [Point3<f64>],
        normals: &'a [Vector3<f64>],
        triangles: &'a [[u32; 3]],
    ) -> Self {
        assert_eq!(points.len(), normals.len(), "a normal per point");
        let nowhere = Vector2::repeat(f64::NAN);
        let pixels: Vec<Vector2<f64>> =
            points.iter().map(|point| camera.project(point).unwrap_or(nowhere)).collect();
        let [columns, rows] = camera.image_size.map(|size| (f64::from(size) / CELL).ceil() as usize + 1);
        let mut cells: Vec<Vec<u32>> = vec![Vec::new(); columns * rows];
        for (number, triangle) in triangles.iter().enumerate() {
            let corners = triangle.map(|vertex| pixels[vertex as usize]);
            let Some([low, high]) = bounds(&corners) else { continue };
            // y runs down in the image: what faces the camera turns the other way.
            let turn = (corners[1] - corners[0]).perp(&(corners[2] - corners[0]));
            if turn >= 0.0 {
                continue;
            }
            let cell = |x: f64, count: usize| ((x.max(0.0) / CELL) as usize).min(count - 1);
            for row in cell(low.y, rows)..=cell(high.y, rows) {
                for column in cell(low.x, columns)..=cell(high.x, columns) {
                    cells[row * columns + column].push(number as u32);
                }
            }
        }
        let far = points.iter().step_by((points.len() / FAR_POINTS).max(1)).copied().collect();
        Self { camera, points, normals, triangles, pixels, columns, cells, far }
    }

    /// The ground along a curve, at `count` even places from its start to its end, as far as `reach` px to both sides tell; none
    /// where the surface is not seen there.
    #[must_use]
    pub fn along(&self, curve: &Curve, count: usize, reach: f64) -> Vec<Option<Ground>> {
        let last = count.saturating_sub(1).max(1) as f64;
        (0..count).map(|i| self.at(curve, curve.len() * i as f64 / last, reach)).collect()
    }

    fn at(&self, curve: &Curve, x: f64, reach: f64) -> Option<Ground> {
        let (_, place, right) = curve.at(x);
        let middle = self.hit(place)?;
        let [before, after] = [(x - ALONG_PX).max(0.0), (x + ALONG_PX).min(curve.len())]
            .map(|x| self.hit(curve.at(x).1).map(|hit| hit.point));
        let step = reach / f64::from(ACROSS);
        let limit = LEAP * reach * self.size_of_pixel(&middle.point);
        let beside = (-ACROSS..=ACROSS).filter_map(|k| {
            let p = step * f64::from(k);
            let hit = self.hit(place + right * p)?;
            ((hit.point - middle.point).norm() < limit).then_some((p, hit))
        });
        let beside: Vec<(f64, Hit)> = beside.collect();
        let normal: Vector3<f64> = beside.iter().map(|(_, hit)| hit.normal).sum();
        let along = (after? - before?).try_normalize(1e-9)?;
        let normal = (normal - along * normal.dot(&along)).try_normalize(1e-9)?;
        // The side on which p grows.
        let across = normal.cross(&along);
        let sign: f64 = beside.iter().map(|(p, hit)| p * (hit.point - middle.point).dot(&across)).sum();
        let across = across * sign.signum();
        let section = beside.iter().map(|(p, hit)| {
            let off = hit.point - middle.point;
            [*p, off.dot(&across), off.dot(&normal)]
        });
        let section: Vec<[f64; 3]> = section.collect();
        let view = self.camera.eye_in_world() - middle.point;
        let (tilt_rad, bend_per_px, [slope, px_per_mm]) =
            bent(&section, view.dot(&across).atan2(view.dot(&normal)))?;
        let nearest = reach * self.size_of_pixel(&middle.point);
        let skyline = self.skyline(&middle.point, &[normal, across, along], nearest);
        let (sine, cosine) = slope.atan().sin_cos();
        let level = [across * cosine + normal * sine, normal * cosine - across * sine];
        let relief = self.relief(place, right, &middle.point, &level.map(|axis| axis * px_per_mm));
        Some(Ground { tilt_rad, bend_per_px, skyline, relief })
    }

    /// How the skin runs across, along two axes of px per mm: across and up.
    fn relief(
        &self,
        place: Vector2<f64>,
        right: Vector2<f64>,
        middle: &Point3<f64>,
        axes: &[Vector3<f64>; 2],
    ) -> Option<Relief> {
        let limit = LEAP * Relief::REACH * self.size_of_pixel(middle);
        let seen = (-WIDE_PLACES..=WIDE_PLACES).filter_map(|k| {
            let p = Relief::REACH * f64::from(k) / f64::from(WIDE_PLACES);
            let off = self.hit(place + right * p)?.point - middle;
            (off.norm() < limit).then(|| axes.map(|axis| off.dot(&axis)))
        });
        Relief::through(&seen.collect::<Vec<_>>())
    }

    /// How high what lies farther off than `nearest`, mm, stands around a place with axes up, across and along.
    fn skyline(&self, place: &Point3<f64>, axes: &[Vector3<f64>; 3], nearest: f64) -> Skyline {
        let mut squares = Skyline::default();
        for point in &self.far {
            let off = point - place;
            let up = off.dot(&axes[0]);
            let run = off.norm_squared() - up * up;
            if up <= 0.0 || run < nearest * nearest || up * up < LEAST_RISE * LEAST_RISE * run {
                continue;
            }
            let (across, along) = (off.dot(&axes[1]), off.dot(&axes[2]));
            let share = 0.5 + along.atan2(across.abs()) / std::f64::consts::PI;
            let sector = ((share * SECTORS as f64) as usize).min(SECTORS - 1);
            let highest = &mut squares[usize::from(across > 0.0)][sector];
            *highest = highest.max(up * up / run);
        }
        squares.map(|side| side.map(f64::sqrt))
    }

    /// mm of the world that one pixel shows at a point.
    fn size_of_pixel(&self, point: &Point3<f64>) -> f64 {
        let depth = (self.camera.cam_from_world * point).z;
        depth / self.camera.lens.focal_px.x
    }

    /// What the camera sees in a pixel. Within a triangle, which is small, perspective is left out.
    fn hit(&self, pixel: Vector2<f64>) -> Option<Hit> {
        if !self.camera.contains(pixel) {
            return None;
        }
        let [column, row] = [pixel.x, pixel.y].map(|x| (x.max(0.0) / CELL) as usize);
        let near = self.cells.get(row * self.columns + column)?;
        let seen = near.iter().filter_map(|&number| self.within(number, pixel));
        let depth = |hit: &Hit| (self.camera.cam_from_world * hit.point).z;
        seen.reduce(|best, other| if depth(&other) < depth(&best) { other } else { best })
    }

    fn within(&self, number: u32, pixel: Vector2<f64>) -> Option<Hit> {
        let corners = self.triangles[number as usize].map(|vertex| vertex as usize);
        let [a, b, c] = corners.map(|vertex| self.pixels[vertex]);
        let area = (b - a).perp(&(c - a));
        let [second, third] = [(pixel - a).perp(&(c - a)) / area, (b - a).perp(&(pixel - a)) / area];
        let weights = [1.0 - second - third, second, third];
        let inside = weights.iter().all(|weight| *weight >= -1e-9);
        inside.then(|| Hit {
            point: corners
                .iter()
                .zip(weights)
                .map(|(&vertex, weight)| self.points[vertex].coords * weight)
                .sum::<Vector3<f64>>()
                .into(),
            normal: corners.iter().zip(weights).map(|(&vertex, weight)| self.normals[vertex] * weight).sum(),
        })
    }
}

fn bounds(corners: &[Vector2<f64>; 3]) -> Option<[Vector2<f64>; 2]> {
    let known = corners.iter().all(|corner| corner.x.is_finite() && corner.y.is_finite());
    known
        .then(|| [corners[0].inf(&corners[1]).inf(&corners[2]), corners[0].sup(&corners[1]).sup(&corners[2])])
}

/// From places (p in the image; s across and z off the skin, mm) to the tilt over the parabola through them and its bend; and to the
/// slope there and how many px a millimetre across is.
fn bent(section: &[[f64; 3]], tilt: f64) -> Option<(f64, f64, [f64; 2])> {
    if section.len() < LEAST_PLACES {
        return None;
    }
    let [_, slope, half] = parabola(section.iter().map(|[_, s, z]| [*s, *z]))?;
    let [_, px_per_mm, _] = parabola(section.iter().map(|[p, s, _]| [*s, *p]))?;
    let curvature = 2.0 * half / (1.0 + slope * slope).powf(1.5);
    (px_per_mm > 1e-6).then(|| (tilt + slope.atan(), curvature / px_per_mm, [slope, px_per_mm]))
}

/// The coefficients of `a + b x + c x²` through points, by least squares.
fn parabola(points: impl Iterator<Item = [f64; 2]>) -> Option<[f64; 3]> {
    let (mut matrix, mut vector) = (Matrix3::zeros(), Vector3::zeros());
    for [x, y] in points {
        let row = Vector3::new(1.0, x, x * x);
        matrix += row * row.transpose();
        vector += row * y;
    }
    matrix.cholesky().map(|factor| factor.solve(&vector).into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use artifact::{Curve2d, CurveState};
    use camera::{BrownConrady, Lens};

    /// A cylinder around y, hollow side or round side to +z, seen from an angle.
    fn seen(radius: f64, hollow: bool, angle: f64) -> Vec<Option<Ground>> {
        let (columns, rows) = (121, 61);
        let at = |i: u32, j: u32| {
            let s = 0.5 * (f64::from(i) - 60.0) / radius;
            let rise = radius * (1.0 - s.cos());
            let z = if hollow { rise } else { -rise };
            (Point3::new(radius * s.sin(), 0.7 * (f64::from(j) - 30.0), z), s)
        };
        let grid = (0..rows).flat_map(|j| (0..columns).map(move |i| at(i, j)));
        let normal = |s: f64| {
            if hollow { Vector3::new(-s.sin(), 0.0, s.cos()) } else { Vector3::new(s.sin(), 0.0, s.cos()) }
        };
        let (points, normals): (Vec<_>, Vec<_>) = grid.map(|(point, s)| (point, normal(s))).unzip();
        let quad = |i: u32, j: u32| {
            let a = j * columns + i;
            [[a, a + 1, a + columns + 1], [a, a + columns + 1, a + columns]]
        };
        let triangles: Vec<[u32; 3]> =
            (0..rows - 1).flat_map(|j| (0..columns - 1).flat_map(move |i| quad(i, j))).collect();
        let eye = Point3::new(600.0 * angle.sin(), 0.0, 600.0 * angle.cos());
        let lens = Lens {
            focal_px: Vector2::repeat(3000.0),
            center_px: Vector2::new(320.0, 240.0),
            distortion: BrownConrady::default(),
        };
        let camera = Camera {
            image_size: [641, 481],
            lens,
            cam_from_world: Camera::pose_looking_at(eye, Point3::origin(), Vector3::y()),
        };
        // Upwards in the image: its right side is x > 0.
        let controls = (0..12).map(|i| [320.0, 340.0 - 20.0 * f64::from(i)]).collect();
        let curve = Curve2d { controls, state: CurveState::Seen, confidence: 1.0, paint: vec![] };
        Surface::new(&camera, &points, &normals, &triangles).along(&Curve::of(&curve).unwrap(), 5, 40.0)
    }

    #[test]
    fn a_cylinder_has_its_curvature_and_the_view_its_angle() {
        for (radius, hollow, angle) in [(40.0, true, 0.0), (60.0, false, 0.5), (50.0, true, -0.6)] {
            for ground in seen(radius, hollow, angle) {
                let ground = ground.expect("a place on the cylinder");
                // 5 px a mm, less what the slant takes.
                let bend = (1.0 / radius) / (5.0 * angle.cos()) * if hollow { 1.0 } else { -1.0 };
                assert!((ground.tilt_rad - angle).abs() < 0.02, "{ground:?} {angle}");
                assert!((ground.bend_per_px / bend - 1.0).abs() < 0.12, "{ground:?} {bend}");
            }
        }
    }

    #[test]
    fn beyond_the_surface_nothing_is_known() {
        let flat = seen(1e6, false, 1.4);
        assert!(flat.iter().flatten().count() < 5);
    }
}
