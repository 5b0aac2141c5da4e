//! How much of a sample's footprint lies inside an edge.

/// A signed distance to an edge, mm on the skin (positive inside), and how it changes per pixel of the image.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub(super) inside_mm: f64,
    pub(super) slope_mm_per_px: [f64; 2],
    /// Of the edge, positive where the inside bulges out.
    pub(super) curvature_per_mm: f64,
}

/// What one sample stands for, and how soft the paint's edge is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Softness {
    pub(super) ramp_px: f64,
    pub(super) smear_mm: f64,
}

impl Edge {
    /// The share of a sample's footprint inside, 0 to 1: a ramp across the edge, as wide as the footprint. Without it,
    /// samples that are all in or all out would put a dot's centroid off by some hundredths of a pixel.
    ///
    /// The middle of the ramp lies inside a curved edge by width² · curvature / 24: the ring that the ramp adds outside is
    /// longer than the one that it takes away inside, and the area must stay.
    pub(super) fn share(self, softness: Softness) -> f64 {
        let [x, y] = self.slope_mm_per_px;
        let squared =
            (x * x + y * y) * softness.ramp_px * softness.ramp_px + softness.smear_mm * softness.smear_mm;
        if squared == 0.0 {
            return f64::from(u8::from(self.inside_mm >= 0.0));
        }
        let inside_mm = self.inside_mm - squared * self.curvature_per_mm / 24.0;
        (0.5 + inside_mm / squared.sqrt()).clamp(0.0, 1.0)
    }
}

/// The share of the footprint between two edges that face each other.
pub(super) fn share_between(one: Edge, other: Edge, softness: Softness) -> f64 {
    (one.share(softness) + other.share(softness) - 1.0).max(0.0)
}

/// A place in a layer's two coordinates, mm, and their change per pixel in x and in y.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spot {
    pub(crate) at: [f64; 2],
    pub(crate) per_px: [[f64; 2]; 2],
}

impl Spot {
    /// The change per pixel of a function whose slopes in the layer's coordinates are given.
    pub(super) fn chain(&self, slope: [f64; 2]) -> [f64; 2] {
        self.per_px.map(|change| slope[0] * change[0] + slope[1] * change[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHARP: Softness = Softness { ramp_px: 0.25, smear_mm: 0.0 };

    fn edge(inside_mm: f64) -> Edge {
        Edge { inside_mm, slope_mm_per_px: [0.3, 0.4], curvature_per_mm: 0.0 }
    }

    #[test]
    fn a_footprint_on_the_edge_is_half_inside() {
        assert_eq!(edge(0.0).share(SHARP), 0.5);
        assert_eq!(edge(0.0625).share(SHARP), 1.0);
        assert_eq!(edge(-0.0625).share(SHARP), 0.0);
        assert_eq!(edge(0.03125).share(SHARP), 0.75);
    }

    #[test]
    fn a_strip_narrower_than_the_footprint_covers_its_share() {
        // 0.025 mm of paint under a footprint of 0.125 mm
        assert!((share_between(edge(0.0125), edge(0.0125), SHARP) - 0.2).abs() < 1e-12);
    }
}
