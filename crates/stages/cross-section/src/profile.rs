//! How steep profiles are.

/// D over d.
fn steepness(epsilon: f64) -> f64 {
    epsilon.exp() / (1.0 - epsilon)
}

/// D / w_s over d / w, and its logarithmic derivative in ε.
pub(crate) fn steepness_of_scale(epsilon: f64) -> (f64, f64) {
    let rest = 1.0 - epsilon * epsilon;
    (rest.sqrt() * steepness(epsilon), 1.0 + 1.0 / (1.0 - epsilon) - epsilon / rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_derivative_of_the_steepness_is_right() {
        for epsilon in [0.0, 0.2, 0.5, 0.8] {
            let step = 1e-6;
            let log = |epsilon: f64| steepness_of_scale(epsilon).0.ln();
            let difference = (log(epsilon + step) - log(epsilon - step)) / (2.0 * step);
            assert!((difference - steepness_of_scale(epsilon).1).abs() < 1e-6);
        }
    }
}
