//! Measures width and depth of painted wrinkles from the shadow that they throw into themselves [BickelBotsch2007, Sec. 5.2].

mod blur;
mod curve;
mod descent;
mod error;
mod fit;
mod measure;
mod paint;
mod params;
mod picture;
mod problem;
mod profile;
mod shading;
mod smooth;
mod spline;

pub use curve::{Curve, Foot};
pub use error::Error;
pub use measure::{Measured, Painted, measure, painted};
pub use paint::{Band, Pixel, band};
pub use params::{Model, Params};
pub use picture::Picture;
pub use profile::Profile;
