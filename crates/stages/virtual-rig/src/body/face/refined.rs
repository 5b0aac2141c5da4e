//! Faces with more vertices than the sampler makes, finer where skin will fold.

use crate::body::face::{Face, surface};
use crate::body::refine::Refinement;
use nalgebra::{Point2, Point3};
use rayon::prelude::*;

/// Spacing far from the lines relative to the spacing at them.
const FINER: f64 = 3.5;
/// Most vertices that the sampler places; the rest come by bisection.
const SAMPLED: usize = 25_000;
/// Share of the vertices that the sampler places.
const SAMPLED_SHARE: f64 = 0.4;
/// How near the number of vertices comes to the wanted one.
const TOLERANCE: f64 = 0.05;
const MAX_TRIALS: usize = 8;
/// Spacing at which bisection puts one vertex on a unit of area; measured.
pub(in crate::body) const BISECTED: f64 = 1.45;

impl Face {
    /// The face of a seed with about `vertex_count` vertices (500 to 1 500 000, within 10 %, or as many as creases need), evenly
    /// spaced but for eyes, mouth and the surroundings of `lines` (domain, mm).
    pub(in crate::body) fn refined(
        seed: u64,
        vertex_count: usize,
        lines: &[Vec<Point2<f64>>],
        fineness: Fineness,
    ) -> Self {
        let wanted = vertex_count.clamp(500, 1_500_000);
        if lines.is_empty() && wanted <= SAMPLED {
            return Self::new(seed, wanted).in_order();
        }
        let base = Self::new(seed, SAMPLED.min((SAMPLED_SHARE * wanted as f64) as usize));
        let near = Near { lines, fineness };
        // What stands there however far apart all else is: the sampler's vertices, and those that creases need.
        let held = match fineness.crease_mm {
            0.0 => base.mesh.positions.len(),
            _ => Growth::of(&base, &near, f64::INFINITY).positions.len(),
        };
        let mut spacing = BISECTED * (base.demand(&near) / wanted as f64).sqrt();
        let mut best = Growth::of(&base, &near, spacing);
        // Spacings that gave too many vertices and too few.
        let (mut narrow, mut wide) = (None, None);
        for _ in 1..MAX_TRIALS {
            let excess = best.positions.len() as f64 / wanted as f64;
            if (excess - 1.0).abs() < TOLERANCE {
                break;
            }
            // As many vertices as the spacing squared says, but for those that are held.
            let placed = (held as f64 / wanted as f64).min(0.9 * excess.min(1.0));
            *(if excess > 1.0 { &mut narrow } else { &mut wide }) = Some(spacing);
            spacing = match (narrow, wide) {
                // Around creases spacing says less: go to the middle.
                (Some(narrow), Some(wide)) if fineness.crease_mm > 0.0 => f64::sqrt(narrow * wide),
                _ => spacing * ((excess - placed) / (1.0 - placed)).sqrt().clamp(0.5, 2.0),
            };
            best = Growth::of(&base, &near, spacing);
        }
        let mesh = best.refinement.mesh(&base.mesh, best.positions);
        Self { person: base.person, domain: best.domain, mesh }.in_order()
    }

    /// Area, each part counted by how much finer it shall be, mm².
    fn demand(&self, near: &Near) -> f64 {
        let areas = mesh::triangle_areas(&self.mesh.positions, &self.mesh.triangles());
        let finer = |triangle: &[u32; 3]| near.factor(self.domain[triangle[0] as usize]).powi(-2);
        areas.iter().zip(self.mesh.triangles()).map(|(area, triangle)| area * finer(&triangle)).sum()
    }
}

/// A face on its way to a spacing.
struct Growth {
    refinement: Refinement,
    domain: Vec<Point2<f64>>,
    positions: Vec<Point3<f64>>,
}

impl Growth {
    fn of(base: &Face, near: &Near, spacing: f64) -> Self {
        let mut refinement = Refinement::of(&base.mesh);
        let (mut domain, mut positions) = (base.domain.clone(), base.mesh.positions.clone());
        let wanted = |at: &Point2<f64>| near.spacing(*at, spacing);
        let mut spacings: Vec<f64> = domain.par_iter().map(wanted).collect();
        while refinement.split_longer(&positions, &spacings) > 0 {
            let first = domain.len() - base.domain.len();
            let middle = |[a, b]: &[u32; 2]| nalgebra::center(&domain[*a as usize], &domain[*b as usize]);
            let new: Vec<Point2<f64>> = refinement.parents()[first..].iter().map(middle).collect();
            positions.par_extend(new.par_iter().map(|&at| surface::point(&base.person, at)));
            spacings.par_extend(new.par_iter().map(wanted));
            domain.extend(new);
        }
        Self { refinement, domain, positions }
    }
}

/// Lines around which the mesh shall be finer.
pub(in crate::body) struct Near<'a> {
    /// Domain, mm.
    pub(in crate::body) lines: &'a [Vec<Point2<f64>>],
    pub(in crate::body) fineness: Fineness,
}

/// Finer triangles along lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fineness {
    /// So far from a line triangles are finer, mm.
    pub reach_mm: f64,
    /// Length of edges on the line itself, mm, so that a sharp crease is not cut off; 0: as beside it.
    pub crease_mm: f64,
}

impl From<f64> for Fineness {
    /// Finer triangles that reach so far, mm.
    fn from(reach_mm: f64) -> Self {
        Self { reach_mm, crease_mm: 0.0 }
    }
}

/// From so many edges' lengths off the crease on, edges may get longer …
const CREASE_EDGES: f64 = 2.0;
/// … by this share of the distance.
const CREASE_GROWTH: f64 = 0.25;

impl Near<'_> {
    /// Wanted spacing relative to the one far from all lines: constant within half the reach, rising to its end.
    pub(in crate::body) fn factor(&self, at: Point2<f64>) -> f64 {
        self.factor_at(self.nearest(at))
    }

    fn factor_at(&self, distance: f64) -> f64 {
        let share = (2.0 * distance / self.fineness.reach_mm - 1.0).clamp(0.0, 1.0);
        (1.0 + (FINER - 1.0) * share) / FINER
    }

    /// Wanted spacing where that far from all lines is `far`, mm.
    pub(in crate::body) fn spacing(&self, at: Point2<f64>, far: f64) -> f64 {
        let distance = self.nearest(at);
        let wanted = far * self.factor_at(distance);
        match self.fineness.crease_mm {
            0.0 => wanted,
            least => wanted.min(least + CREASE_GROWTH * (distance - CREASE_EDGES * least).max(0.0)),
        }
    }

    fn nearest(&self, at: Point2<f64>) -> f64 {
        self.lines.iter().map(|line| self.distance(line, at)).fold(f64::INFINITY, f64::min)
    }

    /// Distance to a polyline; infinite when it is surely beyond reach.
    fn distance(&self, line: &[Point2<f64>], at: Point2<f64>) -> f64 {
        let beyond = |axis: usize| {
            let apart = |bound: fn(f64, f64) -> f64, start: f64| {
                line.iter().map(|point| point[axis]).fold(start, bound)
            };
            at[axis] < apart(f64::min, f64::INFINITY) - self.fineness.reach_mm
                || at[axis] > apart(f64::max, f64::NEG_INFINITY) + self.fineness.reach_mm
        };
        if beyond(0) || beyond(1) {
            return f64::INFINITY;
        }
        let to_segment = |ends: &[Point2<f64>]| {
            let (way, from) = (ends[1] - ends[0], at - ends[0]);
            let share = (from.dot(&way) / way.norm_squared().max(1e-12)).clamp(0.0, 1.0);
            (from - way * share).norm()
        };
        line.windows(2).map(to_segment).fold(f64::INFINITY, f64::min)
    }
}
