//! Elimination orders and response bases, kept by content: the same mesh and parameters find them again.

use super::Arguments;
use anyhow::{Context, bail};
use artifact::{FileRef, Handle, MeshRef, ResponseBasis, Staged};
use linear_shell::{Basis, Completion, Constraints, Params};
use operators::Ordering;
use serde_json::json;
use std::path::{Path, PathBuf};

pub(crate) struct Cache {
    folder: Option<PathBuf>,
    /// Names what the basis depends on: mesh, unit, handles, held vertices, parameters.
    key: String,
    /// Names what the order depends on: the mesh.
    mesh_key: String,
    mesh: MeshRef,
    handles: Vec<Handle>,
    parameters: serde_json::Value,
}

impl Cache {
    pub(crate) fn new(
        arguments: &Arguments,
        mesh: &MeshRef,
        handles: &[Handle],
        constraints: &Constraints,
        params: &Params,
    ) -> anyhow::Result<Self> {
        let mut parameters = serde_json::to_value(params)?;
        parameters["reference"] = serde_json::to_value(arguments.reference)?;
        let vertices = &constraints.handles;
        let content = json!(["basis 2", mesh.file.sha256, mesh.unit, vertices, constraints.held, parameters]);
        Ok(Self {
            folder: arguments.cache.clone(),
            key: artifact::sha256_of(content.to_string().as_bytes())[..24].to_string(),
            mesh_key: mesh.file.sha256[..24].to_string(),
            mesh: mesh.clone(),
            handles: handles.to_vec(),
            parameters,
        })
    }

    pub(crate) fn key(&self) -> &str {
        &self.key
    }

    fn basis_path(&self) -> Option<PathBuf> {
        self.folder.as_ref().map(|folder| folder.join(format!("{}.basis.json", self.key)))
    }

    fn ordering_path(&self) -> Option<PathBuf> {
        self.folder.as_ref().map(|folder| folder.join(format!("{}.order-2.npy", self.mesh_key)))
    }

    /// The kept basis, if there is one.
    pub(crate) fn basis(&self) -> anyhow::Result<Option<(Basis, Completion)>> {
        let Some(path) = self.basis_path().filter(|path| path.exists()) else { return Ok(None) };
        let header: ResponseBasis = artifact::read_document(&path)?;
        let array = path.with_file_name(&header.array.name);
        if artifact::sha256(&array)? != header.array.sha256 {
            bail!("{}: is not what was kept", array.display());
        }
        let ([rows, columns], values) = artifact::npy::read_f32(&array)?;
        if rows != self.mesh.vertex_count || columns != self.handles.len() {
            bail!("{}: is {rows} × {columns}", array.display());
        }
        Ok(Some((Basis::new(values, columns), Completion::new(&header.schur))))
    }

    pub(crate) fn keep_basis(&self, basis: &Basis, completion: &Completion) -> anyhow::Result<()> {
        let Some(path) = self.basis_path() else { return Ok(()) };
        let staged = self.write_basis(&path, basis, completion)?;
        Ok(staged.into_iter().try_for_each(Staged::publish)?)
    }

    /// Stages a basis under any name; the array before the header that refers to it.
    pub(crate) fn write_basis(
        &self,
        path: &Path,
        basis: &Basis,
        completion: &Completion,
    ) -> anyhow::Result<Vec<Staged>> {
        let array_path = path.with_extension("npy");
        if array_path == *path {
            bail!("{}: --basis names the header; give it the ending .json", path.display());
        }
        let array =
            artifact::npy::write(&array_path, [basis.vertex_count(), self.handles.len()], basis.values())?;
        let staged_at = array.temporary().context("a basis cannot be written to a pipe")?;
        let header = ResponseBasis {
            mesh: self.mesh.clone(),
            handles: self.handles.clone(),
            parameters: self.parameters.clone(),
            array: FileRef { name: artifact::file_name(&array_path), sha256: artifact::sha256(staged_at)? },
            schur: completion.rows(),
        };
        let header = artifact::write_document(path, &header)?;
        Ok(vec![array, header])
    }

    /// The kept elimination order, if there is one.
    pub(crate) fn ordering(&self) -> anyhow::Result<Option<Ordering>> {
        let Some(path) = self.ordering_path().filter(|path| path.exists()) else { return Ok(None) };
        let vertices = artifact::npy::read_u32(&path)?;
        let ordering = Ordering::from_saved(vertices, self.mesh.vertex_count)
            .with_context(|| path.display().to_string())?;
        Ok(Some(ordering))
    }

    pub(crate) fn keep_ordering(&self, ordering: &Ordering) -> anyhow::Result<()> {
        match self.ordering_path() {
            Some(path) => Ok(artifact::npy::write_u32(&path, ordering.vertices())?.publish()?),
            None => Ok(()),
        }
    }
}
