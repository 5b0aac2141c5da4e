//! Files below one folder.

use crate::PathError;
use crate::path::is_name;
use std::path::{Path, PathBuf};

/// A folder below which files may be read and written, and nowhere else.
#[derive(Debug, Clone)]
pub struct Root(PathBuf);

impl Root {
    /// The root of a folder that is there.
    ///
    /// # Errors
    /// [`PathError::NoRoot`] if it is not.
    pub fn new(folder: &Path) -> Result<Self, PathError> {
        let found = folder.canonicalize().ok().filter(|folder| folder.is_dir());
        found.map(Self).ok_or_else(|| PathError::NoRoot { root: folder.display().to_string() })
    }

    /// The root itself.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.0
    }

    /// Where a file or folder of this path (names with `/` between) is. Symbolic links are followed as long as they stay below the
    /// root.
    ///
    /// # Errors
    /// [`PathError`] if it is malformed, leads out, or nothing is there.
    pub fn existing(&self, path: &str) -> Result<PathBuf, PathError> {
        let found = self.joined(path)?.canonicalize();
        let found = found.map_err(|_| PathError::Missing { path: path.to_string() })?;
        self.inside(found, path)
    }

    /// Where a file of this path would be written: its folder is there, and it is no link.
    ///
    /// # Errors
    /// [`PathError`] if it is malformed, leads out, or its folder is not there.
    pub fn target(&self, path: &str) -> Result<PathBuf, PathError> {
        let joined = self.joined(path)?;
        let malformed = || PathError::Malformed { path: path.to_string() };
        let (folder, name) = joined.parent().zip(joined.file_name()).ok_or_else(malformed)?;
        let folder = folder.canonicalize().map_err(|_| PathError::Missing { path: path.to_string() })?;
        let target = self.inside(folder, path)?.join(name);
        match target.symlink_metadata() {
            Ok(found) if found.is_symlink() => Err(PathError::Outside { path: path.to_string() }),
            Ok(found) if !found.is_file() => Err(malformed()),
            _ => Ok(target),
        }
    }

    fn joined(&self, path: &str) -> Result<PathBuf, PathError> {
        match path.split('/').all(is_name) {
            true => Ok(path.split('/').fold(self.0.clone(), |whole, name| whole.join(name))),
            false => Err(PathError::Malformed { path: path.to_string() }),
        }
    }

    fn inside(&self, found: PathBuf, path: &str) -> Result<PathBuf, PathError> {
        match found.starts_with(&self.0) {
            true => Ok(found),
            false => Err(PathError::Outside { path: path.to_string() }),
        }
    }
}
