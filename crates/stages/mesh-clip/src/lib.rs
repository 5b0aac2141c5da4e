//! Cuts faces out of a mesh and says which vertex became which [BickelBotsch2007, Sec. 6.2].
//!
//! A scanned head is more than a face: eyes, all above the hair line and the neck are cut out, and lips and lids that
//! the scanner closed are slit open. What stays keeps its positions bit for bit, its vertex order, texture coordinates,
//! colours and groups; the map and its inverse lead results back onto the whole scan.
//!
//! ```
//! use mesh::Mesh;
//! use mesh_clip::{Params, Picks, Region, clip};
//! let square = Mesh::from_triangles(
//!     vec![[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.]],
//!     &[[0, 1, 2], [0, 2, 3]],
//! );
//! let right = Region::Above { axis: 0, value_mm: 0.5 };
//! let params = Params { remove_regions: vec![right], touching: true, ..Params::default() };
//! assert!(clip(&square, &Picks::default(), &params).is_err(), "both triangles reach beyond x = 0.5");
//! let corner = clip(&square, &Picks { remove: vec![&[0, 2, 3]], ..Picks::default() }, &Params::default())?;
//! assert_eq!(corner.old_from_new, [0, 1, 2]);
//! assert_eq!(corner.new_from_old, [Some(0), Some(1), Some(2), None]);
//! # Ok::<(), mesh_clip::Error>(())
//! ```

mod clip;
mod error;
mod params;
mod path;
mod slit;
mod soundness;

pub use clip::{Clipped, Mask, Picks, clip};
pub use error::Error;
pub use params::{Params, Region};
pub use soundness::Dropped;
