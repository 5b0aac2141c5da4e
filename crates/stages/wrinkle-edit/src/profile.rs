//! The profile of a section.

use artifact::Section;

/// The height of a section's profile at a distance p (px, growing along its normal) from the crease, px; below the surrounding skin it
/// is negative [BickelBotsch2007, Eq. 6], rounded and asymmetric as [`artifact::Profile`] says.
#[must_use]
pub fn height(section: &Section, p: f64) -> f64 {
    let Section { w_px, d_px, epsilon, kappa, .. } = *section;
    if d_px == 0.0 || w_px == 0.0 {
        return 0.0;
    }
    let side = w_px / (1.0 - epsilon * epsilon).sqrt() * (1.0 + kappa * p.signum());
    let round = (p / side).hypot(epsilon);
    d_px / (1.0 - epsilon) * epsilon.exp() * (round - 1.0) * (-round).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use artifact::SectionState;

    #[test]
    fn it_is_as_deep_and_as_wide_as_it_says() {
        let (tilt_rad, deviation, residual, state) = (None, None, None, SectionState::Edited);
        let (u, at, normal) = (0.0, [0.0; 2], [0.0, 1.0]);
        let sharp = Section {
            u,
            at,
            normal,
            w_px: 5.0,
            d_px: 2.0,
            epsilon: 0.0,
            kappa: 0.0,
            tilt_rad,
            deviation,
            residual,
            state,
        };
        // The paper's bulge: d e⁻² high at 2 w.
        assert!((height(&sharp, 10.0) - 2.0 * (-2.0f64).exp()).abs() < 1e-12);
        let round = Section { epsilon: 0.3, kappa: 0.2, ..sharp };
        for section in [sharp, round] {
            assert!((height(&section, 0.0) + 2.0).abs() < 1e-12);
            for side in [-1.0, 1.0] {
                let rim = side * 5.0 * (1.0 + section.kappa * side);
                assert!(height(&section, rim).abs() < 1e-12, "{side}");
            }
        }
    }
}
