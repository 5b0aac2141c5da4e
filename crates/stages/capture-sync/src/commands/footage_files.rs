//! The cameras' footage on the disk: numbered pictures, or a video.

use anyhow::{anyhow, bail};
use artifact::timestamps::{self, TimeStamp};
use artifact::{TakeCamera, Transfer, picture};
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

/// How footage is read.
#[derive(Clone, Copy)]
pub(super) struct Looking<'a> {
    /// Whether pixels are looked at.
    pub(super) at_pixels: bool,
    /// Whether a video that ends early will do.
    pub(super) accept_short: bool,
    pub(super) progress: &'a Mutex<stage::Progress>,
}

impl Looking<'_> {
    fn step(&self) {
        if let Ok(mut progress) = self.progress.lock() {
            progress.step();
        }
    }
}

/// A camera's recording, and what is odd about its footage.
pub(super) struct Read {
    pub(super) recording: Recording,
    pub(super) warnings: Vec<String>,
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
        check_coding(take, camera)?;
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
            Source::Video(path) => video::frame_count(path),
        }
    }

    /// The recording: the images' numbers and stamps, and what is read from their pixels where they are looked at.
    pub(super) fn recording(&self, looking: Looking) -> anyhow::Result<Read> {
        let mut warnings = Vec::new();
        let mut images = match &self.source {
            Source::Pictures(pattern, numbers) => self.pictures(pattern, numbers, looking)?,
            Source::Video(path) => video::images(self, path, looking, &mut warnings)?,
        };
        images.retain(|image| image.index >= self.first);
        if let Some((path, stamps)) = &self.stamps {
            self.stamp(&mut images, path, stamps)?;
            warnings.extend(self.ends_before(&images, path, stamps, looking.accept_short)?);
        }
        let (id, rate, first) = (self.camera.id.clone(), self.camera.rate, self.first);
        Ok(Read { recording: Recording { id, rate, first, images }, warnings })
    }

    fn stamp(&self, images: &mut [Image], path: &Path, stamps: &[TimeStamp]) -> anyhow::Result<()> {
        for image in images {
            let Ok(at) = stamps.binary_search_by_key(&image.index, |stamp| stamp.index) else {
                bail!(
                    "{}: camera {} has an image {} without a time stamp\n  to do: export the stamps of all its images, or say --ignore-timestamps",
                    path.display(),
                    self.camera.id,
                    image.index
                );
            };
            image.time_s = Some(stamps[at].time_s);
        }
        Ok(())
    }

    /// A video must have a frame for every stamp: its frames have no numbers of their own, and where one was lost all later
    /// ones would have another's stamp.
    fn ends_before(
        &self,
        images: &[Image],
        stamps_path: &Path,
        stamps: &[TimeStamp],
        accept_short: bool,
    ) -> anyhow::Result<Option<String>> {
        let (Source::Video(path), Some(last), Some(stamped)) =
            (&self.source, images.last(), stamps.last().map(|stamp| stamp.index))
        else {
            return Ok(None);
        };
        if stamped <= last.index {
            return Ok(None);
        }
        let what = format!(
            "{}: camera {}'s last frame is {}, but {} has stamps up to frame {stamped}",
            path.display(),
            self.camera.id,
            last.index,
            stamps_path.display()
        );
        match accept_short {
            true => Ok(Some(format!("{what}; the frames that are not there are gaps"))),
            false => bail!(
                "{what}\n  to do: copy or convert the video again, without leaving out frames; if only its end is lost, say --accept-short"
            ),
        }
    }

    fn pictures(&self, pattern: &Path, numbers: &[i64], looking: Looking) -> anyhow::Result<Vec<Image>> {
        let look = looking.at_pixels;
        let read = |(place, &index): (usize, &i64)| {
            let path = picture_path(pattern, index);
            self.check_picture(&path)?;
            // One picture shows whether they decode, also where none needs to be read.
            let reading = match look || place == 0 {
                true => Some(self.reading(&path)?),
                false => None,
            };
            looking.step();
            Ok(Image { index, time_s: None, reading: reading.filter(|_| look) })
        };
        numbers.par_iter().enumerate().map(|(place, index)| read((place, index))).collect()
    }

    /// Refuses a picture that is cut, or of another size or depth than the manifest says.
    fn check_picture(&self, path: &Path) -> anyhow::Result<()> {
        let id = &self.camera.id;
        let head = picture::read_head(path).map_err(|error| anyhow!("camera {id}: {error}"))?;
        self.check_size(path, head.size)?;
        let stated = self.camera.bit_depth;
        match (head.bits > 8) == (stated > 8) {
            true => Ok(()),
            false => bail!(
                "{}: camera {id} has pictures of {} bits a channel, but the take manifest says {stated}\n  to do: find out which \
                 is right; more than 8 bits come in pictures of 16",
                path.display(),
                head.bits
            ),
        }
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

/// Refuses a transfer function that is not known, and depths that no footage has.
fn check_coding(take: &Path, camera: &TakeCamera) -> anyhow::Result<()> {
    let place = format!("{}, camera {}", take.display(), camera.id);
    camera.transfer.parse::<Transfer>().map_err(|error| anyhow!("{place}: {error}"))?;
    match (1..=16).contains(&camera.bit_depth) {
        true => Ok(()),
        false => bail!(
            "{place}: bit_depth is {}; 1 to 16 bits a channel are allowed\n  to do: correct it",
            camera.bit_depth
        ),
    }
}

/// The file of a numbered picture; its name holds the number, its folder does not.
pub(super) fn picture_path(pattern: &Path, number: i64) -> PathBuf {
    let name = pattern.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    pattern.with_file_name(artifact::image_path(&name, number))
}

#[cfg(feature = "video")]
mod video {
    use super::{FootageFiles, Image, Looking, Path, Reading};
    use anyhow::{anyhow, bail};
    use capture_sync::{FrameTimes, frame_times};
    use footage::{Error, VideoReader};

    /// A container's rate may be this far from the take's, as a share; rates are written with few digits.
    const RATE_TOLERANCE: f64 = 2e-3;

    pub(super) fn frame_count(path: &Path) -> Option<u64> {
        VideoReader::open(path).ok()?.claimed_frames()
    }

    /// The frames in the order of the file, each decoded once: what the container says of their number is not believed.
    pub(super) fn images(
        files: &FootageFiles,
        path: &Path,
        looking: Looking,
        warnings: &mut Vec<String>,
    ) -> anyhow::Result<Vec<Image>> {
        let id = &files.camera.id;
        let fail = |error: Error| anyhow!("camera {id}: {error}");
        let mut reader = VideoReader::open(path).map_err(fail)?;
        files.check_size(path, reader.image_size())?;
        let (mut images, mut times) = (Vec::new(), Vec::new());
        loop {
            match next(&mut reader, looking.at_pixels) {
                None => break,
                Some(Ok((image, time_s))) => {
                    looking.step();
                    images.push(image);
                    times.push(time_s);
                }
                Some(Err(Error::EndsEarly { frame, claimed, .. })) => {
                    warnings.push(ends_early(path, id, [frame, claimed], looking.accept_short)?);
                }
                Some(Err(error)) => return Err(fail(error)),
            }
        }
        if images.is_empty() {
            bail!("{}: camera {id}: no frame can be decoded\n  to do: copy the file again", path.display());
        }
        if files.stamps.is_none() {
            use_container_times(files, path, &mut images, &times, warnings)?;
        }
        if files.camera.bit_depth > 8 {
            warnings.push(format!(
                "{}: camera {id}: of its {} bits a channel 8 are used: OpenCV decodes videos no deeper",
                path.display(),
                files.camera.bit_depth
            ));
        }
        Ok(images)
    }

    /// The next frame, and when its container shows it.
    fn next(reader: &mut VideoReader, at_pixels: bool) -> Option<Result<(Image, Option<f64>), Error>> {
        let image = |index: u64, reading| Image { index: index as i64, time_s: None, reading };
        if !at_pixels {
            return Some(reader.pass()?.map(|passed| (image(passed.index, None), passed.time_s)));
        }
        let [width, height] = reader.image_size().map(|side| side as usize);
        Some(
            reader.next()?.map(|frame| {
                (image(frame.index, Some(Reading::of(width, height, &frame.rgb))), frame.time_s)
            }),
        )
    }

    fn ends_early(
        path: &Path,
        id: &str,
        [frame, claimed]: [u64; 2],
        accept_short: bool,
    ) -> anyhow::Result<String> {
        let what = format!(
            "{}: camera {id}: ends early: frame {frame} of {claimed} is missing or damaged",
            path.display()
        );
        match accept_short {
            true => Ok(format!("{what}; the {frame} frames before it are used, what follows is a gap")),
            false => bail!(
                "{what}\n  to do: copy the file again, or say --accept-short to go on with the {frame} frames before it"
            ),
        }
    }

    /// Gaps in the container's times are lost frames, which the frames' numbers do not tell.
    fn use_container_times(
        files: &FootageFiles,
        path: &Path,
        images: &mut [Image],
        times: &[Option<f64>],
        warnings: &mut Vec<String>,
    ) -> anyhow::Result<()> {
        let (id, stated) = (&files.camera.id, files.camera.rate);
        let FrameTimes { rate_hz: Some(rate_hz), uneven_s } = frame_times(times) else { return Ok(()) };
        let what = (rate_hz / stated.hz() - 1.0).abs() > RATE_TOLERANCE;
        let what = what.then(|| {
            format!(
                "{}: camera {id}'s frames are {rate_hz:.3} Hz apart in the file, but the take manifest says {stated}",
                path.display()
            )
        });
        match (uneven_s, what) {
            (None, None) => {}
            (None, Some(what)) => {
                warnings.push(format!("{what}; the manifest's rate counts: correct it there if it is wrong"));
            }
            (Some(_), Some(what)) => bail!(
                "{what}, and some are further apart\n  to do: state the rate that the file has in the manifest, or give time stamps"
            ),
            (Some(uneven_s), None) => {
                images.iter_mut().zip(uneven_s).for_each(|(image, time_s)| image.time_s = Some(time_s));
                warnings.push(format!(
                    "{}: camera {id}'s frames come at uneven times; the gaps are taken as lost frames",
                    path.display()
                ));
            }
        }
        Ok(())
    }
}

#[cfg(not(feature = "video"))]
mod video {
    use super::{FootageFiles, Image, Looking, Path};
    use anyhow::bail;

    pub(super) fn frame_count(_path: &Path) -> Option<u64> {
        None
    }

    pub(super) fn images(
        files: &FootageFiles,
        path: &Path,
        _looking: Looking,
        _warnings: &mut Vec<String>,
    ) -> anyhow::Result<Vec<Image>> {
        bail!(
            "{}: camera {}'s footage is a video, which this build cannot read\n  to do: build it with --features video (needs \
             OpenCV), or extract the images as PNG and name them in the manifest",
            path.display(),
            files.camera.id
        )
    }
}
