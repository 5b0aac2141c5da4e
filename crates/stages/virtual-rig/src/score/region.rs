//! Which vertices lie how far from the valleys of a frame.

use super::grid::Grid;
use artifact::{ValleyPoint, ValleysFrame};
use nalgebra::Point3;

/// The foot of a valley's point on the surface without wrinkles.
pub(super) fn foot(
    surface: &[Point3<f64>],
    triangles: &[[u32; 3]],
    point: &ValleyPoint,
) -> Option<Point3<f64>> {
    let corners = triangles.get(point.face as usize)?;
    let share = |i: usize| Some(point.barycentric[i] * surface.get(corners[i] as usize)?.coords);
    Some(Point3::from(share(0)? + share(1)? + share(2)?))
}

/// Per vertex its distance to the nearest valley of the frame in widths w of that valley there, infinite beyond `reach` widths.
/// Valleys without depth are none.
pub(super) fn distance_in_widths(
    surface: &[Point3<f64>],
    triangles: &[[u32; 3]],
    valleys: &ValleysFrame,
    reach: f64,
) -> Vec<f64> {
    let mut widths = vec![f64::INFINITY; surface.len()];
    let widest = valleys.valleys.values().flatten().map(|point| point.w_mm).fold(0.0, f64::max);
    if widest == 0.0 {
        return widths;
    }
    let grid = Grid::of(surface, 0.5 * reach * widest);
    for points in valleys.valleys.values() {
        let feet: Vec<(Point3<f64>, f64, f64)> = points
            .iter()
            .filter_map(|point| Some((foot(surface, triangles, point)?, point.w_mm, point.d_mm)))
            .collect();
        for pair in feet.windows(2).filter(|pair| pair[0].2 > 0.0 || pair[1].2 > 0.0) {
            add_segment(&mut widths, surface, &grid, reach, [(pair[0].0, pair[0].1), (pair[1].0, pair[1].1)]);
        }
    }
    widths
}

fn add_segment(
    widths: &mut [f64],
    surface: &[Point3<f64>],
    grid: &Grid,
    reach: f64,
    [(from, from_width), (to, to_width)]: [(Point3<f64>, f64); 2],
) {
    let along = to - from;
    let far = reach * from_width.max(to_width);
    grid.near(&nalgebra::center(&from, &to), far + 0.5 * along.norm(), |vertex| {
        let place = (surface[vertex] - from).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
        let share = place.clamp(0.0, 1.0);
        let distance = (surface[vertex] - (from + share * along)).norm();
        let width = from_width + share * (to_width - from_width);
        if width > 0.0 && distance <= reach * width {
            widths[vertex] = widths[vertex].min(distance / width);
        }
    });
}
