//! Whether a file is all there: containers say how long their parts are.
//!
//! FFmpeg decodes a frame of which only the first half is there into a picture whose second half is garbage, and says
//! nothing. So we look ourselves where the file was cut.

use std::io::{BufReader, Read, Result, Seek, SeekFrom};

/// Where a file ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    /// Where it should, or the container does not tell.
    AsItShould,
    /// Before a part that it says it has; so many frames are whole, if known.
    Early { whole_frames: Option<u64> },
}

/// Looks at a file's parts.
pub(crate) fn ending(file: impl Read + Seek) -> Result<Ending> {
    let mut file = BufReader::new(file);
    let length = file.seek(SeekFrom::End(0))?;
    file.rewind()?;
    let mut head = [0; 8];
    if file.read_exact(&mut head).is_err() {
        return Ok(Ending::AsItShould);
    }
    file.rewind()?;
    match (&head[..4], &head[4..]) {
        (b"RIFF", _) => riff(&mut file, length),
        (_, b"ftyp") => boxes(&mut file, length),
        _ => Ok(Ending::AsItShould),
    }
}

/// AVI: chunks of a name, a size and so many bytes, padded to even; `RIFF` and `LIST` hold a name and chunks. Frames of
/// the first stream are called `00dc` or `00db`.
fn riff(file: &mut BufReader<impl Read + Seek>, length: u64) -> Result<Ending> {
    let (mut at, mut frames) = (0, 0);
    let mut early = false;
    while let Some([name, size]) = words(file)? {
        let is_list = &name == b"RIFF" || &name == b"LIST";
        let size = u64::from(u32::from_le_bytes(size));
        let is_there = at + 8 + size <= length;
        early |= !is_there;
        if is_there && is_frame(name) {
            frames += 1;
        }
        let step = if is_list { 4 } else { size + size % 2 };
        at += 8 + step;
        if at > length {
            break;
        }
        file.seek_relative(i64::try_from(step).unwrap_or(i64::MAX))?;
    }
    Ok(if early { Ending::Early { whole_frames: Some(frames) } } else { Ending::AsItShould })
}

fn is_frame([a, b, c, d]: [u8; 4]) -> bool {
    a.is_ascii_digit() && b.is_ascii_digit() && c == b'd' && (d == b'c' || d == b'b')
}

/// MP4: boxes of a size (their own 8 bytes included), a name and bytes; size 1 means that a longer size follows, 0 that
/// the box goes on to the end.
fn boxes(file: &mut BufReader<impl Read + Seek>, length: u64) -> Result<Ending> {
    let mut at = 0;
    while let Some([size, _name]) = words(file)? {
        let (size, read) = match u32::from_be_bytes(size) {
            0 => return Ok(Ending::AsItShould),
            1 => {
                let mut long = [0; 8];
                if file.read_exact(&mut long).is_err() {
                    break;
                }
                (u64::from_be_bytes(long), 16)
            }
            size => (u64::from(size), 8),
        };
        if size < read {
            return Ok(Ending::AsItShould);
        }
        if at + size > length {
            return Ok(Ending::Early { whole_frames: None });
        }
        at += size;
        file.seek_relative(i64::try_from(size - read).unwrap_or(i64::MAX))?;
    }
    Ok(Ending::AsItShould)
}

/// The next two words of four bytes; none at the end.
fn words(file: &mut impl Read) -> Result<Option<[[u8; 4]; 2]>> {
    let mut words = [[0; 4]; 2];
    for word in &mut words {
        match file.read_exact(word) {
            Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => return Ok(None),
            other => other?,
        }
    }
    Ok(Some(words))
}
