//! OpenEXR pictures of one channel.

use crate::{Error, Result, Sink, Staged};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage,
};
use std::io::Cursor;
use std::path::Path;

/// Writes one channel named Y of 32-bit floats, row after row from the top, losslessly compressed.
///
/// # Errors
/// If the size does not fit the values, or the file cannot be written.
pub fn write_exr(path: &Path, width: usize, height: usize, values: &[f32]) -> Result<Staged> {
    if width * height != values.len() || values.is_empty() {
        let what = format!("{} values make no picture of {width} × {height} pixels", values.len());
        return Err(Error::new(path, what));
    }
    let channel = AnyChannel::new("Y", FlatSamples::F32(values.to_vec()));
    let channels = AnyChannels::sort([channel].into_iter().collect());
    let layer = Layer::new((width, height), LayerAttributes::default(), Encoding::SMALL_LOSSLESS, channels);
    let mut bytes = Cursor::new(Vec::new());
    // One thread, so that the blocks stand in order.
    Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(&mut bytes)
        .map_err(|error| Error::new(path, format!("cannot be written as OpenEXR: {error}")))?;
    let mut sink = Sink::create(path)?;
    std::io::Write::write_all(&mut sink, &bytes.into_inner())
        .map_err(|cause| Error::io(path, "write", &cause))?;
    sink.finish()
}
