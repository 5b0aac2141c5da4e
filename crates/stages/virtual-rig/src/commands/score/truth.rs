//! The truth folder of a take.

use anyhow::bail;
use artifact::MeshRef;
use std::path::{Path, PathBuf};

/// A truth folder, and the take beside it.
pub(super) struct Truth {
    folder: PathBuf,
}

impl Truth {
    /// Refuses what is no folder.
    pub(super) fn open(folder: &Path) -> anyhow::Result<Self> {
        if !folder.is_dir() {
            bail!(
                "{}: is no folder\n  to do: make the take with `virtual-rig make --out DIR`, and say --truth DIR/truth",
                folder.display()
            );
        }
        Ok(Self { folder: folder.to_path_buf() })
    }

    /// Where a file or folder of the truth would be.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// A file of the truth; says how to come by one where it is not there.
    pub(super) fn file(&self, name: &str) -> anyhow::Result<PathBuf> {
        let path = self.path(name);
        match path.is_file() {
            true => Ok(path),
            false => Err(self.missing(&path, name)),
        }
    }

    /// That a file or folder of the truth is not there.
    pub(super) fn missing(&self, path: &Path, name: &str) -> anyhow::Error {
        let inner = self.folder.join("truth");
        let fix = match inner.join(name).exists() {
            true => format!("the truth is a folder within: say --truth {}", inner.display()),
            false => "make the take with `virtual-rig make --out DIR`, and say --truth DIR/truth".to_string(),
        };
        anyhow::anyhow!(
            "{}: is not there, and this kind is scored against it\n  to do: {fix}",
            path.display()
        )
    }

    /// The scan that the truth was made on: it stands in the take's folder beside the truth.
    pub(super) fn scan(&self, mesh: &MeshRef) -> anyhow::Result<PathBuf> {
        let take = match (self.folder.file_name(), self.folder.parent()) {
            (Some(_), Some(above)) => above.join("take"),
            _ => self.folder.join("../take"),
        };
        let path = take.join(&mesh.file.name);
        if !path.is_file() {
            bail!(
                "{}: is not there; the truth's surfaces are made on it\n  to do: keep the folders take/ and truth/ side by side, as `virtual-rig make` writes them",
                path.display()
            );
        }
        Ok(path)
    }
}
