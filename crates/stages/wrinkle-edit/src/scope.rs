//! Where an edit holds, and how much of it: wrinkles, cameras, frames, easing.

use artifact::FrameRange;

/// How an edit grows from nothing to all of itself, and back.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Ease {
    /// Frames over which it grows, from the first frame on.
    pub(crate) rise: u32,
    /// Frames over which it fades, up to the last frame.
    pub(crate) fall: u32,
    /// With a soft start and end, `3 s² − 2 s³`; else at a constant rate.
    pub(crate) smooth: bool,
}

/// Where an edit holds.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Scope {
    pub(crate) ids: Vec<String>,
    pub(crate) cameras: Vec<String>,
    pub(crate) frames: FrameRange,
    pub(crate) ease: Ease,
}

impl Scope {
    /// How much of the edit holds in a frame of the range, 0–1. A rise over N frames passes 1/(N+1), …, N/(N+1) in the first N frames
    /// and is 1 in the next, so that the frame before the range is where it is 0.
    pub(crate) fn strength(&self, frame: i64) -> f64 {
        let Ease { rise, fall, smooth } = self.ease;
        let share = |steps: i64, over: u32| ((steps + 1) as f64 / (f64::from(over) + 1.0)).clamp(0.0, 1.0);
        let up = if rise == 0 { 1.0 } else { share(frame.saturating_sub(self.frames.first), rise) };
        let down = if fall == 0 { 1.0 } else { share(self.frames.last.saturating_sub(frame), fall) };
        let s = up.min(down);
        if smooth { s * s * (3.0 - 2.0 * s) } else { s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scope(ease: Ease) -> Scope {
        Scope { ids: vec![], cameras: vec![], frames: FrameRange { first: 10, last: 19 }, ease }
    }

    #[test]
    fn an_ease_rises_within_the_range_and_is_whole_after_its_frames() {
        let eased = scope(Ease { rise: 3, fall: 1, smooth: false });
        let strengths: Vec<f64> = (10..=19).map(|frame| eased.strength(frame)).collect();
        assert_eq!(strengths, [0.25, 0.5, 0.75, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.5]);
        assert!((scope(Ease { rise: 3, fall: 0, smooth: true }).strength(10) - 0.15625).abs() < 1e-12);
        assert!((10..=19).all(|frame| scope(Ease::default()).strength(frame) == 1.0));
    }
}
