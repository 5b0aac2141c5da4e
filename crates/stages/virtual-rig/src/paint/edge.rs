//! How much of a sample's footprint lies inside an edge.

/// A signed distance to an edge, mm on the skin (positive inside), and how it changes per pixel of the image.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub(super) inside_mm: f64,
    pub(super) slope_mm_per_px: [f64; 2],
}

/// What one sample stands for, and how soft the paint's edge is.
#[derive(Debug, Clone, Copy)]
pub(super) struct Softness {
    pub(super) footprint_px: f64,
    pub(super) smear_mm: f64,
}

impl Edge {
    /// The share of the footprint inside, 0 to 1: a ramp as wide as the footprint across the edge. Without it, samples
    /// that are all in or all out would put a dot's centroid off by some hundredths of a pixel.
    pub(super) fn share(self, softness: Softness) -> f64 {
        let [x, y] = self.slope_mm_per_px;
        let footprint_mm = (x * x + y * y).sqrt() * softness.footprint_px;
        let ramp_mm = footprint_mm.hypot(softness.smear_mm);
        match ramp_mm > 0.0 {
            true => (0.5 + self.inside_mm / ramp_mm).clamp(0.0, 1.0),
            false => f64::from(u8::from(self.inside_mm >= 0.0)),
        }
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

    const SHARP: Softness = Softness { footprint_px: 0.25, smear_mm: 0.0 };

    fn edge(inside_mm: f64) -> Edge {
        Edge { inside_mm, slope_mm_per_px: [0.3, 0.4] }
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
