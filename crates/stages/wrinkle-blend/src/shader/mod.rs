//! The equations for a graphics card, in three languages, printed from one source.
//!
//! `source.rs` holds them as expressions; [`text`] prints them, [`evaluate`] computes them in 32 bits as a card does. The tests
//! compare both with the library: the files in `shaders/` are what is printed, and what is evaluated is what [`MapBlender`] and
//! [`Blender`] compute.
//!
//! [`MapBlender`]: crate::MapBlender
//! [`Blender`]: crate::Blender

mod evaluate;
mod expression;
mod print;
mod source;

pub use evaluate::{Value, evaluate};
pub use print::text;

use serde::{Deserialize, Serialize};

/// A shading language.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Language {
    /// OpenGL, WebGL 2, Vulkan.
    Glsl,
    /// Direct3D, Unity, Unreal.
    Hlsl,
    /// WebGPU.
    Wgsl,
}

impl Language {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Glsl, Self::Hlsl, Self::Wgsl];

    /// The ending of its files.
    #[must_use]
    pub fn ending(self) -> &'static str {
        match self {
            Self::Glsl => "glsl",
            Self::Hlsl => "hlsl",
            Self::Wgsl => "wgsl",
        }
    }
}
