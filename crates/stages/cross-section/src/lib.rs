//! Measures width and depth of painted wrinkles from the shadow that they throw into themselves [BickelBotsch2007, Sec. 5.2].
//!
//! [`painted`] finds the painted pixels beside a curve, [`measure`] fits a groove to them that is lit by the open sky and filmed by a real camera,
//! [`ImageSections`] does all wrinkles of an image. [`Model::Paper`] is the paper's own model, [`SharpGroove`] its closed form.
//!
//! ```
//! use artifact::{Curve2d, CurveState, Transfer};
//! use cross_section::{Params, Picture, SharpGroove, measure, painted};
//! // Green paint on skin, with a sharp valley along row 32: w is 8 px, d/w is 0.4.
//! let groove = SharpGroove::new();
//! let code = |light: f64| (255.0 * light.powf(1.0 / 2.2)).round() as u8;
//! let pixel = |i: usize| {
//!     let p = (i / 96) as f64 - 32.0;
//!     // What a lens of 0.7 px leaves of it.
//!     let weights = [-2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0].map(|k: f64| (k, (-k * k / 1.146).exp()));
//!     let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
//!     let light: f64 = weights.iter().map(|(k, weight)| weight / sum * groove.light((p + k).abs() / 8.0, 0.4)[0]).sum();
//!     let color = if p.abs() < 20.0 { [0.05, 0.34, 0.1] } else { [0.5, 0.4, 0.3] };
//!     color.map(|channel: f64| code(channel * light))
//! };
//! let rgb: Vec<u8> = (0..96 * 64).flat_map(pixel).collect();
//! let picture = Picture::new(96, 64, &rgb)?;
//! let controls = (0..12).map(|i| [10.0 * i as f64 - 8.0, 33.0]).collect();
//! let curve = Curve2d { controls, state: CurveState::Seen, confidence: 1.0, paint: vec![] };
//! let params = Params::default();
//! let paint = painted(&picture, &Transfer::Gamma(2.2).light_of_codes(), &curve, &params).unwrap();
//! let middle = measure(&paint, &params, 0.0).sections[24];
//! assert!((middle.at[1] - 32.0).abs() < 0.2 && (middle.d_px / middle.w_px - 0.4).abs() < 0.06);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod albedo;
mod bare;
mod beside;
mod blur;
mod curve;
mod descent;
mod error;
mod fit;
mod ground;
mod image;
mod measure;
mod paint;
mod paper;
mod params;
mod plan;
mod problem;
mod profile;
mod relief;
mod ridge;
mod shading;
mod skin;
mod smooth;
mod spline;
mod steady;
mod walls;

pub use albedo::estimate_albedo;
pub use artifact::picture::Picture;
pub use curve::{Curve, Foot};
pub use error::Error;
pub use ground::{Ground, Surface};
pub use image::{ImageSections, ImageWrinkle};
pub use measure::{Measured, Painted, failed, measure, painted};
pub use paint::{Band, Pixel, band};
pub use paper::{SharpFit, SharpGroove};
pub use params::{Model, Params};
pub use steady::steadied;
