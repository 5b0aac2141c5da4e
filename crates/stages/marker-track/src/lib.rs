//! Follows painted markers through the images of each camera.

mod assign;
mod blobs;
mod center;
mod detect;
mod dots;
mod draw;
mod edits;
mod error;
mod guide;
mod matching;
mod matte;
mod paint;
mod params;
mod picture;
mod predict;
mod track;
mod tracker;
mod transfer;

pub use detect::{Found, detect, places_of_color};
pub use draw::Canvas;
pub use edits::Edits;
pub use error::Error;
pub use guide::hints;
pub use paint::Paint;
pub use params::Params;
pub use picture::Picture;
pub use tracker::{Hint, Tracker};
pub use transfer::linear_light;
