//! Bakes a wrinkled mesh into the maps of a low-resolution mesh: tangent-space normals and displacement.
//!
//! So what was captured on a full-resolution scan plays back on a game's character. [`Low`] is the character as a renderer sees it,
//! with the tangent space that renderers share [Mikkelsen2008]; [`High`] is the wrinkled surface of a frame; [`bake()`] looks, from
//! each sample of each texel, for the outermost surface along the interpolated normal. [`follow`] brings a character in the neutral
//! pose to the pose of the frame first.
//!
//! ```
//! use bake::{High, Low, Params, bake};
//! use mesh::{Mesh, Polygons};
//! use nalgebra::Vector2;
//! let square = [[0., 0., 0.], [10., 0., 0.], [10., 10., 0.], [0., 10., 0.]];
//! let mut low = Mesh::from_triangles(square.to_vec(), &[[0, 1, 2], [0, 2, 3]]);
//! low.uvs = square.map(|[x, y, _]| Vector2::new(x / 10., y / 10.)).to_vec();
//! low.corner_uvs = vec![0, 1, 2, 0, 2, 3];
//! let ridge = [[0., 0., 0.], [5., 0., 1.], [10., 0., 0.], [0., 10., 0.], [5., 10., 1.], [10., 10., 0.]];
//! let high = Mesh::from_triangles(ridge.to_vec(), &[[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]]);
//! let params = Params { size: 16, ..Params::default() };
//! let (tiles, report) = bake(&Low::of(&low)?, &High::of(&high, &high.positions)?, &params, || ())?;
//! assert_eq!((tiles[0].number, report.missed), (1001, 0));
//! // The left slope looks to the left.
//! assert!(tiles[0].normals[2][0] < -0.1 && (report.displacement_mm[1] - 1.0).abs() < 0.05);
//! # Ok::<(), bake::Error>(())
//! ```

mod bake;
mod encode;
mod error;
mod follow;
mod high;
mod low;
mod padding;
mod params;
mod raster;
mod tangent;

pub use bake::{Report, Tile, bake, steps};
pub use encode::{Bits, displacement_codes, displacement_range, normal_codes};
pub use error::Error;
pub use follow::follow;
pub use high::High;
pub use low::{Corner, Low};
pub use params::Params;
pub use tangent::Tangent;
