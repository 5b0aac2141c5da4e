//! Follows painted markers through the images of each camera.

mod assign;
mod blobs;
mod center;
mod dots;
mod error;
mod matching;
mod matte;
mod paint;
mod params;
mod picture;
mod predict;
mod track;
mod tracker;
mod transfer;

pub use error::Error;
pub use paint::Paint;
pub use params::Params;
pub use picture::Picture;
pub use tracker::{Hint, Tracker};
pub use transfer::linear_light;
