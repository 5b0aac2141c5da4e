//! The face at one moment.

use crate::act::HeadMotion;
use crate::take::Studio;
use crate::wrinkle::Valley;
use nalgebra::{Isometry3, Point3};
use rayon::prelude::*;

/// The face at one moment.
pub struct Pose {
    /// Time of the mocap clock since the first frame, s.
    pub time_s: f64,
    /// Without wrinkles: one point per vertex, scan space, head at rest, mm.
    pub large_scale: Vec<Point3<f64>>,
    /// With wrinkles: one point per vertex, scan space, head at rest, mm.
    pub skin: Vec<Point3<f64>>,
    /// The bottoms of the wrinkles, scan space.
    pub valleys: Vec<Valley>,
    /// Where the head is.
    pub world_from_head: Isometry3<f64>,
}

impl Studio {
    /// The face at a time.
    #[must_use]
    pub fn pose(&self, time_s: f64) -> Pose {
        let acted = time_s * self.scenario.extent.pace;
        let more = self.events.weights(acted);
        let sum = |(one, other): (f64, f64)| (one + other).clamp(0.0, 1.0);
        let weights: Vec<f64> = self.performance.weights(acted).into_iter().zip(more).map(sum).collect();
        let large_scale = self.body.large_scale(&weights);
        let folded = self.wrinkles.fold(&large_scale);
        Pose {
            time_s,
            large_scale,
            skin: folded.positions,
            valleys: folded.valleys,
            world_from_head: self.world_from_head(time_s),
        }
    }

    /// Where the head is at a time; the identity at time 0.
    #[must_use]
    pub fn world_from_head(&self, time_s: f64) -> Isometry3<f64> {
        let neck = self.scenario.spaces.mocap_from_face(HeadMotion::NECK);
        self.scenario.head.world_from_head(time_s, &neck)
    }

    /// Carries points of the scan's space into the world.
    #[must_use]
    pub fn in_world(&self, points: &[Point3<f64>], world_from_head: &Isometry3<f64>) -> Vec<Point3<f64>> {
        let carry = |point: &Point3<f64>| world_from_head * self.scenario.spaces.mocap_from_face(*point);
        points.par_iter().with_min_len(1024).map(carry).collect()
    }
}
