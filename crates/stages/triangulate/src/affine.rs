//! How the neighbours' motion moves a place: a local affine fit, as a sum with fixed coefficients.

use nalgebra::{Matrix4, Point3, Vector3, Vector4};

/// With fewer neighbours there is no fit.
pub(crate) const LEAST_NEIGHBORS: usize = 4;
/// Neighbours that are looked for.
pub(crate) const NEIGHBORS: usize = 12;
/// Resistance of the affine map's linear part, as a share of the neighbours' spread: faces are flat, and across the surface
/// nothing else holds the map.
const RIDGE: f64 = 0.01;

/// A neighbour of a place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Neighbor {
    pub(crate) marker: usize,
    /// From the place to the neighbour, mm.
    pub(crate) arm: Vector3<f64>,
    pub(crate) weight: f64,
}

/// The nearest of some markers, with weights that fall to 0 at the distance of the first one that is left out, so that
/// nothing jumps where neighbours take turns.
pub(crate) fn nearest(
    place: &Point3<f64>,
    others: impl Iterator<Item = (usize, Point3<f64>)>,
) -> Vec<Neighbor> {
    let arms = others.map(|(marker, other)| (marker, other - place));
    let mut arms: Vec<(f64, usize, Vector3<f64>)> =
        arms.map(|(marker, arm)| (arm.norm_squared(), marker, arm)).collect();
    let by_distance = |a: &(f64, usize, Vector3<f64>), b: &(f64, usize, Vector3<f64>)| {
        a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
    };
    if arms.len() > NEIGHBORS {
        arms.select_nth_unstable_by(NEIGHBORS, by_distance);
        arms.truncate(NEIGHBORS + 1);
    }
    arms.sort_unstable_by(by_distance);
    let reach = match arms.len() > NEIGHBORS {
        true => arms.pop().map_or(1.0, |(square, ..)| square),
        // There is no next one: it is taken to be a little further away.
        false => arms.last().map_or(1.0, |(square, ..)| 1.5 * square),
    };
    let neighbor = |(square, marker, arm): (f64, usize, Vector3<f64>)| {
        let weight = (1.0 - square / reach).max(0.0).powi(2);
        Neighbor { marker, arm, weight }
    };
    arms.into_iter().map(neighbor).filter(|neighbor| neighbor.weight > 0.0).collect()
}

/// Coefficients cⱼ, of sum 1, with which Σ cⱼ uⱼ is the value at the place of the affine map fitted to values uⱼ at the
/// neighbours by weighted least squares; none from too few neighbours.
pub(crate) fn coefficients(neighbors: &[Neighbor]) -> Option<Vec<f64>> {
    if neighbors.len() < LEAST_NEIGHBORS {
        return None;
    }
    let row = |neighbor: &Neighbor| Vector4::new(neighbor.arm.x, neighbor.arm.y, neighbor.arm.z, 1.0);
    let mut normal = Matrix4::zeros();
    for neighbor in neighbors {
        normal += neighbor.weight * row(neighbor) * row(neighbor).transpose();
    }
    let ridge = RIDGE * normal.fixed_view::<3, 3>(0, 0).trace();
    (0..3).for_each(|i| normal[(i, i)] += ridge);
    let at_place = normal.cholesky()?.solve(&Vector4::w());
    Some(neighbors.iter().map(|neighbor| neighbor.weight * row(neighbor).dot(&at_place)).collect())
}
