//! Follows painted wrinkles through the images of each camera, as valley curves [BickelBotsch2007, Sec. 5.1].
//!
//! 1. *Learn*: somebody marks the paint of one image ([`marked_paints`], [`labels`]); one machine per paint ([`Svm`]) learns which
//!    ratios of red, green and blue light are paint ([`learn`]). Only ratios count: folds darken the paint.
//! 2. *Classify*: each colour is decided once, and looked up ever after ([`Classifier`]).
//! 3. *Follow*: patches of paint are told apart by where the wrinkles were ([`Follower`]); they may break, touch, go and come back.
//! 4. *Fit*: each patch becomes a B-spline that keeps to its dark middle ([`valley()`]).
//!
//! ```
//! use wrinkle_track::{Sample, Svm, SvmParams};
//! // Green paint has more green than red; skin has less.
//! let sample = |green: f64, paint| Sample { ratios: [green, -0.5], paint };
//! let samples = [sample(1.5, true), sample(1.7, true), sample(-0.5, false), sample(-0.4, false)];
//! let machine = Svm::train(&samples, SvmParams { c: 10.0, gamma: 1.0, tolerance: 1e-9 })?;
//! assert!(machine.decide([1.6, -0.5]) > 0.5 && machine.decide([-0.45, -0.5]) < -0.5);
//! # Ok::<(), wrinkle_track::Error>(())
//! ```

mod assign;
mod bits;
mod classify;
mod draw;
mod error;
mod follow;
mod learn;
mod light;
mod marks;
mod params;
mod region;
mod samples;
mod spline;
mod start;
mod svm;
mod valley;

pub use bits::{Bits, Patch, Run};
pub use classify::{Classified, Classifier};
pub use draw::{Drawing, tint};
pub use error::Error;
pub use follow::{Follower, tidied};
pub use learn::{Learnt, learn};
pub use light::{FLOOR, Picture, ratios};
pub use marks::{BARE, MarkedPaint, UNKNOWN, labels, marked_paints};
pub use params::{TrackParams, TrainParams};
pub use region::Region;
pub use samples::{Chosen, View, choose};
pub use spline::Place;
pub use start::{Marked, MarkedWrinkle, NamedPlace, marked_wrinkles};
pub use svm::{Ratios, Sample, Svm, SvmParams};
pub use valley::{Valley, valley};
