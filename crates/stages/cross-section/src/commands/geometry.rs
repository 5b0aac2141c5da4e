//! The skin without wrinkles in the world, frame by frame.

use anyhow::bail;
use artifact::{CameraRig, FrameReader, HeadPose, MeshCursor, MeshSequence, Unit, read_document};
use camera::fit_similarity;
use cross_section::Surface;
use mesh::vertex_normals;
use nalgebra::{Isometry3, Point3, Vector3};
use stage::Run;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Where the skin lies, so that tilt and curvature need not be guessed.
#[derive(clap::Args)]
pub(crate) struct GeometryOptions {
    /// The face without wrinkles in the space of the head: the scan, mapped back by `rbf-warp apply --inverse`
    #[arg(long, value_name = "FILE", requires_all = ["cameras", "head_pose"])]
    mesh: Option<PathBuf>,
    /// Unit of that mesh
    #[arg(long, value_name = "UNIT", requires = "mesh")]
    unit: Option<Unit>,
    /// The calibrated cameras (cameras)
    #[arg(long, value_name = "FILE", requires = "mesh")]
    cameras: Option<PathBuf>,
    /// Where the head is in each frame (head-pose)
    #[arg(long, value_name = "FILE", requires = "mesh")]
    head_pose: Option<PathBuf>,
    /// How the face moves without wrinkles (large-scale), of the same vertices [default: it keeps still]
    #[arg(long, value_name = "FILE", requires = "mesh")]
    large_scale: Option<PathBuf>,
}

/// What is known of the face.
pub(crate) struct Geometry {
    rig: CameraRig,
    triangles: Vec<[u32; 3]>,
    rest: Vec<Point3<f64>>,
    poses: BTreeMap<i64, Isometry3<f64>>,
    sequence: Option<MeshSequence>,
}

/// The face in the world in one frame.
pub(crate) struct Face {
    points: Vec<Point3<f64>>,
    normals: Vec<Vector3<f64>>,
}

impl GeometryOptions {
    /// What is given; none where nothing is.
    pub(crate) fn read(&self, run: &mut Run) -> anyhow::Result<Option<Geometry>> {
        let (Some(mesh), Some(cameras), Some(head_pose)) = (&self.mesh, &self.cameras, &self.head_pose)
        else {
            return Ok(None);
        };
        let (mesh, _) = run.mesh("mesh", mesh, &[("--unit", self.unit)])?;
        let rig = read_document::<CameraRig>(cameras)?;
        run.input("cameras", cameras)?;
        let reader = FrameReader::<HeadPose>::open(head_pose)?;
        run.input("head-pose", head_pose)?;
        let mut poses = BTreeMap::new();
        for frame in reader {
            let frame = frame?;
            poses.extend(frame.world_from_head.map(|pose| (frame.frame, pose)));
        }
        let sequence = match &self.large_scale {
            Some(path) => {
                let sequence = MeshSequence::open(path, None)?;
                run.input("large-scale", path)?;
                if sequence.vertex_count() != mesh.positions.len() {
                    bail!(
                        "{}: moves {} vertices, but the mesh has {}\n  to do: give the mesh that it was made for, mapped to the space of the head",
                        path.display(),
                        sequence.vertex_count(),
                        mesh.positions.len()
                    );
                }
                Some(sequence)
            }
            None => None,
        };
        let triangles = mesh.triangles();
        Ok(Some(Geometry { rig, triangles, rest: mesh.positions, poses, sequence }))
    }
}

impl Geometry {
    /// The face as a camera sees it; none where the rig lacks that camera.
    pub(crate) fn surface<'a>(&'a self, camera: &str, face: &'a Face) -> Option<Surface<'a>> {
        let camera = &self.rig.cameras.get(camera)?.camera;
        Some(Surface::new(camera, &face.points, &face.normals, &self.triangles))
    }

    /// Reads the motion from its start on.
    pub(crate) fn cursor(&self) -> anyhow::Result<Option<MeshCursor<'_>>> {
        Ok(self.sequence.as_ref().map(MeshSequence::cursor).transpose()?)
    }

    /// The face in a frame; none where the head's pose or the face is not known.
    pub(crate) fn face(
        &self,
        cursor: Option<&mut MeshCursor<'_>>,
        frame: i64,
    ) -> anyhow::Result<Option<Face>> {
        let Some(pose) = self.poses.get(&frame) else { return Ok(None) };
        let in_head = match (cursor, &self.sequence) {
            (Some(cursor), Some(sequence)) if sequence.frames().binary_search(&frame).is_ok() => {
                let moved = cursor.read(frame)?;
                // What the warp bends beyond a similarity is a millimetre over a face, and turns no normal by a degree.
                let head_from_face = fit_similarity(&moved, &self.rest, None)?;
                moved.iter().map(|point| head_from_face * point).collect()
            }
            (Some(_), Some(_)) => return Ok(None),
            _ => self.rest.clone(),
        };
        let points: Vec<Point3<f64>> = in_head.iter().map(|point| pose * point).collect();
        let normals = vertex_normals(&points, &self.triangles);
        Ok(Some(Face { points, normals }))
    }
}
