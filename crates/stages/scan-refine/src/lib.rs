//! Refines a scan by measured normals: positions that are right at large with normals that are right in the small.
//!
//! A scanner measures where the surface is, with noise from vertex to vertex; photometric stereo measures which way it faces,
//! sharply, but bent at large. [`refine`] finds the positions that agree best with both [Nehab2005], as the scans of
//! [BickelBotsch2007, Sec. 3] were made. The normals come per vertex ([`Measured::per_vertex`]) or from a map over the texture
//! coordinates ([`NormalMap::measure`]).
//!
//! ```
//! use nalgebra::Vector3;
//! use scan_refine::{Measured, Params, refine};
//! // A plane that the scanner saw with 0.2 mm of noise, and the normals of a plane.
//! let noise = |x: f64, y: f64| 0.2 * (91.7 * x + 13.3 * y).sin();
//! let scan = testkit::shapes::relief(40, 0.5, noise);
//! let measured = Measured::per_vertex(vec![Vector3::z(); scan.positions.len()])?;
//! let refined = refine(&scan, &measured, &Params::default())?;
//! let roughness = |points: &[nalgebra::Point3<f64>]| points.iter().map(|p| p.z * p.z).sum::<f64>().sqrt();
//! assert!(roughness(&refined.positions) < 0.2 * roughness(&scan.positions));
//! # Ok::<(), scan_refine::Error>(())
//! ```

mod bias;
mod error;
mod frames;
mod map;
mod measured;
mod params;
mod refine;
mod sampling;
mod surface;

pub use error::{Error, Space};
pub use map::NormalMap;
pub use measured::Measured;
pub use params::{Params, crossover_of_lambda};
pub use refine::{Refined, Report, refine};
