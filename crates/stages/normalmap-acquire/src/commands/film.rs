//! A film from rest to an expression: numbered pictures, or a video.

use anyhow::ensure;
use artifact::{FrameRange, Photograph, Transfer, image_numbers, image_path, read_photograph};
use std::path::{Path, PathBuf};

/// Endings of video files.
const VIDEOS: [&str; 5] = ["avi", "mkv", "mov", "mp4", "webm"];

/// Frames of a film.
#[derive(Clone)]
pub(super) struct Film {
    path: PathBuf,
    /// Numbers of those that are wanted, rising; of a video they count from 0.
    pub(super) numbers: Vec<i64>,
    transfer: Option<Transfer>,
}

/// Whether a file is a video.
pub(super) fn is_video(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    ending.is_some_and(|ending| VIDEOS.contains(&ending.as_str()))
}

impl Film {
    /// The film's frames in a range.
    pub(super) fn open(path: &Path, range: FrameRange, transfer: Option<Transfer>) -> anyhow::Result<Self> {
        let numbers = if is_video(path) { video::numbers(path)? } else { image_numbers(path)? };
        let numbers: Vec<i64> = numbers.into_iter().filter(|number| range.contains(*number)).collect();
        ensure!(
            numbers.len() >= 3,
            "{}: {} pictures are there; at least 3 are needed\n  to do: check the file or the pattern, its folder, and --range",
            path.display(),
            numbers.len()
        );
        Ok(Self { path: path.to_path_buf(), numbers, transfer })
    }

    /// The file that a frame comes from.
    pub(super) fn file(&self, number: i64) -> PathBuf {
        match is_video(&self.path) {
            true => self.path.clone(),
            false => numbered(&self.path, number),
        }
    }

    /// Shows each frame from a number to another in turn.
    pub(super) fn show(
        &self,
        [first, last]: [i64; 2],
        mut each: impl FnMut(i64, Photograph) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        if is_video(&self.path) {
            return video::show(&self.path, [first, last], self.transfer, each);
        }
        let wanted = self.numbers.iter().filter(|number| (first..=last).contains(*number));
        for number in wanted {
            each(*number, read_photograph(&self.file(*number), self.transfer)?)?;
        }
        Ok(())
    }
}

/// A pattern's file.
pub(super) fn numbered(pattern: &Path, number: i64) -> PathBuf {
    PathBuf::from(image_path(&pattern.display().to_string(), number))
}

/// One frame of a video.
pub(super) fn frame(path: &Path, number: i64, transfer: Option<Transfer>) -> anyhow::Result<Photograph> {
    let mut found = None;
    video::show(path, [number, number], transfer, |_, photograph| {
        found = Some(photograph);
        Ok(())
    })?;
    found.ok_or_else(|| {
        anyhow::anyhow!(
            "{}: has no frame {number}\n  to do: check its length; frames count from 0",
            path.display()
        )
    })
}

#[cfg(feature = "video")]
mod video {
    use super::{Path, Photograph, Transfer};
    use footage::VideoReader;

    pub(super) fn numbers(path: &Path) -> anyhow::Result<Vec<i64>> {
        let mut reader = VideoReader::open(path)?;
        let mut numbers = Vec::new();
        while let Some(passed) = reader.pass() {
            numbers.push(passed?.index as i64);
        }
        Ok(numbers)
    }

    pub(super) fn show(
        path: &Path,
        [first, last]: [i64; 2],
        transfer: Option<Transfer>,
        mut each: impl FnMut(i64, Photograph) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let mut reader = VideoReader::open(path)?;
        let [width, height] = reader.image_size().map(|side| side as usize);
        while (reader.next_index() as i64) < first {
            match reader.pass() {
                Some(passed) => passed?,
                None => return Ok(()),
            };
        }
        for frame in reader {
            let frame = frame?;
            let number = frame.index as i64;
            if number > last {
                break;
            }
            each(number, Photograph::of_rgb8(width, height, &frame.rgb, transfer))?;
        }
        Ok(())
    }
}

#[cfg(not(feature = "video"))]
mod video {
    use super::{Path, Photograph, Transfer};

    fn refuse<T>(path: &Path) -> anyhow::Result<T> {
        anyhow::bail!(
            "{}: is a video, which this build cannot read\n  to do: build it with --features video (needs OpenCV), or give its \
             frames as numbered PNG files",
            path.display()
        )
    }

    pub(super) fn numbers(path: &Path) -> anyhow::Result<Vec<i64>> {
        refuse(path)
    }

    pub(super) fn show(
        path: &Path,
        _: [i64; 2],
        _: Option<Transfer>,
        _: impl FnMut(i64, Photograph) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        refuse(path)
    }
}
