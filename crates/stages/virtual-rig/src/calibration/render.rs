//! Pictures of boards, by asking for each piece of a pixel where on the board it looks.

use super::board::Pattern;
use super::{Board, Picture};
use crate::Error;
use camera::Camera;
use nalgebra::{Isometry3, Matrix3, Point2, Point3, Vector2, Vector3};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The light on a board: nearly even.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BoardLight {
    /// Irradiance at the world's origin; 1 is full light.
    pub level: f64,
    /// How much it rises per metre of the world, as a share of the level.
    pub rise_per_m: [f64; 3],
    /// Radiance of the room behind the board.
    pub room: f64,
}

impl Default for BoardLight {
    fn default() -> Self {
        Self { level: 0.9, rise_per_m: [0.3, 0.2, 0.1], room: 0.012 }
    }
}

impl BoardLight {
    /// Refuses light that is none.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self, place: &str) -> Result<(), Error> {
        let bad = |key: &str, value: f64| Error::Parameter {
            place: format!("{place}.{key}"),
            what: format!("{value} is no amount of light"),
        };
        if !(self.level.is_finite() && self.level > 0.0) {
            return Err(bad("level", self.level));
        }
        if let Some(value) = self.rise_per_m.iter().find(|value| !value.is_finite()) {
            return Err(bad("rise_per_m", *value));
        }
        match self.room.is_finite() && self.room >= 0.0 {
            true => Ok(()),
            false => Err(bad("room", self.room)),
        }
    }

    fn at(&self, point_in_world: &Point3<f64>) -> f64 {
        let rise = point_in_world.coords.dot(&Vector3::from(self.rise_per_m)) / 1000.0;
        self.level * (1.0 + rise).max(0.0)
    }
}

/// The golden ratio less 1: its multiples spread most evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// Reflectance of a board's back.
const BACK: [f32; 3] = [0.2; 3];

/// A camera with the directions of its pixels' corners worked out, to render many views of a board.
pub struct BoardCamera {
    camera: Camera,
    /// Directions (x / z, y / z) in camera space of the corners of pixels, one row and column more than pixels; not a number where the lens
    /// folds.
    corners: Vec<Vector2<f64>>,
}

impl BoardCamera {
    /// Works out the directions.
    #[must_use]
    pub fn new(camera: &Camera) -> Self {
        let [columns, rows] = camera.image_size.map(|side| side as usize + 1);
        let direction = |index: usize| {
            let [x, y] = [index % columns, index / columns].map(|step| step as f64 - 0.5);
            camera.lens.unproject(Vector2::new(x, y)).map_or(Vector2::repeat(f64::NAN), |ray| ray.xy())
        };
        let corners = (0..columns * rows).into_par_iter().map(direction).collect();
        Self { camera: camera.clone(), corners }
    }

    /// The board as the camera sees it: linear radiance, averaged over each pixel. Pixels that see one colour only take one sample,
    /// others `samples`, spread evenly.
    ///
    /// `world_from_board`: rigid, mm. Inside a pixel the lens counts as linear (off by less than 1e-5 px).
    #[must_use]
    pub fn render(
        &self,
        board: &Board,
        world_from_board: &Isometry3<f64>,
        light: &BoardLight,
        samples: u32,
    ) -> Picture {
        let view = View::new(&self.camera, board, world_from_board, light);
        let [width, height] = self.camera.image_size.map(|side| side as usize);
        let row = |y: usize| (0..width).map(move |x| [x, y]);
        let pixel = |[x, y]: [usize; 2]| {
            let corner = |dx: usize, dy: usize| self.corners[(y + dy) * (width + 1) + x + dx];
            view.pixel([corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)], samples.max(1))
        };
        let radiance = (0..height).into_par_iter().flat_map_iter(row).map(pixel).collect();
        Picture { size: self.camera.image_size, radiance }
    }
}

/// A board before a camera.
struct View<'a> {
    pattern: Pattern,
    /// (x, y, 1) in camera space to a multiple of (x, y, 1) on the board.
    board_from_ray: Option<Matrix3<f64>>,
    world_from_board: &'a Isometry3<f64>,
    light: &'a BoardLight,
    is_front: bool,
}

impl<'a> View<'a> {
    fn new(
        camera: &Camera,
        board: &Board,
        world_from_board: &'a Isometry3<f64>,
        light: &'a BoardLight,
    ) -> Self {
        let cam_from_board = camera.cam_from_world * world_from_board;
        let rotation = cam_from_board.rotation.to_rotation_matrix();
        let ray_from_board = Matrix3::from_columns(&[
            rotation.matrix().column(0).into_owned(),
            rotation.matrix().column(1).into_owned(),
            cam_from_board.translation.vector,
        ]);
        let eye_in_board = cam_from_board.inverse_transform_point(&Point3::origin());
        Self {
            pattern: Pattern::new(board),
            board_from_ray: ray_from_board.try_inverse(),
            world_from_board,
            light,
            is_front: eye_in_board.z < 0.0,
        }
    }

    /// Where on the board's plane a ray lands; none if it does not.
    fn land(&self, ray: Vector2<f64>) -> Option<Point2<f64>> {
        let hit = self.board_from_ray? * ray.push(1.0);
        // A multiple below zero is behind the camera; of rays that are not numbers nothing is above zero.
        (hit.z > 0.0).then(|| Point2::new(hit.x / hit.z, hit.y / hit.z))
    }

    /// Mean radiance over a pixel, from the rays of its corners: top left, top right, bottom left, bottom right.
    fn pixel(&self, corners: [Vector2<f64>; 4], samples: u32) -> [f32; 3] {
        let samples = if self.is_of_one_colour(corners) { 1 } else { samples };
        let [top_left, top_right, bottom_left, bottom_right] = corners;
        let mut sum = [0.0_f64; 3];
        for i in 0..samples {
            // No two samples share a row or a column, so that edges along rows are not placed by steps of 1 / √samples.
            let (u, v) = ((f64::from(i) + 0.5) / f64::from(samples), ((f64::from(i) + 0.5) * GOLDEN).fract());
            let v = if samples == 1 { 0.5 } else { v };
            let (left, right) = (top_left.lerp(&bottom_left, v), top_right.lerp(&bottom_right, v));
            let radiance = self.radiance(left.lerp(&right, u));
            (0..3).for_each(|channel| sum[channel] += radiance[channel]);
        }
        sum.map(|sum| (sum / f64::from(samples)) as f32)
    }

    /// Whether no line of the pattern runs through a pixel.
    fn is_of_one_colour(&self, corners: [Vector2<f64>; 4]) -> bool {
        let landed = corners.map(|ray| self.land(ray));
        if landed.iter().all(Option::is_none) {
            return true;
        }
        let [Some(a), Some(b), Some(c), Some(d)] = landed else { return false };
        let low = a.inf(&b).inf(&c.inf(&d));
        let high = a.sup(&b).sup(&c.sup(&d));
        self.pattern.cell(low) == self.pattern.cell(high)
    }

    fn radiance(&self, ray: Vector2<f64>) -> [f64; 3] {
        let seen = self.land(ray).and_then(|point| {
            let reflectance = self.pattern.reflectance(self.pattern.cell(point))?;
            let light = self.light.at(&(self.world_from_board * Point3::new(point.x, point.y, 0.0)));
            let reflectance = if self.is_front { reflectance } else { BACK };
            Some(reflectance.map(|share| f64::from(share) * light))
        });
        seen.unwrap_or([self.light.room; 3])
    }
}
