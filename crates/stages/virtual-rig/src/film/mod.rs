//! What a camera makes of a painted face.
//!
//! [`expose`] draws triangles with several samples per pixel, each at its own place in the pixel and at one of four
//! times of the exposure; paint is evaluated per sample. The result is in linear light. [`develop`] makes of it what a
//! sensor delivers: lens blur, noise, transfer function, bits.
//!
//! Conventions: pixel (0, 0) is the *centre* of the top-left pixel, footprints are ±0.5 px squares. Vertices go through
//! the whole lens model; triangles are straight in the image, so a coarse surface at the border of a bent image shows its
//! facets. Triangles with a corner behind the camera, or where the lens folds, are left out.

mod bins;
mod exposure;
mod lanes;
mod noise;
mod params;
mod pattern;
mod projection;
mod scene;
mod sensor;
mod shade;
mod tile;
mod transfer;

pub use exposure::{Cover, Exposure, expose};
pub use noise::Grain;
pub use params::{Film, Gloss, Sensor, Transfer};
pub use scene::{Moment, Scene, Skin, Solid};
pub use sensor::develop;
