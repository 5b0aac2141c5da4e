//! An animated mesh, read frame by frame: a `large-scale` or `wrinkled` index with its cache, or a bare PC2 cache.

use crate::envelope::document_kind;
use crate::source::ending;
use crate::{Error, Kind, LargeScale, MeshRef, Result, SequenceForm, Unit, Wrinkled, pc2, read_document};
use nalgebra::Point3;
use std::path::{Path, PathBuf};

/// A mesh sequence on disk: which frames there are, and where. Reading takes the memory of one frame.
#[derive(Debug, Clone)]
pub struct MeshSequence {
    path: PathBuf,
    cache: PathBuf,
    frames: Vec<i64>,
    unit: Unit,
    vertex_count: usize,
    mesh: Option<MeshRef>,
}

impl MeshSequence {
    /// Opens an index (`.json`), or a bare cache (`.pc2`), whose samples are then numbered from its start frame on.
    /// A cache states no unit, so `unit` must; where an index states another one, it is refused.
    ///
    /// # Errors
    /// If a file cannot be read, no unit is stated or two disagree, or index and cache do not fit.
    pub fn open(path: &Path, unit: Option<Unit>) -> Result<Self> {
        match ending(path).as_str() {
            "pc2" => Self::bare(path, unit),
            "json" => Self::indexed(path, unit),
            _ => Err(Error::new(path, "has an ending that is no mesh sequence known here")
                .fix("use the .json index of a sequence, or a .pc2 cache")),
        }
    }

    fn bare(path: &Path, unit: Option<Unit>) -> Result<Self> {
        let reader = pc2::Reader::open(path)?;
        let Some(unit) = unit else {
            return Err(
                Error::new(path, "its unit is not stated").fix("say --unit mm, --unit cm or --unit m")
            );
        };
        let first = reader.start_frame();
        let frames = (first..first + i64::from(reader.sample_count())).collect();
        let (path, cache) = (path.to_path_buf(), path.to_path_buf());
        Self { path, cache, frames, unit, vertex_count: reader.vertex_count(), mesh: None }.checked()
    }

    fn indexed(path: &Path, unit: Option<Unit>) -> Result<Self> {
        let index = read_index(path)?;
        let stated = index.mesh.unit;
        if let Some(unit) = unit.filter(|&unit| unit != stated) {
            return Err(Error::new(path, format!("was made with its mesh in {stated}, not in {unit}"))
                .fix("find out which is right, and say it with --unit"));
        }
        if index.form != SequenceForm::Pc2 {
            let what = format!("is a sequence of {:?} samples; only PC2 caches are read back", index.form);
            return Err(Error::new(path, what).at("form").fix("make it again with --format pc2"));
        }
        let cache = path.with_file_name(&index.cache);
        let reader = pc2::Reader::open(&cache)?;
        reader.check_vertex_count(path, index.mesh.vertex_count)?;
        if reader.sample_count() as usize != index.frames.len() {
            let what = format!(
                "names {} frames, but {} holds {}",
                index.frames.len(),
                index.cache,
                reader.sample_count()
            );
            return Err(Error::new(path, what)
                .at("frames")
                .fix("one of the two was cut short or replaced; write both again"));
        }
        let vertex_count = index.mesh.vertex_count;
        Self {
            path: path.to_path_buf(),
            cache,
            frames: index.frames,
            unit: stated,
            vertex_count,
            mesh: Some(index.mesh),
        }
        .checked()
    }

    fn checked(self) -> Result<Self> {
        match self.frames.is_empty() {
            true => Err(Error::new(&self.path, "holds no frames")
                .fix("the stage that wrote it may have been cut off")),
            false => Ok(self),
        }
    }

    /// The file that was opened.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The cache, where it is another file.
    #[must_use]
    pub fn cache(&self) -> Option<&Path> {
        (self.cache != self.path).then_some(&self.cache)
    }

    /// Absolute frame numbers, rising; at least one.
    #[must_use]
    pub fn frames(&self) -> &[i64] {
        &self.frames
    }

    /// Vertices of every frame.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// The mesh that the sequence was made for, where an index says so.
    #[must_use]
    pub fn mesh(&self) -> Option<&MeshRef> {
        self.mesh.as_ref()
    }

    /// Starts reading.
    ///
    /// # Errors
    /// If the cache cannot be read.
    pub fn cursor(&self) -> Result<MeshCursor<'_>> {
        Ok(MeshCursor { sequence: self, reader: pc2::Reader::open(&self.cache)?, next: 0 })
    }
}

/// The index of a sequence of either kind.
fn read_index(path: &Path) -> Result<LargeScale> {
    match document_kind(path)?.as_deref() {
        Some(Wrinkled::NAME) => Ok(read_document::<Wrinkled>(path)?.0),
        _ => read_document(path),
    }
}

/// Reads a sequence from front to back.
pub struct MeshCursor<'a> {
    sequence: &'a MeshSequence,
    reader: pc2::Reader,
    next: u32,
}

impl MeshCursor<'_> {
    /// The positions of a frame, mm. Frames are asked for in rising order; those between are passed over.
    ///
    /// # Errors
    /// If the sequence has no such frame, it was passed already, cannot be read, or holds a position that is not finite.
    pub fn read(&mut self, frame: i64) -> Result<Vec<Point3<f64>>> {
        let sequence = self.sequence;
        let (first, last) = (sequence.frames[0], sequence.frames[sequence.frames.len() - 1]);
        let refuse = |what: &str| Error::new(&sequence.path, what).at(format!("frame {frame}"));
        let missing =
            || refuse("is not there").fix(format!("the sequence has frames from {first} to {last}"));
        let sample = sequence.frames.binary_search(&frame).map_err(|_| missing())? as u32;
        let ahead = sample.checked_sub(self.next).ok_or_else(|| refuse("was passed already"))?;
        self.reader.skip(ahead)?;
        let coordinates = self.reader.read()?.ok_or_else(missing)?;
        self.next = sample + 1;
        let in_mm = sequence.unit.in_mm();
        let points: Vec<Point3<f64>> = coordinates
            .chunks_exact(3)
            .map(|x| Point3::new(x[0], x[1], x[2]).cast::<f64>() * in_mm)
            .collect();
        match points.iter().position(|point| point.iter().any(|x| !x.is_finite())) {
            Some(vertex) => Err(Error::new(&sequence.cache, "the position is not finite")
                .at(format!("frame {frame}, vertex {vertex}"))),
            None => Ok(points),
        }
    }
}
