//! Where the skin around a valley lies, which its shading hardly tells.
//!
//! Light across a valley follows its walls: from the bottom to the top of the bulges the relief is known well. How much of it lies below
//! the skin around, and how much above, hangs on the gentle outer side of the bulges, which shades little and often lies beyond the paint.
//! A profile of the rounded family takes it from the rounding of its bottom: ε = 0.6 promises bulges of 0.6 d, ε = 0.8 of 1.5 d, which no
//! skin has. Valleys of another form are read as such: their ratio d/w is right, and both lengths are too short by up to a half.

use artifact::ProfileShape;

/// No valley becomes deeper than this many times: a fit that ends at its roundest says little, and its relief lies beyond the paint.
const MOST_GROWTH: f64 = 2.0;

/// Height of the bulges of a profile over its depth: e^(ε − 2)/(1 − ε), the paper's e⁻² for a sharp crease [BickelBotsch2007, Eq. 6].
pub(crate) fn bulge(epsilon: f64) -> f64 {
    (epsilon - 2.0).exp() / (1.0 - epsilon)
}

/// The profile with its skin set anew, where its bulges are higher than `most` of its depth: the relief from the bottom to the top of the
/// bulges stays, and they take up `most` of the depth. The walls stay where they were: width and rounding are such that the profile
/// crosses the new skin, and is half as deep as its bottom, where it was at these heights before.
pub(crate) fn levelled(shape: ProfileShape, most: f64) -> ProfileShape {
    let ProfileShape { w, d, epsilon, kappa } = shape;
    let high = bulge(epsilon);
    if high <= most || d <= 0.0 {
        return shape;
    }
    let deeper = ((1.0 + high) / (1.0 + most)).min(MOST_GROWTH);
    // Heights over the old skin, in depths: of the new skin, and half way down from it.
    let skin = deeper - 1.0;
    let crossing = distance(epsilon, skin);
    let half = distance(epsilon, skin - 0.5 * deeper) / crossing;
    ProfileShape { w: w * crossing, d: d * deeper, epsilon: rounding(half, epsilon), kappa }
}

/// Height at a distance from the crease, both as shares: of depth and of width.
fn height(epsilon: f64, u: f64) -> f64 {
    ProfileShape { w: 1.0, d: 1.0, epsilon, kappa: 0.0 }.at(u).0
}

/// Where a profile, on its way from the bottom to the top of the bulge, has a height.
fn distance(epsilon: f64, at: f64) -> f64 {
    let top = (4.0 - epsilon * epsilon).sqrt() / (1.0 - epsilon * epsilon).sqrt();
    crossing(0.0, top, |u| height(epsilon, u) - at)
}

/// The rounding, at most `most`, of a profile that is half as deep as its bottom at `half` of its width.
fn rounding(half: f64, most: f64) -> f64 {
    crossing(0.0, most, |epsilon| -0.5 - height(epsilon, half))
}

/// Where a rising function crosses zero; the nearer end if it does not. Halving is sure, and exact enough after so many steps.
fn crossing(mut low: f64, mut high: f64, rising: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..48 {
        let middle = 0.5 * (low + high);
        *(if rising(middle) < 0.0 { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(epsilon: f64) -> ProfileShape {
        ProfileShape { w: 1.4, d: 0.9, epsilon, kappa: 0.1 }
    }

    #[test]
    fn believable_profiles_stay_as_they_are() {
        for epsilon in [0.0, 0.1] {
            assert_eq!(levelled(shape(epsilon), 0.18), shape(epsilon));
        }
        let flat = ProfileShape { d: 0.0, ..shape(0.8) };
        assert_eq!(levelled(flat, 0.18), flat);
    }

    #[test]
    fn the_relief_and_the_walls_stay() {
        for epsilon in [0.3, 0.5, 0.7, 0.78] {
            let (old, new) = (shape(epsilon), levelled(shape(epsilon), 0.18));
            let relief = old.d * (1.0 + bulge(epsilon));
            assert!((new.d * 1.18 - relief).abs() < 1e-9, "{new:?}");
            let sunk = new.d - old.d;
            // The valley, which the fold is pressed in by, is the same one.
            for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
                let p = share * new.side(1.0);
                let apart = (new.at(p).0 - (old.at(p).0 - sunk)).abs();
                assert!(apart < 0.03 * new.d, "ε {epsilon}, {share} w: {apart}");
            }
            assert!(new.epsilon < epsilon && new.w > old.w, "{new:?}");
        }
    }

    #[test]
    fn the_roundest_fits_are_not_believed_either() {
        let (old, new) = (shape(0.85), levelled(shape(0.85), 0.18));
        assert!((new.d - 2.0 * old.d).abs() < 1e-9 && new.w < 2.0 * old.w, "{new:?}");
    }

    /// A valley −sech²(u/a) beside low bulges, of unit width and depth, as its best rounded profile has it.
    #[test]
    fn valleys_of_another_form_get_their_depth_back() {
        for (w, d, epsilon) in [(0.57, 0.62, 0.6), (0.75, 0.82, 0.46), (0.43, 0.455, 0.8)] {
            let new = levelled(ProfileShape { w, d, epsilon, kappa: 0.0 }, 0.18);
            assert!((new.d - 1.0).abs() < 0.17 && (new.w - 1.0).abs() < 0.23, "{new:?}");
        }
    }
}
