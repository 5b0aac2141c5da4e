//! What is true of an image: where its paint is, where its valleys run.

use crate::film::Exposure;
use crate::light::Scene;
use crate::take::headband::BALL_MM;
use crate::take::{Role, Set, Station, Studio};
use crate::wrinkle::ValleyPoint;
use artifact::{Curve2d, CurveState, Sample2d, Section, SectionState, TrackState};
use camera::Camera;
use nalgebra::{Point2, Point3, Vector2, Vector3};
use std::collections::BTreeMap;

/// What is true of one image.
#[derive(Debug, Clone, Default)]
pub struct ImageTruth {
    /// Per marker the centroid of its visible paint. Seen: less than 70° to the view, and at least 60 % of its paint
    /// unhidden; `predicted` stands for paint of which less is seen. Confidence is the unhidden share.
    pub tracks: Vec<Option<Sample2d>>,
    /// Valley curves by wrinkle, as far as the camera sees their bottoms; wrinkle cameras only.
    pub curves: BTreeMap<String, Curve2d>,
    /// Their sections: width and depth as image lengths, and the tilt of the view on the skin without wrinkles: what is near to being
    /// hidden by its own wall has a large one; wrinkle cameras only.
    pub sections: BTreeMap<String, Vec<Section>>,
    /// Per pixel the share that wrinkle paint covers, and the stroke that covers most; wrinkle cameras only.
    pub coverage: Vec<(f32, u32)>,
}

/// A marker counts as visible at less than this angle between the skin's normal and the view, rad.
const MOST_OBLIQUE: f64 = 70.0 * std::f64::consts::PI / 180.0;
/// … and with at least this share of its paint unhidden.
const LEAST_SEEN: f64 = 0.6;
/// The depth of a pixel may differ so much from that of a point seen in it, mm, beside what it changes within the pixel.
const DEPTH_TOLERANCE_MM: f64 = 0.2;
/// Distance of sections along a valley in the image, px, about.
const SECTION_PX: f64 = 2.0;
/// Rays to a camera start so far above a valley's bottom, mm: beyond the facets that meet there.
const LIFT_MM: f64 = 0.02;
/// Points that a valley curve needs in an image.
const LEAST_POINTS: usize = 6;

impl Studio {
    /// What is true of an exposure of a set, in the image as it is stored (mirrored if the camera mirrors).
    #[must_use]
    pub fn truth_of(&self, set: &Set, station: &Station, exposure: &Exposure) -> ImageTruth {
        let camera = &station.camera;
        let sees = exposure.sees(camera, DEPTH_TOLERANCE_MM);
        let mut tracks: Vec<Option<Sample2d>> = self
            .layers
            .dot_samples()
            .iter()
            .map(|dot| {
                let view = dot.view(&set.mean_skin, camera, &sees);
                let seen = view.angle_rad < MOST_OBLIQUE && view.share_seen >= LEAST_SEEN;
                Some(sample(view.centroid_px?, view.share_seen, seen))
            })
            .collect();
        let balls = self.in_world(&self.headband.centers().collect::<Vec<_>>(), &set.pose.world_from_head);
        tracks.extend(balls.iter().map(|center| ball_in_image(center, camera, &sees)));
        let mut truth = ImageTruth { tracks, ..ImageTruth::default() };
        if station.role == Role::Wrinkle {
            truth.coverage = self.coverage(exposure);
            for valley in &set.pose.valleys {
                let sees_bottom = |point: &ValleyPoint| self.sees_bottom(set, point, camera);
                let line = self.seen_valley(set, &valley.points, camera, &sees, sees_bottom);
                if line.len() >= LEAST_POINTS {
                    truth.sections.insert(valley.id.clone(), line.iter().map(|seen| seen.section).collect());
                    truth.curves.insert(valley.id.clone(), curve(&line));
                }
            }
        }
        if station.mirrored {
            truth.mirror(camera.image_size[0] as usize);
        }
        truth
    }

    fn coverage(&self, exposure: &Exposure) -> Vec<(f32, u32)> {
        let mut coverage = vec![(0.0f32, 0u32); exposure.radiance.len()];
        let mut most = vec![0.0f32; exposure.radiance.len()];
        let strokes = self.layers.strokes().len() as u32;
        for cover in exposure.covers.iter().filter(|cover| cover.layer < strokes) {
            let pixel = cover.pixel as usize;
            coverage[pixel].0 = (coverage[pixel].0 + cover.share).min(1.0);
            if cover.share > most[pixel] {
                (most[pixel], coverage[pixel].1) = (cover.share, cover.layer);
            }
        }
        coverage
    }

    /// The part of a valley that a camera sees, as sections of the image.
    fn seen_valley(
        &self,
        set: &Set,
        points: &[ValleyPoint],
        camera: &Camera,
        sees: &impl Fn(&Point3<f64>, Vector2<f64>) -> bool,
        sees_bottom: impl Fn(&ValleyPoint) -> bool,
    ) -> Vec<Seen> {
        let world =
            |point: Point3<f64>| set.pose.world_from_head * self.scenario.spaces.mocap_from_face(point);
        let eye = camera.eye_in_world();
        let mut line: Vec<Seen> = Vec::new();
        for point in points {
            let bottom = world(point.at);
            let Some(pixel) = camera.project(&bottom).filter(|pixel| camera.contains(*pixel)) else {
                continue;
            };
            let rim = world(point.surface_point);
            let is_seen = camera.project(&rim).is_some_and(|at| camera.contains(at) && sees(&rim, at));
            let is_near = line.last().is_some_and(|last| (last.pixel - pixel).norm() < SECTION_PX);
            // What the image shows hides props too; that a wall hides the bottom behind it is finer than a pixel.
            if !is_seen || is_near || !sees_bottom(point) {
                continue;
            }
            // The width is a length on the surface: half of what lies between the crossings on both sides.
            let side =
                |sign: f64| camera.project(&world(point.surface_point + point.across * (sign * point.w_mm)));
            let (Some(left), Some(right)) = (side(-1.0), side(1.0)) else { continue };
            let width = 0.5 * (right - left);
            let tilt_rad = tilt(
                &(eye - rim),
                &[point.normal, point.across].map(|axis| world(point.surface_point + axis) - rim),
            );
            line.push(Seen { pixel, section: section(point, pixel, width, tilt_rad) });
        }
        let count = line.len().max(2) - 1;
        for (number, seen) in line.iter_mut().enumerate() {
            seen.section.u = number as f64 / count as f64;
        }
        line
    }

    /// Whether nothing of the wrinkled skin lies between a camera and the skin at a valley's bottom.
    fn sees_bottom(&self, set: &Set, point: &ValleyPoint, camera: &Camera) -> bool {
        let Some(scene) = set.close_scene() else { return true };
        let corners =
            self.body.triangles[point.triangle as usize].map(|vertex| set.skin_in_world[vertex as usize]);
        let bottom: Vector3<f64> =
            corners.iter().zip(point.barycentric).map(|(corner, share)| corner.coords * share).sum();
        let up = self.scenario.spaces.mocap_from_face(point.surface_point + point.normal)
            - self.scenario.spaces.mocap_from_face(point.surface_point);
        let from = Point3::from(bottom + set.pose.world_from_head * up.normalize() * LIFT_MM);
        is_open(scene, &from, &camera.eye_in_world())
    }

    /// Centroids of all markers on the face and centres of the balls in the world, mm, at a set's moment.
    #[must_use]
    pub fn markers_in_world(&self, set: &Set) -> Vec<Point3<f64>> {
        let Some(station) = self.stations.values().next() else { return Vec::new() };
        let dots = self.layers.dot_samples().iter();
        let mut markers: Vec<Point3<f64>> = dots
            .map(|dot| dot.view(&set.skin_in_world, &station.camera, |_, _| true).center_in_world)
            .collect();
        let balls: Vec<Point3<f64>> = self.headband.centers().collect();
        markers.extend(self.in_world(&balls, &set.pose.world_from_head));
        markers
    }
}

/// A place on a valley as a camera sees it.
struct Seen {
    pixel: Vector2<f64>,
    section: Section,
}

fn sample(at: Vector2<f64>, share: f64, seen: bool) -> Sample2d {
    let state = if seen { TrackState::Seen } else { TrackState::Predicted };
    Sample2d { at: Point2::from(at), state, confidence: share.clamp(0.0, 1.0) }
}

/// A ball's outline is a circle around its projected centre, but for a hundredth of a pixel.
fn ball_in_image(
    center: &Point3<f64>,
    camera: &Camera,
    sees: &impl Fn(&Point3<f64>, Vector2<f64>) -> bool,
) -> Option<Sample2d> {
    let pixel = camera.project(center).filter(|pixel| camera.contains(*pixel))?;
    let towards = (camera.eye_in_world() - center).normalize();
    let front = center + towards * BALL_MM;
    sees(&front, pixel).then(|| sample(pixel, 1.0, true))
}

/// Whether nothing of a scene lies between two places.
fn is_open(scene: &Scene, from: &Point3<f64>, to: &Point3<f64>) -> bool {
    !scene.occluded(from, &(to - from), 1.0)
}

/// The angle by which a view leans across a valley, rad, positive towards p > 0; `axes`: the skin's normal, and across.
fn tilt(view: &Vector3<f64>, [normal, across]: &[Vector3<f64>; 2]) -> f64 {
    view.dot(across).atan2(view.dot(normal))
}

fn section(point: &ValleyPoint, pixel: Vector2<f64>, width: Vector2<f64>, tilt_rad: f64) -> Section {
    let (epsilon, kappa) = point.profile.shape.rounding();
    let w_px = width.norm();
    // The rig's p > 0 is the left side, that of sections the right one.
    let normal = -width / w_px.max(1e-12);
    let ratio = if point.w_mm > 0.0 { point.d_mm / point.w_mm } else { 0.0 };
    Section {
        u: 0.0,
        at: pixel.into(),
        normal: normal.into(),
        w_px,
        d_px: ratio * w_px,
        epsilon,
        kappa: 0.0 - kappa,
        tilt_rad: Some(0.0 - tilt_rad),
        deviation: None,
        residual: None,
        state: if point.d_mm > 0.0 { SectionState::Measured } else { SectionState::Flat },
    }
}

/// The uniform cubic B-spline through points that lie about evenly, without bend at its ends: (cᵢ₋₁ + 4cᵢ + cᵢ₊₁) / 6 = qᵢ,
/// solved from one end to the other and back.
fn curve(line: &[Seen]) -> Curve2d {
    let count = line.len();
    let point = |i: usize| line[i].pixel;
    // No bend at an end: its control is its point.
    let mut controls = vec![point(0); count];
    let mut pivots = vec![1.0; count];
    for i in 1..count {
        let (last, before) = (i + 1 == count, i == 1);
        if last {
            controls[i] = point(i);
            break;
        }
        let lower = if before { 0.0 } else { 1.0 / pivots[i - 1] };
        pivots[i] = 4.0 - lower;
        let known = if before { controls[0] } else { controls[i - 1] / pivots[i - 1] };
        controls[i] = point(i) * 6.0 - known;
    }
    for i in (1..count - 1).rev() {
        controls[i] = (controls[i] - controls[i + 1]) / pivots[i];
    }
    let first = controls[0] * 2.0 - controls[1];
    let end = controls[count - 1] * 2.0 - controls[count - 2];
    let controls = std::iter::once(first).chain(controls).chain([end]).map(Into::into).collect();
    Curve2d { controls, state: CurveState::Seen, confidence: 1.0, paint: Vec::new() }
}

impl ImageTruth {
    fn mirror(&mut self, width: usize) {
        let last = width as f64 - 1.0;
        self.coverage.chunks_exact_mut(width).for_each(<[_]>::reverse);
        for sample in self.tracks.iter_mut().flatten() {
            sample.at.x = last - sample.at.x;
        }
        for control in self.curves.values_mut().flat_map(|curve| &mut curve.controls) {
            control[0] = last - control[0];
        }
        for section in self.sections.values_mut().flatten() {
            section.at[0] = last - section.at[0];
            // Left and right of the line change places.
            section.normal[1] = -section.normal[1];
            section.kappa = 0.0 - section.kappa;
            section.tilt_rad = section.tilt_rad.map(|tilt| 0.0 - tilt);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wrinkle::{Profile, Shape};

    fn seen(pixel: Vector2<f64>) -> Seen {
        let profile = Profile { shape: Shape::S, w_mm: 1.0, d_mm: 0.5, fade_mm: [[5.0, 7.0]; 2] };
        let point = ValleyPoint {
            x_mm: 0.0,
            triangle: 0,
            barycentric: [1.0, 0.0, 0.0],
            at: Point3::origin(),
            surface_point: Point3::origin(),
            normal: nalgebra::Vector3::z(),
            across: nalgebra::Vector3::y(),
            w_mm: 1.0,
            d_mm: 0.5,
            profile,
            compression: 1.0,
            uptake: 1.0,
        };
        Seen { pixel, section: section(&point, pixel, Vector2::new(0.0, 4.0), 0.3) }
    }

    #[test]
    fn a_curve_runs_through_its_points() {
        let points: Vec<Seen> =
            (0..9).map(|i| seen(Vector2::new(2.0 * f64::from(i), (0.7 * f64::from(i)).sin()))).collect();
        let Curve2d { controls, .. } = curve(&points);
        assert_eq!(controls.len(), points.len() + 2);
        for (knot, point) in points.iter().enumerate() {
            for axis in 0..2 {
                let at =
                    (controls[knot][axis] + 4.0 * controls[knot + 1][axis] + controls[knot + 2][axis]) / 6.0;
                assert!((at - point.pixel[axis]).abs() < 1e-12, "knot {knot}");
            }
        }
    }

    #[test]
    fn a_mirrored_section_changes_sides() {
        let mut truth = ImageTruth {
            sections: BTreeMap::from([("fold".to_string(), vec![seen(Vector2::new(10.0, 5.0)).section])]),
            ..ImageTruth::default()
        };
        truth.mirror(100);
        let section = truth.sections["fold"][0];
        assert_eq!((section.at, section.normal), ([89.0, 5.0], [0.0, 1.0]));
        assert_eq!(section.tilt_rad, Some(0.3));
    }
}
