//! NumPy `.npy` arrays: float32 and float64 of two dimensions in C order, and lists of uint32.

use crate::source::open;
use crate::{Error, Result, Sink, Staged};
use npyz::WriterBuilder;
use std::io::{Cursor, Read};
use std::path::Path;

/// Writes an array of float32 or float64 of `shape` (rows, columns), given row after row.
///
/// # Errors
/// If a value is not finite or the file cannot be written.
///
/// # Panics
/// If the number of values is not rows × columns.
pub fn write<T: npyz::AutoSerialize + Copy + Into<f64>>(
    path: &Path,
    shape: [usize; 2],
    values: &[T],
) -> Result<Staged> {
    assert_eq!(values.len(), shape[0] * shape[1], "an array has rows × columns values");
    check_finite(path, shape[1], values)?;
    write_shaped(path, &[shape[0] as u64, shape[1] as u64], values)
}

fn write_shaped<T: npyz::AutoSerialize + Copy>(path: &Path, shape: &[u64], values: &[T]) -> Result<Staged> {
    let mut sink = Sink::create(path)?;
    let mut write = || {
        let mut writer =
            npyz::WriteOptions::new().default_dtype().shape(shape).writer(&mut sink).begin_nd()?;
        writer.extend(values.iter().copied())?;
        writer.finish()
    };
    write().map_err(|cause| Error::io(path, "write", &cause))?;
    sink.finish()
}

/// Reads an array: its shape (rows, columns) and its values, row after row.
///
/// # Errors
/// If the file is no array of float32 in C order with two dimensions, is cut short, or holds a value that is not
/// finite.
pub fn read_f32(path: &Path) -> Result<([usize; 2], Vec<f32>)> {
    let refuse = |what: String| Error::new(path, what).fix("give a float32 array of two dimensions, C order");
    let mut bytes = open(path)?;
    let head = head(&mut bytes).map_err(|cause| refuse(format!("is not a NumPy array: {cause}")))?;
    let file = npyz::NpyFile::new(head.chain(bytes))
        .map_err(|cause| refuse(format!("is not a NumPy array: {cause}")))?;
    let &[rows, columns] = file.shape() else {
        return Err(refuse(format!("has {} dimensions", file.shape().len())));
    };
    if file.order() != npyz::Order::C {
        return Err(refuse("is in Fortran order".to_string()));
    }
    let values = file.into_vec::<f32>().map_err(|cause| refuse(format!("cannot be read: {cause}")))?;
    check_finite(path, columns as usize, &values)?;
    Ok(([rows as usize, columns as usize], values))
}

/// Writes a list of indices.
///
/// # Errors
/// If the file cannot be written.
pub fn write_u32(path: &Path, values: &[u32]) -> Result<Staged> {
    write_shaped(path, &[values.len() as u64], values)
}

/// Reads a list of indices.
///
/// # Errors
/// If the file is no list of uint32, or is cut short.
pub fn read_u32(path: &Path) -> Result<Vec<u32>> {
    let refuse = |cause: std::io::Error| {
        Error::new(path, format!("is not a list of uint32: {cause}")).fix("remove it; it will be made again")
    };
    let mut bytes = open(path)?;
    let head = head(&mut bytes).map_err(refuse)?;
    npyz::NpyFile::new(head.chain(bytes)).and_then(npyz::NpyFile::into_vec::<u32>).map_err(refuse)
}

/// Headers are a line of some 60 characters.
const LONGEST_HEADER: usize = 4096;

/// The head of the file, up to the values, when it is such that `npyz` cannot stumble: it multiplies the numbers of
/// the shape without a look, and follows brackets to any depth.
fn head(bytes: &mut impl Read) -> std::io::Result<Cursor<Vec<u8>>> {
    let mut head = vec![0; 10];
    bytes.read_exact(&mut head)?;
    let mut length = usize::from(u16::from_le_bytes([head[8], head[9]]));
    if head[6] > 1 {
        let mut upper = [0; 2];
        bytes.read_exact(&mut upper)?;
        length += usize::from(u16::from_le_bytes(upper)) << 16;
        head.extend(upper);
    }
    if length > LONGEST_HEADER {
        return Err(std::io::Error::other(format!("its header has {length} bytes")));
    }
    let start = head.len();
    head.resize(start + length, 0);
    bytes.read_exact(&mut head[start..])?;
    let text = String::from_utf8_lossy(&head[start..]);
    let shape = text.split_once("shape").and_then(|(_, rest)| rest.split(')').next()).unwrap_or_default();
    let numbers = shape.split(|c: char| !c.is_ascii_digit()).filter(|digits| !digits.is_empty());
    let count = numbers
        .map(|digits| digits.parse::<u64>().ok())
        .try_fold(1u64, |count, number| count.checked_mul(number?.max(1)));
    match count {
        Some(_) => Ok(Cursor::new(head)),
        None => Err(std::io::Error::other("its shape is larger than any memory")),
    }
}

fn check_finite<T: Copy + Into<f64>>(path: &Path, columns: usize, values: &[T]) -> Result<()> {
    match values.iter().position(|&x| !x.into().is_finite()) {
        Some(at) => Err(Error::new(path, "the value is not finite").at(format!(
            "row {}, column {}",
            at / columns,
            at % columns
        ))),
        None => Ok(()),
    }
}
