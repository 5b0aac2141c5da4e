//! The handles' frames: looked through once before the work starts, so that a bad line is found in seconds and not
//! after hours.

use anyhow::{Context, bail};
use artifact::{FrameRange, FrameReader, HandleFrame, Handles, HandlesHeader};
use std::path::{Path, PathBuf};

/// A stream of handle frames that can be gone through twice.
pub(crate) struct HandleTake {
    pub(crate) path: PathBuf,
    pub(crate) header: HandlesHeader,
    /// Frames to make.
    pub(crate) frames: Vec<i64>,
    /// Frames in which no handle has a value: they stay gaps.
    pub(crate) gaps: Vec<i64>,
    /// Per handle in how many of the frames it is missing.
    pub(crate) missing: Vec<usize>,
    /// The frames themselves where they came through a pipe.
    piped: Option<Vec<HandleFrame>>,
}

impl HandleTake {
    pub(crate) fn open(path: &Path, range: FrameRange) -> anyhow::Result<Self> {
        let reader = FrameReader::<Handles>::open(path)?;
        let header = reader.header().clone();
        let mut take = Self {
            path: path.to_path_buf(),
            missing: vec![0; header.handles.len()],
            header,
            frames: Vec::new(),
            gaps: Vec::new(),
            piped: artifact::is_standard_stream(path).then(Vec::new),
        };
        for frame in reader {
            let frame = frame?;
            if range.contains(frame.frame) {
                take.note(frame);
            }
        }
        match take.frames.is_empty() {
            true => bail!("{}: holds no frame of {range} with a handle in it", path.display()),
            false => Ok(take),
        }
    }

    fn note(&mut self, frame: HandleFrame) {
        if frame.displacements.iter().all(Option::is_none) {
            self.gaps.push(frame.frame);
            return;
        }
        self.frames.push(frame.frame);
        for (missing, value) in self.missing.iter_mut().zip(&frame.displacements) {
            *missing += usize::from(value.is_none());
        }
        if let Some(piped) = &mut self.piped {
            piped.push(frame);
        }
    }

    /// The frames to make.
    pub(crate) fn frames(
        &mut self,
    ) -> anyhow::Result<Box<dyn Iterator<Item = artifact::Result<HandleFrame>>>> {
        if let Some(piped) = self.piped.take() {
            return Ok(Box::new(piped.into_iter().map(Ok)));
        }
        let wanted = self.frames.clone();
        let reader = FrameReader::<Handles>::open(&self.path).context("reading the handles again")?;
        let keep = move |frame: &artifact::Result<HandleFrame>| match frame {
            Ok(frame) => wanted.binary_search(&frame.frame).is_ok(),
            Err(_) => true,
        };
        Ok(Box::new(reader.filter(keep)))
    }
}
