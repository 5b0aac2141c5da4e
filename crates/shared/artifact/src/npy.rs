//! NumPy `.npy` arrays: float32 and float64 of two dimensions in C order, and lists of uint32.

use crate::source::open;
use crate::{Error, Result, Sink, Staged};
use npyz::WriterBuilder;
use std::path::Path;

/// Writes an array of float32 or float64 of `shape` (rows, columns), given row after row.
///
/// # Errors
/// If the file cannot be written.
///
/// # Panics
/// If the number of values is not rows × columns.
pub fn write<T: npyz::AutoSerialize + Copy>(path: &Path, shape: [usize; 2], values: &[T]) -> Result<Staged> {
    assert_eq!(values.len(), shape[0] * shape[1], "an array has rows × columns values");
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
/// If the file is no array of float32 in C order with two dimensions, or is cut short.
pub fn read_f32(path: &Path) -> Result<([usize; 2], Vec<f32>)> {
    let refuse = |what: String| Error::new(path, what).fix("give a float32 array of two dimensions, C order");
    let file =
        npyz::NpyFile::new(open(path)?).map_err(|cause| refuse(format!("is not a NumPy array: {cause}")))?;
    let &[rows, columns] = file.shape() else {
        return Err(refuse(format!("has {} dimensions", file.shape().len())));
    };
    if file.order() != npyz::Order::C {
        return Err(refuse("is in Fortran order".to_string()));
    }
    let values = file.into_vec::<f32>().map_err(|cause| refuse(format!("cannot be read: {cause}")))?;
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
    npyz::NpyFile::new(open(path)?).and_then(npyz::NpyFile::into_vec::<u32>).map_err(refuse)
}
