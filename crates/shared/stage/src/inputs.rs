//! Inputs that many stages share: the take manifest, and a mesh with a unit that somebody stated.

use crate::Run;
use anyhow::bail;
use artifact::{MarkerFrame, MarkerHeader, MeshRef, Stream, Take, TakeRef, Trajectories, Unit};
use mesh::Mesh;
use std::path::{Path, PathBuf};

/// Options of a stage that works on one mesh: its file, and who says its unit.
#[derive(Debug, Clone, clap::Args)]
pub struct MeshOptions {
    /// The mesh (.obj, .ply)
    #[arg(long, value_name = "FILE")]
    pub mesh: PathBuf,
    /// Unit of the mesh's coordinates
    #[arg(long, value_name = "mm|cm|m")]
    pub unit: Option<Unit>,
    /// Take manifest; says the mesh's unit too
    #[arg(long, value_name = "FILE")]
    pub take: Option<PathBuf>,
}

impl MeshOptions {
    /// Reads the mesh, in millimetres, and what refers to it.
    ///
    /// # Errors
    /// As [`Run::mesh`].
    pub fn read(&self, run: &mut Run) -> anyhow::Result<(Mesh, MeshRef)> {
        let take = self.take.as_deref().map(|path| load_take(run, path)).transpose()?;
        let by_take = take.map(|(take, _)| take.mesh_unit);
        run.mesh("mesh", &self.mesh, &[("--unit", self.unit), ("the take manifest", by_take)])
    }
}

impl Run {
    /// Reads a mesh, in millimetres, and what refers to it. `stated` are the units that were stated for it and by
    /// whom; see [`resolve_unit`].
    ///
    /// # Errors
    /// If no unit is stated, two disagree, or the mesh cannot be read.
    pub fn mesh(
        &mut self,
        role: &str,
        path: &Path,
        stated: &[(&str, Option<Unit>)],
    ) -> anyhow::Result<(Mesh, MeshRef)> {
        let unit = resolve_unit(path, stated)?;
        let mesh = artifact::read_mesh(path, unit)?;
        let file = self.input(role, path)?;
        let reference = MeshRef { file, unit, vertex_count: mesh.positions.len() };
        Ok((mesh, reference))
    }
}

impl Run {
    /// Reads a whole take's markers, in millimetres, in any format; what the reader had to let pass becomes warnings.
    /// `unit` is for formats that do not state theirs. Record the file with [`Run::input`].
    ///
    /// # Errors
    /// If the markers cannot be read.
    pub fn markers<S>(&mut self, path: &Path, unit: Option<Unit>) -> anyhow::Result<Trajectories>
    where
        S: Stream<Header = MarkerHeader, Frame = MarkerFrame>,
    {
        let (trajectories, warnings) = artifact::read_trajectories::<S>(path, unit)?;
        warnings.into_iter().for_each(|warning| self.warn(warning));
        Ok(trajectories)
    }
}

/// The one unit that was stated for a file's coordinates. Files like OBJ state none, and there is no default.
///
/// # Errors
/// If nobody stated a unit, or two statements disagree.
pub fn resolve_unit(path: &Path, stated: &[(&str, Option<Unit>)]) -> anyhow::Result<Unit> {
    let said: Vec<(&str, Unit)> =
        stated.iter().filter_map(|(by, unit)| unit.map(|unit| (*by, unit))).collect();
    let Some(&(by, unit)) = said.first() else {
        bail!("{}: its unit is not stated\n  to do: say --unit mm, --unit cm or --unit m", path.display());
    };
    match said.iter().find(|(_, other)| *other != unit) {
        Some((other_by, other)) => bail!(
            "{}: {by} says {unit}, but {other_by} says {other}\n  to do: find out which is right and state it once",
            path.display()
        ),
        None => Ok(unit),
    }
}

/// Reads a take manifest, and what refers to it.
///
/// # Errors
/// If it cannot be read.
pub fn load_take(run: &mut Run, path: &Path) -> anyhow::Result<(Take, TakeRef)> {
    let take: Take = artifact::read_document(path)?;
    let sha256 = run.input("take", path)?.sha256;
    let reference = TakeRef { take: take.take.clone(), session: take.session.clone(), sha256 };
    Ok((take, reference))
}
