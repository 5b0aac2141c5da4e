//! A board that is held before the cameras.

use super::Board;
use super::params::BoardViews;
use super::volume::common_volume;
use crate::Error;
use camera::Camera;
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector2, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::{BTreeMap, BTreeSet};

/// A corner of a board in a camera's image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CornerInImage {
    /// The corner's number.
    pub id: u32,
    /// Its place in the image, px.
    pub point_in_image: Vector2<f64>,
}

/// The corners that lie on a camera's image, if it sees the board's front at all.
#[must_use]
pub fn corners_in_image(
    camera: &Camera,
    board: &Board,
    world_from_board: &Isometry3<f64>,
) -> Vec<CornerInImage> {
    if !is_front(camera, board, world_from_board, 0.0) {
        return Vec::new();
    }
    let seen = |corner: super::Corner| {
        let point_in_image = camera.project(&(world_from_board * corner.point_in_board))?;
        camera.contains(point_in_image).then_some(CornerInImage { id: corner.id, point_in_image })
    };
    board.corners().into_iter().filter_map(seen).collect()
}

/// Views flatter than this show corners too squeezed to be found.
const MIN_COSINE: f64 = 0.35;
/// Room that detectors want between the pattern and the image's edge, px.
const EDGE_PX: f64 = 4.0;

/// Whether a camera sees the whole pattern, from before it and not too flat.
#[must_use]
pub fn is_seen_whole(camera: &Camera, board: &Board, world_from_board: &Isometry3<f64>) -> bool {
    let [width, height] = camera.image_size.map(f64::from);
    let inside = |corner: &Point3<f64>| {
        camera.project(&(world_from_board * corner)).is_some_and(|pixel| {
            // A folded lens would bring points from far outside back in.
            let on_image = (EDGE_PX..width - 1.0 - EDGE_PX).contains(&pixel.x)
                && (EDGE_PX..height - 1.0 - EDGE_PX).contains(&pixel.y);
            on_image && camera.ray_in_world(pixel).is_some()
        })
    };
    is_front(camera, board, world_from_board, MIN_COSINE) && board.outline().iter().all(inside)
}

fn is_front(camera: &Camera, board: &Board, world_from_board: &Isometry3<f64>, min_cosine: f64) -> bool {
    let to_eye = camera.eye_in_world() - world_from_board * board.middle();
    let front = world_from_board * -Vector3::z();
    to_eye.dot(&front) > min_cosine * to_eye.norm()
}

/// Candidates per view, of which the best is kept.
const CANDIDATES: usize = 80;
/// Parts along x and y in which the cover of an image is counted.
const PARTS: [f64; 2] = [6.0, 5.0];
/// What a further camera that sees a view whole is worth, in parts of an image that nothing covered yet.
const SHARED_WORTH: f64 = 0.5;

/// A part of a camera's image.
type Part = (usize, [u8; 2]);

/// Poses `world_from_board` of a board that is waved before the cameras (by id): each view aims at a place in one camera's image
/// (the cameras take turns), at a varying distance, tilted and turned by chance. Of 80 candidates the one is kept that
/// shows corners in parts of the images that few views have covered yet, and is seen whole by many cameras.
///
/// # Errors
/// If the cameras' views do not meet, or one cannot see the board whole anywhere.
pub fn board_poses(
    cameras: &[(&str, &Camera)],
    views: &BoardViews,
    seed: u64,
) -> Result<Vec<Isometry3<f64>>, Error> {
    if views.count == 0 {
        return Ok(Vec::new());
    }
    let (ids, cameras): (Vec<&str>, Vec<Camera>) =
        cameras.iter().map(|(id, camera)| (*id, (*camera).clone())).unzip();
    let cameras = cameras.as_slice();
    let refuse = |what: String| Error::Parameter { place: "calibration.boards".into(), what };
    let volume = common_volume(cameras).ok_or_else(|| refuse("the cameras' views do not meet".into()))?;
    let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0xb0a2d);
    let mut covered: BTreeMap<Part, u32> = BTreeMap::new();
    let mut poses = Vec::with_capacity(views.count);
    for view in 0..views.count {
        let aimed = view % cameras.len();
        let mut best: Option<(f64, Isometry3<f64>, Vec<Part>)> = None;
        for _ in 0..CANDIDATES {
            let pose = candidate(cameras, aimed, views, volume.middle, &mut rng);
            if !is_seen_whole(&cameras[aimed], &views.board, &pose) {
                continue;
            }
            let (parts, shared) = parts(cameras, &views.board, &pose);
            let worth_of = |part: &Part| f64::from(1 + covered.get(part).unwrap_or(&0)).powi(-2);
            let worth = parts.iter().map(worth_of).sum::<f64>() + SHARED_WORTH * shared as f64;
            if best.as_ref().is_none_or(|(least, ..)| worth > *least) {
                best = Some((worth, pose, parts));
            }
        }
        let (_, pose, parts) = best.ok_or_else(|| {
            let id = ids[aimed];
            refuse(format!("camera {id} sees the board whole nowhere; take a smaller board"))
        })?;
        parts.into_iter().for_each(|part| *covered.entry(part).or_default() += 1);
        poses.push(pose);
    }
    Ok(poses)
}

/// The parts of the cameras' images in which corners lie, of the cameras that see the board whole; and how many these are.
fn parts(cameras: &[Camera], board: &Board, pose: &Isometry3<f64>) -> (Vec<Part>, usize) {
    let (mut parts, mut shared) = (Vec::new(), 0);
    for (index, camera) in cameras.iter().enumerate() {
        if !is_seen_whole(camera, board, pose) {
            continue;
        }
        shared += 1;
        let part = |corner: CornerInImage| {
            [0, 1].map(|axis| {
                let side = f64::from(camera.image_size[axis]);
                ((corner.point_in_image[axis] + 0.5) / side * PARTS[axis]) as u8
            })
        };
        let own: BTreeSet<[u8; 2]> = corners_in_image(camera, board, pose).into_iter().map(part).collect();
        parts.extend(own.into_iter().map(|part| (index, part)));
    }
    (parts, shared)
}

/// A pose that puts the board's middle at a random place of a camera's image, facing between that camera and all of
/// them.
fn candidate(
    cameras: &[Camera],
    aimed: usize,
    views: &BoardViews,
    middle: Point3<f64>,
    rng: &mut ChaCha8Rng,
) -> Isometry3<f64> {
    let camera = &cameras[aimed];
    let eye = camera.eye_in_world();
    let pixel = Vector2::from_fn(|axis, _| f64::from(camera.image_size[axis]) * rng.random_range(0.08..0.92));
    let toward = camera.ray_in_world(pixel).map_or(middle - eye, |ray| ray.into_inner());
    let [near, far] = views.distance;
    let place = eye + toward.normalize() * (middle - eye).norm() * rng.random_range(near..=far);
    let eyes: Vector3<f64> = cameras.iter().map(|camera| camera.eye_in_world().coords).sum();
    let all = Point3::from(eyes / cameras.len() as f64);
    let facing = (eye - place).lerp(&(all - place), rng.random_range(0.0..1.0));
    let down: Vector3<f64> =
        cameras.iter().map(|camera| camera.cam_from_world.inverse_transform_vector(&Vector3::y())).sum();
    let [tilt, turn] = [views.tilt_deg, views.turn_deg].map(f64::to_radians);
    let direction = rng.random_range(0.0..std::f64::consts::TAU);
    let axis = Unit::new_normalize(Vector3::new(direction.cos(), direction.sin(), 0.0));
    let tilted = UnitQuaternion::from_axis_angle(&axis, tilt * rng.random_range(0.0_f64..1.0).sqrt())
        * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), rng.random_range(-turn..=turn));
    let rotation = facing_rotation(facing, down) * tilted;
    let to_middle = Translation3::from(-views.board.middle().coords);
    Isometry3::from_parts(place.into(), rotation) * to_middle
}

/// The rotation `world_from_board` of a board that faces a direction (its z points the other way) with its y down.
fn facing_rotation(facing: Vector3<f64>, down: Vector3<f64>) -> UnitQuaternion<f64> {
    let z = -facing.normalize();
    let x = down.cross(&z).try_normalize(1e-9).unwrap_or_else(Vector3::x);
    let axes = Matrix3::from_columns(&[x, z.cross(&x), z]);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
}
