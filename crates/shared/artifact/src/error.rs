//! The one error of this crate: which file, where in it, what is wrong, what to do.

use std::path::{Path, PathBuf};

/// A file could not be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{}", self.sentence())]
pub struct Error {
    /// The file, as the user named it; `-` for standard input or output.
    pub path: PathBuf,
    /// Where in the file, e.g. `line 12` or `frame 1001, marker lip_l`.
    pub place: Option<String>,
    /// What is wrong there.
    pub what: String,
    /// What the user can do about it.
    pub fix: Option<String>,
}

/// Results of this crate.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// An error about a whole file.
    #[must_use]
    pub fn new(path: &Path, what: impl Into<String>) -> Self {
        Self { path: path.to_path_buf(), place: None, what: what.into(), fix: None }
    }

    /// Names the place in the file.
    #[must_use]
    pub fn at(mut self, place: impl Into<String>) -> Self {
        self.place = Some(place.into());
        self
    }

    /// Says what to do.
    #[must_use]
    pub fn fix(mut self, fix: impl Into<String>) -> Self {
        self.fix = Some(fix.into());
        self
    }

    /// What the operating system said about a file.
    #[must_use]
    pub fn io(path: &Path, doing: &str, cause: &std::io::Error) -> Self {
        let error = Self::new(path, format!("cannot {doing}: {cause}"));
        match cause.kind() {
            std::io::ErrorKind::NotFound => {
                error.fix("check the path; the stage that writes this file may not have run")
            }
            std::io::ErrorKind::FileTooLarge | std::io::ErrorKind::QuotaExceeded => {
                error.fix("a limit of the system or a quota is reached: raise it, or write elsewhere")
            }
            std::io::ErrorKind::StorageFull => error.fix("the disk is full: free some space and run again"),
            std::io::ErrorKind::PermissionDenied => {
                error.fix("check the permissions of the file and its folder")
            }
            _ => error,
        }
    }

    fn sentence(&self) -> String {
        let place = self.place.as_ref().map(|place| format!(", {place}")).unwrap_or_default();
        let fix = self.fix.as_ref().map(|fix| format!("\n  to do: {fix}")).unwrap_or_default();
        format!("{}{place}: {}{fix}", self.path.display(), self.what)
    }
}

/// What is wrong with a value, before it is known which file it stands in.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Violation {
    /// Where in the value, e.g. `marker lip_l`.
    pub place: String,
    /// What is wrong there.
    pub what: String,
}

impl Violation {
    /// A violation at a place.
    #[must_use]
    pub fn new(place: impl Into<String>, what: impl Into<String>) -> Self {
        Self { place: place.into(), what: what.into() }
    }

    /// The same, in a file.
    #[must_use]
    pub fn in_file(self, path: &Path) -> Error {
        Error::new(path, self.what).at(self.place)
    }
}
