//! Takes on disk, for tests that run the program.

use super::{Points, face, normal3, rng};
use artifact::{
    Correspondence, FileRef, HeadTrajectories, MarkerFrame, MarkerHeader, MeshRef, Pair, SampleStatus,
    Trajectories, Unit,
};
use mesh::Mesh;
use std::path::{Path, PathBuf};

/// A folder with `scan.obj` (cm), `correspondence.json` and `head.jsonl` (frames 1001–1004).
pub(crate) struct Folder {
    pub(crate) root: tempfile::TempDir,
}

impl Folder {
    /// `markers` of the scan's 60 vertices carry a marker.
    pub(crate) fn new(markers: usize) -> Self {
        let folder = Self { root: tempfile::tempdir().unwrap() };
        let rng = &mut rng(5);
        let positions = face(60, rng);
        let triangles: Vec<[u32; 3]> = (0..58).map(|i| [i, i + 1, i + 2]).collect();
        let scan = Mesh::from_triangles(positions.iter().map(|&p| p.into()).collect(), &triangles);
        artifact::write_mesh(&folder.path("scan.obj"), &scan, Unit::Cm).unwrap().publish().unwrap();
        let scan = artifact::read_mesh(&folder.path("scan.obj"), Unit::Cm).unwrap();
        folder.write_correspondence(&scan.positions, markers);
        let turn = super::rotation(0.1, 0.2, -0.3);
        let frame = |number: i64| {
            let share = 1.5 * (number - 1002) as f64;
            // A smile against the scan, so that the warp is not rigid.
            let smile =
                |p: &nalgebra::Point3<f64>| nalgebra::Vector3::new(0.0, 2e-4 * p.x * p.x, 3e-4 * p.x * p.y);
            let moved = |p: &nalgebra::Point3<f64>| Some(turn * (p + smile(p) + normal3(rng, 0.3) * share));
            MarkerFrame {
                frame: number,
                points: scan.positions[..markers].iter().map(moved).collect(),
                status: vec![SampleStatus::Measured; markers],
            }
        };
        let frames = (1001..=1004).map(frame).collect();
        let header = MarkerHeader { unit: Unit::Mm, rate: None, markers: super::names(markers), take: None };
        folder.write_head("head.jsonl", &Trajectories { header, frames });
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    pub(crate) fn write_head(&self, name: &str, trajectories: &Trajectories) {
        trajectories.write::<HeadTrajectories>(&self.path(name)).unwrap().publish().unwrap();
    }

    fn write_correspondence(&self, positions: &Points, markers: usize) {
        let file = FileRef { name: "scan.obj".into(), sha256: sha256(&self.path("scan.obj")) };
        let pair = |(i, marker): (usize, String)| Pair {
            marker,
            vertex: i as u32,
            position_mm: positions[i].into(),
        };
        let pairs = super::names(markers).into_iter().enumerate().map(pair).collect();
        let mesh = MeshRef { file, unit: Unit::Cm, vertex_count: positions.len() };
        let correspondence = Correspondence { mesh, pairs };
        let path = self.path("correspondence.json");
        artifact::write_document(&path, &correspondence).unwrap().publish().unwrap();
    }

    /// Names of everything in the folder, hidden files too.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.root.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

fn sha256(path: &Path) -> String {
    artifact::sha256(path).unwrap()
}
