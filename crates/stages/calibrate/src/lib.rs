//! Finds lenses and poses of all cameras from pictures of a board or a waved point, and judges what was found.
//!
//! - `find_corners` (feature `detect`) looks for a board in a picture; [`calibrate_board`] goes from its [`Corners`] to cameras in
//!   one space.
//! - [`wand`] does the same from one waved point, which [`wand::bright_point`] finds.
//! - [`refine_with_corners`], [`refine_with_tracks`] make known cameras better.
//! - [`bundle`] is the adjustment that ends all of these.
//! - [`doctor`] judges a calibration by what it has not seen.
//!
//! ```
//! use calibrate::{Board, Corners, CornersFrame, CornersHeader, Error, Params, calibrate_board};
//! let board = Board::Chessboard { columns: 8, rows: 6, square_mm: 16.0 };
//! let header = CornersHeader { board, cameras: [("m1".to_string(), [656, 490])].into(), take: None };
//! let unseen = CornersFrame { frame: 0, seen: Default::default() };
//! let refused = calibrate_board(&Corners { header, frames: vec![unseen] }, &Params::default());
//! assert!(matches!(refused, Err(Error::NothingSeen)));
//! ```

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
pub use params::{FEWEST_CORNERS, LensModel, Params, Robust};
pub use picture::draw;
pub use refine::{RefineParams, Refined, refine_with_corners, refine_with_tracks};
pub use report::{CELLS, CameraReport, Report};
