//! Folding the skin at a pose.

use crate::wrinkle::bend::{Bend, Budget, Pose};
use crate::wrinkle::params::Params;
use crate::wrinkle::place::{Placed, Wrinkles};
use crate::wrinkle::profile::Profile;
use crate::wrinkle::section::Station;
use crate::wrinkle::smooth::{smoothed, strides};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Skin with its wrinkles.
#[derive(Debug, Clone, PartialEq)]
pub struct Folded {
    /// #V × 3, mm.
    pub positions: Vec<Point3<f64>>,
    /// The valley of each line.
    pub valleys: Vec<Valley>,
}

/// The bottom of a wrinkle.
#[derive(Debug, Clone, PartialEq)]
pub struct Valley {
    /// Its line's id.
    pub id: String,
    /// From the line's start to its end.
    pub points: Vec<ValleyPoint>,
}

/// A place on a valley.
#[derive(Debug, Clone, PartialEq)]
pub struct ValleyPoint {
    /// Along the line, mm of rest skin.
    pub x_mm: f64,
    /// The triangle of the skin that lies at the bottom.
    pub triangle: u32,
    /// Where in it.
    pub barycentric: [f64; 3],
    /// The bottom, mm.
    pub at: Point3<f64>,
    /// The point of the large-scale surface over it: `at + d_mm · normal`.
    pub surface_point: Point3<f64>,
    /// Unit normal of the large-scale surface there, without fine relief.
    pub normal: Vector3<f64>,
    /// Unit vector across the valley, towards p > 0, perpendicular to valley and normal.
    pub across: Vector3<f64>,
    /// Distance from the bottom to where the section crosses the large-scale surface, mm.
    pub w_mm: f64,
    /// Depth, mm; 0 without a wrinkle.
    pub d_mm: f64,
    /// The whole section.
    pub profile: Profile,
    /// Length of the band on the large-scale surface over its length at rest: below 1 it is compressed.
    pub compression: f64,
    /// Length that the fold takes up over the length that the compression took: 1 conserves the skin's length, less at
    /// the line's ends and where the fold cannot get deeper.
    pub uptake: f64,
}

impl Wrinkles {
    /// Folds the skin at a pose.
    ///
    /// Across each line the skin at rest has a band of length Σ; on the large-scale surface it measures Q. The section
    /// z(q) gets the depth at which its arc length is Q + η (Σ − Q), η = 1 in the core of the line and 0 at its ends;
    /// none where Q ≥ Σ. Skin keeps its arc length along the section: it slides along the large-scale surface, and
    /// leaves it by z along its normal. Where bands overlap, displacements add; beyond them nothing moves by a bit.
    ///
    /// `large_scale`: #V × 3, mm, the mesh of [`Wrinkles::place`] without wrinkles.
    ///
    /// # Panics
    /// If the count of vertices differs: that is a bug of the caller.
    #[must_use]
    pub fn fold(&self, large_scale: &[Point3<f64>]) -> Folded {
        assert_eq!(large_scale.len(), self.vertex_count(), "a deformed mesh keeps its vertices");
        let bends: Vec<Vec<Bend>> =
            self.lines.par_iter().map(|placed| bends(&placed.stations, large_scale, &self.params)).collect();
        let mut positions = large_scale.to_vec();
        for (placed, bends) in self.lines.iter().zip(&bends) {
            for (vertex, displacement) in displacements(placed, bends) {
                positions[vertex as usize] += displacement;
            }
        }
        let valleys = self.lines.iter().zip(&bends);
        Folded {
            positions,
            valleys: valleys.map(|(placed, bends)| valley(placed, bends, large_scale)).collect(),
        }
    }
}

fn bends(stations: &[Station], large_scale: &[Point3<f64>], params: &Params) -> Vec<Bend> {
    let mut poses: Vec<Pose> =
        stations.par_iter().map(|station| Pose::of(station, large_scale, params.station_mm)).collect();
    even_normals(stations, &mut poses, params);
    let budgets = even_budgets(stations, &poses, params);
    let bend = |((station, pose), budget)| Bend::new(station, pose, budget, params);
    stations.par_iter().zip(poses).zip(budgets).map(bend).collect()
}

/// Normals of triangles are averaged over this length across and along a line, mm.
const NORMAL_MM: f64 = 1.5;

/// Averages normals across each section, then along the line between samples at the same place.
fn even_normals(stations: &[Station], poses: &mut [Pose], params: &Params) {
    let even = strides(NORMAL_MM / params.station_mm);
    poses.par_iter_mut().for_each(|pose| pose.normals = smoothed(&pose.normals, &even));
    for &stride in &even {
        let before: Vec<&Vec<Vector3<f64>>> = poses.iter().map(|pose| &pose.normals).collect();
        let sample = |i: usize, from_zero: isize| {
            let k = stations[i].zero as isize + from_zero;
            usize::try_from(k).ok().and_then(|k| before[i].get(k))
        };
        let averaged = |i: usize| -> Vec<Vector3<f64>> {
            let step = stride.min(i).min(before.len() - 1 - i);
            let own = |(k, normal): (usize, &Vector3<f64>)| {
                let from_zero = k as isize - stations[i].zero as isize;
                // Sections differ in length: what has no neighbours keeps its own.
                match (sample(i - step, from_zero), sample(i + step, from_zero)) {
                    (Some(one), Some(other)) => normal * 0.5 + (one + other) * 0.25,
                    _ => *normal,
                }
            };
            before[i].iter().enumerate().map(own).collect()
        };
        let after: Vec<Vec<Vector3<f64>>> = (0..before.len()).into_par_iter().map(averaged).collect();
        poses.iter_mut().zip(after).for_each(|(pose, normals)| pose.normals = normals);
    }
}

/// Budgets whose share of the band is averaged along the line; each keeps its own band.
fn even_budgets(stations: &[Station], poses: &[Pose], params: &Params) -> Vec<Budget> {
    let spacing = stations[1].x - stations[0].x;
    let share = |(station, pose): (&Station, &Pose)| {
        let Budget { lost, pressed: [left, right] } = pose.budget;
        Vector3::new(lost, left, right) / station.band()
    };
    let shares: Vec<Vector3<f64>> = stations.iter().zip(poses).map(share).collect();
    let even = smoothed(&shares, &strides(params.smoothing_mm / spacing));
    let budget = |(station, share): (&Station, Vector3<f64>)| {
        let sum = share * station.band();
        Budget { lost: sum.x, pressed: [sum.y, sum.z] }
    };
    stations.iter().zip(even).map(budget).collect()
}

/// The vertices that a line moves, and how.
fn displacements(placed: &Placed, bends: &[Bend]) -> Vec<(u32, Vector3<f64>)> {
    let displacement = |at: &crate::wrinkle::reach::Beside| {
        let station = at.station as usize;
        let of = |i: usize| bends[i].displacement(&placed.stations[i], at.p);
        let sum = of(station) * (1.0 - at.share) + of(station + 1) * at.share;
        // Adding zero could still turn −0 into 0.
        (sum != Vector3::zeros()).then_some((at.vertex, sum))
    };
    placed.beside.par_iter().filter_map(displacement).collect()
}

fn valley(placed: &Placed, bends: &[Bend], large_scale: &[Point3<f64>]) -> Valley {
    let feet: Vec<(Point3<f64>, Vector3<f64>)> = placed
        .stations
        .iter()
        .zip(bends)
        .map(|(station, bend)| {
            let (slid, normal) = bend.foot(station);
            (station.spots[station.zero].at(large_scale) + slid, normal)
        })
        .collect();
    let bottom = |i: usize| feet[i].0 - feet[i].1 * bends[i].profile.d_mm;
    let last = feet.len() - 1;
    let point = |i: usize| {
        let ((surface_point, normal), bend) = (feet[i], &bends[i]);
        let spot = &placed.stations[i].spots[placed.stations[i].zero];
        let along = bottom((i + 1).min(last)) - bottom(i.saturating_sub(1));
        ValleyPoint {
            x_mm: placed.stations[i].x,
            triangle: spot.triangle,
            barycentric: spot.barycentric,
            at: bottom(i),
            surface_point,
            normal,
            across: normal.cross(&along).try_normalize(0.0).unwrap_or_else(Vector3::zeros),
            w_mm: bend.profile.w_mm,
            d_mm: bend.profile.d_mm,
            profile: bend.profile,
            compression: bend.compression,
            uptake: bend.uptake,
        }
    };
    Valley { id: placed.line.id.clone(), points: (0..feet.len()).map(point).collect() }
}
