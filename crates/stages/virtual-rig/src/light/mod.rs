//! How much of the sky each point of the skin sees.
//!
//! Rays are cast from the vertices at the true geometry of a frame; there is no formula for any shape. [`Scene`] holds the
//! geometry, [`irradiance`] lights any points, [`shade`] a whole frame by a [`Plan`]. Light is traced in the space of the
//! face, where a uniform sky stays the same while the head moves; a gradient must be turned into it.

pub mod ambient;
mod beam;
mod directions;
pub mod groove;
mod interreflection;
mod params;
pub mod scene;
mod shading;
mod sweep;
mod tree;

pub use ambient::irradiance;
pub use params::{Ambient, Interreflection};
pub use scene::{Hit, Occluder, Scene};
pub use shading::{Plan, Surface, shade};
