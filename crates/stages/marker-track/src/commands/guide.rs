//! 3D markers of a first pass, and the cameras that they are seen by again.

use anyhow::{Context, bail};
use artifact::{
    CameraRig, FrameReader, MeasuredTrajectories, Sample2d, TakeRef, TrackState, Tracks2dFrame,
    Tracks2dHeader, Trajectories,
};
use marker_track::{Hint, bears_out, drop_untied, hints};
use stage::{Run, check_take};
use std::collections::BTreeMap;
use std::path::Path;

/// Fewer markers do not tell whether a guide fits.
const FEWEST: usize = 3;

/// Per camera and frame, which of the guide's markers other cameras bear out.
type BorneOut = BTreeMap<String, Vec<Vec<bool>>>;

/// The guide of a second pass.
pub(crate) struct Guide {
    trajectories: Trajectories,
    rig: CameraRig,
    path: Box<Path>,
    cameras: Box<Path>,
    /// Place of each frame.
    frames: BTreeMap<i64, usize>,
    borne_out: BorneOut,
    /// How far from the guide a dot may be, px.
    gate_px: f64,
}

impl Guide {
    pub(crate) fn read(
        run: &mut Run,
        path: &Path,
        cameras: &Path,
        take: Option<&TakeRef>,
        gate_px: f64,
    ) -> anyhow::Result<Self> {
        let rig: CameraRig = artifact::read_document(cameras)?;
        let (trajectories, borne_out) = read(path, &rig, gate_px)?;
        run.input("guide", path)?;
        run.input("cameras", cameras)?;
        check_take(run, path, trajectories.header.take.as_ref(), take)?;
        let frames =
            trajectories.frames.iter().enumerate().map(|(index, frame)| (frame.frame, index)).collect();
        Ok(Self { trajectories, rig, path: path.into(), cameras: cameras.into(), frames, borne_out, gate_px })
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
            format!(
                "{}: has no camera {camera}, which has labels\n  to do: calibrate it, or take its labels out",
                self.cameras.display()
            )
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

    /// Takes samples back that neither other cameras nor time bear out ([`drop_untied`]), in place, and returns how many.
    pub(crate) fn drop_untied(
        &self,
        header: &Tracks2dHeader,
        frames: &mut [Tracks2dFrame],
        labelled: usize,
    ) -> usize {
        let places: Vec<Option<usize>> =
            header.markers.iter().map(|id| self.trajectories.marker(id)).collect();
        let of_camera = |frame: i64, id: &String| -> Vec<bool> {
            let said = self.frames.get(&frame).and_then(|&index| self.borne_out.get(id)?.get(index));
            places.iter().map(|place| said.zip(*place).is_some_and(|(said, at)| said[at])).collect()
        };
        let of_frame = |frame: &Tracks2dFrame| -> Vec<Vec<bool>> {
            header.cameras.iter().map(|id| of_camera(frame.frame, id)).collect()
        };
        let borne_out: Vec<Vec<Vec<bool>>> = frames.iter().map(of_frame).collect();
        drop_untied(frames, &borne_out, labelled, self.gate_px)
    }

    /// Whether the camera is calibrated.
    pub(crate) fn has_camera(&self, camera: &str) -> bool {
        self.rig.cameras.contains_key(camera)
    }

    /// The median distance from what a camera sees of markers to where the guide puts them, px: infinite where it puts most of
    /// them outside the image. None where the guide has fewer than three of them in that frame.
    pub(crate) fn median_off(
        &self,
        frame: i64,
        markers: &[String],
        seen: &[Option<Sample2d>],
        hints: &[Option<Hint>],
    ) -> Option<f64> {
        let points = &self.trajectories.frames[*self.frames.get(&frame)?].points;
        let known = |id: &String| self.trajectories.marker(id).is_some_and(|marker| points[marker].is_some());
        let off = |((id, sample), hint): ((&String, &Option<Sample2d>), &Option<Hint>)| {
            let at = sample.filter(|sample| sample.state == TrackState::Seen && known(id))?.at;
            Some(hint.map_or(f64::INFINITY, |hint| (at.x - hint.at[0]).hypot(at.y - hint.at[1])))
        };
        let mut off: Vec<f64> = markers.iter().zip(seen).zip(hints).filter_map(off).collect();
        off.sort_by(f64::total_cmp);
        (off.len() >= FEWEST).then(|| off[off.len() / 2])
    }

    /// The file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    pub(crate) fn check_overlap(&self, numbers: &[i64]) -> anyhow::Result<()> {
        match numbers.iter().any(|number| self.frames.contains_key(number)) {
            true => Ok(()),
            false => bail!("{}: shares no frame with the images", self.path.display()),
        }
    }
}

/// The markers, and per camera and frame which of them other cameras bear out.
fn read(path: &Path, rig: &CameraRig, gate_px: f64) -> anyhow::Result<(Trajectories, BorneOut)> {
    let reader = FrameReader::<MeasuredTrajectories>::open(path)?;
    let header = reader.header().clone();
    let mut frames = Vec::new();
    let mut borne_out = BorneOut::new();
    for frame in reader {
        let frame = frame?;
        for (id, camera) in &rig.cameras {
            let said = bears_out(&frame, id, &camera.camera, gate_px);
            borne_out.entry(id.clone()).or_default().push(said);
        }
        frames.push(frame.markers);
    }
    if frames.is_empty() {
        bail!("{}: holds no frames\n  to do: the stage that wrote it may have been cut off", path.display());
    }
    Ok((Trajectories { header, frames }, borne_out))
}
