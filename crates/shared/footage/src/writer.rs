//! Frames into a video file.

use crate::swap::swap_red_blue;
use crate::whole::{Count, Ending, Whole, parts};
use crate::{Codec, Error, VideoReader, quiet};
use opencv::core::{CV_8UC3, Mat, Scalar, Size};
use opencv::prelude::{MatTraitManual, VideoWriterTrait, VideoWriterTraitConst};
use opencv::videoio::{CAP_FFMPEG, VideoWriter as Encoder};
use std::path::{Path, PathBuf};

/// A video file that is being written. Dropped without [`VideoWriter::finish`], it takes the file away.
pub struct VideoWriter {
    path: PathBuf,
    size: [u32; 2],
    encoder: Encoder,
    /// The frame in OpenCV's order of channels; made once.
    bgr: Mat,
    written: u64,
    finished: bool,
}

impl VideoWriter {
    /// Whether [`VideoWriter::create`] would take these; touches nothing on the disk.
    ///
    /// # Errors
    /// If size, rate or ending will not do.
    pub fn check(path: &Path, codec: Codec, image_size: [u32; 2], rate: (u32, u32)) -> Result<(), Error> {
        let path_buf = || path.to_path_buf();
        if !path
            .extension()
            .is_some_and(|own| codec.endings().iter().any(|ending| own.eq_ignore_ascii_case(ending)))
        {
            return Err(Error::Ending { path: path_buf(), codec });
        }
        if image_size.iter().any(|&side| side == 0 || side % 2 == 1 || side > 1 << 15) {
            return Err(Error::Size { path: path_buf(), size: image_size });
        }
        match rate.0 > 0 && rate.1 > 0 {
            true => Ok(()),
            false => Err(Error::Rate { path: path_buf(), rate }),
        }
    }

    /// Starts a file. Its ending chooses the container (see [`Codec::endings`]), so a temporary name must keep it.
    ///
    /// `image_size`: width, height, px, both even; `rate`: frames, in so many seconds (`(30000, 1001)` is written as
    /// 29.97 Hz, the nearest that OpenCV can say).
    ///
    /// # Errors
    /// If size, rate or ending will not do, the folder is missing, or the codec cannot be written here.
    pub fn create(path: &Path, codec: Codec, image_size: [u32; 2], rate: (u32, u32)) -> Result<Self, Error> {
        quiet::silence();
        Self::check(path, codec, image_size, rate)?;
        // OpenCV would not say why a file cannot be made.
        touch(path).map_err(Error::io(path, "written"))?;
        let mut guard = Discard(Some(path));
        let fail = Error::opencv(path);
        let [a, b, c, d] = codec.letters();
        let fourcc = Encoder::fourcc(a, b, c, d).map_err(&fail)?;
        let [width, height] = image_size.map(|side| side as i32);
        let hz = f64::from(rate.0) / f64::from(rate.1);
        let size = Size::new(width, height);
        let encoder = Encoder::new_with_backend(plain(path).as_path(), CAP_FFMPEG, fourcc, hz, size, true)
            .map_err(&fail)?;
        if !encoder.is_opened().map_err(&fail)? {
            return Err(Error::NoEncoder { path: path.to_path_buf(), codec });
        }
        let bgr =
            Mat::new_rows_cols_with_default(height, width, CV_8UC3, Scalar::default()).map_err(&fail)?;
        guard.0 = None;
        Ok(Self { path: path.to_path_buf(), size: image_size, encoder, bgr, written: 0, finished: false })
    }

    /// Appends a frame. `rgb`: 3 × width × height bytes, row after row from the top.
    ///
    /// # Errors
    /// If OpenCV fails. A full disk shows in [`VideoWriter::finish`] only.
    ///
    /// # Panics
    /// If the number of bytes is not that of the image size.
    pub fn write(&mut self, rgb: &[u8]) -> Result<(), Error> {
        let [width, height] = self.size.map(|side| side as usize);
        assert_eq!(rgb.len(), 3 * width * height, "a frame has 3 × width × height bytes");
        let fail = Error::opencv(&self.path);
        swap_red_blue(rgb, self.bgr.data_bytes_mut().map_err(&fail)?);
        self.encoder.write(&self.bgr).map_err(&fail)?;
        self.written += 1;
        Ok(())
    }

    /// Frames written so far.
    #[must_use]
    pub fn written(&self) -> u64 {
        self.written
    }

    /// Ends the file and looks whether all of it arrived.
    ///
    /// # Errors
    /// If the file is not whole; it is taken away then.
    pub fn finish(mut self) -> Result<(), Error> {
        self.encoder.release().map_err(Error::opencv(&self.path))?;
        let found = match self.written {
            // A video without frames is no video; nothing can be counted in it.
            0 => 0,
            _ => whole_frames(&self.path)?,
        };
        if found != self.written {
            return Err(Error::Incomplete { path: self.path.clone(), found, written: self.written });
        }
        self.finished = true;
        Ok(())
    }
}

impl Drop for VideoWriter {
    fn drop(&mut self) {
        if !self.finished {
            // OpenCV writes the file's end when it lets go.
            let _ = self.encoder.release();
            drop(Discard(Some(&self.path)));
        }
    }
}

/// Takes a file away when dropped.
struct Discard<'a>(Option<&'a Path>);

impl Drop for Discard<'_> {
    #[allow(clippy::disallowed_methods, reason = "videos do not pass through `artifact`")]
    fn drop(&mut self) {
        if let Some(path) = self.0 {
            let _ = std::fs::remove_file(path);
        }
    }
}

#[allow(clippy::disallowed_methods, reason = "videos do not pass through `artifact`")]
fn touch(path: &Path) -> std::io::Result<()> {
    std::fs::File::create(path).map(drop)
}

/// How many frames the file claims, if it is all there; else how many are.
#[allow(clippy::disallowed_methods, reason = "videos do not pass through `artifact`")]
fn whole_frames(path: &Path) -> Result<u64, Error> {
    let file = std::fs::File::open(path).map_err(Error::io(path, "read"))?;
    let parts = parts(file).map_err(Error::io(path, "read"))?;
    match (parts.ending, parts.count) {
        (Ending::AsItShould, Count::Counted(frames)) => Ok(frames),
        (Ending::AsItShould, _) => Ok(VideoReader::open(path)?.claimed_frames().unwrap_or(0)),
        (Ending::Early(Whole::First(frames)), _) => Ok(frames),
        (Ending::Early(_), _) => Ok(0),
    }
}

/// The path in a form that FFmpeg cannot take for a protocol (`a:b.avi`) or a device.
pub(crate) fn plain(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf())
}
