//! Discrete differential operators on triangle meshes, and the sparse symmetric positive definite solve that they
//! lead to.
//!
//! One sign everywhere: the cotangent stiffness `L` is positive semi-definite and *integrated* (its rows sum to
//! zero, `uᵀ L u` is the Dirichlet energy); the pointwise Laplacian is `−M⁻¹ L`.
//!
//! - [`cotan_stiffness`], [`lumped_mass`], [`bilaplacian`]: assembly.
//! - [`Ordering`]: an elimination order with little fill, by nested dissection.
//! - [`Dirichlet`]: a system whose values are prescribed at some vertices; factor once, solve often.
//!
//! ```
//! use nalgebra::Point3;
//! // A strip of two triangles, its left side held at 0 and its right side at 1.
//! let points = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.], [2., 0., 0.], [2., 1., 0.]].map(Point3::from);
//! let triangles = [[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]];
//! let (stiffness, _) = operators::cotan_stiffness(&points, &triangles, 1e4);
//! let ordering = operators::Ordering::nested_dissection(&stiffness, &points);
//! let system = operators::Dirichlet::factor(&stiffness, &[0, 3, 4, 5], &[], &ordering).unwrap();
//! let solution = system.solve(&[vec![0., 0., 1., 1.]]);
//! assert!((solution[0][1] - 0.5).abs() < 1e-12 && (solution[0][2] - 0.5).abs() < 1e-12);
//! ```

mod assembly;
mod bisection;
mod dense;
mod dirichlet;
mod elimination;
mod elimination_tree;
mod factor;
mod matching;
mod ordering;
mod prefetch;
mod responses;
mod substitution;
mod symbolic;
mod walk;

pub use assembly::{Slivers, bilaplacian, cotan_stiffness, lumped_mass};
pub use dirichlet::{Dirichlet, Responses};
pub use factor::{Factor, FactorError};
pub use ordering::{NotAPermutation, Ordering};
pub use sprs::CsMat;
