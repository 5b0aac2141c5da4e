//! Finds one time base for all cameras of a take.
//!
//! Cameras drop images, store some twice, start late, and their clocks drift. [`synchronize`] takes each camera's
//! [`Recording`] and tells which image of it shows each mocap frame, in two steps:
//!
//! 1. The [`Cadence`] numbers the camera's exposures: from its time stamps where there are some, else from the images'
//!    numbers and pixels. A dropped image leaves its number out; a doubled one shares it.
//! 2. A [`Timeline`] says when the exposures were, by one of four [`Mode`]s: as stated; by time stamps of a common clock; by
//!    a flash; or by what moves in the images. It is a line, so that an offset and a drift describe a clock.
//!
//! Frames show the image nearest in time; where it is missing, they say so. [`skews`] says what is left between the cameras.
//!
//! ```
//! use artifact::{Clock, Rate};
//! use capture_sync::{Image, Mode, Params, Recording, TakeClock, synchronize};
//! let rate = Rate::per_second(50);
//! let camera = |id: &str, exposures: &[i64], late_s: f64| Recording {
//!     id: id.into(),
//!     rate,
//!     first: 0,
//!     images: (0..)
//!         .zip(exposures)
//!         .map(|(index, n)| Image { index, time_s: Some(*n as f64 / 50.0 + late_s), reading: None })
//!         .collect(),
//! };
//! let recordings = [camera("m1", &[0, 1, 2, 3, 4], 0.0), camera("m2", &[0, 1, 3, 4], 0.005)];
//! let clock = TakeClock { rate, first_frame: 1001, clock: Clock::Timestamps };
//! let params = Params { mode: Mode::Timestamps, ..Params::default() };
//! let found = synchronize(&clock, &recordings, &params)?;
//! assert!((found.header.cameras["m2"].offset_frames - 0.25).abs() < 1e-6);
//! assert_eq!(found.frames[2].shows["m2"], None, "the third image was dropped");
//! assert_eq!(found.frames[3].shows["m2"].unwrap().index, 2);
//! # Ok::<(), capture_sync::Error>(())
//! ```

mod breaks;
mod cadence;
mod canonical;
mod chart;
mod correlation;
mod course;
mod error;
mod extent;
mod flash;
mod frame_times;
mod line;
mod params;
mod reading;
mod recording;
mod skew;
mod stamps;
mod synchronize;
mod time_base;
mod timeline;

pub use cadence::Cadence;
pub use chart::draw;
pub use error::Error;
pub use frame_times::{FrameTimes, frame_times};
pub use params::{DRIFT_PRIOR_PPM, LATE_FRAMES, Mode, Params, SEARCH_S};
pub use reading::{CELL_COUNT, Reading};
pub use recording::{Image, Recording};
pub use skew::{Skew, Speeds, skews, speeds};
pub use synchronize::{CameraReport, synchronize};
pub use time_base::{Synchronized, TakeClock};
pub use timeline::{Loss, Timeline};
