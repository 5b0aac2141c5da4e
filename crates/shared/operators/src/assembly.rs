//! Assembly of the operators.

use nalgebra::Point3;
use sprs::{CsMat, TriMat};

/// Triangles whose shape had to be tempered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Slivers {
    /// Triangles whose cotangents were scaled down to the limit.
    pub tempered: usize,
    /// Triangles whose corners lie in one place, left out.
    pub collapsed: usize,
}

/// Cotangent stiffness `L` [Meyer2003, Eq. 8; integrated]: `L_ij = −(cot αᵢⱼ + cot βᵢⱼ)/2`, rows sum to zero, so
/// that `uᵀ L u = ∫ ‖∇u‖²` for piecewise linear u.
///
/// `points`: #V, any unit; `triangles`: #F. The result is #V × #V, positive semi-definite, without unit.
/// Obtuse triangles keep their negative cotangents. Only needles and caps with a cotangent beyond `cotangent_limit`
/// (angles of a hundredth of a degree for 1e4), which would drown everything else in rounding, have all three of theirs
/// scaled down to it: cut one by one, they would make the matrix indefinite.
#[must_use]
pub fn cotan_stiffness(
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    cotangent_limit: f64,
) -> (CsMat<f64>, Slivers) {
    assemble(points, triangles, cotangent_limit, |_| 1.0)
}

/// Cotangent stiffness of a surface whose stiffness varies: `uᵀ L u = ∫ κ ‖∇u‖²`, κ constant on each triangle.
///
/// As [`cotan_stiffness`]; `weights`: #F, κ ≥ 0.
///
/// # Panics
/// If there is not one weight per triangle.
#[must_use]
pub fn weighted_cotan_stiffness(
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    weights: &[f64],
    cotangent_limit: f64,
) -> CsMat<f64> {
    assert_eq!(weights.len(), triangles.len(), "one weight per triangle");
    assemble(points, triangles, cotangent_limit, |triangle| weights[triangle]).0
}

fn assemble(
    points: &[Point3<f64>],
    triangles: &[[u32; 3]],
    cotangent_limit: f64,
    stiffness: impl Fn(usize) -> f64,
) -> (CsMat<f64>, Slivers) {
    let mut entries = TriMat::with_capacity((points.len(), points.len()), triangles.len() * 12);
    let mut slivers = Slivers::default();
    for (number, triangle) in triangles.iter().enumerate() {
        let corner = triangle.map(|vertex| points[vertex as usize]);
        let spokes = |i: usize| (corner[(i + 1) % 3] - corner[i], corner[(i + 2) % 3] - corner[i]);
        let dots: [f64; 3] = std::array::from_fn(|i| spokes(i).0.dot(&spokes(i).1));
        let double_area = spokes(0).0.cross(&spokes(0).1).norm();
        let least_area = dots.iter().fold(0.0, |largest: f64, dot| largest.max(dot.abs())) / cotangent_limit;
        if least_area == 0.0 {
            slivers.collapsed += 1;
            continue;
        }
        slivers.tempered += usize::from(double_area < least_area);
        for i in 0..3 {
            let weight = 0.5 * stiffness(number) * dots[i] / double_area.max(least_area);
            let (j, k) = (triangle[(i + 1) % 3] as usize, triangle[(i + 2) % 3] as usize);
            entries.add_triplet(j, k, -weight);
            entries.add_triplet(k, j, -weight);
            entries.add_triplet(j, j, weight);
            entries.add_triplet(k, k, weight);
        }
    }
    (entries.to_csr(), slivers)
}

/// Smallest vertex area, as a share of the median, that is taken at its word.
const MASS_FLOOR: f64 = 1e-8;

/// Lumped mass: mixed Voronoi area per vertex [Meyer2003, Sec. 3.3], in the square of the positions' unit. Areas below
/// 10⁻⁸ of the median (slivers, vertices without triangles) are raised to that, so that `M⁻¹` exists.
#[must_use]
pub fn lumped_mass(points: &[Point3<f64>], triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut areas = mesh::mixed_voronoi_areas(points, triangles);
    let mut sorted: Vec<f64> = areas.iter().copied().filter(|&area| area > 0.0).collect();
    let middle = sorted.len() / 2;
    let median = match sorted.is_empty() {
        true => 1.0,
        false => *sorted.select_nth_unstable_by(middle, f64::total_cmp).1,
    };
    areas.iter_mut().for_each(|area| *area = area.max(MASS_FLOOR * median));
    areas
}

/// `a L + b L M⁻¹ L`: stretching and bending of a displacement field, in one matrix [BickelBotsch2007, Eq. 4].
///
/// `mass`: #V lumped areas. With positions in mm, `a` has no unit and `b` is in mm².
///
/// # Panics
/// If `mass` does not have one entry per row.
#[must_use]
pub fn bilaplacian(stiffness: &CsMat<f64>, mass: &[f64], a: f64, b: f64) -> CsMat<f64> {
    assert_eq!(mass.len(), stiffness.rows(), "one area per vertex");
    let mut pointwise = stiffness.clone();
    for (row, mut entries) in pointwise.outer_iterator_mut().enumerate() {
        entries.iter_mut().for_each(|(_, value)| *value *= b / mass[row]);
    }
    let bending = stiffness * &pointwise;
    match a == 0.0 {
        true => bending,
        false => &bending + &stiffness.map(|value| a * value),
    }
}
