//! Whether a file is all there: containers say how long their parts are.
//!
//! FFmpeg decodes a frame of which only the first half is there into a picture whose second half is garbage, and says
//! nothing. So we look ourselves where the file was cut.

use std::io::{BufReader, Read, Result, Seek, SeekFrom};

/// What a container says of its frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Parts {
    /// Where the file ends.
    pub(crate) ending: Ending,
    pub(crate) count: Count,
}

/// Where a file ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    /// Where it should, or the container does not tell.
    AsItShould,
    /// Before a part that it says it has.
    Early(Whole),
}

/// Which frames of a cut file are whole.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Whole {
    /// So many.
    First(u64),
    /// All that decode but the last one.
    AllButLast,
    /// All that decode.
    All,
}

/// What is known of the number of frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Count {
    /// Counted here; empty frames, which stand for lost ones in AVI files, left out.
    Counted(u64),
    /// The container has a list of its frames.
    Listed,
    /// Length times rate, and the length may be that of a sound track.
    Estimated,
}

impl Parts {
    fn whole(count: Count) -> Self {
        Self { ending: Ending::AsItShould, count }
    }
}

/// Looks at a file's parts.
pub(crate) fn parts(file: impl Read + Seek) -> Result<Parts> {
    let mut file = BufReader::new(file);
    let length = file.seek(SeekFrom::End(0))?;
    file.rewind()?;
    let mut head = [0; 8];
    if file.read_exact(&mut head).is_err() {
        return Ok(Parts::whole(Count::Estimated));
    }
    file.rewind()?;
    match (&head[..4], &head[4..]) {
        (b"RIFF", _) => riff(&mut file, length),
        (_, b"ftyp" | b"moov" | b"mdat" | b"wide" | b"free") => boxes(&mut file, length),
        ([0x1a, 0x45, 0xdf, 0xa3], _) => matroska(&mut file, length),
        _ => Ok(Parts::whole(Count::Estimated)),
    }
}

/// AVI: chunks of a name, a size and so many bytes, padded to even; `RIFF` and `LIST` hold a name and chunks. Frames of
/// the first stream are called `00dc` or `00db`.
fn riff(file: &mut BufReader<impl Read + Seek>, length: u64) -> Result<Parts> {
    let (mut at, mut frames) = (0, 0);
    let mut early = false;
    while let Some([name, size]) = words(file)? {
        let is_list = &name == b"RIFF" || &name == b"LIST";
        let size = u64::from(u32::from_le_bytes(size));
        let is_there = at + 8 + size <= length;
        early |= !is_there;
        if is_there && size > 0 && is_frame(name) {
            frames += 1;
        }
        let step = if is_list { 4 } else { size + size % 2 };
        at += 8 + step;
        if at > length {
            break;
        }
        file.seek_relative(i64::try_from(step).unwrap_or(i64::MAX))?;
    }
    Ok(match early {
        true => Parts { ending: Ending::Early(Whole::First(frames)), count: Count::Listed },
        false => Parts::whole(Count::Counted(frames)),
    })
}

fn is_frame([a, b, c, d]: [u8; 4]) -> bool {
    a.is_ascii_digit() && b.is_ascii_digit() && c == b'd' && (d == b'c' || d == b'b')
}

/// MP4: boxes of a size (their own 8 bytes included), a name and bytes; size 1 means that a longer size follows, 0 that
/// the box goes on to the end.
fn boxes(file: &mut BufReader<impl Read + Seek>, length: u64) -> Result<Parts> {
    let (mut at, mut count) = (0, Count::Listed);
    while let Some([size, name]) = words(file)? {
        if &name == b"moof" {
            // Written piece by piece: each piece lists its own frames only.
            count = Count::Estimated;
        }
        let (size, read) = match u32::from_be_bytes(size) {
            0 => break,
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
            break;
        }
        if at + size > length {
            return Ok(Parts { ending: Ending::Early(Whole::AllButLast), count });
        }
        at += size;
        file.seek_relative(i64::try_from(size - read).unwrap_or(i64::MAX))?;
    }
    Ok(Parts::whole(count))
}

/// Matroska: elements of an id, a size and so many bytes; the segment holds all the rest. Of a live recording the size is
/// not known. FFmpeg gives out no block of which a part is missing.
fn matroska(file: &mut BufReader<impl Read + Seek>, length: u64) -> Result<Parts> {
    const SEGMENT: u64 = 0x1853_8067;
    let mut at = 0;
    while let Some((id, id_length)) = number(file, true)? {
        let Some((size, size_length)) = number(file, false)? else { break };
        at += id_length + size_length;
        let is_open = size == (1 << (7 * size_length)) - 1;
        if !is_open && at + size > length {
            return Ok(Parts { ending: Ending::Early(Whole::All), count: Count::Estimated });
        }
        if is_open || id == SEGMENT {
            break;
        }
        at += size;
        file.seek_relative(i64::try_from(size).unwrap_or(i64::MAX))?;
    }
    Ok(Parts::whole(Count::Estimated))
}

/// A number of Matroska, and of how many bytes: zeros before the first one bit say how many follow; ids keep that bit.
fn number(file: &mut impl Read, keeps_mark: bool) -> Result<Option<(u64, u64)>> {
    let mut bytes = [0; 8];
    if file.read(&mut bytes[..1])? == 0 || bytes[0] == 0 {
        return Ok(None);
    }
    let following = bytes[0].leading_zeros() as usize;
    if !keeps_mark {
        bytes[0] ^= 0x80 >> following;
    }
    match file.read_exact(&mut bytes[1..=following]) {
        Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => return Ok(None),
        other => other?,
    }
    let value = bytes[..=following].iter().fold(0, |value, byte| value << 8 | u64::from(*byte));
    Ok(Some((value, following as u64 + 1)))
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
