//! What is to be drawn, read shot by shot: the rest mesh, poses, or frames of a sequence.

use anyhow::bail;
use artifact::{FrameRange, MeshRef, MeshSequence};
use mesh::Mesh;
use nalgebra::Point3;
use stage::Run;
use std::path::{Path, PathBuf};

type Points = Vec<Point3<f64>>;

/// Frames that are drawn when the user does not say which.
const FRAMES_DRAWN: usize = 9;

/// One thing to draw.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Shot {
    /// The rest mesh.
    Rest,
    /// A mesh file.
    Pose(PathBuf),
    /// A frame of the sequence.
    Frame(i64),
}

impl Shot {
    /// For captions; empty for the rest mesh.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Rest => String::new(),
            Self::Pose(path) => {
                path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
            }
            Self::Frame(frame) => format!("frame {frame}"),
        }
    }
}

/// The rest mesh that shots and references must fit.
pub(crate) struct Rest<'a> {
    pub(crate) path: &'a Path,
    pub(crate) mesh: &'a Mesh,
    pub(crate) reference: MeshRef,
}

impl Rest<'_> {
    fn pose(&self, path: &Path) -> anyhow::Result<Points> {
        let mesh = artifact::read_mesh(path, self.reference.unit)?;
        let (count, own) = (mesh.positions.len(), self.mesh.positions.len());
        if count != own {
            let rest = self.path.display();
            bail!(
                "{}: has {count} vertices, but {rest} has {own}\n  to do: give meshes with the same vertices",
                path.display()
            );
        }
        Ok(mesh.positions)
    }
}

/// Opens a sequence and checks that it fits the rest mesh.
pub(crate) fn open_sequence(
    run: &mut Run,
    role: &str,
    path: &Path,
    rest: &Rest,
) -> anyhow::Result<MeshSequence> {
    run.input(role, path)?;
    let sequence = MeshSequence::open(path, Some(rest.reference.unit))?;
    let (count, own) = (sequence.vertex_count(), rest.mesh.positions.len());
    if count != own {
        let (path, rest) = (path.display(), rest.path.display());
        bail!(
            "{path}: has {count} vertices, but {rest} has {own}\n  to do: give the mesh that the sequence was made for"
        );
    }
    if let Some(mismatch) = sequence.mesh().and_then(|mesh| mesh.mismatch(&rest.reference)) {
        run.warn(format!("{}: {mismatch}", path.display()));
    }
    if let Some(cache) = sequence.cache() {
        run.input(&format!("{role} cache"), cache)?;
    }
    Ok(sequence)
}

/// The frames that the user asked for, rising.
pub(crate) fn select(
    sequence: &MeshSequence,
    ranges: &[FrameRange],
    count: Option<u32>,
) -> anyhow::Result<Vec<i64>> {
    let frames = sequence.frames();
    for range in ranges {
        if !frames.iter().any(|&frame| range.contains(frame)) {
            let (first, last) = (frames[0], frames[frames.len() - 1]);
            let noun = if range.first == range.last { "frame" } else { "frames" };
            let what = format!("{noun} {range}");
            bail!("{}: has no {what}\n  to do: choose from {first} to {last}", sequence.path().display());
        }
    }
    let wanted = |frame: &i64| ranges.is_empty() || ranges.iter().any(|range| range.contains(*frame));
    let chosen: Vec<i64> = frames.iter().copied().filter(wanted).collect();
    let default = if ranges.is_empty() { FRAMES_DRAWN } else { chosen.len() };
    Ok(evenly(&chosen, count.map_or(default, |count| count as usize)))
}

/// `count` of the frames with even steps between, first and last among them.
fn evenly(frames: &[i64], count: usize) -> Vec<i64> {
    match count {
        _ if count >= frames.len() => frames.to_vec(),
        1 => vec![frames[frames.len() / 2]],
        _ => (0..count).map(|k| frames[(k * (frames.len() - 1) + (count - 1) / 2) / (count - 1)]).collect(),
    }
}

/// What errors are measured against.
pub(crate) enum Reference {
    /// One shape for all shots.
    Still(Points),
    /// The same frame of another sequence.
    Sequence(MeshSequence),
}

impl Reference {
    /// Opens a mesh or a sequence, by its ending.
    pub(crate) fn open(run: &mut Run, path: &Path, rest: &Rest) -> anyhow::Result<Self> {
        if path
            .extension()
            .is_some_and(|ending| ending.eq_ignore_ascii_case("pc2") || ending.eq_ignore_ascii_case("json"))
        {
            return open_sequence(run, "reference", path, rest).map(Self::Sequence);
        }
        run.input("reference", path)?;
        rest.pose(path).map(Self::Still)
    }
}

/// Where shots and references come from.
pub(crate) struct Source<'a> {
    pub(crate) rest: Rest<'a>,
    pub(crate) sequence: Option<MeshSequence>,
    pub(crate) reference: Option<Reference>,
}

impl Source<'_> {
    /// Passes every shot with its positions and those of the reference, one after the other.
    pub(crate) fn visit(
        &self,
        shots: &[Shot],
        mut visit: impl FnMut(&Shot, Points, Option<&[Point3<f64>]>) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let mut frames = self.sequence.as_ref().map(MeshSequence::cursor).transpose()?;
        let mut moving = match &self.reference {
            Some(Reference::Sequence(sequence)) => Some(sequence.cursor()?),
            _ => None,
        };
        for shot in shots {
            let positions = match (shot, &mut frames) {
                (Shot::Pose(path), _) => self.rest.pose(path)?,
                (Shot::Frame(frame), Some(cursor)) => cursor.read(*frame)?,
                _ => self.rest.mesh.positions.clone(),
            };
            let reference = match (&self.reference, &mut moving, shot) {
                (Some(Reference::Still(points)), ..) => Some(points.clone()),
                (_, Some(cursor), Shot::Frame(frame)) => Some(cursor.read(*frame)?),
                (Some(_), ..) => bail!(
                    "a sequence as --reference needs a --sequence with the same frames\n  to do: give it, or a mesh as --reference"
                ),
                _ => None,
            };
            visit(shot, positions, reference.as_deref())?;
        }
        Ok(())
    }
}
