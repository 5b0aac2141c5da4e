//! Nearest points.

use nalgebra::Point3;

/// Shares of the corners at the point of a triangle that is nearest to a point: by which corner, side or inside it is nearest to
/// [Ericson2004, Sec. 5.1.5]. They add up to 1, and none is negative.
#[must_use]
pub fn nearest_in_triangle(point: &Point3<f64>, [a, b, c]: &[Point3<f64>; 3]) -> [f64; 3] {
    let (ab, ac, ap) = (b - a, c - a, point - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bp = point - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let cp = point - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let share = d1 / (d1 - d3);
        return [1.0 - share, share, 0.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let share = d2 / (d2 - d6);
        return [1.0 - share, 0.0, share];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let share = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - share, share];
    }
    let whole = va + vb + vc;
    let (v, w) = (vb / whole, vc / whole);
    [(1.0 - v - w).max(0.0), v, w]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = Point3<f64>> {
        prop::array::uniform3(-3.0..3.0f64).prop_map(Point3::from)
    }

    proptest! {
        #[test]
        fn no_point_of_the_triangle_is_nearer(
            at in point(),
            corners in [point(), point(), point()],
            shares in prop::array::uniform3(0.0..1.0f64),
        ) {
            let of = |shares: [f64; 3]| {
                let sum: f64 = shares.iter().sum();
                let along = |k: usize| corners[k].coords * (shares[k] / sum);
                (at.coords - (along(0) + along(1) + along(2))).norm()
            };
            let nearest = nearest_in_triangle(&at, &corners);
            prop_assert!(nearest.iter().all(|share| *share >= 0.0));
            prop_assert!((nearest.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            prop_assert!(of(nearest) <= of(shares.map(|share| share + 1e-3)) + 1e-9);
        }
    }
}
