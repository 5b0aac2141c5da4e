//! Small shapes for tests, with known properties and known faults.
//!
//! ```
//! use testkit::shapes;
//! let ball = shapes::sphere(10.0, 8);
//! assert!(ball.positions.iter().all(|point| (point.coords.norm() - 10.0).abs() < 1e-12));
//! ```

pub mod shapes;
