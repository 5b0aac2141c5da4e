//! Vertices in the image.

use super::lanes::{LANES, Lanes};
use super::pattern::times;
use super::scene::{self, Scene, Solid};
use camera::{BrownConrady, Camera};
use nalgebra::{Matrix3, Point3, Vector2, Vector3};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

/// Vertices nearer to the camera's plane than this are not drawn, mm.
const NEAREST_MM: f64 = 1.0;
/// How far out, in tangents of the angle to the optical axis, a lens is searched for its fold, and in which steps.
const FOLD_SEARCH: (f64, f64) = (6.0, 2e-3);

/// A vertex in the image at the four times: pixel position and 1 / depth (1/mm); the latter is 0 where it cannot be drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub(super) x: Lanes,
    pub(super) y: Lanes,
    pub(super) nearness: Lanes,
}

/// All vertices in the image, those of the face first.
pub(super) enum Projection {
    /// Nothing moves.
    Still(Vec<[f32; 3]>),
    Moving(Vec<Corner>),
}

impl Projection {
    pub(super) fn of(scene: &Scene<'_>, camera: &Camera) -> Self {
        let eye = Eye::of(camera);
        let moves = scene.moves();
        let count = scene.solids().map(|solid| solid.moment.open.len()).sum();
        if moves {
            let mut all = Vec::with_capacity(count);
            scene.solids().for_each(|solid| eye.moving(solid, &mut all));
            return Self::Moving(all);
        }
        let mut all = Vec::with_capacity(count);
        scene.solids().for_each(|solid| {
            all.par_extend(solid.moment.open.par_iter().with_min_len(4096).map(|point| eye.see(point)));
        });
        Self::Still(all)
    }
}

/// Where corners are read from; the drawing is compiled for each kind.
pub(super) trait Corners: Sync {
    fn corner(&self, vertex: u32) -> Corner;
}

impl Corners for Vec<[f32; 3]> {
    #[inline(always)]
    fn corner(&self, vertex: u32) -> Corner {
        let [x, y, nearness] = self[vertex as usize];
        Corner { x: [x; LANES], y: [y; LANES], nearness: [nearness; LANES] }
    }
}

impl Corners for Vec<Corner> {
    #[inline(always)]
    fn corner(&self, vertex: u32) -> Corner {
        self[vertex as usize]
    }
}

/// A camera with its matrix at hand and the bounds of its lens known.
struct Eye<'a> {
    camera: &'a Camera,
    rotation: Matrix3<f64>,
    shift: Vector3<f64>,
    fold_squared: f64,
}

impl<'a> Eye<'a> {
    fn of(camera: &'a Camera) -> Self {
        let rotation = *camera.cam_from_world.rotation.to_rotation_matrix().matrix();
        let shift = camera.cam_from_world.translation.vector;
        let fold = fold(&camera.lens.distortion);
        Self { camera, rotation, shift, fold_squared: fold * fold }
    }

    /// x, y, 1 / depth.
    fn see(&self, point: &Point3<f64>) -> [f32; 3] {
        let cam = self.rotation * point.coords + self.shift;
        let nearness = 1.0 / cam.z;
        let normalised: Vector2<f64> = cam.xy() * nearness;
        if cam.z < NEAREST_MM || normalised.norm_squared() >= self.fold_squared {
            return [0.0; 3];
        }
        let lens = &self.camera.lens;
        let pixel = lens.focal_px.component_mul(&lens.distortion.distort(normalised)) + lens.center_px;
        [pixel.x as f32, pixel.y as f32, nearness as f32]
    }

    /// Adds a solid's vertices at the four times.
    fn moving(&self, solid: &Solid<'_>, all: &mut Vec<Corner>) {
        let open = solid.moment.open;
        let close = solid.moment.close.unwrap_or(open);
        let first = all.len();
        let nowhere = Corner { x: [0.0; LANES], y: [0.0; LANES], nearness: [0.0; LANES] };
        all.resize(first + open.len(), nowhere);
        let arch = Arch::new();
        let parts = all[first..].par_chunks_mut(RUN).zip(open.par_chunks(RUN).zip(close.par_chunks(RUN)));
        match solid.moment.middle {
            None => parts.for_each(|(corners, (open, close))| {
                arch.dispatch(Seen { eye: self, open, middle: None, close, corners });
            }),
            Some(middle) => {
                parts.zip(middle.par_chunks(RUN)).for_each(|((corners, (open, close)), middle)| {
                    arch.dispatch(Seen { eye: self, open, middle: Some(middle), close, corners });
                })
            }
        }
    }

    /// A vertex at the four times, given its keys and their weights per time; [`Eye::see`] side by side.
    #[inline(always)]
    fn corner<const KEYS: usize>(
        &self,
        keys: [&Point3<f64>; KEYS],
        weights: &[[f64; LANES]; KEYS],
    ) -> Corner {
        let row = |row: usize| -> [f64; LANES] {
            let [x, y, z] = [0, 1, 2].map(|axis| {
                each(|t| {
                    let mut place = 0.0;
                    for key in 0..KEYS {
                        place += keys[key][axis] * weights[key][t];
                    }
                    place
                })
            });
            let r = |column: usize| self.rotation[(row, column)];
            each(|t| r(0) * x[t] + r(1) * y[t] + r(2) * z[t] + self.shift[row])
        };
        let (cam_x, cam_y, depth) = (row(0), row(1), row(2));
        let nearness = each(|t| 1.0 / depth[t]);
        let (x, y) = (each(|t| cam_x[t] * nearness[t]), each(|t| cam_y[t] * nearness[t]));
        let lens = &self.camera.lens;
        let mut corner = Corner { x: [0.0; LANES], y: [0.0; LANES], nearness: [0.0; LANES] };
        for t in 0..LANES {
            let drawn = depth[t] >= NEAREST_MM && x[t] * x[t] + y[t] * y[t] < self.fold_squared;
            let at = lens.distortion.distort(Vector2::new(x[t], y[t]));
            let pixel = lens.focal_px.component_mul(&at) + lens.center_px;
            corner.x[t] = if drawn { pixel.x as f32 } else { 0.0 };
            corner.y[t] = if drawn { pixel.y as f32 } else { 0.0 };
            corner.nearness[t] = if drawn { nearness[t] as f32 } else { 0.0 };
        }
        corner
    }
}

/// Vertices per job.
const RUN: usize = 2048;

#[inline(always)]
fn each(f: impl Fn(usize) -> f64) -> [f64; LANES] {
    std::array::from_fn(f)
}

/// Vertices seen with the widest vectors that the processor has; they change no bit.
struct Seen<'a> {
    eye: &'a Eye<'a>,
    open: &'a [Point3<f64>],
    middle: Option<&'a [Point3<f64>]>,
    close: &'a [Point3<f64>],
    corners: &'a mut [Corner],
}

impl NullaryFnOnce for Seen<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let times = times();
        let ends = self.corners.iter_mut().zip(self.open).zip(self.close);
        match self.middle {
            None => {
                let weights = [times.map(|time| 1.0 - time), times];
                ends.for_each(|((corner, from), to)| *corner = self.eye.corner([from, to], &weights));
            }
            Some(middle) => {
                let of_time = times.map(scene::weights);
                let weights = [0, 1, 2].map(|key| of_time.map(|weights| weights[key]));
                ends.zip(middle).for_each(|(((corner, from), to), halfway)| {
                    *corner = self.eye.corner([from, halfway, to], &weights);
                });
            }
        }
    }
}

/// The distance from the optical axis, as the tangent of the angle, where the radial distortion stops growing; beyond
/// it the model brings points back into the image.
fn fold(lens: &BrownConrady) -> f64 {
    let (end, step) = FOLD_SEARCH;
    let grows = |r2: f64| 1.0 + r2 * (3.0 * lens.k1 + r2 * (5.0 * lens.k2 + r2 * 7.0 * lens.k3)) > 0.0;
    (0..(end / step) as usize)
        .map(|index| step * index as f64)
        .find(|r| !grows(r * r))
        .unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use camera::Lens;

    #[test]
    fn a_barrel_lens_folds_where_its_slope_ends_and_a_pincushion_one_does_not() {
        let lens = |k1: f64| BrownConrady { k1, ..BrownConrady::default() };
        assert!((fold(&lens(-0.25)) - (4.0_f64 / 3.0).sqrt()).abs() < 3e-3);
        assert_eq!(fold(&lens(0.1)), f64::INFINITY);
    }

    #[test]
    fn vertices_are_where_the_camera_projects_them_and_none_behind_it() {
        let camera = Camera {
            image_size: [640, 480],
            lens: Lens {
                focal_px: Vector2::new(900.0, 905.0),
                center_px: Vector2::new(320.5, 239.0),
                distortion: BrownConrady { k1: -0.2, k2: 0.1, p1: 1e-3, p2: -5e-4, k3: 0.01 },
            },
            cam_from_world: Camera::pose_looking_at(
                Point3::new(100.0, 50.0, 600.0),
                Point3::origin(),
                Vector3::y(),
            ),
        };
        let eye = Eye::of(&camera);
        let point = Point3::new(40.0, -30.0, 20.0);
        let [x, y, nearness] = eye.see(&point);
        let pixel = camera.project(&point).unwrap();
        assert!((f64::from(x) - pixel.x).abs() < 1e-4 && (f64::from(y) - pixel.y).abs() < 1e-4);
        assert!((1.0 / f64::from(nearness) - (camera.cam_from_world * point).z).abs() < 1e-3);
        assert_eq!(eye.see(&Point3::new(100.0, 50.0, 700.0))[2], 0.0);
    }
}
