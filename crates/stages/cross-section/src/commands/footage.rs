//! Where the image of a frame is, whether it was extracted or stands in the take's own footage.

use anyhow::{Context, bail};
use artifact::picture::{Rgb, read_rgb};
use artifact::{FrameReader, Frames, SyncFrame, Take, TakeCamera, TakeRef, TimeBase, Transfer};
use cross_section::Picture;
use stage::Run;
use std::path::{Path, PathBuf};

/// The images to measure in.
#[derive(clap::Args)]
pub(crate) struct Source {
    /// Extracted images (frames)
    #[arg(long, value_name = "FILE", required_unless_present = "take", conflicts_with = "take")]
    frames: Option<PathBuf>,
    /// Take manifest whose footage is image sequences, instead of extracted images
    #[arg(long, value_name = "FILE")]
    take: Option<PathBuf>,
    /// Which image shows which frame (sync)
    #[arg(long, value_name = "FILE")]
    sync: PathBuf,
}

/// A camera's images.
pub(crate) struct CameraImages {
    pub(crate) transfer: Transfer,
    pub(crate) size: [u32; 2],
    /// Per frame of the footage its image, where there is one.
    pub(crate) paths: Vec<Option<PathBuf>>,
}

/// What is known of a take's images.
pub(crate) struct Footage {
    folder: PathBuf,
    kind: Kind,
    path: PathBuf,
    pub(crate) take: Option<TakeRef>,
    /// All mocap frames, rising.
    frames: Vec<SyncFrame>,
}

enum Kind {
    Extracted(Frames),
    Take(Box<Take>),
}

impl Source {
    pub(crate) fn open(&self, run: &mut Run) -> anyhow::Result<Footage> {
        let sync = FrameReader::<TimeBase>::open(&self.sync)?;
        run.input("sync", &self.sync)?;
        let header = sync.header().clone();
        let frames = sync.collect::<artifact::Result<Vec<_>>>()?;
        if frames.is_empty() {
            bail!("{}: holds no frames\n  to do: run capture-sync again", self.sync.display());
        }
        let (path, kind, take) = match (&self.frames, &self.take) {
            (Some(path), _) => {
                let extracted: Frames = artifact::read_document(path)?;
                run.input("frames", path)?;
                let take = extracted.take.clone();
                (path, Kind::Extracted(extracted), take)
            }
            (None, Some(path)) => {
                let (take, reference) = stage::load_take(run, path)?;
                (path, Kind::Take(Box::new(take)), Some(reference))
            }
            (None, None) => bail!("name the images: --frames or --take"),
        };
        check_take(run, &self.sync, header.take.as_ref(), take.as_ref())?;
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let take = take.or(header.take);
        Ok(Footage { folder, kind, path: path.clone(), take, frames })
    }
}

/// Refuses a file of another take than the images; warns of one that was made before the manifest was changed.
pub(crate) fn check_take(
    run: &mut Run,
    file: &Path,
    stated: Option<&TakeRef>,
    take: Option<&TakeRef>,
) -> anyhow::Result<()> {
    let (Some(stated), Some(take)) = (stated, take) else { return Ok(()) };
    let file = file.display();
    if (&stated.take, &stated.session) != (&take.take, &take.session) {
        bail!(
            "{file}: is of take {} of session {}, but the images are of take {} of session {}\n  to do: give files of one take",
            stated.take,
            stated.session,
            take.take,
            take.session
        );
    }
    if stated.sha256 != take.sha256 {
        run.warn(format!(
            "{file}: the manifest of take {} was changed since this was made; if the change moves images or frames, make it again",
            take.take
        ));
    }
    Ok(())
}

impl Footage {
    /// The cameras that have images.
    pub(crate) fn ids(&self) -> Vec<&String> {
        match &self.kind {
            Kind::Extracted(frames) => frames.cameras.keys().collect(),
            Kind::Take(take) => {
                let has_images = |camera: &&TakeCamera| {
                    camera.footage.as_ref().is_some_and(|footage| footage.images.is_some())
                };
                take.cameras.iter().filter(has_images).map(|camera| &camera.id).collect()
            }
        }
    }

    pub(crate) fn numbers(&self) -> Vec<i64> {
        self.frames.iter().map(|frame| frame.frame).collect()
    }

    /// The file that the images are named by.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    fn transfer(&self, id: &str, name: &str) -> anyhow::Result<Transfer> {
        name.parse().with_context(|| format!("{}, camera {id}", self.path.display()))
    }

    /// The images of a camera.
    pub(crate) fn camera(&self, id: &str) -> anyhow::Result<CameraImages> {
        let unknown = || {
            format!(
                "{}: has no camera {id}\n  to do: name one of {}",
                self.path.display(),
                self.ids().into_iter().cloned().collect::<Vec<_>>().join(", ")
            )
        };
        match &self.kind {
            Kind::Extracted(frames) => {
                let camera = frames.cameras.get(id).with_context(unknown)?;
                let path = |frame: &SyncFrame| {
                    let fresh = shown(frame, id).is_none_or(|shown| !shown.doubled);
                    camera.image(frame.frame).filter(|_| fresh).map(|name| self.folder.join(name))
                };
                Ok(CameraImages {
                    transfer: self.transfer(id, &camera.transfer)?,
                    size: camera.image_size,
                    paths: self.frames.iter().map(path).collect(),
                })
            }
            Kind::Take(take) => {
                let camera = take.cameras.iter().find(|camera| camera.id == id).with_context(unknown)?;
                let Some(footage) = camera.footage.as_ref().filter(|footage| footage.images.is_some()) else {
                    bail!(
                        "{}, camera {id}: its footage is no image sequence\n  to do: run capture-sync first, and give --frames",
                        self.path.display()
                    );
                };
                let path = |frame: &SyncFrame| {
                    let shown = shown(frame, id).filter(|shown| !shown.doubled)?;
                    footage.image(shown.index).map(|name| self.folder.join(name))
                };
                Ok(CameraImages {
                    transfer: self.transfer(id, &camera.transfer)?,
                    size: camera.image_size,
                    paths: self.frames.iter().map(path).collect(),
                })
            }
        }
    }
}

fn shown<'a>(frame: &'a SyncFrame, camera: &str) -> Option<&'a artifact::Shown> {
    frame.shows.get(camera).and_then(Option::as_ref)
}

/// An image in 8 bits.
pub(crate) struct Image {
    width: usize,
    height: usize,
    codes: Vec<u8>,
}

impl Image {
    /// Reads an image, which must have the size that is stated.
    pub(crate) fn read(path: &Path, size: [u32; 2]) -> anyhow::Result<Self> {
        let Rgb { width, height, codes } = read_rgb(path)?;
        if [width, height] != size.map(|side| side as usize) {
            bail!(
                "{}: has {width} × {height} px, but its camera {} × {}\n  to do: find out which is right",
                path.display(),
                size[0],
                size[1]
            );
        }
        let codes = match codes {
            artifact::picture::Codes::Bits8(codes) => codes,
            codes => Rgb { width, height, codes }.to_8_bits(),
        };
        Ok(Self { width, height, codes })
    }

    pub(crate) fn picture(&self) -> Result<Picture<'_>, cross_section::Error> {
        Picture::new(self.width, self.height, &self.codes)
    }
}
