//! The images of the take's cameras.

use super::{Answer, Bench};
use anyhow::Context;
use artifact::{Frames, TakeRef};
use loopback::Response;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use workbench::IMAGES;

/// Images by camera and frame.
pub(crate) struct Images {
    /// What lists them.
    list: PathBuf,
    take: Option<TakeRef>,
    cameras: BTreeMap<String, Camera>,
}

struct Camera {
    size: [u32; 2],
    /// Per frame its image.
    paths: BTreeMap<i64, PathBuf>,
}

/// The cameras, as pages see them.
#[derive(Serialize)]
pub(crate) struct Listed<'a> {
    take: Option<&'a TakeRef>,
    cameras: Vec<Shown<'a>>,
}

#[derive(Serialize)]
struct Shown<'a> {
    id: &'a str,
    size: [u32; 2],
    frames: Vec<i64>,
}

impl Images {
    pub(crate) fn open(bench: &Bench) -> anyhow::Result<Self> {
        let list = bench.find(IMAGES).context(
            "there are no images by frame yet\n  to do: just take TAKE makes them; then start the workbench with --run",
        )?;
        let folder = list.parent().unwrap_or(Path::new(""));
        let frames: Frames = artifact::read_document(&list)?;
        let camera = |(id, camera): (&String, &artifact::CameraFrames)| {
            let paths = camera.images().map(|(frame, name)| (frame, folder.join(name))).collect();
            (id.clone(), Camera { size: camera.image_size, paths })
        };
        let cameras = frames.cameras.iter().map(camera).collect();
        Ok(Self { list, take: frames.take, cameras })
    }

    /// What lists the images.
    pub(crate) fn list(&self) -> &Path {
        &self.list
    }

    pub(crate) fn cameras(&self) -> Listed<'_> {
        let frames = |camera: &Camera| camera.paths.keys().copied().collect();
        let cameras = self.cameras.iter();
        let cameras =
            cameras.map(|(id, camera)| Shown { id, size: camera.size, frames: frames(camera) }).collect();
        Listed { take: self.take.as_ref(), cameras }
    }

    /// Cameras.
    pub(crate) fn ids(&self) -> impl Iterator<Item = &String> {
        self.cameras.keys()
    }

    /// The first frame of a camera that has an image.
    pub(crate) fn first(&self, camera: &str) -> Option<i64> {
        self.cameras.get(camera)?.paths.keys().next().copied()
    }

    /// `<camera>/<frame>`.
    pub(crate) fn image(&self, asked: &str) -> Answer {
        let path = asked
            .rsplit_once('/')
            .and_then(|(camera, frame)| self.cameras.get(camera)?.paths.get(&frame.parse::<i64>().ok()?));
        let Some(path) = path else { return Err(Response::missing()) };
        let bytes = artifact::read_bytes(path).map_err(|error| Response::refused(422, &error.to_string()))?;
        Ok(Response::bytes("image/png", bytes))
    }
}
