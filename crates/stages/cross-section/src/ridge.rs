//! Where the paint lies and where it is dark: the first guess of a valley.

use crate::plan::NOISE;
use crate::problem::Row;

/// How far the paint reaches to both sides, about: the median over stations of half of its extent, with what erosion took.
pub(crate) fn half_width(places: impl Iterator<Item = (usize, f64)>) -> f64 {
    let mut extents: Vec<[f64; 2]> = Vec::new();
    for (station, p) in places {
        if extents.len() <= station {
            extents.resize(station + 1, [f64::INFINITY, f64::NEG_INFINITY]);
        }
        let extent = &mut extents[station];
        *extent = [extent[0].min(p), extent[1].max(p)];
    }
    let mut halves: Vec<f64> = extents
        .iter()
        .filter(|extent| extent[1] > extent[0])
        .map(|extent| 0.5 * (extent[1] - extent[0]) + 2.5)
        .collect();
    if halves.is_empty() {
        return 1.0;
    }
    let middle = halves.len() / 2;
    *halves.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Where the valley runs beside the curve, per station: the middle of what is dark, smoothed.
pub(crate) fn ridge(rows: &[Row], stations: usize) -> Vec<f64> {
    let mut bins: Vec<Vec<[f64; 2]>> = vec![Vec::new(); stations];
    for row in rows {
        let nearest = row.station + usize::from(row.share > 0.5);
        bins[nearest].push([row.p, row.light]);
    }
    let found: Vec<[f64; 2]> = bins.iter().map(|bin| dark_middle(bin)).collect();
    let weighted = |at: usize| {
        let mut sums = [1e-9, 0.0];
        for other in at.saturating_sub(2)..(at + 3).min(found.len()) {
            let weight = found[other][0] / (1.0 + (other as f64 - at as f64).powi(2));
            sums = [sums[0] + weight, sums[1] + weight * found[other][1]];
        }
        sums[1] / sums[0]
    };
    (0..found.len()).map(weighted).collect()
}

/// How much is dark across the curve, and the middle of it.
fn dark_middle(bin: &[[f64; 2]]) -> [f64; 2] {
    if bin.len() < 8 {
        return [0.0; 2];
    }
    let mut lights: Vec<f64> = bin.iter().map(|[_, light]| *light).collect();
    lights.sort_by(f64::total_cmp);
    let (dark, bright) = (lights[lights.len() / 20], lights[lights.len() * 9 / 10]);
    let threshold = bright - 0.4 * (bright - dark);
    let mut sums = [0.0; 2];
    for [p, light] in bin.iter().filter(|[_, light]| *light < threshold) {
        let weight = threshold - light;
        sums = [sums[0] + weight, sums[1] + weight * p];
    }
    match sums[0] > 0.0 {
        // Noise has dark pixels as well: only what is much darker counts.
        true => [(bright - dark - 3.0 * NOISE[0]).max(0.0) + 1e-6, sums[1] / sums[0]],
        false => [0.0; 2],
    }
}
