//! Finds lenses and poses of all cameras from pictures of a board or a waved point.
//!
//! [`calibrate_board`] goes from the corners of a board ([`Corners`]) to cameras in one space, [`wand`] from one waved point;
//! [`bundle`] is the adjustment that ends every calibration; [`doctor`] judges a calibration by what it has not seen.

pub mod bundle;
pub mod doctor;
pub mod wand;

mod board;
mod corners;
#[cfg(feature = "detect")]
mod detect;
mod error;
mod extrinsics;
mod intrinsics;
mod joint;
mod params;
mod picture;
mod planar;
mod refine;
mod report;

pub use board::{Board, Dictionary};
pub use corners::{BoardCorners, BoardFile, Corners, CornersFrame, CornersHeader};
#[cfg(feature = "detect")]
pub use detect::{DetectError, Picture, find_corners};
pub use error::Error;
pub use joint::{Calibration, Residual, calibrate_board};
pub use params::{LensModel, Params, Robust};
pub use picture::{FontError, Sheet, draw};
pub use refine::{RefineParams, Refined, refine_with_corners, refine_with_tracks};
pub use report::{CELLS, CameraReport, Report};
