//! Says how far two artifacts of one kind are apart: numbers with units, and where the largest difference is.
//!
//! Vertices are compared with the vertex of the same index ([`compare_meshes`], [`SequenceDiff`]), markers and handles
//! with those of the same id in the same frame ([`compare_samples`]), pixels with the pixel in the same place
//! ([`compare_images`]). All give a [`Report`]: one [`Part`] for the whole and one per region or marker, and the
//! differences that no number says. Nothing is aligned first: what lies apart is reported as apart.
//!
//! ```
//! use artifact_diff::compare_meshes;
//! let flat = mesh::Mesh::from_triangles(vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], &[[0, 1, 2]]);
//! let mut raised = flat.clone();
//! raised.positions[2].z = 0.5;
//! let report = compare_meshes(&flat, &raised, &[]).unwrap();
//! assert_eq!(report.whole().max, 0.5);
//! assert_eq!(report.whole().max_at, "vertex 2");
//! ```

mod error;
mod images;
mod meshes;
mod report;
mod samples;
mod sequences;
mod summary;

pub use error::Error;
pub use images::compare_images;
pub use meshes::{Region, compare_meshes};
pub use report::{Part, Report};
pub use samples::{Samples, compare_samples};
pub use sequences::SequenceDiff;
pub use summary::Summary;
