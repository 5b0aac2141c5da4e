//! The data section: points, and analog values that are passed over.

use super::layout::{Layout, Storage};
use crate::markers::warn_of_origins;
use crate::{MarkerFrame, SampleStatus, Violation};
use nalgebra::Point3;

/// What a point of the data means.
pub(super) struct Decoder<'a> {
    pub(super) layout: Layout,
    /// POINT:SCALE, for integers.
    pub(super) scale: f32,
    pub(super) mm_per_unit: f64,
    pub(super) ids: &'a [String],
    pub(super) first_frame: i64,
}

impl Decoder<'_> {
    /// All frames; the layout fits the bytes.
    pub(super) fn frames(
        &self,
        bytes: &[u8],
        warnings: &mut Vec<String>,
    ) -> std::result::Result<Vec<MarkerFrame>, Violation> {
        let data = bytes.get(self.layout.start as usize..).unwrap_or_default();
        let frames = data.chunks_exact(self.layout.stride() as usize).take(self.layout.frames as usize);
        let frames: Vec<MarkerFrame> = (self.first_frame..)
            .zip(frames)
            .map(|(number, frame)| self.frame(number, frame))
            .collect::<std::result::Result<_, _>>()?;
        warn_of_origins(self.ids, &frames, warnings);
        Ok(frames)
    }

    fn frame(&self, number: i64, bytes: &[u8]) -> std::result::Result<MarkerFrame, Violation> {
        let point_size = 4 * self.layout.storage.size() as usize;
        let points = self.ids.iter().zip(bytes.chunks_exact(point_size)).map(|(id, bytes)| {
            self.point(bytes).map_err(|what| Violation::new(format!("frame {number}, marker {id}"), what))
        });
        Ok(MarkerFrame {
            frame: number,
            points: points.collect::<std::result::Result<_, _>>()?,
            status: vec![SampleStatus::Measured; self.ids.len()],
        })
    }

    /// A point, mm: three coordinates, then a word that holds the residual and is negative where it is missing. Some
    /// writers mark a missing sample by three NaN instead.
    fn point(&self, bytes: &[u8]) -> std::result::Result<Option<Point3<f64>>, String> {
        let words: [f32; 4] = match self.layout.storage {
            // In the file's own precision, so that the same take stored as reals gives the same numbers.
            Storage::Integer => std::array::from_fn(|i| {
                let word = f32::from(i16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]));
                if i < 3 { word * self.scale } else { word }
            }),
            Storage::Real => std::array::from_fn(|i| super::real(bytes, 4 * i) as f32),
        };
        let [x, y, z, residual] = words;
        if residual < 0.0 || words[..3].iter().all(|word| word.is_nan()) {
            return Ok(None);
        }
        match words.iter().find(|word| !word.is_finite()) {
            Some(word) => Err(format!(
                "{word} is not a finite number, and the sample is not marked as missing (by a residual of -1)"
            )),
            None => Ok(Some(Point3::new(f64::from(x), f64::from(y), f64::from(z)) * self.mm_per_unit)),
        }
    }
}
