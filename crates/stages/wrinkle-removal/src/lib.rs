//! Takes existing wrinkles out of a scan, and keeps its pores and its shape.
//!
//! A scan of a relaxed face has wrinkles already. Where the animation then finds wrinkles in the footage, they would be made
//! twice; so they are taken out first [BickelBotsch2007, Sec. 5.4]. [`remove`] does it in three steps: fine detail is split off
//! and kept, the region's base becomes the surface that bends least between its surroundings (the steady state of bi-Laplacian
//! smoothing), and the detail goes back on along the normals. Where the wrinkles are, say [`painted`] (a mask over the texture
//! coordinates), [`listed`] (vertices), [`along_valleys`] (curves on the scan) or [`detect()`].
//!
//! ```
//! use testkit::shapes;
//! // A round dent of 1 mm in a plane of 20 × 20 mm; the region is what lies within 6 mm of it.
//! let dented = shapes::bump_plane(40, 0.5, -1.0, 1.5);
//! let middle = nalgebra::Point3::new(10.0, 10.0, 0.0);
//! let near = |point: &nalgebra::Point3<f64>| f64::from(u8::from((point - middle).norm() < 6.0));
//! let weights: Vec<f64> = dented.positions.iter().map(near).collect();
//! let smoothed = wrinkle_removal::remove(&dented, &weights, &wrinkle_removal::Params::default())?;
//! let deepest = |points: &[nalgebra::Point3<f64>]| points.iter().map(|point| -point.z).fold(0.0, f64::max);
//! assert!(deepest(&dented.positions) > 0.99 && deepest(&smoothed.positions) < 0.05);
//! # Ok::<(), wrinkle_removal::Error>(())
//! ```

mod calculus;
mod detail;
mod detect;
mod error;
mod fill;
mod params;
mod patch;
mod picture;
mod region;
mod removal;
mod valley;

pub use detect::{Detection, detect};
pub use error::Error;
pub use params::{Params, Split};
pub use picture::{Picture, draw};
pub use region::{Mask, listed, painted};
pub use removal::{Report, Smoothed, remove};
pub use valley::{DEFAULT_REACH, along_valleys};
