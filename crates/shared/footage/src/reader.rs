//! Frames out of a video file.

use crate::swap::swap_red_blue;
use crate::whole::{Count, Ending, Parts, Whole, parts};
use crate::writer::plain;
use crate::{Error, quiet, rate};
use opencv::core::Mat;
use opencv::prelude::{MatTraitConst, MatTraitConstManual, VideoCaptureTrait, VideoCaptureTraitConst};
use opencv::videoio::{
    CAP_FFMPEG, CAP_PROP_FPS, CAP_PROP_FRAME_COUNT, CAP_PROP_FRAME_HEIGHT, CAP_PROP_FRAME_WIDTH,
    CAP_PROP_POS_MSEC, VideoCapture as Decoder,
};
use std::path::{Path, PathBuf};

/// Sound may go on so much longer than the pictures where only the length of the whole file is known, s.
const TAIL_S: f64 = 0.5;

/// A frame of a video.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Its place in the file, from 0.
    pub index: u64,
    /// When it shall be shown, s, as the file says; the first frame need not be at 0. None for the last one to three frames
    /// of codecs that look ahead (H.264): OpenCV loses their times.
    pub time_s: Option<f64>,
    /// 3 × width × height bytes, row after row from the top. Of lossy codecs, what FFmpeg's scaler makes of their luma and
    /// chroma.
    pub rgb: Vec<u8>,
}

/// A frame that was passed over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passed {
    /// Its place in the file, from 0.
    pub index: u64,
    /// When it shall be shown, as [`Frame::time_s`].
    pub time_s: Option<f64>,
}

/// A video file that is being read: an iterator over its frames, in their order. After the last good frame of a cut or
/// damaged file comes one [`Error::EndsEarly`]. Frames are counted as they decode, from the first: nothing jumps to a key
/// frame or to a time, so that a frame's index is right for any codec and any rate.
pub struct VideoReader {
    path: PathBuf,
    decoder: Decoder,
    size: [u32; 2],
    rate: (u32, u32),
    claimed: Option<u64>,
    parts: Parts,
    next: u64,
    last_time_s: f64,
    /// One frame is decoded ahead where the last one cannot be trusted.
    ahead: Option<Frame>,
    over: bool,
}

impl VideoReader {
    /// Opens a file.
    ///
    /// # Errors
    /// If it cannot be read, or is no video that can be decoded here.
    #[allow(clippy::disallowed_methods, reason = "videos do not pass through `artifact`")]
    pub fn open(path: &Path) -> Result<Self, Error> {
        quiet::silence();
        let file = std::fs::File::open(path).map_err(Error::io(path, "read"))?;
        let parts = parts(file).map_err(Error::io(path, "read"))?;
        let fail = Error::opencv(path);
        let not_video = || Error::NotVideo { path: path.to_path_buf() };
        let decoder = Decoder::from_file(plain(path).as_path(), CAP_FFMPEG).map_err(&fail)?;
        if !decoder.is_opened().map_err(&fail)? {
            return Err(not_video());
        }
        let number = |property: i32| decoder.get(property).map_err(&fail);
        let size = [number(CAP_PROP_FRAME_WIDTH)? as u32, number(CAP_PROP_FRAME_HEIGHT)? as u32];
        let rate = rate::from_hz(number(CAP_PROP_FPS)?).ok_or_else(not_video)?;
        let count = number(CAP_PROP_FRAME_COUNT)?;
        let claimed = match parts.count {
            Count::Counted(frames) if frames > 0 => Some(frames),
            _ => (count >= 1.0).then_some(count as u64),
        };
        let path = path.to_path_buf();
        Ok(Self {
            path,
            decoder,
            size,
            rate,
            claimed,
            parts,
            next: 0,
            last_time_s: 0.0,
            ahead: None,
            over: false,
        })
    }

    /// Width, height, px.
    #[must_use]
    pub fn image_size(&self) -> [u32; 2] {
        self.size
    }

    /// Frames, in so many seconds: the nearest usual fraction to what the file says.
    #[must_use]
    pub fn rate(&self) -> (u32, u32) {
        self.rate
    }

    /// How many frames the file says it has, or its length and rate imply; none if it does not tell.
    #[must_use]
    pub fn claimed_frames(&self) -> Option<u64> {
        self.claimed
    }

    /// Whether [`VideoReader::claimed_frames`] was counted; else it is the file's length times its rate, and a sound track or
    /// uneven times make it wrong.
    #[must_use]
    pub fn counts_frames(&self) -> bool {
        self.parts.count != Count::Estimated
    }

    /// The index of the next frame.
    #[must_use]
    pub fn next_index(&self) -> u64 {
        self.next - u64::from(self.ahead.is_some())
    }

    /// Goes past the next frame without making a picture of it, which is faster; none at the end.
    ///
    /// # Errors
    /// As the iterator.
    pub fn pass(&mut self) -> Option<Result<Passed, Error>> {
        if self.parts.ending == Ending::Early(Whole::AllButLast) {
            // The last frame that decodes is told by its picture's successor only.
            let frame = self.next()?;
            return Some(frame.map(|Frame { index, time_s, .. }| Passed { index, time_s }));
        }
        self.step(|reader| match reader.is_past_whole() {
            true => Ok(None),
            false => reader.grab(),
        })
    }

    fn is_past_whole(&self) -> bool {
        matches!(self.parts.ending, Ending::Early(Whole::First(count)) if self.next >= count)
    }

    /// Decodes the next frame; none at the end.
    fn grab(&mut self) -> Result<Option<Passed>, Error> {
        let fail = Error::opencv(&self.path);
        if !self.decoder.grab().map_err(&fail)? {
            return Ok(None);
        }
        let time_s = self.decoder.get(CAP_PROP_POS_MSEC).map_err(&fail)? / 1000.0;
        let time_s = (self.next == 0 || time_s > self.last_time_s).then_some(time_s);
        self.last_time_s = time_s.unwrap_or(self.last_time_s);
        let index = self.next;
        self.next += 1;
        Ok(Some(Passed { index, time_s }))
    }

    /// The next picture that decodes; none at the end.
    fn decode(&mut self) -> Result<Option<Frame>, Error> {
        let Some(Passed { index, time_s }) = self.grab()? else { return Ok(None) };
        let fail = Error::opencv(&self.path);
        let mut bgr = Mat::default();
        if !self.decoder.retrieve(&mut bgr, 0).map_err(&fail)? {
            return Ok(None);
        }
        let size = [bgr.cols() as u32, bgr.rows() as u32];
        if size != self.size {
            let (path, expected) = (self.path.clone(), self.size);
            return Err(Error::SizeChanges { path, frame: index, size, expected });
        }
        let bgr = bgr.data_bytes().map_err(&fail)?;
        let mut rgb = vec![0; bgr.len()];
        swap_red_blue(bgr, &mut rgb);
        Ok(Some(Frame { index, time_s, rgb }))
    }

    /// The next picture that is whole; none at the end.
    fn advance(&mut self) -> Result<Option<Frame>, Error> {
        if self.is_past_whole() {
            return Ok(None);
        }
        if self.parts.ending != Ending::Early(Whole::AllButLast) {
            return self.decode();
        }
        // Which frame the cut went through is unknown, but it is the last one.
        if self.ahead.is_none() {
            self.ahead = self.decode()?;
        }
        let after = self.decode()?;
        Ok(match after {
            Some(after) => self.ahead.replace(after),
            None => None,
        })
    }

    /// What to say when no frame is left.
    fn end(&self) -> Option<Error> {
        let frame = self.next_index();
        let is_cut = self.parts.ending != Ending::AsItShould;
        if !is_cut && !self.counts_frames() {
            let hz = f64::from(self.rate.0) / f64::from(self.rate.1);
            let length_s = self.claimed? as f64 / hz;
            let is_short = self.last_time_s + 1.0 / hz < length_s - TAIL_S;
            return is_short.then(|| Error::EndsEarly {
                path: self.path.clone(),
                frame,
                claimed: self.claimed.unwrap_or(frame),
            });
        }
        let claimed = self.claimed.or(is_cut.then_some(frame + 1))?;
        (frame < claimed).then(|| Error::EndsEarly { path: self.path.clone(), frame, claimed })
    }

    /// A step that ends for good with the last frame or an error.
    fn step<T>(
        &mut self,
        advance: impl FnOnce(&mut Self) -> Result<Option<T>, Error>,
    ) -> Option<Result<T, Error>> {
        if self.over {
            return None;
        }
        match advance(self) {
            Ok(Some(item)) => Some(Ok(item)),
            Ok(None) => {
                self.over = true;
                self.end().map(Err)
            }
            Err(error) => {
                self.over = true;
                Some(Err(error))
            }
        }
    }
}

impl Iterator for VideoReader {
    type Item = Result<Frame, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        self.step(Self::advance)
    }
}
