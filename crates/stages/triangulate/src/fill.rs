//! Samples that two cameras did not see: from one camera and the neighbours, from the neighbours, or over time.

use crate::affine::{coefficients, nearest};
use crate::solve::Ray;
use crate::surface::surface_depth;
use artifact::SampleStatus;
use nalgebra::{Matrix3, Point3};
use std::collections::VecDeque;
use std::sync::Arc;

/// A frame after the filter.
#[derive(Debug, Clone)]
pub(crate) struct Placed {
    pub(crate) frame: i64,
    /// Per marker.
    pub(crate) places: Vec<Option<Place>>,
    /// Per marker its ray, where one camera saw it.
    pub(crate) rays: Vec<Option<Ray>>,
}

/// Where a marker is, and how that is known.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    pub(crate) position: Point3<f64>,
    pub(crate) status: SampleStatus,
    /// Of the measurement, mm².
    pub(crate) covariance: Option<Matrix3<f64>>,
    /// Cameras that it was found from.
    pub(crate) cameras: Vec<usize>,
}

impl Placed {
    pub(crate) fn position(&self, marker: usize) -> Option<Point3<f64>> {
        self.places[marker].as_ref().map(|place| place.position)
    }

    /// All markers but one that are known here and in another frame.
    pub(crate) fn shared<'a>(
        &'a self,
        other: &'a Self,
        marker: usize,
    ) -> impl Iterator<Item = (usize, Point3<f64>)> + 'a {
        let is_there = move |m: &usize| *m != marker && other.places[*m].is_some();
        (0..self.places.len()).filter(is_there).filter_map(|m| Some((m, self.position(m)?)))
    }
}

/// Fills gaps on a sliding window. Frames come out when what follows them is known as far as the longest gap that is filled.
pub(crate) struct Filler {
    longest: i64,
    window: VecDeque<Arc<Placed>>,
    /// Per marker the last frame that it was measured in.
    last: Vec<Option<Arc<Placed>>>,
}

impl Filler {
    /// `longest`: of the gaps filled from neighbours or over time, frames.
    pub(crate) fn new(marker_count: usize, longest: i64) -> Self {
        Self { longest, window: VecDeque::new(), last: vec![None; marker_count] }
    }

    /// Takes a frame; returns those that no later frame can help.
    pub(crate) fn push(&mut self, frame: Placed) -> Vec<Placed> {
        let newest = frame.frame;
        self.window.push_back(Arc::new(frame));
        let mut done = Vec::new();
        while self.window.front().is_some_and(|front| newest - front.frame > self.longest) {
            done.extend(self.advance());
        }
        done
    }

    /// The frames at the end, after which none follow.
    pub(crate) fn finish(&mut self) -> Vec<Placed> {
        let mut done = Vec::new();
        while let Some(frame) = self.advance() {
            done.push(frame);
        }
        done
    }

    fn advance(&mut self) -> Option<Placed> {
        let frame = self.window.pop_front()?;
        let mut filled = Placed::clone(&frame);
        for marker in 0..frame.places.len() {
            if frame.places[marker].is_some() {
                self.last[marker] = Some(Arc::clone(&frame));
            } else {
                filled.places[marker] = self.fill(&frame, marker);
            }
        }
        Some(filled)
    }

    fn fill(&self, frame: &Placed, marker: usize) -> Option<Place> {
        let between = self.between(frame, marker);
        if let Some(ray) = &frame.rays[marker] {
            return self.on_ray(frame, marker, ray, between.as_ref().map(|(position, _)| *position));
        }
        between.map(|(position, status)| Place { position, status, covariance: None, cameras: Vec::new() })
    }

    /// In a short gap: moved along with the neighbours from both its ends, and blended, so that the path meets both.
    fn between(&self, frame: &Placed, marker: usize) -> Option<(Point3<f64>, SampleStatus)> {
        let before = self.last[marker].as_ref()?;
        let after = self.window.iter().find(|after| after.places[marker].is_some())?;
        if after.frame - before.frame - 1 > self.longest {
            return None;
        }
        let share = (frame.frame - before.frame) as f64 / (after.frame - before.frame) as f64;
        let (from, to) = (before.position(marker)?, after.position(marker)?);
        Some(match (carried(before, frame, marker), carried(after, frame, marker)) {
            (Some(from), Some(to)) => (from + (to - from) * share, SampleStatus::NeighborFilled),
            _ => (from + (to - from) * share, SampleStatus::Interpolated),
        })
    }

    /// On the ray of the one camera that sees it. How far along: where the gap's filling, or the neighbours' motion since it
    /// was last seen, says; else as far as the surface of the neighbours.
    fn on_ray(
        &self,
        frame: &Placed,
        marker: usize,
        ray: &Ray,
        between: Option<Point3<f64>>,
    ) -> Option<Place> {
        let carried = || carried(self.last[marker].as_ref()?, frame, marker);
        let depth = match between.or_else(carried) {
            Some(guess) => ray.direction.dot(&(guess - ray.origin)),
            None => surface_depth(frame, marker, ray)?,
        };
        let position = ray.origin + ray.direction.into_inner() * depth;
        let status = SampleStatus::SingleCamera;
        (depth > 0.0).then(|| Place { position, status, covariance: None, cameras: vec![ray.camera] })
    }
}

/// A marker's place in another frame, moved along with its neighbours.
fn carried(known: &Placed, frame: &Placed, marker: usize) -> Option<Point3<f64>> {
    let here = known.position(marker)?;
    let neighbors = nearest(&here, known.shared(frame, marker));
    let steps = neighbors.iter().map(|n| Some(frame.position(n.marker)? - known.position(n.marker)?));
    let steps: Vec<_> = steps.collect::<Option<_>>()?;
    Some(
        here + steps
            .iter()
            .zip(coefficients(&neighbors)?)
            .map(|(step, c)| step * c)
            .sum::<nalgebra::Vector3<_>>(),
    )
}
