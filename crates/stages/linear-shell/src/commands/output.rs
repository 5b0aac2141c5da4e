//! Sequences on disk: one vertex cache, or one mesh per frame.

use super::Arguments;
use super::arguments::Format;
use super::take::HandleTake;
use artifact::{Staged, Unit, pc2, usda};
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
    Usd(Box<usda::Writer>),
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
        let path = arguments.samples();
        let name = artifact::file_name(&path);
        let mut already = 0;
        let form = match arguments.format {
            Format::Pc2 => {
                let (vertices, start) = (rest.positions.len(), take.frames[0]);
                let (writer, samples) =
                    pc2::Writer::resumable(&path, vertices, start, key, arguments.resume)?;
                already = samples as usize;
                Form::Cache(writer)
            }
            Format::Usda => Form::Usd(Box::new(usda::Writer::create(
                &path,
                rest,
                unit,
                arguments.up(),
                take.header.rate,
            )?)),
            Format::Obj => Form::Meshes { folder: path, ending: "obj", rest: rest.clone() },
            Format::Ply => Form::Meshes { folder: path, ending: "ply", rest: rest.clone() },
            Format::Npy => Form::Fields { folder: path },
        };
        let mut output = Self { unit, name, already, form };
        if let Some(folder) = output.folder().map(Path::to_path_buf) {
            let same = arguments.resume && same_key(&folder, key);
            if !same {
                artifact::remove_frames(&folder, &output.name, output.ending())?;
            }
            let there = |frame: &&i64| same && output.frame_path(**frame).exists();
            output.already = take.frames.iter().take_while(there).count();
            artifact::stage_bytes(&key_path(&folder), key.as_bytes())?.publish()?;
        }
        Ok(output)
    }

    fn ending(&self) -> &'static str {
        match &self.form {
            Form::Meshes { ending, .. } => ending,
            _ => "npy",
        }
    }

    /// The folder of a sequence that has a file per frame.
    fn folder(&self) -> Option<&Path> {
        match &self.form {
            Form::Meshes { folder, .. } | Form::Fields { folder } => Some(folder),
            Form::Cache(_) | Form::Usd(_) => None,
        }
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
        let file = format!("{}.{frame:04}.{}", self.name, self.ending());
        self.folder().unwrap_or(Path::new("")).join(file)
    }

    /// Writes a frame: #V × 3 coordinates in the sequence's unit.
    pub(crate) fn write(&mut self, frame: i64, coordinates: &[f32]) -> artifact::Result<()> {
        let path = self.frame_path(frame);
        match &mut self.form {
            Form::Cache(writer) => writer.write(coordinates),
            Form::Usd(writer) => writer.write(frame, coordinates),
            Form::Meshes { rest, .. } => {
                let point = |c: &[f32]| Point3::from([c[0], c[1], c[2]].map(decimal));
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
            Form::Usd(writer) => Ok(vec![writer.finish()?]),
            Form::Meshes { .. } | Form::Fields { .. } => Ok(Vec::new()),
        }
    }
}

/// Whether the frames in a folder were made from the same inputs.
fn same_key(folder: &Path, key: &str) -> bool {
    artifact::read_text(&key_path(folder)).is_ok_and(|left| left == key)
}

fn key_path(folder: &Path) -> PathBuf {
    folder.join(".made-from")
}

/// The f64 that prints as shortly as the f32 it comes from.
fn decimal(x: f32) -> f64 {
    x.to_string().parse().unwrap_or_else(|_| f64::from(x))
}
