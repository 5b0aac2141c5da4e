//! What the tests of this crate share.
#![allow(dead_code, reason = "each test file uses its own part")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

use artifact::{
    Document, FileRef, FrameReader, FrameWriter, MeshRef, Staged, Stream, Unit, read_document, write_document,
};
use proptest::prelude::*;
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

/// The text of a frozen file.
pub(crate) fn text(path: &str) -> String {
    std::fs::read_to_string(fixture(path)).unwrap()
}

/// What the reader of documents says about a text.
pub(crate) fn document_refusal<T: Document>(text: &str) -> String {
    refusal(read_document::<T>(&Place::new().file("a.json", text)))
}

/// What the reader of frames says, sooner or later.
pub(crate) fn stream_refusal<S: Stream>(text: &str) -> String {
    let place = Place::new();
    let path = place.file("a.jsonl", text);
    refusal(FrameReader::<S>::open(&path).and_then(|reader| reader.collect::<artifact::Result<Vec<_>>>()))
}

/// What a writer of frames says about a frame.
pub(crate) fn frame_refusal<S: Stream>(header: S::Header, frame: &S::Frame) -> String {
    let place = Place::new();
    let mut writer = FrameWriter::<S>::create(&place.path("a.jsonl"), header).unwrap();
    let message = refusal(writer.write(frame));
    drop(writer);
    assert!(place.names().is_empty(), "{:?}", place.names());
    message
}

/// What the writer of documents says about a document.
pub(crate) fn written_refusal<T: Document>(document: &T) -> String {
    let place = Place::new();
    let message = refusal(write_document(&place.path("a.json"), document));
    assert!(place.names().is_empty());
    message
}

/// Any finite number.
pub(crate) fn any_number() -> impl Strategy<Value = f64> {
    use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    NORMAL | SUBNORMAL | ZERO | POSITIVE | NEGATIVE
}

/// What a writer of frames says about a header.
pub(crate) fn header_refusal<S: Stream>(header: S::Header) -> String {
    let place = Place::new();
    let message = refusal(FrameWriter::<S>::create(&place.path("a.jsonl"), header).map(drop));
    assert!(place.names().is_empty(), "{:?}", place.names());
    message
}

/// A document, written and read again.
pub(crate) fn document_again<T: Document>(document: &T) -> T {
    let place = Place::new();
    write_document(&place.path("a.json"), document).and_then(Staged::publish).unwrap();
    read_document(&place.path("a.json")).unwrap()
}

/// Frames, written and read again.
pub(crate) fn stream_again<S: Stream>(header: &S::Header, frames: &[S::Frame]) -> Vec<S::Frame> {
    let place = Place::new();
    let path = place.path("a.jsonl");
    let mut writer = FrameWriter::<S>::create(&path, header.clone()).unwrap();
    frames.iter().for_each(|frame| writer.write(frame).unwrap());
    writer.finish().and_then(Staged::publish).unwrap();
    FrameReader::<S>::open(&path).unwrap().map(Result::unwrap).collect()
}
