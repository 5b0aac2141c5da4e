//! Sections across a line, as material points of the skin.

use crate::wrinkle::arc::Outline;
use crate::wrinkle::profile::Shape;
use crate::wrinkle::smooth::{smoothed, strides};
use crate::wrinkle::surface::{Cut, Ground, Spot};
use nalgebra::{Point3, Vector3};

/// Standard deviation of the smoothing of a section: relief finer than this is neither compression nor a direction to
/// slide in, mm.
const FINE_MM: f64 = 0.8;
/// Sections end where the surface turns this steeply away from the line's tangent plane: least cosine.
const STEEPEST: f64 = 0.25;

/// One side of a band.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Side {
    /// From how far skin gathers into the fold, mm of rest skin.
    pub(super) demand: f64,
    /// Where the profile ends, mm of rest skin.
    pub(super) end: f64,
}

impl Side {
    /// Nothing moves from here on, mm of rest skin.
    pub(super) fn still_from(&self) -> f64 {
        self.demand.max(self.end)
    }
}

/// A section across a line; its samples run from p < 0 to p > 0.
#[derive(Debug, Clone)]
pub(super) struct Station {
    /// Place along the line, mm.
    pub(super) x: f64,
    /// The line's point at rest.
    pub(super) origin: Point3<f64>,
    /// Across the line (towards p > 0) and along it, at rest; with the skin's normal an orthonormal frame.
    pub(super) across: Vector3<f64>,
    pub(super) along: Vector3<f64>,
    /// Material points.
    pub(super) spots: Vec<Spot>,
    /// The sample on the line.
    pub(super) zero: usize,
    /// Distances from the line along the rest skin, mm.
    pub(super) p: Vec<f64>,
    /// The same measured straight, along `across`; rising.
    pub(super) lateral: Vec<f64>,
    /// The samples at rest, without fine relief.
    pub(super) rest: Vec<Vector3<f64>>,
    /// Which share of the compression the fold takes up.
    pub(super) uptake: f64,
    /// Width at rest, mm.
    pub(super) width: f64,
    pub(super) shape: Shape,
    pub(super) outline: Outline,
    /// p < 0, p > 0.
    pub(super) sides: [Side; 2],
}

impl Station {
    /// The section through `spot`, at most `length` mm to each side. `cut`: the line's frame there.
    pub(super) fn new(ground: &Ground, spot: Spot, cut: Cut, x: f64, step: f64, length: f64) -> Self {
        let back = Cut { across: -cut.across, ..cut };
        let left = ground.walk(&spot, &back, step, length);
        let zero = left.len();
        let mut spots: Vec<Spot> = left.into_iter().rev().collect();
        spots.push(spot);
        spots.extend(ground.walk(&spot, &cut, step, length));
        let rest = fair(&spots, ground.points, step);
        let p = arc_lengths(&rest, zero);
        let lateral = rest.iter().map(|point| (point - rest[zero]).dot(&cut.across)).collect();
        let side = Side { demand: 0.0, end: 0.0 };
        let mut station = Self {
            x,
            origin: cut.origin,
            across: cut.across,
            along: cut.along,
            spots,
            zero,
            p,
            lateral,
            rest,
            uptake: 0.0,
            width: 0.0,
            shape: Shape::S,
            outline: Outline::of(&Shape::S, 1.0),
            sides: [side; 2],
        };
        station.end_where_steep();
        station
    }

    fn end_where_steep(&mut self) {
        let steep = |i: &usize| {
            let (one, other) = (*i, *i + 1);
            self.lateral[other] - self.lateral[one] < STEEPEST * (self.p[other] - self.p[one])
        };
        let last = (self.zero..self.spots.len() - 1).find(steep).unwrap_or(self.spots.len() - 1);
        let first = (0..self.zero).rev().find(steep).map_or(0, |i| i + 1);
        self.spots = self.spots[first..=last].to_vec();
        self.p = self.p[first..=last].to_vec();
        self.lateral = self.lateral[first..=last].to_vec();
        self.rest = self.rest[first..=last].to_vec();
        self.zero -= first;
    }

    /// Length of the band from which skin gathers into the fold, mm of rest skin.
    pub(super) fn band(&self) -> f64 {
        (self.sides[0].demand + self.sides[1].demand).max(1e-9)
    }

    /// How far the section goes on side p < 0 and on side p > 0, mm of rest skin.
    pub(super) fn ends(&self) -> [f64; 2] {
        [-self.p[0], self.p[self.p.len() - 1]]
    }

    /// The distance along the skin to what lies so far across the line, measured straight.
    pub(super) fn p_of_lateral(&self, lateral: f64) -> f64 {
        interpolate(&self.lateral, &self.p, lateral)
    }

    /// The rest point at p, without fine relief; the nearest end beyond the section.
    pub(super) fn rest_at(&self, p: f64) -> Vector3<f64> {
        let (k, share) = locate(&self.p, p.clamp(self.p[0], self.p[self.p.len() - 1]));
        match self.rest.get(k + 1) {
            Some(next) => self.rest[k] * (1.0 - share) + next * share,
            None => self.rest[k],
        }
    }
}

/// Samples at some pose, without fine relief.
pub(super) fn fair(spots: &[Spot], points: &[Point3<f64>], step: f64) -> Vec<Vector3<f64>> {
    let raw: Vec<Vector3<f64>> = spots.iter().map(|spot| spot.at(points).coords).collect();
    smoothed(&raw, &strides(FINE_MM / step))
}

/// Arc lengths along a polyline, 0 at sample `zero`.
pub(super) fn arc_lengths(points: &[Vector3<f64>], zero: usize) -> Vec<f64> {
    let mut lengths = vec![0.0; points.len()];
    for i in zero + 1..points.len() {
        lengths[i] = lengths[i - 1] + (points[i] - points[i - 1]).norm();
    }
    for i in (0..zero).rev() {
        lengths[i] = lengths[i + 1] - (points[i] - points[i + 1]).norm();
    }
    lengths
}

/// The interval of a rising list in which a value lies (the first or last one beyond it), and where in it.
pub(super) fn locate(rising: &[f64], value: f64) -> (usize, f64) {
    if rising.len() < 2 {
        return (0, 0.0);
    }
    let k = rising.partition_point(|&x| x <= value).clamp(1, rising.len() - 1) - 1;
    let step = rising[k + 1] - rising[k];
    (k, if step > 0.0 { (value - rising[k]) / step } else { 0.0 })
}

/// The value over `x`, linear between samples and on beyond them.
pub(super) fn interpolate(xs: &[f64], values: &[f64], x: f64) -> f64 {
    let (k, share) = locate(xs, x);
    match values.get(k + 1) {
        Some(next) => values[k] + share * (next - values[k]),
        None => values[k],
    }
}
