//! How the skin folds where the face compresses it.
//!
//! A wrinkle lies along a line on the skin ([`lines`]). Where the face shortens the skin across the line, the skin
//! gives way out of its surface: a valley with bulges beside it ([`Profile`]), as deep as it must be for a section
//! across the line to keep its length at rest ([`Wrinkles::fold`]). The material slides along with it: what was 3 mm
//! from the crease at rest is 3 mm of skin away from it in the fold.
//!
//! Coordinates of a line: x along it from its start, p across it, both mm of skin at rest; p > 0 to the left of who
//! walks along the line on the outside of the face.
//!
//! ```
//! use nalgebra::{Point2, Point3};
//! use virtual_rig::wrinkle::{Params, WrinkleLine, Wrinkles};
//! // A strip of skin, 60 × 40 mm, with a line through its middle.
//! let at = |i: u32, j: u32| Point2::new(f64::from(i) - 30.0, f64::from(j) * 0.5 - 20.0);
//! let domain: Vec<_> = (0..81).flat_map(|j| (0..61).map(move |i| at(i, j))).collect();
//! let quad = |i: u32, j: u32| [[j * 61 + i, j * 61 + i + 1, j * 61 + i + 62], [j * 61 + i, j * 61 + i + 62, j * 61 + i + 61]];
//! let triangles: Vec<_> = (0..80).flat_map(|j| (0..60).flat_map(move |i| quad(i, j))).collect();
//! let rest: Vec<_> = domain.iter().map(|d| Point3::new(d.x, d.y, 0.0)).collect();
//! let line = WrinkleLine::new("fold", vec![Point2::new(-25.0, 0.1), Point2::new(25.0, 0.1)], 2.0);
//! let wrinkles = Wrinkles::place(&rest, &triangles, &domain, &[line], &Params::default())?;
//! // 4 % shorter across the line.
//! let pushed: Vec<_> = rest.iter().map(|point| Point3::new(point.x, 0.96 * point.y, 0.0)).collect();
//! let folded = wrinkles.fold(&pushed);
//! let deepest = folded.valleys[0].points.iter().map(|point| point.d_mm).fold(0.0, f64::max);
//! assert!(deepest > 0.8 && deepest < 2.0);
//! # Ok::<(), virtual_rig::Error>(())
//! ```

mod arc;
mod band;
mod bend;
mod fold;
mod form;
mod lines;
mod params;
mod place;
mod profile;
mod reach;
mod section;
mod smooth;
mod surface;
mod wave;

pub use fold::{Folded, Valley, ValleyPoint};
pub use lines::{Group, WrinkleLine, lines};
pub use params::{Family, Fixed, Params, Style};
pub use place::Wrinkles;
pub use profile::{Profile, Shape};
pub use reach::Coordinates;
