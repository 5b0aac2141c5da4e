//! The face and the head between two frames.

use nalgebra::{Isometry3, Point3};

/// A time between two frames of the motion capture: `share` of the way from frame `from` to the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Absolute frame number.
    pub from: i64,
    /// 0 at that frame, below 1.
    pub share: f64,
}

/// Less than this beside a frame is the frame itself: at 50 frames a second, 20 µs.
const AT_ONCE: f64 = 1e-3;

impl Moment {
    /// The moment of an image that was taken `lag` frames after the frame that it shows.
    #[must_use]
    pub fn of(frame: i64, lag: f64) -> Self {
        let whole = lag.round();
        if (lag - whole).abs() < AT_ONCE {
            return Self { from: frame + whole as i64, share: 0.0 };
        }
        Self { from: frame + lag.floor() as i64, share: lag - lag.floor() }
    }

    /// The frames that are needed.
    pub fn frames(&self) -> impl Iterator<Item = i64> + use<> {
        self.from..=self.from + i64::from(self.share > 0.0)
    }

    /// Positions at the moment, from those of its frames.
    #[must_use]
    pub fn points(&self, from: &[Point3<f64>], to: &[Point3<f64>]) -> Vec<Point3<f64>> {
        from.iter().zip(to).map(|(a, b)| a + (b - a) * self.share).collect()
    }

    /// The pose at the moment, turned evenly from one to the other; none where they are half a turn apart.
    #[must_use]
    pub fn pose(&self, from: &Isometry3<f64>, to: &Isometry3<f64>) -> Option<Isometry3<f64>> {
        from.try_lerp_slerp(to, self.share, 1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{UnitQuaternion, Vector3};

    #[test]
    fn a_lag_names_the_frames_beside_it() {
        assert_eq!(Moment::of(1008, 0.0), Moment { from: 1008, share: 0.0 });
        assert_eq!(Moment::of(1008, 1.0 - 1e-6), Moment { from: 1009, share: 0.0 });
        let early = Moment::of(1008, -0.25);
        assert_eq!((early.from, early.share), (1007, 0.75));
        assert_eq!(early.frames().collect::<Vec<_>>(), [1007, 1008]);
        assert_eq!(Moment::of(1008, 0.0).frames().collect::<Vec<_>>(), [1008]);
    }

    #[test]
    fn poses_turn_evenly() {
        let pose = |angle: f64| {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::y() * angle);
            Isometry3::from_parts(Vector3::new(10.0 * angle, 0.0, 0.0).into(), turn)
        };
        let between = Moment { from: 1, share: 0.25 }.pose(&pose(0.0), &pose(0.2)).unwrap();
        assert!((between.to_homogeneous() - pose(0.05).to_homogeneous()).norm() < 1e-12);
    }
}
