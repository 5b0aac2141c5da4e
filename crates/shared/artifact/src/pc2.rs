//! PC2 (Point Cache 2), the vertex cache that Blender, 3ds Max, Maya and Houdini read.
//!
//! 32 bytes of header (`POINTCACHE2\0`, version 1, vertex count, start frame, sample rate, sample count; little
//! endian), then per sample #V × 3 float32. It states no unit: positions are in the unit of the rest mesh beside it.

use crate::source::open;
use crate::{Error, Result, Sink, Staged};
use std::io::{BufRead, Read, Write};
use std::path::{Path, PathBuf};

const MAGIC: &[u8; 12] = b"POINTCACHE2\0";
const HEADER_BYTES: u64 = 32;
/// Where the sample count stands.
const COUNT_OFFSET: u64 = 28;

/// Writes a cache sample by sample; memory does not grow with the samples.
pub struct Writer {
    sink: Sink,
    vertex_count: usize,
    sample_count: u32,
}

impl Writer {
    /// Starts a cache of `vertex_count` vertices whose first sample belongs to frame `start_frame`.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn create(path: &Path, vertex_count: usize, start_frame: i64) -> Result<Self> {
        let mut sink = Sink::create_seekable(path)?;
        sink.write_all(&header(vertex_count, start_frame))
            .map_err(|cause| Error::io(path, "write", &cause))?;
        Ok(Self { sink, vertex_count, sample_count: 0 })
    }

    /// Starts a cache that outlives an interrupted run as `<name>.partial`, or, with `resume`, continues the one that a
    /// run left. `key` says what the cache is made from; what was left by a run with another key is dropped. Also
    /// returns how many samples are there already.
    ///
    /// # Errors
    /// If the file cannot be read or written.
    pub fn resumable(
        path: &Path,
        vertex_count: usize,
        start_frame: i64,
        key: &str,
        resume: bool,
    ) -> Result<(Self, u32)> {
        let sample = sample_bytes(vertex_count);
        let (mut sink, kept) = Sink::resumable(path, key, resume, HEADER_BYTES, sample)?;
        if kept == 0 {
            sink.write_all(&header(vertex_count, start_frame))
                .map_err(|cause| Error::io(path, "write", &cause))?;
        }
        let sample_count = (kept.saturating_sub(HEADER_BYTES) / sample) as u32;
        Ok((Self { sink, vertex_count, sample_count }, sample_count))
    }

    /// Appends a sample: #V × 3 coordinates.
    ///
    /// # Errors
    /// If a coordinate is not finite or writing fails.
    ///
    /// # Panics
    /// If the count is not three per vertex: that is a bug of the caller.
    pub fn write(&mut self, coordinates: &[f32]) -> Result<()> {
        assert_eq!(coordinates.len(), self.vertex_count * 3, "a sample has three coordinates per vertex");
        check_finite(self.sink.path(), self.sample_count, coordinates)?;
        let mut bytes = Vec::with_capacity(3 * 4 * 4096);
        for block in coordinates.chunks(3 * 4096) {
            bytes.clear();
            block.iter().for_each(|x| bytes.extend_from_slice(&x.to_le_bytes()));
            self.sink.write_all(&bytes).map_err(|cause| self.sink.failed(&cause))?;
        }
        self.sample_count += 1;
        Ok(())
    }

    /// Completes the cache.
    ///
    /// # Errors
    /// If the rest cannot be written.
    pub fn finish(mut self) -> Result<Staged> {
        self.sink.patch(COUNT_OFFSET, &self.sample_count.to_le_bytes())?;
        self.sink.finish()
    }
}

fn header(vertex_count: usize, start_frame: i64) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    bytes.extend_from_slice(&1i32.to_le_bytes());
    bytes.extend_from_slice(&(vertex_count as i32).to_le_bytes());
    bytes.extend_from_slice(&(start_frame as f32).to_le_bytes());
    bytes.extend_from_slice(&1f32.to_le_bytes());
    bytes.extend_from_slice(&0u32.to_le_bytes());
    bytes
}

fn check_finite(path: &Path, sample: u32, coordinates: &[f32]) -> Result<()> {
    match coordinates.iter().position(|x| !x.is_finite()) {
        Some(at) => {
            Err(Error::new(path, "the position is not finite")
                .at(format!("sample {sample}, vertex {}", at / 3)))
        }
        None => Ok(()),
    }
}

fn sample_bytes(vertex_count: usize) -> u64 {
    vertex_count as u64 * 12
}

/// Reads a cache sample by sample.
pub struct Reader {
    path: PathBuf,
    bytes: Box<dyn BufRead>,
    vertex_count: usize,
    start_frame: i64,
    sample_count: u32,
    next: u32,
}

impl Reader {
    /// Opens a cache and checks its header against the size of the file.
    ///
    /// # Errors
    /// If it is no PC2, or its counts disagree with its size.
    #[allow(clippy::disallowed_methods, reason = "a reader asks for the size of its file")]
    pub fn open(path: &Path) -> Result<Self> {
        let mut bytes = open(path)?;
        let mut head = [0u8; HEADER_BYTES as usize];
        bytes.read_exact(&mut head).map_err(|_| {
            Error::new(path, "is shorter than a PC2 header (32 bytes)")
                .fix("the file was cut short; write it again")
        })?;
        if &head[..12] != MAGIC {
            return Err(Error::new(path, "is not a PC2 vertex cache").at("byte 0"));
        }
        let word = |at: usize| [head[at], head[at + 1], head[at + 2], head[at + 3]];
        let (version, vertices) = (i32::from_le_bytes(word(12)), i32::from_le_bytes(word(16)));
        let sample_count = u32::from_le_bytes(word(28));
        if version != 1 || vertices <= 0 {
            return Err(
                Error::new(path, format!("is PC2 version {version} with {vertices} vertices")).at("byte 12")
            );
        }
        // Any counts may stand in a file: their product need not fit 64 bits.
        let expected =
            u128::from(HEADER_BYTES) + u128::from(sample_count) * u128::from(sample_bytes(vertices as usize));
        let size = std::fs::metadata(path).map_err(|cause| Error::io(path, "read", &cause))?.len();
        if u128::from(size) != expected {
            let what = format!(
                "says {sample_count} samples of {vertices} vertices, {expected} bytes, but has {size}"
            );
            return Err(Error::new(path, what)
                .at("byte 28")
                .fix("the file was cut short or never finished; write it again"));
        }
        let start_frame = f32::from_le_bytes(word(20)) as i64;
        Ok(Self {
            path: path.to_path_buf(),
            bytes,
            vertex_count: vertices as usize,
            start_frame,
            sample_count,
            next: 0,
        })
    }

    /// Vertices per sample.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Samples in the file.
    #[must_use]
    pub fn sample_count(&self) -> u32 {
        self.sample_count
    }

    /// The frame that the first sample belongs to.
    #[must_use]
    pub fn start_frame(&self) -> i64 {
        self.start_frame
    }

    /// Refuses a cache that does not fit a rest mesh.
    ///
    /// # Errors
    /// If the vertex counts differ.
    pub fn check_vertex_count(&self, rest: &Path, vertex_count: usize) -> Result<()> {
        if self.vertex_count == vertex_count {
            return Ok(());
        }
        let what = format!("has {} vertices, but {} has {vertex_count}", self.vertex_count, rest.display());
        Err(Error::new(&self.path, what).fix("give the rest mesh that the cache was made for"))
    }

    /// The next sample, #V × 3 coordinates, or `None` after the last.
    ///
    /// # Errors
    /// If it cannot be read, or a coordinate is not finite.
    pub fn read(&mut self) -> Result<Option<Vec<f32>>> {
        if self.next == self.sample_count {
            return Ok(None);
        }
        let mut bytes = vec![0u8; self.vertex_count * 12];
        self.bytes
            .read_exact(&mut bytes)
            .map_err(|cause| Error::io(&self.path, "read", &cause).at(format!("sample {}", self.next)))?;
        let coordinates: Vec<f32> =
            bytes.chunks_exact(4).map(|x| f32::from_le_bytes([x[0], x[1], x[2], x[3]])).collect();
        check_finite(&self.path, self.next, &coordinates)?;
        self.next += 1;
        Ok(Some(coordinates))
    }

    /// Passes over samples without decoding them.
    ///
    /// # Errors
    /// If they cannot be read.
    pub fn skip(&mut self, samples: u32) -> Result<()> {
        let samples = samples.min(self.sample_count - self.next);
        let bytes = u64::from(samples) * sample_bytes(self.vertex_count);
        std::io::copy(&mut (&mut self.bytes).take(bytes), &mut std::io::sink())
            .map_err(|cause| Error::io(&self.path, "read", &cause).at(format!("sample {}", self.next)))?;
        self.next += samples;
        Ok(())
    }
}
