//! What pages edit: drafts that outlive everything, and saves that lose nothing.
//!
//! A page hands over every change as a draft, `.workbench/draft/…`, which is the whole file as it will be. A save checks the draft as
//! the stages would, keeps what it replaces, `.workbench/previous/…`, and writes the file as `artifact` writes it. A draft and a save
//! say which version they are based on; if the file was changed by somebody else meanwhile, they are refused.

use super::{Answer, refused};
use artifact::{Labels, Landmarks, Staged, Unit, VertexSet, picks, picture};
use loopback::Response;
use serde::Serialize;
use std::path::{Path, PathBuf};
use workbench::{Document, Form};

/// Documents of a take's folder.
pub(crate) struct Documents {
    folder: PathBuf,
    /// Unit of the scan, which picks are in.
    unit: Option<Unit>,
}

/// What a page gets of a document.
#[derive(Serialize)]
struct Shown {
    /// Hash of the saved file; none if there is none.
    version: Option<String>,
    /// The saved file; of a picture only whether there is one.
    saved: Option<String>,
    /// What is not saved yet, if it is of this version.
    draft: Option<String>,
    /// A draft that was begun on another version, which somebody has replaced since.
    stale_draft: Option<String>,
}

#[derive(Serialize)]
struct Saved {
    version: Option<String>,
    /// Whether the file was written: one that says the same stays as it is.
    is_changed: bool,
}

impl Documents {
    pub(crate) fn new(folder: &Path, unit: Option<Unit>) -> Self {
        Self { folder: folder.to_path_buf(), unit }
    }

    /// A document, saved and draft.
    pub(crate) fn shown(&self, document: Document) -> Answer {
        let version = self.version(&document)?;
        let text = |path: PathBuf| match (path.exists(), document.form()) {
            (false, _) => Ok(None),
            (true, Form::Picture) => Ok(Some(String::new())),
            (true, _) => artifact::read_text(&path).map(Some).map_err(failed),
        };
        let saved = text(self.folder.join(document.path()))?;
        let draft = text(self.folder.join(document.draft()))?;
        let is_current = self.base(&document)? == version;
        let (draft, stale_draft) = if is_current { (draft, None) } else { (None, draft) };
        Ok(Response::json(&Shown { version, saved, draft, stale_draft }))
    }

    /// A picture: the draft, if there is one.
    pub(crate) fn picture(&self, document: Document) -> Answer {
        match self.latest(&document).map_err(failed)? {
            Some(bytes) if document.form() == Form::Picture => Ok(Response::bytes("image/png", bytes)),
            _ => Err(Response::missing()),
        }
    }

    /// The bytes as they are now, saved or not; none if there are none.
    pub(crate) fn latest(&self, document: &Document) -> artifact::Result<Option<Vec<u8>>> {
        let paths = [document.draft(), document.path()].map(|path| self.folder.join(path));
        paths.iter().find(|path| path.exists()).map(|path| artifact::read_bytes(path)).transpose()
    }

    /// Keeps what a page has so far.
    pub(crate) fn draft(&self, document: &Document, base: Option<&str>, bytes: &[u8]) -> Answer {
        let path = self.folder.join(document.draft());
        // Read together: a draft without its base would look stale, which loses nothing.
        let staged = [stage(&path, bytes)?, stage(&base_path(&path), base.unwrap_or("").as_bytes())?];
        staged.into_iter().try_for_each(publish)?;
        Ok(Response::done())
    }

    /// Makes the draft the file.
    pub(crate) fn save(&self, document: &Document, base: Option<&str>) -> Answer {
        let version = self.version(document)?;
        if version.as_deref() != base {
            return Err(Response::refused(
                409,
                "the file was changed by somebody else since this page read it",
            ));
        }
        let (path, draft) = (self.folder.join(document.path()), self.folder.join(document.draft()));
        if !draft.exists() {
            return Ok(Response::json(&Saved { version, is_changed: false }));
        }
        let staged = self.checked(document, &path, &draft).map_err(|error| refused(&error))?;
        let is_changed = staged.is_some();
        if let Some(staged) = staged {
            self.keep(document, &path)?;
            publish(staged)?;
        }
        self.forget(document)?;
        Ok(Response::json(&Saved { version: self.version(document)?, is_changed }))
    }

    /// Throws the draft away.
    pub(crate) fn discard(&self, document: &Document) -> Answer {
        self.forget(document)?;
        Ok(Response::done())
    }

    /// The file as it will be, if that is any different from what it is. The draft is read as the stages read the file.
    fn checked(&self, document: &Document, path: &Path, draft: &Path) -> anyhow::Result<Option<Staged>> {
        match document {
            Document::Labels => same_or_written::<Labels>(path, draft),
            Document::Landmarks(_) => same_or_written::<Landmarks>(path, draft),
            Document::Region(_) => same_or_written::<VertexSet>(path, draft),
            Document::Picks => {
                let unit = self.unit.unwrap_or(Unit::Mm);
                picks::read(draft, unit)?;
                copied(path, draft)
            }
            Document::Paint(_) | Document::Mask(_) => {
                let new = picture::read_marked(draft)?;
                // The same picture may be packed in many ways.
                let is_same = path.exists() && picture::read_marked(path).is_ok_and(|old| old == new);
                if is_same { Ok(None) } else { copied(path, draft) }
            }
            Document::Names | Document::Edits => copied(path, draft),
        }
    }

    /// Keeps the version that a save replaces.
    fn keep(&self, document: &Document, path: &Path) -> Result<(), Response> {
        if !path.exists() {
            return Ok(());
        }
        let bytes = artifact::read_bytes(path).map_err(failed)?;
        publish(stage(&self.folder.join(document.previous()), &bytes)?)
    }

    fn forget(&self, document: &Document) -> Result<(), Response> {
        let path = self.folder.join(document.draft());
        artifact::withdraw(&base_path(&path)).and_then(|()| artifact::withdraw(&path)).map_err(failed)
    }

    /// Hash of the saved file.
    fn version(&self, document: &Document) -> Result<Option<String>, Response> {
        let path = self.folder.join(document.path());
        path.exists().then(|| artifact::sha256(&path)).transpose().map_err(failed)
    }

    /// Which version the draft is based on.
    fn base(&self, document: &Document) -> Result<Option<String>, Response> {
        let path = base_path(&self.folder.join(document.draft()));
        let base = path.exists().then(|| artifact::read_text(&path)).transpose().map_err(failed)?;
        Ok(base.filter(|base| !base.is_empty()))
    }
}

/// What says which version a draft is based on.
fn base_path(draft: &Path) -> PathBuf {
    let mut name = draft.as_os_str().to_os_string();
    name.push(".base");
    name.into()
}

fn same_or_written<T: artifact::Document + PartialEq>(
    path: &Path,
    draft: &Path,
) -> anyhow::Result<Option<Staged>> {
    let new: T = artifact::read_document(draft)?;
    // A file that cannot be read is replaced; what it held is kept.
    let is_same = path.exists() && artifact::read_document::<T>(path).is_ok_and(|old| old == new);
    if is_same { Ok(None) } else { Ok(Some(artifact::write_document(path, &new)?)) }
}

fn copied(path: &Path, draft: &Path) -> anyhow::Result<Option<Staged>> {
    let bytes = artifact::read_bytes(draft)?;
    let is_same = path.exists() && artifact::read_bytes(path)? == bytes;
    if is_same { Ok(None) } else { Ok(Some(artifact::stage_bytes(path, &bytes)?)) }
}

fn stage(path: &Path, bytes: &[u8]) -> Result<Staged, Response> {
    artifact::stage_bytes(path, bytes).map_err(failed)
}

fn publish(staged: Staged) -> Result<(), Response> {
    staged.publish().map_err(failed)
}

/// What the disk would not do.
fn failed(error: artifact::Error) -> Response {
    Response::refused(507, &error.to_string())
}
