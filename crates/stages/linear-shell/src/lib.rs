//! Deforms a scan so that it follows the displacements of a few handle vertices, as a linear thin shell
//! [BickelBotsch2007, Sec. 4.2].
//!
//! The displacement field d minimises stretching and bending, `k_s dᵀ L d + k_b dᵀ L M⁻¹ L d`, and takes the prescribed
//! values at the handles. Because the *displacements* are smooth, not the surface, pores and fine wrinkles of the scan
//! survive; and because d is discontinuous across a cut, lips and lids part.
//!
//! 1. [`Surface::survey`] looks at the mesh, refuses what cannot be solved, and assembles the operators.
//! 2. [`Shell::factor`] factors the system once.
//! 3. Either [`Shell::solve`] every frame (direct), or take the [`Basis`] of the handles' responses: then a frame is
//!    one small dense product. Both first ask [`Completion`] where missing and soft handles go.
//!
//! ```
//! use linear_shell::{Constraints, Params, Shell, Surface};
//! use mesh::Mesh;
//! use nalgebra::Vector3;
//! let grid: Vec<[f64; 3]> = (0..25).map(|i| [f64::from(i % 5) * 10.0, f64::from(i / 5) * 10.0, 0.0]).collect();
//! let cell = |i: u32| [[i, i + 1, i + 6], [i, i + 6, i + 5]];
//! let faces: Vec<[u32; 3]> = (0..20).filter(|i| i % 5 < 4).flat_map(cell).collect();
//! let mesh = Mesh::from_triangles(grid, &faces);
//!
//! let constraints = Constraints { handles: vec![0, 4, 20, 24], held: Vec::new() };
//! let surface = Surface::survey(&mesh, &constraints, &Params::default())?;
//! let shell = Shell::factor(&surface, &constraints, &surface.ordering())?;
//! // All corners move alike, so everything does.
//! let field = shell.solve(&[Vector3::new(0.0, 0.0, 3.0); 4]);
//! assert!(field.iter().all(|d| (d - Vector3::new(0.0, 0.0, 3.0)).norm() < 1e-9));
//! # Ok::<(), linear_shell::Error>(())
//! ```

mod basis;
mod completion;
mod error;
mod leave_one_out;
mod openings;
mod params;
mod product;
mod prolongation;
mod reference;
mod shell;
mod soft;
mod surface;

pub use basis::Basis;
pub use completion::Completion;
pub use error::Error;
pub use leave_one_out::{HandleError, LeaveOneOut};
pub use openings::{Tear, TearWatch};
pub use operators::{Keep, Proxy};
pub use params::{BowTies, FreeComponents, Model, Params};
pub use reference::AffineReference;
pub use shell::{Constraints, Shell};
pub use soft::SoftShell;
pub use surface::{Surface, Survey};
