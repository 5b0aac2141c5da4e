//! Follows painted markers through the images of each camera.
//!
//! A [`Tracker`] starts at an image whose markers a person has labelled, learns what the paint looks like ([`Paint`]), and then goes
//! from image to image, forwards or backwards in time:
//!
//! 1. *Predict*: each marker moves on at constant velocity, corrected by the local affine motion of its neighbours, or stands
//!    where 3D markers of a first pass say ([`hints`]).
//! 2. *Find*: painted pixels around the predictions, by a table over ratios of linear light; connected patches; the centroid of
//!    the painted *area* of each, whatever the light and whatever the dot lies on. Touching dots are shared out.
//! 3. *Assign*: one assignment of least total cost per image, not greedily.
//! 4. *Remember*: a marker without a dot is predicted, goes with its neighbours, and is found again near its prediction, or where
//!    it belongs among them. Dots without a name are followed too, lest they are taken for others.
//!
//! When all cameras are done, [`drop_misfits`] takes back what no other cameras agree with, and [`name_strays`] names such dots by
//! what other cameras see.
//!
//! [`detect`] finds dots without names, [`Edits`] replays corrections made by hand.
//!
//! ```
//! use artifact::Transfer;
//! use marker_track::{Params, Picture, Tracker};
//! // Blue dots on skin, which move by two pixels.
//! let draw = |shift: usize| -> Vec<u8> {
//!     let is_dot = |x: usize, y: usize| (x + 40 - shift) % 20 < 5 && y % 20 < 5 && x > 9 && y > 9;
//!     let pixel = |i: usize| if is_dot(i % 80, i / 80) { [30, 60, 140] } else { [170, 135, 115] };
//!     (0..80 * 60).flat_map(pixel).collect()
//! };
//! let (first, second) = (draw(0), draw(2));
//! let labels = [("nose".to_string(), [42.0, 22.0]), ("chin".to_string(), [42.0, 42.0])].into();
//! let markers = ["nose".to_string(), "chin".to_string()];
//! let picture = Picture::new(80, 60, &first)?;
//! let mut tracker = Tracker::start(&picture, Transfer::Srgb, &markers, &labels, &Params::default())?;
//! let samples = tracker.step(&Picture::new(80, 60, &second)?, 1.0, None)?;
//! let nose = samples[0].unwrap();
//! assert!((nose.at.x - 44.0).abs() < 0.1 && (nose.at.y - 22.0).abs() < 0.1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod assign;
mod blobs;
mod center;
mod detect;
mod dots;
mod doubt;
mod draw;
mod edits;
mod error;
mod guide;
mod labels;
mod matching;
mod matte;
mod naming;
mod paint;
mod params;
mod predict;
mod track;
mod tracker;
mod untied;

pub use artifact::picture::Picture;
pub use detect::{Found, detect, places_of_color};
pub use doubt::{drop_misfits, drop_passing};
pub use draw::Canvas;
pub use edits::Edits;
pub use error::Error;
pub use guide::{bears_out, hints};
pub use naming::{Strays, name_strays};
pub use paint::Paint;
pub use params::Params;
pub use tracker::{GuideHits, Hint, Tracker};
pub use untied::drop_untied;
