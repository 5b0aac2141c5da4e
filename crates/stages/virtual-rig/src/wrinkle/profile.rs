//! Sections across a wrinkle: height over the large-scale surface as a function of the distance from the bottom.

use crate::wrinkle::smooth::{smooth_step, smooth_step_slope};

/// The form of a section of unit width and unit depth: −1 at 0, crossing 0 at ±1 (rounded: at ±(1 ± κ)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// (|u| − 1) e^{−|u|} [BickelBotsch2007, Eq. 6].
    S,
    /// The paper's S over ũ = √((u/(u_s(1 ± κ)))² + ε²), scaled so that width and depth stay 1:
    /// (ũ − 1) e^{−ũ} / ((1 − ε) e^{−ε}) with u_s = 1/√(1 − ε²).
    Rounded {
        /// Rounding of the bottom, below 1; 0 is the paper's.
        epsilon: f64,
        /// Asymmetry: the side p > 0 is 1 + κ wide, the other 1 − κ.
        kappa: f64,
    },
    /// A valley −sech²(u/a) with a bulge h (u/m)³ e^{3(1 − |u|/m)} beside it, each side with its own a and m; h is
    /// such that the section crosses 0 at ±1. Curvature jumps at the bottom, slope does not.
    Foreign {
        /// Half width of the valley: side p < 0, side p > 0.
        valley: [f64; 2],
        /// Where the bulge is highest: side p < 0, side p > 0.
        bulge: [f64; 2],
    },
}

impl Shape {
    /// Rounding ε and asymmetry κ in the sense of the rounded S; both 0 for other forms, which have neither.
    #[must_use]
    pub fn rounding(&self) -> (f64, f64) {
        match *self {
            Self::Rounded { epsilon, kappa } => (epsilon, kappa),
            Self::S | Self::Foreign { .. } => (0.0, 0.0),
        }
    }

    /// Height and slope at u.
    #[must_use]
    pub fn at(&self, u: f64) -> (f64, f64) {
        let (side, sign) = if u < 0.0 { (0, -1.0) } else { (1, 1.0) };
        let (height, slope) = self.on_side(side, u.abs());
        (height, sign * slope)
    }

    /// Height and slope at a distance u ≥ 0 on side 0 (p < 0) or 1; the slope is outwards.
    pub(super) fn on_side(&self, side: usize, u: f64) -> (f64, f64) {
        match *self {
            Self::S => {
                let fall = (-u).exp();
                ((u - 1.0) * fall, (2.0 - u) * fall)
            }
            Self::Rounded { epsilon, kappa } => {
                let stretch = if side == 0 { 1.0 - kappa } else { 1.0 + kappa };
                let scale = (1.0 - epsilon * epsilon).sqrt() / stretch;
                let round = (scale * u).hypot(epsilon);
                let fall = (epsilon - round).exp() / (1.0 - epsilon);
                // At the sharp bottom (ε = 0) the outward slope is that of the side.
                let lean = if round > 0.0 { scale * scale * u / round } else { scale };
                ((round - 1.0) * fall, (2.0 - round) * fall * lean)
            }
            Self::Foreign { valley, bulge } => foreign(valley[side], bulge[side], u),
        }
    }
}

fn foreign(a: f64, m: f64, u: f64) -> (f64, f64) {
    let cosh = |x: f64| (x.exp() + (-x).exp()) * 0.5;
    let rise = |v: f64| v * v * v * (3.0 * (1.0 - v)).exp();
    let height = 1.0 / (cosh(1.0 / a).powi(2) * rise(1.0 / m));
    let sech = 1.0 / cosh(u / a).powi(2);
    let v = u / m;
    let mound = height * rise(v);
    let mound_slope = height * 3.0 * v * v * (1.0 - v) * (3.0 * (1.0 - v)).exp() / m;
    (mound - sech, 2.0 * sech * (u / a).tanh() / a + mound_slope)
}

/// A section in millimetres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// Its form.
    pub shape: Shape,
    /// Width: where it crosses the large-scale surface, mm (the mean of both sides where they differ).
    pub w_mm: f64,
    /// Depth of the bottom below the large-scale surface, mm.
    pub d_mm: f64,
    /// Distances on side p < 0 and on side p > 0 from which and to which it fades to exactly 0, mm.
    pub fade_mm: [[f64; 2]; 2],
}

impl Profile {
    /// Height over the large-scale surface at a signed distance q from the bottom along that surface, mm.
    #[must_use]
    pub fn height(&self, q: f64) -> f64 {
        let side = usize::from(q >= 0.0);
        let distance = q.abs();
        if distance >= self.fade_mm[side][1] {
            return 0.0;
        }
        let (height, _) = self.shape.on_side(side, distance / self.w_mm);
        self.d_mm * height * fade(self.fade_mm[side], distance).0
    }
}

/// A factor that goes from 1 to 0 between two distances, and its slope.
pub(super) fn fade([from, to]: [f64; 2], distance: f64) -> (f64, f64) {
    let x = (distance - from) / (to - from);
    (1.0 - smooth_step(x), -smooth_step_slope(x) / (to - from))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPES: [Shape; 4] = [
        Shape::S,
        Shape::Rounded { epsilon: 0.3, kappa: 0.0 },
        Shape::Foreign { valley: [0.45, 0.6], bulge: [2.2, 1.8] },
        Shape::Foreign { valley: [0.6, 0.5], bulge: [1.7, 2.4] },
    ];

    #[test]
    fn shapes_have_unit_depth_and_width() {
        for shape in SHAPES {
            assert!((shape.at(0.0).0 + 1.0).abs() < 1e-12, "{shape:?}");
            for u in [-1.0, 1.0] {
                assert!(shape.at(u).0.abs() < 1e-12, "{shape:?}");
                assert!(shape.at(0.9 * u).0 < 0.0 && shape.at(2.0 * u).0 > 0.03, "{shape:?}");
            }
        }
        let skewed = Shape::Rounded { epsilon: 0.3, kappa: 0.2 };
        assert!(skewed.at(1.2).0.abs() < 1e-12 && skewed.at(-0.8).0.abs() < 1e-12);
    }

    #[test]
    fn slopes_are_derivatives() {
        for shape in SHAPES {
            for i in -60..60 {
                let u = 0.05 + 0.1 * f64::from(i);
                let difference = (shape.at(u + 1e-6).0 - shape.at(u - 1e-6).0) / 2e-6;
                assert!((difference - shape.at(u).1).abs() < 1e-7, "{shape:?} at {u}");
            }
        }
        for i in 0..150 {
            let at = 0.1 * f64::from(i);
            let difference = (fade([4.0, 9.0], at + 1e-6).0 - fade([4.0, 9.0], at - 1e-6).0) / 2e-6;
            assert!((difference - fade([4.0, 9.0], at).1).abs() < 1e-6);
        }
    }

    #[test]
    fn without_rounding_it_is_the_papers() {
        let shape = Shape::Rounded { epsilon: 0.0, kappa: 0.0 };
        for i in 0..100 {
            let u = 0.1 * f64::from(i) - 5.0;
            assert!((shape.at(u).0 - (u.abs() - 1.0) * (-u.abs()).exp()).abs() < 1e-15);
        }
    }
}
