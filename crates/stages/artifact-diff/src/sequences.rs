//! Two mesh sequences, frame by frame, in constant memory.

use crate::meshes::distances;
use crate::summary::{Moments, rank95};
use crate::{Error, Part, Region, Report};
use nalgebra::Point3;

/// Ratio between neighbouring bounds of the histogram: its percentile is at most 0.25 % off.
const BIN_RATIO: f64 = 1.005;
/// Lowest bound of the histogram, mm; what lies below counts as this.
const BIN_LOW: f64 = 1e-9;
/// Bins up to 10⁹ mm.
const BIN_COUNT: usize = 8313;

/// Collects the distances between two sequences.
///
/// Counts, means and maxima are exact; the 95th percentile comes from a histogram and is within 0.25 %, since keeping
/// all distances of a long sequence would take its size in memory.
pub struct SequenceDiff<'a> {
    regions: &'a [Region],
    all: Spread,
    per_region: Vec<Spread>,
    vertex_count: usize,
}

impl<'a> SequenceDiff<'a> {
    /// Starts a comparison of sequences of `vertex_count` vertices.
    ///
    /// # Errors
    /// [`Error::Region`] where a region does not fit.
    pub fn new(vertex_count: usize, regions: &'a [Region]) -> Result<Self, Error> {
        regions.iter().try_for_each(|region| region.check(vertex_count))?;
        let per_region = regions.iter().map(|_| Spread::new()).collect();
        Ok(Self { regions, all: Spread::new(), per_region, vertex_count })
    }

    /// Adds a frame: #V points each, mm.
    ///
    /// # Errors
    /// [`Error::VertexCount`] where a count is another one.
    pub fn add(&mut self, frame: i64, points: &[Point3<f64>], other: &[Point3<f64>]) -> Result<(), Error> {
        let distances = distances(points, other)?;
        if distances.len() != self.vertex_count {
            return Err(Error::VertexCount { count: distances.len(), other: self.vertex_count });
        }
        for (vertex, &distance) in distances.iter().enumerate() {
            self.all.add(distance, frame, vertex);
        }
        for (spread, region) in self.per_region.iter_mut().zip(self.regions) {
            for &vertex in &region.vertices {
                spread.add(distances[vertex as usize], frame, vertex as usize);
            }
        }
        Ok(())
    }

    /// The outcome; `only_first` and `only_second` are frames that have no counterpart.
    ///
    /// # Errors
    /// [`Error::NothingShared`] if no frame was added.
    pub fn finish(self, only_first: &[i64], only_second: &[i64]) -> Result<Report, Error> {
        if self.all.moments.count == 0 {
            return Err(Error::NothingShared("frame"));
        }
        let mut report = Report::new("mm", self.all.summary());
        let parts = self.regions.iter().zip(&self.per_region);
        report.regions = parts
            .map(|(region, spread)| Part { name: region.name.clone(), summary: spread.summary() })
            .collect();
        report.structure = one_sided_frames(only_first, only_second);
        Ok(report)
    }
}

/// A sentence per side that has frames of its own.
pub(crate) fn one_sided_frames(only_first: &[i64], only_second: &[i64]) -> Vec<String> {
    let sentence = |side: &str, frames: &[i64]| match frames {
        [] => None,
        [frame] => Some(format!("frame {frame} is only in the {side}")),
        [first, .., last] => {
            Some(format!("{} frames between {first} and {last} are only in the {side}", frames.len()))
        }
    };
    [sentence("first", only_first), sentence("second", only_second)].into_iter().flatten().collect()
}

struct Spread {
    moments: Moments,
    bins: Vec<u64>,
    max_at: Option<(i64, usize)>,
}

impl Spread {
    fn new() -> Self {
        Self { moments: Moments::default(), bins: vec![0; BIN_COUNT + 1], max_at: None }
    }

    fn add(&mut self, distance: f64, frame: i64, vertex: usize) {
        if self.max_at.is_none() || distance > self.moments.max {
            self.max_at = Some((frame, vertex));
        }
        self.moments.add(distance);
        self.bins[bin(distance)] += 1;
    }

    fn summary(&self) -> crate::Summary {
        let place = self.max_at.map(|(frame, vertex)| format!("frame {frame}, vertex {vertex}"));
        self.moments.summary(self.percentile95(), place.unwrap_or_default())
    }

    /// The geometric middle of the bin that holds the rank.
    fn percentile95(&self) -> f64 {
        let rank = rank95(self.moments.count);
        let mut below = 0;
        let holds = |count: &u64| {
            below += count;
            below > rank
        };
        match self.bins.iter().position(holds) {
            None | Some(0) => 0.0,
            Some(bin) => (BIN_LOW * BIN_RATIO.powf(bin as f64 - 0.5)).min(self.moments.max),
        }
    }
}

/// Bin 0 holds what is no difference at all, bin b the distances from ratio^(b−1) to ratio^b times the lowest bound.
fn bin(distance: f64) -> usize {
    match distance > 0.0 {
        true => 1 + ((distance / BIN_LOW).ln() / BIN_RATIO.ln()).clamp(0.0, BIN_COUNT as f64 - 1.0) as usize,
        false => 0,
    }
}
