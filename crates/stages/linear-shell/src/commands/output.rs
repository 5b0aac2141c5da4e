//! Sequences on disk: one vertex cache, or one mesh per frame.

use super::Arguments;
use super::arguments::Format;
use super::take::HandleTake;
use anyhow::bail;
use artifact::{Staged, Unit, pc2};
use mesh::Mesh;
use nalgebra::Point3;
use std::path::{Path, PathBuf};

/// A sequence that is being written.
pub(crate) struct Output {
    unit: Unit,
    name: String,
    already: usize,
    form: Form,
}

enum Form {
    Cache(pc2::Writer),
    Meshes { folder: PathBuf, ending: &'static str, rest: Mesh },
    Fields { folder: PathBuf },
}

impl Output {
    /// Starts or continues a sequence beside its index. `key` says what it is made from.
    pub(crate) fn start(
        arguments: &Arguments,
        rest: &Mesh,
        unit: Unit,
        take: &HandleTake,
        key: &str,
    ) -> anyhow::Result<Self> {
        if arguments.resume && artifact::is_standard_stream(&arguments.handles) {
            bail!("--resume: handles from a pipe cannot be recognised again; give a file");
        }
        let path = match arguments.format {
            Format::Pc2 => arguments.out.with_extension("pc2"),
            Format::Obj | Format::Ply | Format::Npy => arguments.out.with_extension(""),
        };
        if path == arguments.out {
            bail!("{}: --out names the index; give it the ending .json", path.display());
        }
        let name = artifact::file_name(&path);
        let (form, already) = match arguments.format {
            Format::Pc2 => {
                let start = take.frames[0];
                let (writer, samples) =
                    pc2::Writer::resumable(&path, rest.positions.len(), start, key, arguments.resume)?;
                (Form::Cache(writer), samples as usize)
            }
            Format::Obj => (Form::Meshes { folder: path, ending: "obj", rest: rest.clone() }, 0),
            Format::Ply => (Form::Meshes { folder: path, ending: "ply", rest: rest.clone() }, 0),
            Format::Npy => (Form::Fields { folder: path }, 0),
        };
        let mut output = Self { unit, name, already, form };
        if arguments.resume && !matches!(output.form, Form::Cache(_)) {
            output.already =
                take.frames.iter().take_while(|&&frame| output.frame_path(frame).exists()).count();
        }
        Ok(output)
    }

    pub(crate) fn unit(&self) -> Unit {
        self.unit
    }

    /// File or folder name of the samples.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// How many frames an earlier run left.
    pub(crate) fn already(&self) -> usize {
        self.already
    }

    /// Whether the sequence holds displacement fields, not coordinates.
    pub(crate) fn wants_fields(&self) -> bool {
        matches!(self.form, Form::Fields { .. })
    }

    fn frame_path(&self, frame: i64) -> PathBuf {
        let (folder, ending) = match &self.form {
            Form::Meshes { folder, ending, .. } => (folder.as_path(), *ending),
            Form::Fields { folder } => (folder.as_path(), "npy"),
            Form::Cache(_) => (Path::new(""), "pc2"),
        };
        folder.join(format!("{}.{frame:04}.{ending}", self.name))
    }

    /// Writes a frame: #V × 3 coordinates in the sequence's unit.
    pub(crate) fn write(&mut self, frame: i64, coordinates: &[f32]) -> artifact::Result<()> {
        let path = self.frame_path(frame);
        match &mut self.form {
            Form::Cache(writer) => writer.write(coordinates),
            Form::Meshes { rest, .. } => {
                let point = |c: &[f32]| Point3::new(c[0].into(), c[1].into(), c[2].into());
                rest.positions = coordinates.chunks_exact(3).map(point).collect();
                // The coordinates are in the sequence's unit already.
                artifact::write_mesh(&path, rest, Unit::Mm)?.publish()
            }
            Form::Fields { .. } => {
                artifact::npy::write(&path, [coordinates.len() / 3, 3], coordinates)?.publish()
            }
        }
    }

    /// Writes a frame's displacement field: #V × 3, mm.
    pub(crate) fn write_field(&self, frame: i64, field: &[f64]) -> artifact::Result<()> {
        artifact::npy::write(&self.frame_path(frame), [field.len() / 3, 3], field)?.publish()
    }

    /// Completes the sequence.
    pub(crate) fn finish(self) -> artifact::Result<Vec<Staged>> {
        match self.form {
            Form::Cache(writer) => Ok(vec![writer.finish()?]),
            Form::Meshes { .. } | Form::Fields { .. } => Ok(Vec::new()),
        }
    }
}
