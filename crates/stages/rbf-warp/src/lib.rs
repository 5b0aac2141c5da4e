//! Maps marker motion from mocap space onto a face scan [BickelBotsch2007, Sec. 4.1].
//!
//! Markers and scan are captured in different coordinates, and the scan's expression is never quite the markers' rest
//! expression. A smooth space warp c, interpolating picked pairs (marker at rest → vertex), takes up both; moved markers
//! go through the same warp, and what is left after the rest position is taken away displaces the scan's vertices.
//!
//! - [`correspond`]: picks → vertices.
//! - [`fit_warp`]: trajectories and vertices → warp, with everything needed to judge it; [`fit_interpolant`] is its heart.
//! - [`map_of`]: a warp's map, with its Jacobian; [`inverse_of`]: the way back.
//! - [`Displacer`]: moved markers → displacements of handle vertices.
//!
//! Everything is in millimetres, and nothing depends on the number of threads.
//!
//! ```
//! use nalgebra::Point3;
//! use rbf_warp::{Degree, Pairs, fit_interpolant, map_of};
//! // Markers on a bowl, and the same twice as large and lifted.
//! let from: Vec<Point3<f64>> = (0..16)
//!     .map(|i| (f64::from(i % 4) * 10.0, f64::from(i / 4) * 10.0))
//!     .map(|(x, y)| Point3::new(x, y, 0.01 * (x - 12.0).powi(2) + 0.3 * (y * 0.2).sin()))
//!     .collect();
//! let to: Vec<Point3<f64>> = from.iter().map(|p| Point3::new(2.0 * p.x, 2.0 * p.y, 2.0 * p.z + 5.0)).collect();
//! let markers: Vec<String> = (0..16).map(|i| format!("m{i}")).collect();
//! let pairs = Pairs { markers: &markers, from: &from, to: &to, space: "mocap space" };
//! let fit = fit_interpolant(pairs, Degree::Quadratic).unwrap();
//! let map = map_of(&fit.interpolant);
//! assert!((map.at(&Point3::new(7.0, 8.0, 9.0)) - Point3::new(14.0, 16.0, 23.0)).norm() < 1e-9);
//! ```

mod correspond;
mod displace;
mod error;
mod fit;
mod folding;
mod likeness;
mod map;
mod params;
mod polynomial;
mod rest;
mod saddle;
mod warning;
mod warp;

pub use correspond::{Place, Snapped, correspond};
pub use displace::{Displacer, handles_header, mismatch};
pub use error::{Error, Result};
pub use fit::{InterpolantFit, Pairs, fit_interpolant};
pub use folding::{Folding, folding};
pub use map::{inverse_of, map_of};
pub use params::{Degree, FitParams, RestFrame};
pub use polynomial::UNDETERMINED;
pub use warning::Warning;
pub use warp::{FittedWarp, Source, fit_warp};
