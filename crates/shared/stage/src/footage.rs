//! The images of a take by mocap frame, whether they were extracted or stand in the take's own footage.

use crate::Run;
use anyhow::{Context, bail};
use artifact::picture::{Image8, Rgb, read_rgb};
use artifact::{
    FrameReader, Frames, Rate, Shown, SyncCamera, SyncFrame, Take, TakeCamera, TakeRef, TimeBase, Transfer,
};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Arguments that name a take's images.
#[derive(Debug, Clone, clap::Args)]
pub struct ImageSource {
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

/// What is known of a take's images.
#[derive(Debug)]
pub struct Footage {
    folder: PathBuf,
    kind: Kind,
    path: PathBuf,
    /// Frames per second of the mocap clock.
    pub rate: Rate,
    /// The take, if it is known.
    pub take: Option<TakeRef>,
    /// Per camera id how its clock stands to the mocap clock.
    pub clocks: BTreeMap<String, SyncCamera>,
    frames: Vec<SyncFrame>,
}

#[derive(Debug)]
enum Kind {
    Extracted(Frames),
    Take(Box<Take>),
}

/// A camera's images.
#[derive(Debug)]
pub struct CameraImages {
    /// What a stored value means in light.
    pub transfer: Transfer,
    /// Width, height, px.
    pub size: [u32; 2],
    /// Per frame of the footage its image, where there is one that does not only repeat the one before.
    pub paths: Vec<Option<PathBuf>>,
}

impl CameraImages {
    /// Reads an image, which must have the size that is stated.
    ///
    /// # Errors
    /// If it cannot be read, or has another size.
    pub fn read(&self, path: &Path) -> anyhow::Result<Rgb> {
        let picture = read_rgb(path)?;
        let [width, height] = self.size;
        if [picture.width, picture.height] != self.size.map(|side| side as usize) {
            bail!(
                "{}: has {} × {} px, but its camera {width} × {height}\n  to do: find out which is right",
                path.display(),
                picture.width,
                picture.height,
            );
        }
        Ok(picture)
    }

    /// The same with code values of 8 bits, whatever the image has.
    ///
    /// # Errors
    /// If it cannot be read, or has another size.
    pub fn read_8_bits(&self, path: &Path) -> anyhow::Result<Image8> {
        Ok(self.read(path)?.into_8_bits())
    }
}

impl ImageSource {
    /// Reads what says where the images are.
    ///
    /// # Errors
    /// If a file cannot be read, or they are of different takes.
    pub fn open(&self, run: &mut Run) -> anyhow::Result<Footage> {
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
                let (take, reference) = crate::load_take(run, path)?;
                (path, Kind::Take(Box::new(take)), Some(reference))
            }
            (None, None) => bail!("name the images: --frames or --take"),
        };
        check_take(run, &self.sync, header.take.as_ref(), take.as_ref())?;
        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        let take = take.or(header.take);
        Ok(Footage {
            folder,
            kind,
            path: path.clone(),
            rate: header.rate,
            take,
            clocks: header.cameras,
            frames,
        })
    }
}

/// Refuses a file of another take than the images; warns of one that was made before the manifest was changed.
///
/// # Errors
/// If both takes are known and differ.
pub fn check_take(
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
    #[must_use]
    pub fn ids(&self) -> Vec<&String> {
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

    /// All mocap frames, rising.
    #[must_use]
    pub fn numbers(&self) -> Vec<i64> {
        self.frames.iter().map(|frame| frame.frame).collect()
    }

    /// The file that the images are named by.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The images of a camera.
    ///
    /// # Errors
    /// If there is no such camera, its footage is a video, or its transfer function is not known.
    pub fn camera(&self, id: &str) -> anyhow::Result<CameraImages> {
        match &self.kind {
            Kind::Extracted(frames) => {
                let camera = frames.cameras.get(id).with_context(|| self.no_camera(id))?;
                let path = |frame: &SyncFrame| {
                    let fresh = shown(frame, id).is_none_or(|shown| !shown.doubled);
                    camera.image(frame.frame).filter(|_| fresh).map(|name| self.folder.join(name))
                };
                self.images(id, &camera.transfer, camera.image_size, path)
            }
            Kind::Take(take) => {
                let camera =
                    take.cameras.iter().find(|camera| camera.id == id).with_context(|| self.no_camera(id))?;
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
                self.images(id, &camera.transfer, camera.image_size, path)
            }
        }
    }

    fn images(
        &self,
        id: &str,
        transfer: &str,
        size: [u32; 2],
        path: impl Fn(&SyncFrame) -> Option<PathBuf>,
    ) -> anyhow::Result<CameraImages> {
        let transfer = transfer.parse().with_context(|| format!("{}, camera {id}", self.path.display()))?;
        Ok(CameraImages { transfer, size, paths: self.frames.iter().map(path).collect() })
    }

    fn no_camera(&self, id: &str) -> String {
        let known = self.ids().into_iter().cloned().collect::<Vec<_>>().join(", ");
        format!("{}: has no camera {id}\n  to do: name one of {known}", self.path.display())
    }
}

fn shown<'a>(frame: &'a SyncFrame, camera: &str) -> Option<&'a Shown> {
    frame.shows.get(camera).and_then(Option::as_ref)
}
