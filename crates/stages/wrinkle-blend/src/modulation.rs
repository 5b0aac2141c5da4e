//! How much of its wrinkles a bone shows on its way [DutreveMeyer2011, Sec. 4.4].

use std::f64::consts::PI;

/// θ: the share of the wrinkles over the share of the way.
#[derive(Debug, Clone, PartialEq)]
pub enum Modulation {
    /// `θ(x) = (cos(π(1 + x)) + 1)/2` [DutreveMeyer2011, Eq. 6].
    Cosine,
    /// A captured curve: points from [0, 0] to [1, 1], both rising; straight lines between.
    Curve(Vec<[f64; 2]>),
}

impl Modulation {
    /// θ(x), for x in 0 … 1.
    #[must_use]
    pub fn at(&self, share: f64) -> f64 {
        match self {
            Self::Cosine => 0.5 * ((PI * (1.0 + share)).cos() + 1.0),
            Self::Curve(points) => {
                let after = points.partition_point(|point| point[0] < share).clamp(1, points.len() - 1);
                let [[x0, y0], [x1, y1]] = [points[after - 1], points[after]];
                (y0 + (share - x0) / (x1 - x0) * (y1 - y0)).clamp(0.0, 1.0)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cosine_of_the_paper() {
        for (x, y) in [(0.0, 0.0), (0.25, 0.146_446_609), (0.5, 0.5), (1.0, 1.0)] {
            assert!((Modulation::Cosine.at(x) - y).abs() < 1e-9);
        }
    }

    #[test]
    fn a_curve_goes_through_its_points() {
        let curve = Modulation::Curve(vec![[0.0, 0.0], [0.5, 0.1], [1.0, 1.0]]);
        for (x, y) in [(0.0, 0.0), (0.25, 0.05), (0.5, 0.1), (0.75, 0.55), (1.0, 1.0)] {
            assert!((curve.at(x) - y).abs() < 1e-12, "{x}");
        }
    }
}
