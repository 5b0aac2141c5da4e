//! Transforms and cameras.
//!
//! Transforms are named `target_from_source`. [`fit_rigid`] and [`fit_similarity`] find the one that carries a set
//! of points onto another [Horn1987]; [`Camera`] is a calibrated camera with its [`Lens`], [`Pinhole`] one without distortion
//! for drawing. [`place_at_zero`] says where a tracked point was between images.
//!
//! ```
//! use nalgebra::{Point3, Vector3, UnitQuaternion, Isometry3};
//! let planted = Isometry3::from_parts(Vector3::new(1., 2., 3.).into(), UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3));
//! let source = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]].map(Point3::from);
//! let target = source.map(|point| planted * point);
//! let found = camera::fit_rigid(&source, &target, None).unwrap();
//! assert!((found.to_homogeneous() - planted.to_homogeneous()).norm() < 1e-12);
//! ```

mod align;
mod camera;
mod lens;
mod pinhole;
mod time;
mod triangulate;

pub use align::{AlignError, fit_rigid, fit_similarity};
pub use camera::Camera;
pub use lens::{BrownConrady, Lens};
pub use pinhole::Pinhole;
pub use time::place_at_zero;
pub use triangulate::nearest_to_lines;
