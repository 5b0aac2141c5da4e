//! Bare skin beside the paint: the same valley shades it, whatever its colour is.

use crate::paint::Pixel;
use crate::problem::Row;
use std::collections::{BTreeMap, BTreeSet};

/// Cells are so wide across the wrinkle, px; along it they are as long as stations are apart.
const CELL_PX: f64 = 2.0;
/// Pixels that a cell needs.
const LEAST_PIXELS: usize = 6;
/// Cells in a row that a side of a station needs: their level is their own.
const LEAST_CELLS: usize = 3;

/// Cells beside each other on one side of the paint, between two stations.
pub(crate) type Group = Vec<Row>;

/// Groups of cells from the skin's pixels, of which `row` says where they lie; from the paint outwards until something else begins.
pub(crate) fn groups(pixels: &[Pixel], intervals: usize, row: impl Fn(&Pixel) -> Row) -> Vec<Group> {
    let mut cells: BTreeMap<(usize, bool, i64), Vec<Row>> = BTreeMap::new();
    for pixel in pixels {
        let row = row(pixel);
        let cell = (pixel.p.abs() / CELL_PX) as i64;
        cells.entry((row.station.min(intervals - 1), pixel.p > 0.0, cell)).or_default().push(row);
    }
    let mut groups: Vec<Group> = Vec::new();
    let mut last: Option<(usize, bool, i64)> = None;
    let mut is_open = false;
    for (at, rows) in &cells {
        let is_same = last.is_some_and(|last| (last.0, last.1) == (at.0, at.1));
        if !is_same {
            groups.push(Vec::new());
            is_open = true;
        }
        let is_next = !is_same || last.is_some_and(|last| last.2 + 1 == at.2);
        let is_full = rows.len() >= LEAST_PIXELS;
        let Some(group) = groups.last_mut() else { continue };
        if is_open && is_full && (is_next || group.is_empty()) {
            group.push(mean(rows));
        } else if !group.is_empty() {
            is_open = false;
        }
        last = Some(*at);
    }
    groups.retain(|group| group.len() >= LEAST_CELLS);
    on_both_sides(groups)
}

/// The groups whose station has one on its other side too: one side alone cannot tell a valley from light that rises.
fn on_both_sides(groups: Vec<Group>) -> Vec<Group> {
    let side = |group: &Group| (group[0].station, group[0].p > 0.0);
    let sides: BTreeSet<(usize, bool)> = groups.iter().map(side).collect();
    let other = |(station, is_right): (usize, bool)| (station, !is_right);
    groups.into_iter().filter(|group| sides.contains(&other(side(group)))).collect()
}

fn mean(rows: &[Row]) -> Row {
    let share = 1.0 / rows.len() as f64;
    let of = |value: fn(&Row) -> f64| rows.iter().map(value).sum::<f64>() * share;
    Row {
        station: rows[0].station,
        share: of(|row| row.share),
        p: of(|row| row.p),
        light: of(|row| row.light),
        weight: 1.0,
    }
}

/// All groups as two, by the distance from the creases: what lies on the left and on the right of a wrinkle that is the same everywhere.
pub(crate) fn collapsed(groups: &[Group], crease: impl Fn(&Row) -> f64) -> Vec<Group> {
    let mut bins: BTreeMap<(bool, i64), [f64; 3]> = BTreeMap::new();
    for group in groups {
        let level = group.iter().map(|row| row.light).sum::<f64>() / group.len() as f64;
        for row in group {
            let p = row.p - crease(row);
            let bin = bins.entry((row.p > 0.0, (p / CELL_PX).round() as i64)).or_default();
            *bin = [bin[0] + 1.0, bin[1] + p, bin[2] + row.light / level];
        }
    }
    let row = |[count, p, light]: [f64; 3]| Row {
        station: 0,
        share: 0.0,
        p: p / count,
        light: light / count,
        weight: count,
    };
    let side = |right: bool| -> Group {
        bins.iter().filter(|((side, _), _)| *side == right).map(|(_, bin)| row(*bin)).collect()
    };
    [side(false), side(true)].into_iter().filter(|group| group.len() >= LEAST_CELLS).collect()
}
