//! Which parameters of a camera move, and in which directions.

use super::{Element, Scene};
use nalgebra::{SMatrix, Vector3};
use serde::{Deserialize, Serialize};

/// Parameters of a camera: turn and shift in its own axes, focal lengths, principal point, k₁, k₂, p₁, p₂, k₃.
pub(super) const PARAMETERS: usize = 15;
pub(super) const TURN: usize = 0;
pub(super) const SHIFT: usize = 3;
pub(super) const FOCAL: usize = 6;
pub(super) const CENTER: usize = 8;
pub(super) const DISTORTION: usize = 10;

/// Directions in the space of a camera's parameters, one per column; what is not used is zero.
pub(super) type Directions = SMatrix<f64, PARAMETERS, PARAMETERS>;

/// What of the focal lengths may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Focal {
    /// Nothing.
    Held,
    /// Both, in proportion: the shape of the pixels is known.
    Tied,
    /// Each by itself.
    Free,
}

/// What of a camera may change.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Free {
    /// The pose.
    pub pose: bool,
    /// The focal lengths.
    pub focal: Focal,
    /// The principal point.
    pub center: bool,
    /// k₁, k₂, p₁, p₂, k₃, each.
    pub distortion: [bool; 5],
}

impl Free {
    /// Everything.
    pub const ALL: Self = Self { pose: true, focal: Focal::Free, center: true, distortion: [true; 5] };
    /// The pose alone.
    pub const POSE: Self = Self { pose: true, focal: Focal::Held, center: false, distortion: [false; 5] };
    /// Nothing.
    pub const NOTHING: Self = Self { pose: false, ..Self::POSE };

    /// Everything but the pose.
    #[must_use]
    pub fn without_pose(self) -> Self {
        Self { pose: false, ..self }
    }
}

/// The free directions of one camera, and how many there are.
#[derive(Debug, Clone)]
pub(super) struct Frame {
    pub(super) directions: Directions,
    pub(super) count: usize,
}

/// What is held although the caller left it free, because no observation depends on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Gauge {
    /// Holds its whole pose: it carries the world.
    pose: Option<usize>,
    /// Keeps its distance from the first one's: it carries the scale.
    scale: Option<(usize, usize)>,
}

impl Gauge {
    /// The pose of one camera where nothing is tied to the world; the distance between two where nothing tells the scale.
    pub(super) fn of(scene: &Scene, structure_moves: bool) -> Self {
        if !structure_moves {
            return Self::default();
        }
        let seen = |c: &usize| scene.observations.iter().any(|seen| seen.camera == *c);
        let cameras: Vec<usize> = (0..scene.cameras.len()).filter(seen).collect();
        let held: Vec<usize> = cameras.iter().copied().filter(|&c| !scene.free[c].pose).collect();
        let pose = if held.is_empty() { cameras.first().copied() } else { None };
        let has_scale = scene.structure.iter().any(|element| matches!(element, Element::Body { .. }));
        let is_moving = |c: &usize| scene.free[*c].pose && pose != Some(*c);
        let anchor = pose.or(if held.len() == 1 { held.first().copied() } else { None });
        let scale = match (anchor, cameras.iter().copied().find(is_moving)) {
            (Some(anchor), Some(other)) if !has_scale => Some((anchor, other)),
            _ => None,
        };
        Self { pose, scale }
    }

    /// The free directions of a camera.
    pub(super) fn frame(&self, scene: &Scene, camera: usize) -> Frame {
        let free = scene.free[camera];
        let mut frame = Frame { directions: Directions::zeros(), count: 0 };
        if free.pose && self.pose != Some(camera) {
            (TURN..SHIFT).for_each(|row| frame.push(row));
            self.shifts(scene, camera, &mut frame);
        }
        match free.focal {
            Focal::Held => {}
            Focal::Free => (FOCAL..CENTER).for_each(|row| frame.push(row)),
            Focal::Tied => {
                let focal = scene.cameras[camera].lens.focal_px;
                frame.directions[(FOCAL + 1, frame.count)] = focal.y / focal.x;
                frame.push(FOCAL);
            }
        }
        if free.center {
            (CENTER..DISTORTION).for_each(|row| frame.push(row));
        }
        (0..5).filter(|&i| free.distortion[i]).for_each(|i| frame.push(DISTORTION + i));
        frame
    }

    fn shifts(&self, scene: &Scene, camera: usize, frame: &mut Frame) {
        let along = match self.scale {
            Some((anchor, carrier)) if carrier == camera => {
                let [from, to] = [anchor, camera].map(|c| scene.cameras[c].eye_in_world());
                (scene.cameras[camera].cam_from_world.rotation * (to - from)).try_normalize(f64::MIN_POSITIVE)
            }
            _ => None,
        };
        let Some(along) = along else { return (SHIFT..FOCAL).for_each(|row| frame.push(row)) };
        // A centre moves against the shift; across the baseline it keeps its distance.
        let aside = along.cross(&Vector3::ith(along.iamin(), 1.0)).normalize();
        for across in [aside, along.cross(&aside)] {
            frame.directions.fixed_view_mut::<3, 1>(SHIFT, frame.count).copy_from(&across);
            frame.count += 1;
        }
    }
}

impl Frame {
    fn push(&mut self, row: usize) {
        self.directions[(row, self.count)] = 1.0;
        self.count += 1;
    }
}
