//! What the tests of this crate share.
#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

use artifact::{FileRef, MeshRef, Unit};
use std::path::{Path, PathBuf};

/// A file of the repository, from its root.
pub(crate) fn in_repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..").join(path)
}

/// A frozen file.
pub(crate) fn fixture(path: &str) -> PathBuf {
    in_repository("fixtures/schema").join(path)
}

pub(crate) fn file_ref() -> FileRef {
    FileRef { name: "scan.obj".to_string(), sha256: artifact::sha256_of(b"scan") }
}

pub(crate) fn mesh_ref(vertex_count: usize) -> MeshRef {
    MeshRef { file: file_ref(), unit: Unit::Mm, vertex_count }
}

/// A folder of its own for each test, and a file in it.
pub(crate) struct Place(tempfile::TempDir);

impl Place {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// A file with these bytes.
    pub(crate) fn file(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }

    /// The names of all files, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = std::fs::read_dir(self.0.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }
}

pub(crate) fn bytes(path: &Path) -> Vec<u8> {
    std::fs::read(path).unwrap()
}

/// The message of an error, without the folder.
#[track_caller]
pub(crate) fn refusal<T>(result: artifact::Result<T>) -> String {
    let Err(mut error) = result else { panic!("this had to be refused") };
    error.path = artifact::file_name(&error.path).into();
    error.to_string()
}

/// That a message holds all these parts.
#[track_caller]
pub(crate) fn says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "'{part}' is missing in: {message}");
    }
}
