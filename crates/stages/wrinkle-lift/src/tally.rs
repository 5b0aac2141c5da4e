//! What became of the sections.

use crate::section::{Lifted, Lost};
use std::collections::BTreeMap;

/// Counts over wrinkles, images and frames.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tally {
    /// Per camera.
    pub cameras: BTreeMap<String, CameraTally>,
    /// Per wrinkle how far apart two cameras put its places, mm.
    pub apart_mm: BTreeMap<String, Vec<f64>>,
    /// Points of valleys.
    pub points: usize,
    /// Points whose valley the mesh is too coarse for.
    pub coarse: usize,
    /// Lengths without a section that were bridged, mm.
    pub bridged_mm: f64,
    /// Lengths without a section that split a wrinkle, mm.
    pub split_mm: f64,
}

/// Counts of one camera.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CameraTally {
    /// Sections that are on the face.
    pub lifted: usize,
    /// Sections that are not, by reason.
    pub lost: BTreeMap<Lost, usize>,
    /// Sections on another sheet of the face than most of their wrinkle, or alone.
    pub strays: usize,
    /// Wrinkles that are open in an image and have no place on the face.
    pub gone: usize,
    /// One of these wrinkles.
    pub example: Option<String>,
    /// Sum of the angles of view, rad.
    pub view_rad: f64,
}

impl CameraTally {
    /// All sections that had a measure.
    #[must_use]
    pub fn cast(&self) -> usize {
        let unmeasured = self.lost.get(&Lost::Unmeasured).copied().unwrap_or(0);
        self.lifted + self.lost.values().sum::<usize>() - unmeasured
    }

    fn add(&mut self, more: Self) {
        self.lifted += more.lifted;
        self.strays += more.strays;
        self.gone += more.gone;
        self.view_rad += more.view_rad;
        more.lost.into_iter().for_each(|(why, count)| *self.lost.entry(why).or_default() += count);
        self.example = self.example.take().or(more.example);
    }
}

impl Tally {
    /// Adds counts of other wrinkles or frames.
    pub fn add(&mut self, more: Self) {
        more.cameras.into_iter().for_each(|(id, counts)| self.cameras.entry(id).or_default().add(counts));
        more.apart_mm.into_iter().for_each(|(id, mm)| self.apart_mm.entry(id).or_default().extend(mm));
        self.points += more.points;
        self.coarse += more.coarse;
        self.bridged_mm += more.bridged_mm;
        self.split_mm += more.split_mm;
    }

    pub(crate) fn count(&mut self, camera: &str, lifted: &[Result<Lifted, Lost>]) {
        let counts = self.cameras.entry(camera.to_string()).or_default();
        for one in lifted {
            match one {
                Ok(point) => {
                    counts.lifted += 1;
                    counts.view_rad += point.view_rad;
                }
                Err(why) => *counts.lost.entry(*why).or_default() += 1,
            }
        }
    }

    pub(crate) fn strays(&mut self, camera: &str, count: usize) {
        self.cameras.entry(camera.to_string()).or_default().strays += count;
    }

    pub(crate) fn wrinkle(&mut self, camera: &str, id: &str, gone: bool) {
        let counts = self.cameras.entry(camera.to_string()).or_default();
        if gone {
            counts.gone += 1;
            counts.example.get_or_insert_with(|| id.to_string());
        }
    }

    pub(crate) fn apart(&mut self, id: &str, mm: &[f64]) {
        if !mm.is_empty() {
            self.apart_mm.entry(id.to_string()).or_default().extend(mm);
        }
    }
}

/// The value that a share of all do not exceed; none of an empty list.
#[must_use]
pub fn percentile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let place = (share * sorted.len().saturating_sub(1) as f64).round() as usize;
    sorted.get(place).copied()
}
