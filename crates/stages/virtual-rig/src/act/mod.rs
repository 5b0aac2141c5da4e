//! What the face does over time.
//!
//! A [`Timeline`] names events (brow raise, smile, blink, speech …); a [`Clip`] is a recording of real weight curves.
//! Either is bound to the shapes that a body has, and then gives a weight per shape at any time, also between frames,
//! since a shutter is open for a while. [`HeadMotion`] moves the head.
//!
//! ```
//! use virtual_rig::act::Timeline;
//! let shapes = ["jaw_open", "smile_l", "smile_r"].map(str::to_string);
//! let smile = Timeline::default().with("smile", 0.1, [0.3, 0.5, 0.4], 1.0);
//! let performance = smile.bind(&shapes)?;
//! assert_eq!(performance.weights(0.0), [0.0; 3]);
//! assert_eq!(performance.weights(0.5), [0.0, 1.0, 1.0]);
//! # Ok::<(), virtual_rig::Error>(())
//! ```

mod arkit;
mod band;
mod clip;
mod cubic;
mod head;
mod presets;
mod standard;
mod timeline;

pub use clip::{Clip, ClipError, ClipParams};
pub use head::HeadMotion;
pub use presets::preset_names;
pub use timeline::{Event, Timeline};

use clip::BoundClip;
use timeline::BoundEvent;

/// Weights over time for the shapes of one body.
#[derive(Debug, Clone, PartialEq)]
pub struct Performance {
    shape_count: usize,
    source: Source,
}

#[derive(Debug, Clone, PartialEq)]
enum Source {
    Events(Vec<BoundEvent>),
    Clip(BoundClip),
}

impl Performance {
    /// One weight per shape at a time (s, any), from 0 to 1. Events have two continuous derivatives, clips one.
    #[must_use]
    pub fn weights(&self, time_s: f64) -> Vec<f64> {
        match &self.source {
            Source::Events(events) => timeline::weights(events, self.shape_count, time_s),
            Source::Clip(clip) => clip.weights(time_s),
        }
    }
}

/// Refuses a parameter, naming its place.
fn refuse(place: impl Into<String>, what: impl Into<String>) -> crate::Error {
    crate::Error::Parameter { place: place.into(), what: what.into() }
}
