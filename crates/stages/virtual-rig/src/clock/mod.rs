//! When frames are taken, and what goes wrong with them.
//!
//! The motion capture's frame k is at k / rate, from 0 on. A [`Clock`] says when a camera exposes by it, [`Faults`] what
//! happens on the way to its file, and a [`Schedule`] is what comes of both: for each picture in each file the true time,
//! and the time that the camera wrote beside it.

mod flash;
mod params;
mod schedule;
mod stamps;

pub use flash::Flash;
pub use params::{Clock, Faults, Trigger};
pub use schedule::{Entry, Schedule, Timed};
pub use stamps::time_stamps_csv;
