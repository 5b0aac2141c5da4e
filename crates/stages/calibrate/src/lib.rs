//! Finds lenses and poses of all cameras from pictures of a board or a waved point.

pub mod bundle;
pub mod doctor;
pub mod wand;
