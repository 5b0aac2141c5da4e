//! What the page draws: the character, its poses and its motion, as a small document and one block of numbers.
//!
//! The page computes the shares of the bones per frame ([`Blender::shares`](crate::Blender::shares)) and hands them to a shader, which
//! computes the rest with the equations of [`shader`](crate::shader). Everything that it needs for that stands in a [`Scene`]; it
//! reads no glTF itself, so that it sees what the other commands see.

mod block;
mod expressions;
mod parts;
mod scene;
mod surface;

pub use block::Span;
pub use expressions::{Expression, Mix};
pub use parts::{Part, PartKind};
pub use scene::{Clip, MAX_POSES, Scene, SceneBone, SceneNode, ScenePose, Wish, scene};

/// The colours of the poses where influence is shown, over and over.
pub const COLORS: [[f32; 3]; 8] = [
    [0.9, 0.1, 0.1],
    [0.1, 0.75, 0.15],
    [0.15, 0.3, 0.95],
    [0.95, 0.8, 0.1],
    [0.8, 0.2, 0.85],
    [0.1, 0.8, 0.85],
    [0.95, 0.5, 0.1],
    [0.45, 0.3, 0.2],
];
