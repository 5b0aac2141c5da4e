//! Skin along sections, and what lies between two sections.

use artifact::ProfileShape;

/// Steps of the arc length's integral between the crease and the rim.
const ARC_STEPS: usize = 24;

/// How much skin, mm, lies between the crease and a distance `p` ≥ 0 on a side (±1).
fn arc_mm(section: &ProfileShape, p: f64, side: f64) -> f64 {
    let step = p / ARC_STEPS as f64;
    let speed = |i: usize| (1.0 + section.at(side * (i as f64 + 0.5) * step).1.powi(2)).sqrt();
    (0..ARC_STEPS).map(speed).sum::<f64>() * step
}

/// The distance from the crease, ≥ 0, up to which there are `arc` mm of skin: the inverse of [`arc_mm`].
pub(crate) fn distance_of_arc(section: &ProfileShape, arc: f64, side: f64) -> f64 {
    let mut p = arc;
    for _ in 0..8 {
        let slope = (1.0 + section.at(side * p).1.powi(2)).sqrt();
        p = (p - (arc_mm(section, p, side) - arc) / slope).clamp(0.0, arc);
    }
    p
}

/// Between two sections.
pub(crate) fn between(one: &ProfileShape, other: &ProfileShape, share: f64) -> ProfileShape {
    let mix = |a: f64, b: f64| a + share * (b - a);
    ProfileShape {
        w: mix(one.w, other.w),
        d: mix(one.d, other.d),
        epsilon: mix(one.epsilon, other.epsilon),
        kappa: mix(one.kappa, other.kappa),
    }
}

/// `3x² − 2x³` between 0 and 1, constant outside.
pub(crate) fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arc_lengths_turn_back_into_distances() {
        let section = ProfileShape { w: 1.5, d: 0.6, epsilon: 0.3, kappa: 0.2 };
        for (p, side) in [(0.3, 1.0), (1.0, -1.0), (1.7, 1.0)] {
            let arc = arc_mm(&section, p, side);
            assert!(arc > p && (distance_of_arc(&section, arc, side) - p).abs() < 1e-6, "{p}");
        }
    }
}
