//! Where the markers sit on the face, and what a marker's neighbours say about it.

use crate::robust::geometric_median;
use crate::samples::Samples;
use nalgebra::Vector3;

/// Neighbours asked about a marker: enough that three wrong ones are outvoted.
const NEIGHBORS: usize = 8;
/// Fewer than this say nothing.
const LEAST_NEIGHBORS: usize = 3;

/// The markers' usual places in head space.
#[derive(Debug, Clone)]
pub(crate) struct Layout {
    /// Usual place of each marker, mm; `None` for one that is never seen.
    pub(crate) rest: Vec<Option<Vector3<f64>>>,
    /// Per marker the nearest others at rest, nearest first.
    pub(crate) neighbors: Vec<Vec<usize>>,
}

impl Layout {
    /// Geometric medians over the take, so that a minority of wrong samples moves nothing far.
    pub(crate) fn of(head: &Samples) -> Self {
        let rest: Vec<Option<Vector3<f64>>> =
            (0..head.marker_count()).map(|marker| geometric_median(&head.of(marker))).collect();
        let nearest = |marker: usize| {
            let Some(here) = rest[marker] else { return Vec::new() };
            let mut others: Vec<(f64, usize)> = (0..rest.len())
                .filter(|&other| other != marker)
                .filter_map(|other| rest[other].map(|there| ((there - here).norm(), other)))
                .collect();
            others.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            others.into_iter().take(NEIGHBORS).map(|(_, other)| other).collect()
        };
        let neighbors = (0..rest.len()).map(nearest).collect();
        Self { rest, neighbors }
    }

    /// How far the neighbours moved from rest, in a frame.
    pub(crate) fn neighbors_displacement(&self, head: &Samples, marker: usize, f: usize) -> Vector3<f64> {
        let moved = self.neighbors[marker]
            .iter()
            .filter_map(|&other| Some(head.points[f][other]?.coords - self.rest[other]?));
        agreed(moved.collect())
    }

    /// How far the neighbours moved from frame `a` to frame `b`.
    pub(crate) fn neighbors_step(&self, head: &Samples, marker: usize, a: usize, b: usize) -> Vector3<f64> {
        let moved = self.neighbors[marker]
            .iter()
            .filter_map(|&other| Some(head.points[b][other]? - head.points[a][other]?));
        agreed(moved.collect())
    }

    /// Distance of two markers at rest, mm.
    pub(crate) fn distance(&self, a: usize, b: usize) -> Option<f64> {
        Some((self.rest[a]? - self.rest[b]?).norm())
    }
}

fn agreed(moved: Vec<Vector3<f64>>) -> Vector3<f64> {
    match moved.len() >= LEAST_NEIGHBORS {
        true => geometric_median(&moved).unwrap_or_default(),
        false => Vector3::zeros(),
    }
}
