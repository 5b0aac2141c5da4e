//! NumPy `.npy` arrays of two dimensions, C order, float32.

use crate::source::open;
use crate::{Error, Result, Sink, Staged};
use npyz::WriterBuilder;
use std::path::Path;

/// Writes an array of `shape` (rows, columns), given row after row.
///
/// # Errors
/// If a value is not finite or the file cannot be written.
///
/// # Panics
/// If the number of values is not rows × columns.
pub fn write_f32(path: &Path, shape: [usize; 2], values: &[f32]) -> Result<Staged> {
    assert_eq!(values.len(), shape[0] * shape[1], "an array has rows × columns values");
    check_finite(path, shape[1], values)?;
    let mut sink = Sink::create(path)?;
    let mut write = || {
        let options = npyz::WriteOptions::new().default_dtype().shape(&[shape[0] as u64, shape[1] as u64]);
        let mut writer = options.writer(&mut sink).begin_nd()?;
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
    let file =
        npyz::NpyFile::new(open(path)?).map_err(|cause| refuse(format!("is not a NumPy array: {cause}")))?;
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

fn check_finite(path: &Path, columns: usize, values: &[f32]) -> Result<()> {
    match values.iter().position(|x| !x.is_finite()) {
        Some(at) => Err(Error::new(path, "the value is not finite").at(format!(
            "row {}, column {}",
            at / columns,
            at % columns
        ))),
        None => Ok(()),
    }
}
