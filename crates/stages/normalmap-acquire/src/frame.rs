//! The part of a photograph that is worked on.

use crate::acquire::{Face, Photo, Region};
use crate::plane::Plane;

/// Skin beyond the landmarks that is looked at too, io.
const MARGIN_IO: f64 = 0.2;
/// The rectangle of the neutral photograph that is worked on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    /// Its left column and top row.
    pub(crate) first: [usize; 2],
    /// Its columns and rows.
    pub(crate) size: [usize; 2],
    /// Those of the photograph.
    pub(crate) whole: [usize; 2],
}

impl Frame {
    pub(crate) fn of(neutral: &Photo, face: &Face, region: &Region) -> Self {
        let whole = [neutral.light.width, neutral.light.height];
        if !region.masks {
            return Self { first: [0, 0], size: whole, whole };
        }
        let margin = MARGIN_IO * face.io_px;
        let bounds = |axis: usize| {
            let places = face.pairs.iter().map(|pair| pair.from[axis]);
            let (low, high) = places.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
            let first = (low - margin).clamp(0.0, (whole[axis] - 1) as f64) as usize;
            let last = (high + margin).clamp(0.0, (whole[axis] - 1) as f64) as usize;
            (first, last + 1 - first)
        };
        let ((left, width), (top, height)) = (bounds(0), bounds(1));
        Self { first: [left, top], size: [width, height], whole }
    }

    pub(crate) fn crop(&self, plane: &Plane) -> Plane {
        if self.size == self.whole {
            return plane.clone();
        }
        plane.cropped([self.first[0], self.first[1], self.size[0], self.size[1]])
    }

    pub(crate) fn restore(&self, plane: &Plane, value: f64) -> Plane {
        if self.size == self.whole {
            return plane.clone();
        }
        plane.framed(self.first, self.whole, value)
    }
}
