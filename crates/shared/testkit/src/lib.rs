//! What tests share: small shapes with known properties and known faults, and where recorded data is.
//!
//! ```
//! use testkit::shapes;
//! let ball = shapes::sphere(10.0, 8);
//! assert!(ball.positions.iter().all(|point| (point.coords.norm() - 10.0).abs() < 1e-12));
//! ```

mod data;
mod pages;
pub mod shapes;

pub use data::data;
pub use pages::node;
