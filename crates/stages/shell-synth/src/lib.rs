//! WIP
mod at_rest;
mod coarse;
mod crease;
mod curve;
mod descent;
pub mod energy;
mod error;
mod locator;
mod params;
mod patch;
mod profile;
mod reach;
mod slack;
mod stamp;
mod surface;
mod synthesis;

pub use crease::Drift;
pub use descent::Descent;
pub use error::Error;
pub use params::{Params, Solver, Track};
pub use profile::Profile;
pub use synthesis::{CreaseReport, RegionReport, Synthesis, Wrinkling};
