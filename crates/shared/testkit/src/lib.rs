//! Synthetic scenes for tests: a face that acts and a mocap system that records it, small shapes with known faults.
//!
//! The scenes are the truth that stages are measured against; they share no code with any stage.
//!
//! ```
//! use testkit::face::{Face, Weights};
//! let face = Face::new(1, 2_000);
//! let shouting = face.deform(&Weights { jaw_open: 1.0, ..Weights::default() });
//! assert_eq!(shouting.len(), face.mesh().positions.len());
//! ```

pub mod face;
pub mod shapes;

mod performance;

pub use performance::{Performance, Recording};
