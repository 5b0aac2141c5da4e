//! Pictures of meshes: shaded, coloured by a number per vertex, several on a sheet.
//!
//! A [`Surface`] is what is drawn: positions, triangles, normals and, where wanted, a value per vertex, polygon edges
//! and marker dots. A [`Frame`] finds the camera that shows it from a [`View`]; [`render`] draws it in software, the
//! same bytes for any number of threads; [`sheet`] puts pictures side by side with captions and a colour bar.
//!
//! ```
//! use preview::{Axes, CloseUp, Frame, Look, Surface, View, render};
//! let tent = mesh::Mesh::from_triangles(
//!     vec![[-10., 0., 0.], [10., 0., 0.], [0., 15., 0.], [0., 5., 6.]],
//!     &[[0, 1, 3], [1, 2, 3], [2, 0, 3]],
//! );
//! let surface = Surface::of(&tent);
//! let mut frame = Frame::around(View::FRONT, Axes::default(), &surface.positions);
//! frame.include(&surface.positions);
//! let camera = frame.camera([64, 48], &CloseUp::None);
//! let picture = render(&surface, &camera, [64, 48], &Look::default());
//! assert_eq!(picture.dimensions(), (64, 48));
//! ```

mod colormap;
mod dots;
mod error;
mod occlusion;
mod params;
mod raster;
mod render;
mod shade;
pub mod sheet;
mod surface;
mod values;
mod view;

pub use colormap::ColorMap;
pub use error::Error;
pub use params::{Backdrop, Look};
pub use render::render;
pub use surface::Surface;
pub use values::{Spread, ValueRange, distances};
pub use view::{Axes, CloseUp, Frame, SignedAxis, View};
