//! Which vertices lie beside a line, and where.

use crate::wrinkle::section::Station;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::Point3;
use rayon::prelude::*;

/// A vertex beside a line: between two sections, `share` of the way from `station` to the next.
#[derive(Debug, Clone, Copy)]
pub(super) struct Beside {
    pub(super) vertex: u32,
    pub(super) station: u32,
    pub(super) share: f64,
    pub(super) p: f64,
}

/// Vertices beside a line in its coordinates.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Coordinates {
    /// Vertices, rising.
    pub vertices: Vec<u32>,
    /// Per vertex its place along the line, mm of rest skin from the line's start.
    pub x_mm: Vec<f64>,
    /// Per vertex its signed distance across the line, mm of rest skin.
    pub p_mm: Vec<f64>,
}

/// Farther than this above or below the section, a vertex is on another sheet of the skin: at p = 0, mm, and per mm of p.
const SHEET: [f64; 2] = [1.5, 0.15];
/// Sections looked at on either side of the nearest station.
const SEARCH: usize = 6;

/// The vertices within `radius` mm of a line's stations whose foot falls on the line, rising.
pub(super) fn vertices_beside(stations: &[Station], rest: &[Point3<f64>], radius: f64) -> Vec<Beside> {
    let points: Vec<[f64; 3]> = stations.iter().map(|station| station.origin.into()).collect();
    let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&points) else { return Vec::new() };
    let low = stations.iter().fold(stations[0].origin, |low, s| low.inf(&s.origin)).map(|x| x - radius);
    let high = stations.iter().fold(stations[0].origin, |high, s| high.sup(&s.origin)).map(|x| x + radius);
    let beside = |(vertex, point): (usize, &Point3<f64>)| {
        if !(0..3).all(|axis| (low[axis]..=high[axis]).contains(&point[axis])) {
            return None;
        }
        let nearest = tree.query(&(*point).into()).nearest_one::<SquaredEuclidean<f64>>().execute();
        match nearest.distance <= radius * radius {
            true => foot(stations, nearest.item as usize, point, vertex as u32),
            false => None,
        }
    };
    rest.par_iter().enumerate().filter_map(beside).collect()
}

/// The place between two sections whose planes enclose the point, near station `near`.
fn foot(stations: &[Station], near: usize, point: &Point3<f64>, vertex: u32) -> Option<Beside> {
    let ahead = |i: usize| (point - stations[i].origin).dot(&stations[i].along);
    let encloses = |i: &usize| ahead(*i) >= 0.0 && ahead(*i + 1) < 0.0;
    let first = near.saturating_sub(SEARCH);
    let last = (near + SEARCH).min(stations.len() - 1);
    // The nearest interval first.
    let outwards = (0..=SEARCH).flat_map(|off| [near.checked_sub(off + 1), Some(near + off)]).flatten();
    let station = outwards.filter(|i| (first..last).contains(i)).find(encloses)?;
    let (one, other) = (&stations[station], &stations[station + 1]);
    let share = ahead(station) / (ahead(station) - ahead(station + 1));
    let lateral = |station: &Station| (point - station.origin).dot(&station.across);
    let lateral = lateral(one) * (1.0 - share) + lateral(other) * share;
    let p = one.p_of_lateral(lateral) * (1.0 - share) + other.p_of_lateral(lateral) * share;
    let on_skin = one.rest_at(p) * (1.0 - share) + other.rest_at(p) * share;
    let is_covered =
        [one, other].iter().any(|station| station.p[0] <= p && p <= station.p[station.p.len() - 1]);
    let off = (point.coords - on_skin).norm();
    (is_covered && off <= SHEET[0] + SHEET[1] * p.abs()).then_some(Beside {
        vertex,
        station: station as u32,
        share,
        p,
    })
}
