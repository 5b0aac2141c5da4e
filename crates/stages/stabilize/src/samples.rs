//! Markers over frames, in whichever space.

use nalgebra::{Isometry3, Point3, Vector3};

/// Positions of all markers in a run of frames, mm; `None` where a sample is missing.
#[derive(Debug, Clone)]
pub(crate) struct Samples {
    /// Absolute frame numbers, rising.
    pub(crate) numbers: Vec<i64>,
    /// `[frame][marker]`.
    pub(crate) points: Vec<Vec<Option<Point3<f64>>>>,
}

impl Samples {
    pub(crate) fn frame_count(&self) -> usize {
        self.points.len()
    }

    pub(crate) fn marker_count(&self) -> usize {
        self.points.first().map_or(0, Vec::len)
    }

    /// Where a marker is seen.
    pub(crate) fn seen(&self, marker: usize) -> Vec<usize> {
        (0..self.frame_count()).filter(|&f| self.points[f][marker].is_some()).collect()
    }

    /// All positions of a marker.
    pub(crate) fn of(&self, marker: usize) -> Vec<Vector3<f64>> {
        self.points.iter().filter_map(|row| row[marker]).map(|point| point.coords).collect()
    }

    /// The same in another space, per frame; a frame without a transform loses its samples.
    pub(crate) fn moved(&self, to_from: impl Fn(usize) -> Option<Isometry3<f64>>) -> Self {
        let row = |(f, row): (usize, &Vec<Option<Point3<f64>>>)| {
            let transform = to_from(f);
            row.iter().map(|point| Some(transform.as_ref()? * (*point)?)).collect()
        };
        Self { numbers: self.numbers.clone(), points: self.points.iter().enumerate().map(row).collect() }
    }
}
