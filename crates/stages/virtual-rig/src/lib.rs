//! Takes whose every intermediate is known.
//!
//! No public recording has blue markers, painted wrinkles, eight calibrated cameras *and* the true surface. The rig makes
//! such takes, and scores what stages make of them. It shares no model and no code of a method with the stages.
//!
//! A take comes about in this order, one room each: [`body`] (whose face), [`act`] (what it does), [`wrinkle`] (how the
//! skin folds), [`paint`] (dots and strokes on it), [`light`] (how much sky each point sees), [`film`] (what a camera
//! makes of it), [`calibration`] (boards and wands), [`clock`] (when frames come, and which do not), [`take`] (all of it,
//! from a [`scenario`]). [`score`] compares results with the truth. Apart from takes, [`pair`] photographs patches of
//! skin for maps from ratio images. [`character`] is the same face on bones,
//! for wrinkles in games.

pub mod act;
pub mod body;
pub mod calibration;
pub mod character;
pub mod clock;
pub mod film;
pub mod light;
pub mod paint;
pub mod pair;
pub mod scenario;
pub mod score;
pub mod take;
pub mod wrinkle;

mod error;

pub use error::Error;
