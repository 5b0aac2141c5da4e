//! The cameras' images: folders of numbered pictures, or videos.

use anyhow::bail;
use artifact::{Error, Take, picture};
use rayon::prelude::*;
use stage::{Progress, Run};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Endings of files that are taken for videos.
const VIDEOS: [&str; 4] = ["avi", "mkv", "mov", "mp4"];

/// The images of a camera.
pub(super) struct Shots {
    pub(super) camera: String,
    source: Source,
}

enum Source {
    /// Numbered files.
    Pictures { pattern: PathBuf, numbers: Vec<i64> },
    /// The number of a frame is its place in the file, from 0.
    Video(PathBuf),
}

/// An image.
pub(super) struct Shot<'a> {
    pub(super) camera: &'a str,
    pub(super) size: [u32; 2],
    /// Red, green, blue of each pixel, row after row.
    pub(super) rgb: &'a [u8],
}

/// What a camera's images showed.
pub(super) struct Looked<T> {
    pub(super) camera: String,
    pub(super) size: [u32; 2],
    /// Of all that was read.
    pub(super) sha256: String,
    /// By the images' numbers.
    pub(super) shown: Vec<(i64, T)>,
    warnings: Vec<String>,
}

/// How images are looked at.
pub(super) struct Choice<'a> {
    /// Only images whose number this divides.
    pub(super) every: u32,
    /// Says how large the images are.
    pub(super) take: Option<&'a Take>,
}

impl Choice<'_> {
    fn takes(&self, number: i64) -> bool {
        number.rem_euclid(i64::from(self.every)) == 0
    }

    /// Refuses images of another size than the take's.
    fn check_size(&self, path: &Path, camera: &str, size: [u32; 2]) -> anyhow::Result<()> {
        let stated = self.take.and_then(|take| take.cameras.iter().find(|known| known.id == camera));
        match stated.map(|camera| camera.image_size) {
            Some([width, height]) if [width, height] != size => {
                let what = format!(
                    "has {} × {} px, but the take manifest says {width} × {height} px",
                    size[0], size[1]
                );
                let error = Error::new(path, what).at(format!("camera {camera}"));
                Err(error.fix("calibrate a camera with images of the size that it films with").into())
            }
            _ => Ok(()),
        }
    }
}

/// The images in a folder that has a folder of pictures or a video of each camera, under the camera's id.
pub(super) fn in_folder(folder: &Path, name: &str) -> anyhow::Result<BTreeMap<String, Shots>> {
    let mut found = BTreeMap::new();
    for camera in artifact::subfolders(folder)? {
        let shots = numbered(&camera, &folder.join(&camera).join(name))?;
        if !shots.is_empty() {
            found.insert(camera, shots);
        }
    }
    for file in artifact::files(folder)? {
        let path = folder.join(&file);
        let Some(camera) = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()) else { continue };
        if is_video(&path) && found.insert(camera.clone(), Shots::video(&camera, &path)).is_some() {
            let error = Error::new(&path, format!("camera {camera} has other images in the folder"));
            return Err(error.fix("leave one of them in the folder").into());
        }
    }
    match found.is_empty() {
        true => {
            let what = format!("holds neither folders with pictures named {name} nor videos");
            Err(Error::new(folder, what).fix("say how the pictures are named").into())
        }
        false => Ok(found),
    }
}

/// The images of one camera: a video, or pictures whose names have `{frame}` for their number.
#[cfg(feature = "detect")]
pub(super) fn of_camera(camera: &str, path: &Path) -> anyhow::Result<Shots> {
    if is_video(path) {
        return Ok(Shots::video(camera, path));
    }
    let shots = numbered(camera, path)?;
    match shots.is_empty() {
        true => {
            let error = Error::new(path, format!("camera {camera} has no such pictures"));
            Err(error.fix("check the path, and where the number stands in the names").into())
        }
        false => Ok(shots),
    }
}

fn numbered(camera: &str, pattern: &Path) -> anyhow::Result<Shots> {
    let numbers = artifact::image_numbers(pattern)?;
    let source = Source::Pictures { pattern: pattern.to_path_buf(), numbers };
    Ok(Shots { camera: camera.to_string(), source })
}

fn is_video(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    ending.is_some_and(|ending| VIDEOS.contains(&ending.as_str()))
}

/// Looks at the images of all cameras, each as it is read: none is kept.
pub(super) fn look<T: Send>(
    run: &mut Run,
    all: &[Shots],
    choice: &Choice,
    look: impl Fn(&Shot) -> anyhow::Result<T> + Sync,
) -> anyhow::Result<Vec<Looked<T>>> {
    let counts: Option<Vec<usize>> = all.iter().map(|shots| shots.count(choice)).collect();
    let total = counts.map(|counts| counts.iter().sum::<usize>() as u64);
    let progress = Mutex::new(run.progress("images", total));
    let looked = all
        .par_iter()
        .map(|shots| match &shots.source {
            Source::Pictures { pattern, numbers } => {
                shots.pictures(pattern, numbers, choice, &look, &progress)
            }
            Source::Video(path) => video::look(&shots.camera, path, choice, &look, &progress),
        })
        .collect::<anyhow::Result<Vec<_>>>()?;
    drop(progress);
    looked.iter().flat_map(|looked| &looked.warnings).for_each(|what| run.warn(what));
    Ok(looked)
}

fn step(progress: &Mutex<Progress>) {
    if let Ok(mut progress) = progress.lock() {
        progress.step();
    }
}

impl Shots {
    fn video(camera: &str, path: &Path) -> Self {
        Self { camera: camera.to_string(), source: Source::Video(path.to_path_buf()) }
    }

    fn is_empty(&self) -> bool {
        matches!(&self.source, Source::Pictures { numbers, .. } if numbers.is_empty())
    }

    /// How many images there are to look at; unknown of a video.
    fn count(&self, choice: &Choice) -> Option<usize> {
        match &self.source {
            Source::Pictures { numbers, .. } => {
                Some(numbers.iter().filter(|number| choice.takes(**number)).count())
            }
            Source::Video(_) => None,
        }
    }

    fn pictures<T: Send>(
        &self,
        pattern: &Path,
        numbers: &[i64],
        choice: &Choice,
        look: &(impl Fn(&Shot) -> anyhow::Result<T> + Sync),
        progress: &Mutex<Progress>,
    ) -> anyhow::Result<Looked<T>> {
        let name = artifact::file_name(pattern);
        let camera = &self.camera;
        let one = |&number: &i64| {
            let path = pattern.with_file_name(artifact::image_path(&name, number));
            let picture = picture::read_rgb(&path)?;
            let size = [picture.width as u32, picture.height as u32];
            choice.check_size(&path, camera, size)?;
            let shown = look(&Shot { camera, size, rgb: &picture.to_8_bits() })
                .map_err(|error| error.context(path.display().to_string()))?;
            step(progress);
            Ok((path.clone(), size, artifact::sha256(&path)?, (number, shown)))
        };
        let wanted: Vec<i64> = numbers.iter().copied().filter(|number| choice.takes(*number)).collect();
        let all = wanted.par_iter().map(one).collect::<anyhow::Result<Vec<_>>>()?;
        let Some(size) = all.first().map(|(_, size, ..)| *size) else {
            let every = choice.every;
            bail!(
                "{}: no picture has a number that {every} divides\n  to do: give a smaller --every",
                pattern.display()
            );
        };
        if let Some((path, other, ..)) = all.iter().find(|(_, other, ..)| *other != size) {
            let what = format!(
                "has {} × {} px, the pictures before it {} × {} px",
                other[0], other[1], size[0], size[1]
            );
            let error = Error::new(path, what).at(format!("camera {camera}"));
            return Err(error.fix("calibrate a camera with images of one size").into());
        }
        let hashes: String = all.iter().map(|(_, _, sha256, _)| sha256.as_str()).collect();
        Ok(Looked {
            camera: camera.clone(),
            size,
            sha256: artifact::sha256_of(hashes.as_bytes()),
            shown: all.into_iter().map(|(.., shown)| shown).collect(),
            warnings: Vec::new(),
        })
    }
}

#[cfg(feature = "video")]
mod video {
    use super::{Choice, Looked, Mutex, Path, Progress, Shot, step};
    use footage::VideoReader;

    pub(super) fn look<T>(
        camera: &str,
        path: &Path,
        choice: &Choice,
        look: &impl Fn(&Shot) -> anyhow::Result<T>,
        progress: &Mutex<Progress>,
    ) -> anyhow::Result<Looked<T>> {
        let reader = VideoReader::open(path)?;
        let size = reader.image_size();
        choice.check_size(path, camera, size)?;
        let (mut shown, mut warnings) = (Vec::new(), Vec::new());
        for frame in reader {
            let frame = match frame {
                Ok(frame) => frame,
                // The frames before the cut are good.
                Err(error @ footage::Error::EndsEarly { frame: 1.., .. }) => {
                    warnings.push(error.to_string());
                    break;
                }
                Err(error) => return Err(error.into()),
            };
            let number = frame.index as i64;
            if choice.takes(number) {
                let seen = look(&Shot { camera, size, rgb: &frame.rgb })
                    .map_err(|error| error.context(format!("{}, frame {number}", path.display())))?;
                shown.push((number, seen));
                step(progress);
            }
        }
        Ok(Looked { camera: camera.to_string(), size, sha256: artifact::sha256(path)?, shown, warnings })
    }
}

#[cfg(not(feature = "video"))]
mod video {
    use super::{Choice, Looked, Mutex, Path, Progress, Shot};
    use anyhow::bail;

    pub(super) fn look<T>(
        camera: &str,
        path: &Path,
        _: &Choice,
        _: &impl Fn(&Shot) -> anyhow::Result<T>,
        _: &Mutex<Progress>,
    ) -> anyhow::Result<Looked<T>> {
        bail!(
            "{}: camera {camera} has a video, which this build cannot read\n  to do: build it with --features video (needs \
             OpenCV), or give its frames as numbered PNG files",
            path.display()
        )
    }
}
