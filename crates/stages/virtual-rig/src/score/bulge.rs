//! The bulges that rise between neighbouring valleys.

use super::grid::Grid;
use super::polyline;
use super::region::foot;
use artifact::ValleysFrame;
use nalgebra::{Point3, Vector3};

/// Two valleys are neighbours where they lie no farther apart than this many times the sum of their widths: beyond, the
/// bulges of both have flattened before they meet.
const NEIGHBORS: f64 = 4.0;
/// A bulge is looked for so near to the straight way from valley to valley, in widths.
const BESIDE: f64 = 0.5;

/// A way across the skin between two neighbouring valleys.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    from: Point3<f64>,
    to: Point3<f64>,
    width: f64,
}

/// An open valley on the surface without wrinkles.
struct OpenValley {
    feet: Vec<Vector3<f64>>,
    widths: Vec<f64>,
}

/// The crossings of a frame: from every point of an open valley to the nearest place of every later one (by id) that is its
/// neighbour, where no third valley lies between.
pub(super) fn crossings(
    surface: &[Point3<f64>],
    triangles: &[[u32; 3]],
    valleys: &ValleysFrame,
) -> Vec<Crossing> {
    let open = |points: &Vec<artifact::ValleyPoint>| {
        let feet = points.iter().filter(|point| point.d_mm > 0.0);
        let (feet, widths) =
            feet.filter_map(|point| Some((foot(surface, triangles, point)?.coords, point.w_mm))).unzip();
        OpenValley { feet, widths }
    };
    let valleys: Vec<OpenValley> =
        valleys.valleys.values().map(open).filter(|valley| valley.feet.len() > 1).collect();
    let mut found = Vec::new();
    for (i, one) in valleys.iter().enumerate() {
        for (j, other) in valleys.iter().enumerate().skip(i + 1) {
            let thirds: Vec<&OpenValley> = valleys
                .iter()
                .enumerate()
                .filter(|(k, _)| *k != i && *k != j)
                .map(|(_, valley)| valley)
                .collect();
            found.extend((0..one.feet.len()).filter_map(|at| crossing(one, at, other, &thirds)));
        }
    }
    found
}

fn crossing(one: &OpenValley, at: usize, other: &OpenValley, thirds: &[&OpenValley]) -> Option<Crossing> {
    let (from, width) = (one.feet[at], one.widths[at]);
    let there = polyline::nearest(&other.feet, &from).filter(|foot| !foot.beyond)?;
    let other_width = there.value(|i| other.widths[i]);
    if there.distance > NEIGHBORS * (width + other_width) {
        return None;
    }
    let to = Vector3::from_fn(|axis, _| there.value(|i| other.feet[i][axis]));
    let middle = 0.5 * (from + to);
    let between = |third: &&OpenValley| {
        polyline::nearest(&third.feet, &middle).is_some_and(|foot| foot.distance < 0.5 * there.distance)
    };
    (!thirds.iter().any(between)).then_some(Crossing {
        from: from.into(),
        to: to.into(),
        width: 0.5 * (width + other_width),
    })
}

/// The highest vertex beside each crossing, once for every field of heights (one per vertex); none where no vertex is near.
pub(super) fn heights<const N: usize>(
    surface: &[Point3<f64>],
    crossings: &[Crossing],
    fields: [&[f64]; N],
) -> Vec<[f64; N]> {
    let Some(widest) = crossings.iter().map(|crossing| crossing.width).reduce(f64::max) else {
        return Vec::new();
    };
    let grid = Grid::of(surface, widest);
    let highest = |crossing: &Crossing| {
        let along = crossing.to - crossing.from;
        let near = BESIDE * crossing.width;
        let mut best = [f64::NEG_INFINITY; N];
        grid.near(&nalgebra::center(&crossing.from, &crossing.to), 0.5 * along.norm() + near, |vertex| {
            let share =
                (surface[vertex] - crossing.from).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
            let distance = (surface[vertex] - (crossing.from + share.clamp(0.0, 1.0) * along)).norm();
            if distance <= near {
                (0..N).for_each(|field| best[field] = best[field].max(fields[field][vertex]));
            }
        });
        best[0].is_finite().then_some(best)
    };
    crossings.iter().filter_map(highest).collect()
}
