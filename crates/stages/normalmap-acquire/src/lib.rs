//! Normal maps of wrinkles from two photographs of a face, at rest and with an expression [DutreveMeyer2011].
//!
//! Landmarks carry the expression onto the neutral photograph ([`Warp`]), the ratio of linear light says where skin became darker, and
//! [`acquire`] reads tilts from it: by the paper's rule or, by default, by an estimator that survives uneven exposure, flashes, rounded
//! wrinkles and landmarks that are off.
//!
//! ```
//! use normalmap_acquire::{Face, Pair, Params, Photo, Plane, Region, acquire};
//! // Skin with a wrinkle along row 40: 5 % darker there, and the face moved by three pixels.
//! let grain = |x: usize, y: usize| 0.5 + 0.02 * ((x * 7 + y * 13) as f64 * 0.37).sin();
//! let dark = |y: usize| 1.0 - 0.3 * (-((y as f64 - 40.0) / 3.0).powi(2)).exp();
//! let photo = |light: Plane| Photo { usable: light.map(|_| 1.0), light };
//! let neutral = photo(Plane::from_fn(96, 80, |x, y| grain(x, y)));
//! let expression = photo(Plane::from_fn(96, 80, |x, y| dark(y) * grain(x + 3, y)));
//! let pair = |id: &str, from: [f64; 2]| Pair { id: id.into(), from, to: [from[0] - 3.0, from[1]] };
//! let corners = [[8.0, 8.0], [90.0, 8.0], [8.0, 72.0], [90.0, 72.0]];
//! let pairs = ["a", "b", "c", "d"].iter().zip(corners).map(|(id, at)| pair(id, at)).collect();
//! let face = Face { pairs, io_px: 200.0, ..Face::default() };
//! let region = Region { refine: false, ..Region::of(Default::default()) };
//! let found = acquire(&neutral, &expression, &face, &region, &Params::default())?;
//! // The upper wall looks down, the lower one up.
//! assert!(found.normals[1].at(48, 37) < -0.2 && found.normals[1].at(48, 43) > 0.2);
//! # Ok::<(), normalmap_acquire::Error>(())
//! ```

mod acquire;
mod blur;
mod crease;
mod encode;
mod error;
mod estimator;
mod flow;
mod frame;
mod hair;
mod integrate;
mod light;
mod mask;
mod modulation;
mod normals;
mod outline;
mod paper;
mod params;
mod parts;
mod plane;
mod ratio;
mod texture;
mod warp;

pub use acquire::{Acquired, Face, Photo, Region, Report, acquire};
pub use blur::exact as gaussian;
pub use encode::{height_shares, normal_codes, normal_of};
pub use error::Error;
pub use flow::{Refined, refined};
pub use integrate::integrated;
pub use light::{estimated_light, rough_normals};
pub use mask::{hull, inside};
pub use modulation::{Modulation, fit_modulation, shown, way};
pub use paper::paper_normals;
pub use params::{Exposure, Light, Mode, Params};
pub use parts::{Part, Scheme};
pub use plane::Plane;
pub use texture::{Textured, texture_spread, textured};
pub use warp::{Field, Pair, Warp};
