//! Takes the head's rigid motion out of marker trajectories.
//!
//! Real heads move. [`stabilize`] finds the head's pose in every frame from markers on its rigid parts, and brings
//! all markers to *head space*, where what is left is the face's own motion. Head space is world space at the
//! reference frame; in every frame `world = world_from_head · head`, exactly.
//!
//! 1. The head is a rigid body, estimated over the whole take (generalised Procrustes analysis); its pose in a frame
//!    is a robust rigid fit. Without named head markers the group that deforms least is found and named.
//! 2. In head space a marker that jumps against its neighbours is taken out until it is back; samples under
//!    another marker's name are given back where it is clear whose they are.
//! 3. The pose's jitter is the fast motion that all markers share in head space. It is given back to the pose. No
//!    filter touches the head's own motion, so a rigid motion of the take changes nothing in head space.
//! 4. Short gaps are filled from the neighbours' affine motion.
//!
//! ```
//! use artifact::{MarkerFrame, MarkerHeader, Rate, SampleStatus, Trajectories, Unit};
//! use nalgebra::{Isometry3, Point3, Vector3};
//! let rest = [[0., 0., 0.], [90., 5., 0.], [40., 80., 10.], [45., 30., 40.]].map(Point3::from);
//! let turn = |t: i64| Isometry3::new(Vector3::new(2.0 * t as f64, 0., 0.), Vector3::y() * 0.05 * t as f64);
//! let frame = |t| MarkerFrame {
//!     frame: 1001 + t,
//!     points: rest.iter().map(|p| Some(turn(t) * p)).collect(),
//!     status: vec![SampleStatus::Measured; 4],
//! };
//! let markers = ["head_l", "head_r", "head_top", "nose"].map(String::from).to_vec();
//! let header = MarkerHeader { unit: Unit::Mm, rate: Some(Rate::per_second(100)), markers, take: None };
//! let take = Trajectories { header, frames: (0..20).map(frame).collect() };
//! let params = stabilize::Params { head_markers: vec!["head_*".into()], ..Default::default() };
//! let stable = stabilize::stabilize(&take, &params)?;
//! for frame in &stable.head.frames {
//!     let nose = frame.points[0].unwrap();
//!     assert!((nose - rest[3]).norm() < 1e-6, "the nose is still");
//! }
//! # Ok::<(), stabilize::Error>(())
//! ```

mod error;
mod fill;
mod jitter;
mod jumps;
mod layout;
mod local_quadratic;
mod names;
mod outcome;
mod params;
mod pose;
mod report;
mod rigid_body;
mod rigid_subset;
mod robust;
mod samples;
mod stabilizer;
mod swaps;
mod words;

pub use error::Error;
pub use outcome::Stabilized;
pub use params::{JumpLimit, Params, Swaps, TIMES_MS};
pub use report::{Gaps, JumpReport, PlaceReport, Report};
pub use stabilizer::stabilize;
