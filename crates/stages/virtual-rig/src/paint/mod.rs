//! Dots and strokes of paint on the skin.
//!
//! Paint is not in the mesh: each [`Dot`] and [`Stroke`] has coordinates of its own on the skin at rest, which
//! [`Layers`] keeps at the corners of the triangles that it may touch. The outline is a function of those coordinates, so
//! that edges stay as sharp as the picture allows, and paint stretches with the skin.
//!
//! [`DotSamples`] says where a camera should see a dot. It knows nothing of pixels, and can therefore check the film.

mod dot;
mod edge;
mod layers;
mod stroke;
mod texture;
mod truth;

pub use dot::{Dot, Outline};
pub(crate) use edge::Spot;
pub use layers::{Layers, StrokeCoordinates, Touch};
pub use stroke::{HalfWidth, Stroke};
pub use texture::Texture;
pub use truth::{DotSamples, DotView};

/// A paint, linear RGB reflectance.
pub type Paint = [f32; 3];

/// The dots' blue.
pub const BLUE: Paint = [0.020, 0.075, 0.420];
/// One colour of wrinkle paint.
pub const GREEN: Paint = [0.060, 0.330, 0.090];
/// The other colour of wrinkle paint, for neighbours of a green line.
pub const VIOLET: Paint = [0.330, 0.045, 0.300];
