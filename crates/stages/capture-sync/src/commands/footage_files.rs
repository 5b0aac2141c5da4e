//! The cameras' footage on the disk: numbered pictures, or a video.

use anyhow::{anyhow, bail};
use artifact::timestamps::{self, TimeStamp};
use artifact::{TakeCamera, picture};
use capture_sync::{Image, Reading, Recording};
use rayon::prelude::*;
use stage::Run;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// A camera's footage.
pub(super) struct FootageFiles {
    pub(super) camera: TakeCamera,
    /// First image that belongs to the take.
    first: i64,
    pub(super) source: Source,
    stamps: Option<(PathBuf, Vec<TimeStamp>)>,
}

/// Where the images are.
pub(super) enum Source {
    /// Numbered files: the pattern with the manifest's folder, and the numbers that are there.
    Pictures(PathBuf, Vec<i64>),
    /// A video file.
    Video(PathBuf),
}

impl FootageFiles {
    /// Looks what is there; reads the time stamps.
    pub(super) fn open(run: &mut Run, take: &Path, camera: &TakeCamera) -> anyhow::Result<Self> {
        let id = &camera.id;
        let folder = take.parent().unwrap_or(Path::new("."));
        let Some(footage) = &camera.footage else {
            bail!(
                "{}, camera {id}: has no footage\n  to do: name it there, or leave the camera out by --cameras",
                take.display()
            );
        };
        let source = match (&footage.images, &footage.file) {
            (Some(pattern), _) => {
                let pattern = folder.join(pattern);
                let mut numbers = artifact::image_numbers(&pattern)?;
                numbers.retain(|number| *number >= footage.first);
                if numbers.is_empty() {
                    bail!(
                        "{}: camera {id} has no image there from number {} on\n  to do: check the path and 'first' in {}",
                        pattern.display(),
                        footage.first,
                        take.display()
                    );
                }
                Source::Pictures(pattern, numbers)
            }
            (None, file) => Source::Video(folder.join(file.as_deref().unwrap_or_default())),
        };
        let stamps = footage.timestamps.as_ref().map(|name| {
            let path = folder.join(name);
            run.input(&format!("timestamps {id}"), &path).map_err(|error| anyhow!("camera {id}: {error}"))?;
            let stamps =
                timestamps::read(&path, camera.rate).map_err(|error| anyhow!("camera {id}: {error}"))?;
            anyhow::Ok((path, stamps))
        });
        Ok(Self { camera: camera.clone(), first: footage.first, source, stamps: stamps.transpose()? })
    }

    pub(super) fn is_stamped(&self) -> bool {
        self.stamps.is_some()
    }

    /// How many images are to be read, if that is known before.
    pub(super) fn image_count(&self) -> Option<u64> {
        match &self.source {
            Source::Pictures(_, numbers) => Some(numbers.len() as u64),
            Source::Video(_) => None,
        }
    }

    /// The recording: the images' numbers and stamps, and with `look` what is read from their pixels.
    pub(super) fn recording(
        &self,
        look: bool,
        progress: &Mutex<stage::Progress>,
    ) -> anyhow::Result<Recording> {
        let id = self.camera.id.clone();
        let mut images = match &self.source {
            Source::Pictures(pattern, numbers) => self.pictures(pattern, numbers, look, progress)?,
            Source::Video(path) => video::images(self, path, look, progress)?,
        };
        images.retain(|image| image.index >= self.first);
        if let Some((path, stamps)) = &self.stamps {
            for image in &mut images {
                let at = stamps.binary_search_by_key(&image.index, |stamp| stamp.index);
                let Ok(at) = at else {
                    bail!(
                        "{}: camera {id} has an image {} without a time stamp\n  to do: export the stamps of all its images, or say --ignore-timestamps",
                        path.display(),
                        image.index
                    );
                };
                image.time_s = Some(stamps[at].time_s);
            }
        }
        Ok(Recording { id, rate: self.camera.rate, first: self.first, images })
    }

    fn pictures(
        &self,
        pattern: &Path,
        numbers: &[i64],
        look: bool,
        progress: &Mutex<stage::Progress>,
    ) -> anyhow::Result<Vec<Image>> {
        let read = |(place, &index): (usize, &i64)| {
            // One picture shows whether the manifest describes this footage, also where none needs to be read.
            let reading = match look || place == 0 {
                true => Some(self.reading(&picture_path(pattern, index))?),
                false => None,
            };
            if let Ok(mut progress) = progress.lock() {
                progress.step();
            }
            Ok(Image { index, time_s: None, reading: reading.filter(|_| look) })
        };
        numbers.par_iter().enumerate().map(|(place, index)| read((place, index))).collect()
    }

    fn reading(&self, path: &Path) -> anyhow::Result<Reading> {
        let picture =
            picture::read_rgb(path).map_err(|error| anyhow!("camera {}: {error}", self.camera.id))?;
        self.check_size(path, [picture.width as u32, picture.height as u32])?;
        Ok(Reading::of(picture.width, picture.height, &picture.to_8_bits()))
    }

    /// Refuses images of another size than the manifest's.
    pub(super) fn check_size(&self, path: &Path, size: [u32; 2]) -> anyhow::Result<()> {
        let stated = self.camera.image_size;
        match size == stated {
            true => Ok(()),
            false => bail!(
                "{}: camera {} has images of {}×{} pixels, but the take manifest says {}×{}\n  to do: find out which is right; \
                 a calibration holds for one size only",
                path.display(),
                self.camera.id,
                size[0],
                size[1],
                stated[0],
                stated[1]
            ),
        }
    }
}

/// The file of a numbered picture; its name holds the number, its folder does not.
pub(super) fn picture_path(pattern: &Path, number: i64) -> PathBuf {
    let name = pattern.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    pattern.with_file_name(artifact::image_path(&name, number))
}

#[cfg(feature = "video")]
mod video {
    use super::{FootageFiles, Image, Mutex, Path, Reading, anyhow};
    use footage::VideoReader;

    pub(super) fn images(
        files: &FootageFiles,
        path: &Path,
        look: bool,
        progress: &Mutex<stage::Progress>,
    ) -> anyhow::Result<Vec<Image>> {
        let fail = |error: footage::Error| anyhow!("camera {}: {error}", files.camera.id);
        let reader = VideoReader::open(path).map_err(fail)?;
        let [width, height] = reader.image_size();
        files.check_size(path, [width, height])?;
        let image = |index: u64, reading| Image { index: index as i64, time_s: None, reading };
        if let (false, Some(count)) = (look, reader.claimed_frames()) {
            return Ok((0..count).map(|index| image(index, None)).collect());
        }
        let read = |frame: Result<footage::Frame, footage::Error>| {
            let frame = frame.map_err(fail)?;
            if let Ok(mut progress) = progress.lock() {
                progress.step();
            }
            let reading = look.then(|| Reading::of(width as usize, height as usize, &frame.rgb));
            Ok(image(frame.index, reading))
        };
        reader.map(read).collect()
    }
}

#[cfg(not(feature = "video"))]
mod video {
    use super::{FootageFiles, Image, Mutex, Path};
    use anyhow::bail;

    pub(super) fn images(
        files: &FootageFiles,
        path: &Path,
        _look: bool,
        _progress: &Mutex<stage::Progress>,
    ) -> anyhow::Result<Vec<Image>> {
        bail!(
            "{}: camera {}'s footage is a video, which this build cannot read\n  to do: build it with --features video (needs \
             OpenCV), or extract the images as PNG and name them in the manifest",
            path.display(),
            files.camera.id
        )
    }
}
