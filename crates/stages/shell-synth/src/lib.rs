//! Puts measured wrinkles on an animated face mesh, and lets a nonlinear thin shell raise the bulges between them
//! [BickelBotsch2007, Sec. 5.3].
//!
//! The large-scale motion of a face is smooth; its valleys were measured apart from it, as curves on the scan with a width and a
//! depth. [`Synthesis`] brings both together:
//!
//! 1. Valleys are interpolated in time, in the rest pose; a crease that wanders over the skin is put back to where it belongs.
//! 2. Vertices inside a valley are held on its section. They slide towards the crease, since its walls are skin too.
//! 3. Around them, as far as valleys reach and no farther, the shell's energy [Grinspun2003] is minimised, each region by itself:
//!    coarse to fine, by Gauss–Newton steps.
//!
//! The shell does not work against the large-scale motion: skin may be as long as in the scan or as short as the motion makes
//! it ([`Params::resistance`]). The paper's own shell is [`Params::paper`].
//!
//! ```
//! use artifact::{ValleyPoint, ValleysFrame};
//! use mesh::Mesh;
//! use shell_synth::{Params, Synthesis};
//! // A plate of 20 × 16 mm with a valley along it, 1 mm wide to either side and 0.4 mm deep in frame 1.
//! let points: Vec<[f64; 3]> = (0..41 * 33).map(|i| [f64::from(i % 41) * 0.5, f64::from(i / 41) * 0.5, 0.0]).collect();
//! let cell = |i: u32| [[i, i + 1, i + 42], [i, i + 42, i + 41]];
//! let triangles: Vec<[u32; 3]> = (0..41 * 32).filter(|i| i % 41 < 40).flat_map(cell).collect();
//! let plate = Mesh::from_triangles(points, &triangles);
//! let point = |k: u32| ValleyPoint {
//!     x_mm: f64::from(k) * 0.5, face: 2 * (16 * 40 + k + 10), barycentric: [1.0, 0.0, 0.0], at_mm: [0.0; 3],
//!     normal: [0.0, 0.0, 1.0], across: [0.0, -1.0, 0.0], w_mm: 1.0, d_mm: 0.4, epsilon: 0.0, kappa: 0.0,
//! };
//! let valleys = ValleysFrame { frame: 1, valleys: [("fold".to_string(), (0..21).map(point).collect())].into() };
//! let synthesis = Synthesis::new(&plate, &["fold".to_string()], &[valleys], &Params::default())?;
//! // Shortened by 4 % across the valley.
//! let pushed: Vec<_> = plate.positions.iter().map(|p| nalgebra::Point3::new(p.x, 0.96 * p.y, 0.0)).collect();
//! let folded = synthesis.frame(1, &pushed, None)?;
//! let height = |i: usize, j: usize| folded.positions[41 * j + i].z;
//! assert!((height(20, 16) + 0.4).abs() < 0.01 && height(20, 20) > 0.0 && height(20, 2) == 0.0);
//! # Ok::<(), shell_synth::Error>(())
//! ```

mod at_rest;
mod blocks;
mod coarse;
mod crease;
mod curve;
mod descent;
pub mod energy;
mod error;
mod jet;
mod line;
mod locator;
mod moment;
mod params;
mod patch;
mod profile;
mod reach;
mod refine;
mod region;
mod report;
mod slack;
mod solve;
mod stamp;
mod surface;
mod synthesis;

pub use crease::Drift;
pub use descent::Descent;
pub use error::Error;
pub use params::{Params, Solver, Track};
pub use refine::Refinement;
pub use report::{CreaseReport, RegionReport};
pub use solve::Memory;
pub use synthesis::{Synthesis, Wrinkling};
