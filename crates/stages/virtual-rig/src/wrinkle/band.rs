//! How far each wrinkle reaches: to its own widths, half way to its neighbour, not past the edge of the skin.

use crate::wrinkle::params::Params;
use crate::wrinkle::section::{Side, Station};
use crate::wrinkle::smooth::{eroded, smoothed, strides};

/// Past the half way to a neighbour, a profile's tail goes on to this share of the half way, so that the bulges of
/// neighbours meet in a ridge; it ends before the neighbour's valley.
const OVERLAP: f64 = 1.7;
/// Where neighbours are near, a wrinkle is at most this share of the half way wide: bulges are highest at twice the width.
const SLENDER: f64 = 0.55;
/// Bands widen and narrow over about this length along a line, mm.
const EVEN_MM: f64 = 2.0;

/// Sets the bands of all stations of all lines.
pub(super) fn set(lines: &mut [Vec<Station>], params: &Params) {
    let limits: Vec<Vec<[f64; 2]>> = (0..lines.len())
        .map(|line| lines[line].iter().map(|station| half_ways(station, lines, line)).collect())
        .collect();
    for (stations, limits) in lines.iter_mut().zip(&limits) {
        for side in 0..2 {
            set_side(stations, side, &limits.iter().map(|both| both[side]).collect::<Vec<_>>(), params);
        }
    }
}

/// Where the section leaves its line's Voronoi cell among all lines' stations, on both sides, mm.
fn half_ways(station: &Station, lines: &[Vec<Station>], own: usize) -> [f64; 2] {
    let others = lines.iter().enumerate().filter(|(line, _)| *line != own).flat_map(|(_, stations)| stations);
    let mut least = [f64::INFINITY; 2];
    for other in others {
        let way = other.origin - station.origin;
        let across = way.dot(&station.across);
        let side = usize::from(across > 0.0);
        if across != 0.0 {
            least[side] = least[side].min(0.5 * way.norm_squared() / across.abs());
        }
    }
    least
}

fn set_side(stations: &mut [Station], side: usize, half_ways: &[f64], params: &Params) {
    let spacing = if stations.len() > 1 { stations[1].x - stations[0].x } else { params.station_mm };
    let even = strides(EVEN_MM / spacing);
    let halo: usize = even.iter().sum();
    let skin: Vec<f64> = stations.iter().map(|station| station.ends()[side]).collect();
    let skin = smoothed(&eroded(&skin, halo), &even);
    let own = |station: &Station, factor: f64| factor * station.width;
    let free: Vec<f64> =
        stations.iter().zip(half_ways).map(|(station, &half)| own(station, params.reach).min(half)).collect();
    let free = smoothed(&free, &even);
    for (i, station) in stations.iter_mut().enumerate() {
        let demand = free[i].min(skin[i]);
        let end = own(station, params.reach).min(OVERLAP * free[i]).min(skin[i]);
        station.sides[side] = Side { demand, end };
        if params.fixed.is_none() {
            station.width = station.width.min(SLENDER * free[i]);
        }
    }
}
