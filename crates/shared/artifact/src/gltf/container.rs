//! A glTF file in memory: its JSON, and the bytes of its buffers, wherever they lie.

use super::json::Root;
use crate::source::read_bytes;
use crate::{Error, Result};
use std::path::{Path, PathBuf};

/// Extensions that a file may require of its reader without changing what is read here.
const HARMLESS: [&str; 8] = [
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_materials_unlit",
    "KHR_texture_basisu",
    "KHR_lights_punctual",
    "EXT_texture_webp",
    "KHR_materials_specular",
    "KHR_materials_ior",
];

pub(super) struct File {
    pub(super) path: PathBuf,
    pub(super) root: Root,
    pub(super) buffers: Vec<Vec<u8>>,
}

impl File {
    pub(super) fn error(&self, place: impl Into<String>, what: impl Into<String>) -> Error {
        Error::new(&self.path, what).at(place)
    }

    /// An entry of one of the document's lists.
    pub(super) fn entry<'a, T>(&self, list: &'a [T], index: usize, thing: &str, by: &str) -> Result<&'a T> {
        list.get(index).ok_or_else(|| {
            self.error(by, format!("refers to {thing} {index}, but there are {}", list.len()))
                .fix("the file is damaged; export it again")
        })
    }
}

pub(super) fn open(path: &Path) -> Result<File> {
    let bytes = read_bytes(path)?;
    let (json, mut binary) = match bytes.starts_with(b"glTF") {
        true => chunks(path, &bytes)?,
        false => (bytes.as_slice(), None),
    };
    let root: Root = serde_json::from_slice(json).map_err(|error| {
        Error::new(path, format!("is no glTF: {error}")).fix("give a .glb or .gltf file of version 2")
    })?;
    if !root.asset.version.starts_with("2.") {
        let version = &root.asset.version;
        return Err(Error::new(path, format!("is no glTF 2 (its version is '{version}')"))
            .at("asset")
            .fix("export it as glTF 2.0"));
    }
    if let Some(name) = root.extensions_required.iter().find(|name| !HARMLESS.contains(&name.as_str())) {
        return Err(Error::new(path, format!("requires {name}, which is not read here"))
            .at("extensionsRequired")
            .fix("export it without compression"));
    }
    let buffers = root.buffers.iter().enumerate().map(|(number, buffer)| {
        let place = format!("buffer {number}");
        let bytes = match &buffer.uri {
            Some(uri) => resource(path, &place, uri)?,
            None => binary.take().ok_or_else(|| Error::new(path, "has no binary part").at(&place))?.to_vec(),
        };
        match bytes.len() >= buffer.byte_length {
            true => Ok(bytes),
            false => {
                Err(Error::new(path, format!("has {} bytes instead of {}", bytes.len(), buffer.byte_length))
                    .at(place)
                    .fix("the file was cut: copy or export it again"))
            }
        }
    });
    let buffers = buffers.collect::<Result<_>>()?;
    Ok(File { path: path.to_path_buf(), root, buffers })
}

/// The JSON and the binary chunk of a `.glb`.
fn chunks<'a>(path: &Path, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>)> {
    let cut = || Error::new(path, "is a GLB that was cut").fix("copy or export it again");
    let word = |at: usize| -> Result<usize> {
        let bytes = bytes.get(at..at + 4).ok_or_else(cut)?;
        Ok(bytes.iter().rev().fold(0, |word, byte| word << 8 | usize::from(*byte)))
    };
    if word(4)? != 2 {
        return Err(Error::new(path, format!("is a GLB of version {}, not 2", word(4)?)));
    }
    let (mut json, mut binary, mut at) = (None, None, 12);
    while at < bytes.len().min(word(8)?) {
        let (length, kind) = (word(at)?, word(at + 4)?);
        let chunk = bytes.get(at + 8..at + 8 + length).ok_or_else(cut)?;
        match kind {
            0x4e4f_534a => json = json.or(Some(chunk)),
            0x004e_4942 => binary = binary.or(Some(chunk)),
            _ => {}
        }
        at += 8 + length;
    }
    Ok((json.ok_or_else(cut)?, binary))
}

/// The bytes of a `data:` text, or of a file beside the document.
fn resource(path: &Path, place: &str, uri: &str) -> Result<Vec<u8>> {
    let Some(data) = uri.strip_prefix("data:") else {
        let beside = path.parent().unwrap_or(Path::new("")).join(unescaped(uri));
        return read_bytes(&beside);
    };
    let text = data.split_once(";base64,").map(|(_, text)| text);
    text.and_then(base64)
        .ok_or_else(|| Error::new(path, "its data: text is not base64").at(place).fix("export it as .glb"))
}

/// A name whose `%20` and the like are bytes again.
fn unescaped(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let (mut name, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while at < bytes.len() {
        let code =
            (bytes[at] == b'%').then(|| u8::from_str_radix(uri.get(at + 1..at + 3)?, 16).ok()).flatten();
        name.push(code.unwrap_or(bytes[at]));
        at += if code.is_some() { 3 } else { 1 };
    }
    String::from_utf8_lossy(&name).into_owned()
}

/// The bytes that a text of base64 stands for [RFC 4648]; none where it is not base64.
fn base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut count) = (0u32, 0);
    for letter in text.trim_end_matches('=').bytes() {
        let value = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        (bits, count) = (bits << 6 | u32::from(value), count + 6);
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
            bits &= (1 << count) - 1;
        }
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_the_rfc() {
        for (text, bytes) in
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9vYmE=", "fooba"), ("Zm9vYmFy", "foobar")]
        {
            assert_eq!(base64(text).as_deref(), Some(bytes.as_bytes()));
        }
        assert_eq!(base64("Zm*v"), None);
    }

    #[test]
    fn names_are_unescaped() {
        assert_eq!(unescaped("my%20head.bin"), "my head.bin");
        assert_eq!(unescaped("50%.bin"), "50%.bin");
    }
}
