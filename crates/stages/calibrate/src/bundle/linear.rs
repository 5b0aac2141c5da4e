//! The reprojection of one observation and its derivatives.

use super::free::{CENTER, DISTORTION, FOCAL, PARAMETERS, SHIFT, TURN};
use super::{Element, Observation, Scene};
use camera::{Camera, Lens};
use nalgebra::{
    Isometry3, Matrix2x3, Matrix3, Point3, SMatrix, Translation3, UnitQuaternion, Vector2, Vector3,
};

/// Parameters of an element: turn and shift of a body in its own axes, or a point's place and three that are not used.
pub(super) const ELEMENT: usize = 6;

pub(super) type ByCamera = SMatrix<f64, 2, PARAMETERS>;
pub(super) type ByElement = SMatrix<f64, 2, ELEMENT>;

/// An observation's residual (projection − pixel, px) and its derivatives.
pub(super) struct Linear {
    pub(super) residual: Vector2<f64>,
    pub(super) by_camera: ByCamera,
    pub(super) by_element: ByElement,
}

impl Scene {
    /// Where an observed point is, in world space.
    pub(super) fn place(&self, seen: &Observation) -> Point3<f64> {
        match &self.structure[seen.element] {
            Element::Point(point) => *point,
            Element::Body { world_from_body } => world_from_body * self.body[seen.point],
        }
    }

    /// projection − pixel, px; none where the point is not in front of the camera.
    pub(super) fn residual(&self, seen: &Observation) -> Option<Vector2<f64>> {
        Some(self.cameras[seen.camera].project(&self.place(seen))? - seen.pixel)
    }

    /// The residual with its derivatives; none where the point is not in front of the camera.
    pub(super) fn linear(&self, seen: &Observation) -> Option<Linear> {
        let camera = &self.cameras[seen.camera];
        let cam = (camera.cam_from_world * self.place(seen)).coords;
        if cam.z <= 0.0 {
            return None;
        }
        let by_place = by_place_in_cam(&camera.lens, cam);
        let mut by_camera = by_lens(&camera.lens, cam);
        by_camera.fixed_view_mut::<2, 3>(0, TURN).copy_from(&(-by_place * cam.cross_matrix()));
        by_camera.fixed_view_mut::<2, 3>(0, SHIFT).copy_from(&by_place);
        let by_element = self.by_element(seen, camera, by_place);
        Some(Linear { residual: camera.lens.project(cam) - seen.pixel, by_camera, by_element })
    }

    fn by_element(&self, seen: &Observation, camera: &Camera, by_place: Matrix2x3<f64>) -> ByElement {
        let by_world = by_place * rotation(&camera.cam_from_world);
        let mut by_element = ByElement::zeros();
        match &self.structure[seen.element] {
            Element::Point(_) => by_element.fixed_columns_mut::<3>(0).copy_from(&by_world),
            Element::Body { world_from_body } => {
                let by_body = by_world * rotation(world_from_body);
                let turned = -by_body * self.body[seen.point].coords.cross_matrix();
                by_element.fixed_columns_mut::<3>(0).copy_from(&turned);
                by_element.fixed_columns_mut::<3>(3).copy_from(&by_body);
            }
        }
        by_element
    }
}

fn rotation(transform: &Isometry3<f64>) -> Matrix3<f64> {
    transform.rotation.to_rotation_matrix().into_inner()
}

/// ∂ pixel / ∂ place in camera space.
fn by_place_in_cam(lens: &Lens, cam: Vector3<f64>) -> Matrix2x3<f64> {
    let (x, y, w) = (cam.x / cam.z, cam.y / cam.z, 1.0 / cam.z);
    let by_normalised = Matrix2x3::new(w, 0.0, -x * w, 0.0, w, -y * w);
    let mut slopes = lens.distortion.jacobian(Vector2::new(x, y)) * by_normalised;
    slopes.row_mut(0).scale_mut(lens.focal_px.x);
    slopes.row_mut(1).scale_mut(lens.focal_px.y);
    slopes
}

/// ∂ pixel / ∂ intrinsics, in the camera's columns; zero elsewhere.
fn by_lens(lens: &Lens, cam: Vector3<f64>) -> ByCamera {
    let point = cam.xy() / cam.z;
    let (x, y) = (point.x, point.y);
    let r2 = point.norm_squared();
    let image = lens.distortion.distort(point);
    let mut slopes = ByCamera::zeros();
    slopes[(0, FOCAL)] = image.x;
    slopes[(1, FOCAL + 1)] = image.y;
    slopes[(0, CENTER)] = 1.0;
    slopes[(1, CENTER + 1)] = 1.0;
    let columns = [
        point * r2,
        point * (r2 * r2),
        Vector2::new(2.0 * x * y, r2 + 2.0 * y * y),
        Vector2::new(r2 + 2.0 * x * x, 2.0 * x * y),
        point * (r2 * r2 * r2),
    ];
    for (i, column) in columns.iter().enumerate() {
        slopes.fixed_view_mut::<2, 1>(0, DISTORTION + i).copy_from(&column.component_mul(&lens.focal_px));
    }
    slopes
}

/// A camera after a step in its parameters: the turn and the shift act in its own axes, x_cam ← exp(ω) x_cam + τ.
pub(super) fn moved_camera(camera: &Camera, step: &SMatrix<f64, PARAMETERS, 1>) -> Camera {
    let mut moved = camera.clone();
    moved.cam_from_world =
        motion(step.fixed_rows::<3>(TURN).into(), step.fixed_rows::<3>(SHIFT).into()) * camera.cam_from_world;
    moved.cam_from_world.rotation.renormalize();
    let lens = &mut moved.lens;
    lens.focal_px += step.fixed_rows::<2>(FOCAL);
    lens.center_px += step.fixed_rows::<2>(CENTER);
    let d = &mut lens.distortion;
    for (i, value) in [&mut d.k1, &mut d.k2, &mut d.p1, &mut d.p2, &mut d.k3].into_iter().enumerate() {
        *value += step[DISTORTION + i];
    }
    moved
}

/// An element after a step: a body turns and shifts in its own axes.
pub(super) fn moved_element(element: &Element, step: &SMatrix<f64, ELEMENT, 1>) -> Element {
    let first: Vector3<f64> = step.fixed_rows::<3>(0).into();
    match element {
        Element::Point(point) => Element::Point(point + first),
        Element::Body { world_from_body } => {
            let mut world_from_body = world_from_body * motion(first, step.fixed_rows::<3>(3).into());
            world_from_body.rotation.renormalize();
            Element::Body { world_from_body }
        }
    }
}

fn motion(turn: Vector3<f64>, shift: Vector3<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(shift), UnitQuaternion::from_scaled_axis(turn))
}
