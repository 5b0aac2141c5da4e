//! Frames out of a video file.

use crate::swap::swap_red_blue;
use crate::whole::{Ending, ending};
use crate::writer::plain;
use crate::{Error, quiet, rate};
use opencv::core::Mat;
use opencv::prelude::{MatTraitConst, MatTraitConstManual, VideoCaptureTrait, VideoCaptureTraitConst};
use opencv::videoio::{
    CAP_FFMPEG, CAP_PROP_FPS, CAP_PROP_FRAME_COUNT, CAP_PROP_FRAME_HEIGHT, CAP_PROP_FRAME_WIDTH,
    CAP_PROP_POS_MSEC, VideoCapture as Decoder,
};
use std::path::{Path, PathBuf};

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

/// A video file that is being read: an iterator over its frames, in their order. After the last good frame of a cut or
/// damaged file comes one [`Error::EndsEarly`].
pub struct VideoReader {
    path: PathBuf,
    decoder: Decoder,
    size: [u32; 2],
    rate: (u32, u32),
    claimed: Option<u64>,
    ending: Ending,
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
        let ending = ending(file).map_err(Error::io(path, "read"))?;
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
        let claimed = (count >= 1.0).then_some(count as u64);
        let path = path.to_path_buf();
        Ok(Self {
            path,
            decoder,
            size,
            rate,
            claimed,
            ending,
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

    /// The next picture that decodes; none at the end.
    fn decode(&mut self) -> Result<Option<Frame>, Error> {
        let fail = Error::opencv(&self.path);
        let mut bgr = Mat::default();
        if !self.decoder.read(&mut bgr).map_err(&fail)? {
            return Ok(None);
        }
        let size = [bgr.cols() as u32, bgr.rows() as u32];
        if size != self.size {
            let (path, frame, expected) = (self.path.clone(), self.next, self.size);
            return Err(Error::SizeChanges { path, frame, size, expected });
        }
        let bgr = bgr.data_bytes().map_err(&fail)?;
        let mut rgb = vec![0; bgr.len()];
        swap_red_blue(bgr, &mut rgb);
        let time_s = self.decoder.get(CAP_PROP_POS_MSEC).map_err(&fail)? / 1000.0;
        let time_s = (self.next == 0 || time_s > self.last_time_s).then_some(time_s);
        self.last_time_s = time_s.unwrap_or(self.last_time_s);
        let index = self.next;
        self.next += 1;
        Ok(Some(Frame { index, time_s, rgb }))
    }

    /// The next picture that is whole; none at the end.
    fn advance(&mut self) -> Result<Option<Frame>, Error> {
        match self.ending {
            Ending::AsItShould => self.decode(),
            Ending::Early { whole_frames: Some(count) } => match self.next < count {
                true => self.decode(),
                false => Ok(None),
            },
            // Which frame the cut went through is unknown, but it is the last one.
            Ending::Early { whole_frames: None } => {
                if self.ahead.is_none() {
                    self.ahead = self.decode()?;
                }
                let after = self.decode()?;
                Ok(match after {
                    Some(after) => self.ahead.replace(after),
                    None => None,
                })
            }
        }
    }

    /// What to say when no frame is left.
    fn end(&self) -> Option<Error> {
        let frame = self.next - u64::from(self.ahead.is_some());
        let is_cut = self.ending != Ending::AsItShould;
        let claimed = self.claimed.or(is_cut.then_some(frame + 1))?;
        (frame < claimed).then(|| Error::EndsEarly { path: self.path.clone(), frame, claimed })
    }
}

impl Iterator for VideoReader {
    type Item = Result<Frame, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.over {
            return None;
        }
        match self.advance() {
            Ok(Some(frame)) => Some(Ok(frame)),
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
