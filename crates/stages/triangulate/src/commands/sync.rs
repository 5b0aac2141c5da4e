//! The time base, read in step with the tracks.

use artifact::{FrameReader, SyncFrame, SyncHeader, TimeBase};
use std::path::Path;

/// A time base in the course of being read.
pub(crate) struct Sync {
    frames: FrameReader<TimeBase>,
    ahead: Option<SyncFrame>,
}

impl Sync {
    pub(crate) fn open(path: &Path) -> anyhow::Result<Self> {
        Ok(Self { frames: FrameReader::open(path)?, ahead: None })
    }

    pub(crate) fn header(&self) -> &SyncHeader {
        self.frames.header()
    }

    /// What it says of a frame; frames are asked for in rising order.
    pub(crate) fn at(&mut self, frame: i64) -> anyhow::Result<Option<SyncFrame>> {
        while self.ahead.as_ref().is_none_or(|ahead| ahead.frame < frame) {
            match self.frames.next() {
                Some(next) => self.ahead = Some(next?),
                None => return Ok(None),
            }
        }
        Ok(self.ahead.take_if(|ahead| ahead.frame == frame))
    }
}
