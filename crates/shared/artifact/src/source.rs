//! Inputs: whole files, standard input, and their hashes.

use crate::staged::is_standard_stream;
use crate::{Error, Result};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// All bytes of a file, or of standard input for `-`.
///
/// # Errors
/// If it cannot be read.
#[allow(clippy::disallowed_methods, reason = "this is the room where files are read")]
pub fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    let result = if is_standard_stream(path) {
        let mut bytes = Vec::new();
        std::io::stdin().lock().read_to_end(&mut bytes).map(|_| bytes)
    } else {
        std::fs::read(path)
    };
    result.map_err(|cause| Error::io(path, "read", &cause))
}

/// The text of a file: UTF-8, or else ISO 8859-1, in which many programs write names and comments. Binary data is
/// refused with its place.
///
/// # Errors
/// If it cannot be read or is not text.
pub fn read_text(path: &Path) -> Result<String> {
    text_of(path, read_bytes(path)?)
}

/// The text of a file of a format that must be UTF-8.
///
/// # Errors
/// If it cannot be read or is not UTF-8.
pub(crate) fn read_utf8(path: &Path) -> Result<String> {
    String::from_utf8(read_bytes(path)?)
        .map_err(|error| no_text(path, error.as_bytes(), error.utf8_error().valid_up_to()))
}

/// The text that bytes of a file are, as [`read_text`] reads it.
///
/// # Errors
/// If they are not text.
pub(crate) fn text_of(path: &Path, bytes: Vec<u8>) -> Result<String> {
    String::from_utf8(bytes).or_else(|error| {
        let bytes = error.as_bytes();
        match bytes.iter().any(is_binary) {
            true => Err(no_text(path, bytes, error.utf8_error().valid_up_to())),
            // ISO 8859-1: each byte is the character of that number.
            false => Ok(bytes.iter().map(|&byte| char::from(byte)).collect()),
        }
    })
}

/// Control characters that no text holds; blanks, line ends and form feeds are none of them.
fn is_binary(byte: &u8) -> bool {
    byte.is_ascii_control() && !matches!(byte, b'\t'..=b'\r')
}

fn no_text(path: &Path, bytes: &[u8], at: usize) -> Error {
    let line = bytes[..at].iter().filter(|&&byte| byte == b'\n').count() + 1;
    Error::new(path, "is not text (binary data)")
        .at(format!("line {line} (byte {at})"))
        .fix("check that this is the right file and that it was not cut or compressed")
}

/// Opens a file, or standard input for `-`, to be read line by line.
///
/// # Errors
/// If it cannot be opened.
#[allow(clippy::disallowed_methods, reason = "this is the room where files are read")]
pub(crate) fn open(path: &Path) -> Result<Box<dyn BufRead>> {
    if is_standard_stream(path) {
        return Ok(Box::new(BufReader::new(std::io::stdin())));
    }
    let file = File::open(path).map_err(|cause| Error::io(path, "read", &cause))?;
    Ok(Box::new(BufReader::with_capacity(1 << 20, file)))
}

/// SHA-256 of bytes, as 64 hexadecimal digits.
#[must_use]
pub fn sha256_of(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// SHA-256 of a file, as `sha256sum` prints it.
///
/// # Errors
/// If it cannot be read.
pub fn sha256(path: &Path) -> Result<String> {
    let mut reader = open(path)?;
    let mut digest = Sha256::new();
    loop {
        let block = reader.fill_buf().map_err(|cause| Error::io(path, "read", &cause))?;
        if block.is_empty() {
            return Ok(hex(&digest.finalize()));
        }
        digest.update(block);
        let used = block.len();
        reader.consume(used);
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The file's own name, without folders: what artifacts and side-cars may say of a path.
#[must_use]
pub fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// The file's ending in lower case, without the dot; empty where it has none.
pub(crate) fn ending(path: &Path) -> String {
    path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}
