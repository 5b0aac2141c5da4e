//! What the discrete shell energy [Grinspun2003] measures, with derivatives in closed form: lengths, areas, dihedral angles.

use nalgebra::{Point3, Vector3};

/// An edge's length, and its derivative at the second end (that at the first is the opposite).
#[must_use]
pub fn length(points: &[Point3<f64>; 2]) -> (f64, Vector3<f64>) {
    let along = points[1] - points[0];
    let length = along.norm().max(f64::MIN_POSITIVE);
    (length, along / length)
}

/// A triangle's area, and its derivatives: with n the unit normal and eᵢ the side opposite to vertex i, `∂A/∂xᵢ = ½ n × eᵢ`.
#[must_use]
pub fn area(points: &[Point3<f64>; 3]) -> (f64, [Vector3<f64>; 3]) {
    let opposite: [Vector3<f64>; 3] = std::array::from_fn(|i| points[(i + 2) % 3] - points[(i + 1) % 3]);
    let double = opposite[0].cross(&opposite[1]);
    let area = (0.5 * double.norm()).max(f64::MIN_POSITIVE);
    let half_normal = double / (4.0 * area);
    (area, opposite.map(|side| half_normal.cross(&side)))
}

/// The angle between the normals of two triangles that share the edge 0–1, positive where the surface is convex seen from
/// outside, and its derivatives; `points`: both ends of the edge, in the direction in which the first triangle runs along it, then
/// the apex of the first and of the second triangle.
///
/// The derivative at an apex is the normal over the triangle's height, at the edge's ends what keeps forces and moments in
/// balance.
#[must_use]
pub fn dihedral(points: &[Point3<f64>; 4]) -> (f64, [Vector3<f64>; 4]) {
    let along = points[1] - points[0];
    let to_apex = [points[2] - points[0], points[3] - points[0]];
    let area = [along.cross(&to_apex[0]), to_apex[1].cross(&along)];
    let squared = along.norm_squared().max(f64::MIN_POSITIVE);
    let length = squared.sqrt();
    let angle = (area[0].cross(&area[1]).dot(&along) / length).atan2(area[0].dot(&area[1]));
    let [one, other] = area.map(|a| a * (-length / a.norm_squared().max(f64::MIN_POSITIVE)));
    let [s, t] = to_apex.map(|a| a.dot(&along) / squared);
    (angle, [-(one * (1.0 - s) + other * (1.0 - t)), -(one * s + other * t), one, other])
}

/// An angle in (−π, π].
pub(crate) fn wrapped(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};

    fn points<const N: usize>(seed: u64, spread: f64) -> [Point3<f64>; N] {
        let flat = [[0.0, 0.0], [1.0, 0.1], [0.4, 0.9], [0.6, -0.8]];
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let mut shaken = || spread * (random.random::<f64>() - 0.5);
        std::array::from_fn(|i| Point3::new(flat[i][0] + shaken(), flat[i][1] + shaken(), shaken()))
    }

    /// Largest deviation of derivatives from central differences, relative to the largest entry.
    fn deviation<const N: usize>(
        at: [Point3<f64>; N],
        measure: impl Fn(&[Point3<f64>; N]) -> (f64, [Vector3<f64>; N]),
    ) -> f64 {
        let step = 1e-5;
        let slopes = measure(&at).1;
        let (mut worst, mut largest) = (0.0f64, 0.0f64);
        for j in 0..N {
            for c in 0..3 {
                let (mut up, mut down) = (at, at);
                up[j][c] += step;
                down[j][c] -= step;
                let slope = (measure(&up).0 - measure(&down).0) / (2.0 * step);
                worst = worst.max((slope - slopes[j][c]).abs());
                largest = largest.max(slope.abs());
            }
        }
        worst / largest
    }

    #[test]
    fn derivatives_agree_with_differences() {
        for seed in 0..40 {
            let spread = 0.02 * seed as f64;
            let edge = |p: &[Point3<f64>; 2]| {
                let (length, slope) = length(p);
                (length, [-slope, slope])
            };
            let found = [
                deviation(points::<2>(seed, spread), edge),
                deviation(points::<3>(seed, spread), area),
                deviation(points::<4>(seed, spread), dihedral),
            ];
            assert!(found.iter().all(|&found| found < 1e-6), "seed {seed}: {found:?}");
        }
    }

    #[test]
    fn a_fold_beyond_half_a_turn_is_taken_the_short_way() {
        assert!((wrapped(3.5) - (3.5 - std::f64::consts::TAU)).abs() < 1e-15);
        let nearly_closed = |up: f64| {
            let tip = Point3::new(0.5, 1.0, 0.0);
            [Point3::origin(), Point3::new(1.0, 0.0, 0.0), tip, Point3::new(0.5, 1.0, up)]
        };
        let (over, under) = (dihedral(&nearly_closed(0.01)).0, dihedral(&nearly_closed(-0.01)).0);
        assert!(over * under < 0.0 && over.abs() > 3.1);
        assert!(wrapped(under - over).abs() < 0.03);
    }

    #[test]
    fn forces_and_moments_balance() {
        let at = points::<4>(7, 0.5);
        let (_, slopes) = dihedral(&at);
        let force: Vector3<f64> = slopes.iter().sum();
        let moment: Vector3<f64> = (0..4).map(|i| at[i].coords.cross(&slopes[i])).sum();
        assert!(force.norm() < 1e-12 && moment.norm() < 1e-12);
    }
}
