//! What lifting and drawing read alike: the animated face, and how it stands before the cameras.

use anyhow::bail;
use artifact::{
    CameraRig, FrameReader, HeadPose, Interpolant, MeshRef, MeshSequence, RigCamera, TakeRef, Unit, Warp,
};
use camera::Camera;
use mesh::Mesh;
use nalgebra::Isometry3;
use operators::{Inverse, InvertParams, RbfMap, RbfSum};
use stage::{Run, check_take};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use wrinkle_lift::{Moment, Spaces};

/// The animated face, and how it stands before the cameras.
#[derive(clap::Args)]
pub(crate) struct Options {
    /// Rest mesh
    #[arg(long, value_name = "FILE")]
    mesh: PathBuf,
    /// Unit of its coordinates: mm, cm or m
    #[arg(long)]
    unit: Option<Unit>,
    /// The mesh without wrinkles in all frames (large-scale)
    #[arg(long, value_name = "FILE")]
    large_scale: PathBuf,
    /// Warp from mocap space to face space (warp)
    #[arg(long, value_name = "FILE")]
    warp: PathBuf,
    /// Where the head is (head-pose)
    #[arg(long, value_name = "FILE")]
    head_pose: PathBuf,
    /// Calibrated cameras (cameras)
    #[arg(long, value_name = "FILE")]
    cameras: PathBuf,
}

/// The same, read.
pub(crate) struct Material {
    pub(crate) mesh: Mesh,
    pub(crate) reference: MeshRef,
    pub(crate) sequence: MeshSequence,
    pub(crate) spaces: Spaces,
    poses: BTreeMap<i64, Isometry3<f64>>,
    pub(crate) rig: BTreeMap<String, RigCamera>,
}

impl Options {
    /// Reads everything; `take`: the take that the wrinkles are of, if it is known.
    ///
    /// # Errors
    /// If a file cannot be read, or is of another mesh, take or session.
    pub(crate) fn read(&self, run: &mut Run, take: Option<&TakeRef>) -> anyhow::Result<Material> {
        let (mesh, reference) = run.mesh("mesh", &self.mesh, &[("--unit", self.unit)])?;
        let sequence = self.sequence(run, &mesh, &reference)?;
        let warp: Warp = artifact::read_document(&self.warp)?;
        run.input("warp", &self.warp)?;
        if let Some(mismatch) = warp.mesh.mismatch(&reference) {
            bail!("{}: {mismatch}\n  to do: fit the warp on this mesh", self.warp.display());
        }
        check_session(&self.warp, "warp", warp.take.as_ref(), take)?;
        let rig: CameraRig = artifact::read_document(&self.cameras)?;
        run.input("cameras", &self.cameras)?;
        if let Err(other) = check_session(&self.cameras, "calibration", rig.take.as_ref(), take) {
            run.warn(format!("{other}, unless no camera was touched between"));
        }
        let poses = self.poses(run, take)?;
        Ok(Material { mesh, reference, sequence, spaces: spaces(&warp), poses, rig: rig.cameras })
    }

    fn sequence(&self, run: &mut Run, mesh: &Mesh, reference: &MeshRef) -> anyhow::Result<MeshSequence> {
        let path = &self.large_scale;
        let sequence = MeshSequence::open(path, Some(reference.unit))?;
        run.input("large-scale", path)?;
        if let Some(cache) = sequence.cache() {
            run.input("large-scale cache", cache)?;
        }
        if let Some(mismatch) = sequence.mesh().and_then(|mesh| mesh.mismatch(reference)) {
            bail!("{}: {mismatch}\n  to do: give the mesh that the sequence was made for", path.display());
        }
        let (count, own) = (sequence.vertex_count(), mesh.positions.len());
        if count != own {
            bail!(
                "{}: has {count} vertices, but {} has {own}\n  to do: give the mesh that the sequence was made for",
                path.display(),
                self.mesh.display()
            );
        }
        Ok(sequence)
    }

    fn poses(&self, run: &mut Run, take: Option<&TakeRef>) -> anyhow::Result<BTreeMap<i64, Isometry3<f64>>> {
        let path = &self.head_pose;
        let reader = FrameReader::<HeadPose>::open(path)?;
        run.input("head-pose", path)?;
        check_take(run, path, reader.header().take.as_ref(), take)?;
        let mut poses = BTreeMap::new();
        for frame in reader {
            let frame = frame?;
            poses.extend(frame.world_from_head.map(|pose| (frame.frame, pose)));
        }
        match poses.is_empty() {
            true => bail!("{}: no frame has a pose\n  to do: run stabilize again", path.display()),
            false => Ok(poses),
        }
    }
}

/// Refuses what was made in another session: markers are painted anew, and cameras were moved.
fn check_session(
    path: &Path,
    what: &str,
    stated: Option<&TakeRef>,
    take: Option<&TakeRef>,
) -> anyhow::Result<()> {
    match (stated, take) {
        (Some(stated), Some(take)) if stated.session != take.session => bail!(
            "{}: is the {what} of session {}, {stated}, but the wrinkles are of session {}, {take}\n  to do: give the {what} of the same session",
            path.display(),
            stated.session,
            take.session
        ),
        _ => Ok(()),
    }
}

fn spaces(warp: &Warp) -> Spaces {
    let face_from_head = map_of(&warp.face_from_mocap);
    let backward = map_of(&warp.mocap_from_face);
    let head_from_face = Inverse::of(face_from_head.clone(), backward, InvertParams::default());
    Spaces { face_from_head, head_from_face }
}

fn map_of(interpolant: &Interpolant) -> RbfMap {
    let Interpolant { origin_mm, scale_mm, centers, weights, polynomial } = interpolant;
    RbfMap::new(&RbfSum { origin_mm: *origin_mm, scale_mm: *scale_mm, centers, weights, polynomial })
}

impl Material {
    /// Where the head is at a moment; none where a frame beside it has no pose.
    pub(crate) fn pose(&self, moment: Moment) -> Option<Isometry3<f64>> {
        let from = self.poses.get(&moment.from)?;
        match moment.share > 0.0 {
            true => moment.pose(from, self.poses.get(&(moment.from + 1))?),
            false => Some(*from),
        }
    }

    /// Whether the face is known at a moment.
    pub(crate) fn has_face(&self, moment: Moment) -> bool {
        moment.frames().all(|frame| self.sequence.frames().binary_search(&frame).is_ok())
    }

    /// The calibration of a camera.
    pub(crate) fn camera(&self, id: &str, named_by: &Path) -> anyhow::Result<&Camera> {
        let Some(found) = self.rig.get(id) else {
            let known = self.rig.keys().cloned().collect::<Vec<_>>().join(", ");
            bail!(
                "{}: camera {id} is not calibrated\n  to do: give cameras with it; there are {known}",
                named_by.display()
            );
        };
        Ok(&found.camera)
    }
}
