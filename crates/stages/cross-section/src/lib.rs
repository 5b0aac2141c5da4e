//! Measures width and depth of painted wrinkles from the shadow that they throw into themselves [BickelBotsch2007, Sec. 5.2].

mod albedo;
mod blur;
mod chroma;
mod curve;
mod descent;
mod error;
mod fit;
mod measure;
mod paint;
mod paper;
mod params;
mod picture;
mod problem;
mod profile;
mod shading;
mod smooth;
mod spline;

pub use albedo::estimate_albedo;
pub use chroma::is_subsampled;
pub use curve::{Curve, Foot};
pub use error::Error;
pub use measure::{Measured, Painted, failed, measure, painted};
pub use paint::{Band, Pixel, band};
pub use paper::{SharpFit, SharpGroove};
pub use params::{Model, Params};
pub use picture::Picture;
pub use profile::Profile;
