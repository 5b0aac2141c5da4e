//! Finds markers in 3D from their images in calibrated cameras.
//!
//! mod docs below
mod affine;
mod error;
mod fill;
mod filter;
mod noise;
mod paper;
mod params;
mod point;
mod report;
mod skew;
mod solve;
mod strain;
mod timeline;
mod triangulator;
mod view;

pub use error::Error;
pub use params::{Filter, PIXELS, Params, TIMES_MS};
pub use report::{CameraReport, MarkerReport, Report};
pub use strain::Swap;
pub use timeline::{Column, STATES, Timeline};
pub use triangulator::{Outcome, Triangulator, triangulate};
