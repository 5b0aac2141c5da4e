//! 3D markers of a first pass, and the cameras that they are seen by again.

use anyhow::{Context, bail};
use artifact::{CameraRig, TakeRef, Trajectories, Trajectories3d};
use marker_track::{Hint, hints};
use stage::Run;
use std::collections::BTreeMap;
use std::path::Path;

/// The guide of a second pass.
pub(crate) struct Guide {
    trajectories: Trajectories,
    rig: CameraRig,
    path: Box<Path>,
    cameras: Box<Path>,
    /// Place of each frame.
    frames: BTreeMap<i64, usize>,
}

impl Guide {
    pub(crate) fn read(
        run: &mut Run,
        path: &Path,
        cameras: &Path,
        take: Option<&TakeRef>,
    ) -> anyhow::Result<Self> {
        let trajectories = Trajectories::read::<Trajectories3d>(path)?;
        run.input("guide", path)?;
        let rig: CameraRig = artifact::read_document(cameras)?;
        run.input("cameras", cameras)?;
        if let (Some(stated), Some(take)) = (&trajectories.header.take, take)
            && stated.sha256 != take.sha256
        {
            bail!(
                "{}: is of {stated}, but the images are of {take}\n  to do: give the guide of that take",
                path.display()
            );
        }
        let frames =
            trajectories.frames.iter().enumerate().map(|(index, frame)| (frame.frame, index)).collect();
        Ok(Self { trajectories, rig, path: path.into(), cameras: cameras.into(), frames })
    }

    pub(crate) fn markers(&self) -> &[String] {
        &self.trajectories.header.markers
    }

    /// Per marker of `markers` what the guide says of it in a camera's image of a frame.
    pub(crate) fn hints(
        &self,
        frame: i64,
        camera: &str,
        size: [u32; 2],
        markers: &[String],
    ) -> anyhow::Result<Option<Vec<Option<Hint>>>> {
        let rig = self.rig.cameras.get(camera).with_context(|| {
            format!("{}: has no camera {camera}, which has labels", self.cameras.display())
        })?;
        if rig.camera.image_size != size {
            let [width, height] = rig.camera.image_size;
            bail!(
                "{}, camera {camera}: is calibrated for {width} × {height} px, but its images have {} × {}\n  to do: find out which is right",
                self.cameras.display(),
                size[0],
                size[1]
            );
        }
        let Some(&index) = self.frames.get(&frame) else { return Ok(None) };
        let found = hints(&self.trajectories.frames[index].points, &rig.camera);
        let of = |id: &String| self.trajectories.marker(id).and_then(|marker| found[marker]);
        Ok(Some(markers.iter().map(of).collect()))
    }

    pub(crate) fn check_overlap(&self, numbers: &[i64]) -> anyhow::Result<()> {
        match numbers.iter().any(|number| self.frames.contains_key(number)) {
            true => Ok(()),
            false => bail!("{}: shares no frame with the images", self.path.display()),
        }
    }
}
