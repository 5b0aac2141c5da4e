//! What is to be drawn, read shot by shot: the rest mesh, poses, or frames of a sequence.

use anyhow::{Context, bail};
use artifact::{FrameRange, LargeScale, MeshRef, pc2};
use mesh::Mesh;
use nalgebra::Point3;
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

/// A vertex cache and the frame of every sample.
#[derive(Clone)]
pub(crate) struct Sequence {
    cache: PathBuf,
    named: PathBuf,
    frames: Vec<i64>,
    in_mm: f64,
}

impl Sequence {
    /// Opens an index (`.json`) or a bare cache (`.pc2`) and checks that it fits the rest mesh.
    pub(crate) fn open(run: &mut stage::Run, role: &str, path: &Path, rest: &Rest) -> anyhow::Result<Self> {
        run.input(role, path)?;
        let is_cache = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("pc2"));
        let sequence = match is_cache {
            true => Self::bare(path, rest)?,
            false => Self::indexed(run, role, path, rest)?,
        };
        let reader = pc2::Reader::open(&sequence.cache)?;
        reader.check_vertex_count(rest.path, rest.mesh.positions.len())?;
        let (samples, frames) = (reader.sample_count() as usize, sequence.frames.len());
        if samples != frames || frames == 0 {
            let cache = sequence.cache.display();
            bail!("{}: names {frames} frames, but {cache} holds {samples}", path.display());
        }
        Ok(sequence)
    }

    fn bare(path: &Path, rest: &Rest) -> anyhow::Result<Self> {
        let reader = pc2::Reader::open(path)?;
        let first = reader.start_frame();
        let frames = (first..first + i64::from(reader.sample_count())).collect();
        let (cache, named) = (path.to_path_buf(), path.to_path_buf());
        Ok(Self { cache, named, frames, in_mm: rest.reference.unit.in_mm() })
    }

    fn indexed(run: &mut stage::Run, role: &str, path: &Path, rest: &Rest) -> anyhow::Result<Self> {
        let index: LargeScale = artifact::read_document(path)?;
        let (stated, own) = (index.mesh.unit, rest.reference.unit);
        if stated != own {
            bail!(
                "{}: was made with the mesh in {stated}, not in {own}\n  to do: find out which is right and say it with --unit",
                path.display()
            );
        }
        if let Some(mismatch) = index.mesh.mismatch(&rest.reference) {
            run.warn(format!("{}: {mismatch}", path.display()));
        }
        let cache = path.with_file_name(&index.cache);
        run.input(&format!("{role} cache"), &cache)?;
        Ok(Self { cache, named: path.to_path_buf(), frames: index.frames, in_mm: stated.in_mm() })
    }

    /// The frames that the user asked for, rising.
    pub(crate) fn select(&self, ranges: &[FrameRange], count: Option<u32>) -> anyhow::Result<Vec<i64>> {
        for range in ranges {
            if !self.frames.iter().any(|&frame| range.contains(frame)) {
                let (first, last) = (self.frames[0], self.frames[self.frames.len() - 1]);
                let what = if range.first == range.last {
                    format!("frame {}", range.first)
                } else {
                    format!("frames {range}")
                };
                bail!("{}: has no {what}\n  to do: choose from {first} to {last}", self.named.display());
            }
        }
        let wanted = |frame: &i64| ranges.is_empty() || ranges.iter().any(|range| range.contains(*frame));
        let frames: Vec<i64> = self.frames.iter().copied().filter(wanted).collect();
        let default = if ranges.is_empty() { FRAMES_DRAWN } else { frames.len() };
        Ok(evenly(&frames, count.map_or(default, |count| count as usize)))
    }

    fn cursor(&self) -> anyhow::Result<Cursor<'_>> {
        Ok(Cursor { sequence: self, reader: pc2::Reader::open(&self.cache)?, next: 0 })
    }
}

/// `count` of the frames with even steps between, first and last among them.
fn evenly(frames: &[i64], count: usize) -> Vec<i64> {
    match count {
        _ if count >= frames.len() => frames.to_vec(),
        1 => vec![frames[frames.len() / 2]],
        _ => (0..count).map(|k| frames[(k * (frames.len() - 1) + (count - 1) / 2) / (count - 1)]).collect(),
    }
}

/// Reads a cache from front to back; only the frame that is asked for is in memory.
struct Cursor<'a> {
    sequence: &'a Sequence,
    reader: pc2::Reader,
    next: u32,
}

impl Cursor<'_> {
    /// The positions of a frame, mm. Frames must be asked for in rising order.
    fn read(&mut self, frame: i64) -> anyhow::Result<Points> {
        let sequence = self.sequence;
        let missing = || format!("{}: has no frame {frame}", sequence.named.display());
        let sample = sequence.frames.binary_search(&frame).ok().with_context(missing)? as u32;
        self.reader.skip(sample - self.next)?;
        let coordinates = self.reader.read()?.with_context(missing)?;
        self.next = sample + 1;
        let point = |x: &[f32]| Point3::new(x[0], x[1], x[2]).cast::<f64>() * sequence.in_mm;
        let points: Points = coordinates.chunks_exact(3).map(point).collect();
        match points.iter().position(|point| point.iter().any(|x| !x.is_finite())) {
            Some(vertex) => bail!(
                "{}, frame {frame}, vertex {vertex}: the position is not finite",
                sequence.cache.display()
            ),
            None => Ok(points),
        }
    }
}

/// What errors are measured against.
pub(crate) enum Reference {
    /// One shape for all shots.
    Still(Points),
    /// The same frame of another sequence.
    Sequence(Sequence),
}

impl Reference {
    /// Opens a mesh or a sequence, by its ending.
    pub(crate) fn open(run: &mut stage::Run, path: &Path, rest: &Rest) -> anyhow::Result<Self> {
        if path
            .extension()
            .is_some_and(|ending| ending.eq_ignore_ascii_case("pc2") || ending.eq_ignore_ascii_case("json"))
        {
            return Sequence::open(run, "reference", path, rest).map(Self::Sequence);
        }
        run.input("reference", path)?;
        rest.pose(path).map(Self::Still)
    }
}

/// Where shots and references come from.
pub(crate) struct Source<'a> {
    pub(crate) rest: Rest<'a>,
    pub(crate) sequence: Option<Sequence>,
    pub(crate) reference: Option<Reference>,
}

impl Source<'_> {
    /// Passes every shot with its positions and those of the reference, one after the other.
    pub(crate) fn visit(
        &self,
        shots: &[Shot],
        mut visit: impl FnMut(&Shot, Points, Option<&[Point3<f64>]>) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        let mut frames = self.sequence.as_ref().map(Sequence::cursor).transpose()?;
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
                (Some(_), ..) => bail!("a sequence as --reference needs a --sequence with the same frames"),
                _ => None,
            };
            visit(shot, positions, reference.as_deref())?;
        }
        Ok(())
    }
}
