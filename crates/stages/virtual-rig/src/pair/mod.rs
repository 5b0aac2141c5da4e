//! Photographs of a patch of skin, at rest and wrinkled, whose normals are known: the test bench of maps from ratio images
//! [DutreveMeyer2011].
//!
//! The wrinkled skin is a height field ([`skin`]); how bright each of its places is, under open sky, a flash beside the lens or a
//! mixture, is gathered over it with all bounces ([`glow`]); then the camera, and everything that makes two photographs of a face
//! differ though nothing wrinkled, spoils them ([`photo`]). [`face`] photographs a whole face.

pub mod face;
mod glow;
mod params;
mod photo;
mod skin;
mod waves;

pub use params::{Degradation, Groove, PairScenario};
pub use photo::{Pair, photograph};
pub use skin::Skin;
