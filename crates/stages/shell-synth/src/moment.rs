//! Interpolation in time.

/// A time between two frames in which valleys are known.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    pub(crate) before: usize,
    pub(crate) after: usize,
    pub(crate) share: f64,
    /// Share of the depth that is left.
    pub(crate) held: f64,
}

impl Moment {
    /// Between which of the known frames a frame lies, and how deep valleys still are that far from them. `step`: the usual distance of
    /// known frames; `gap`: the longest that is bridged.
    pub(crate) fn of(frames: &[i64], step: i64, frame: i64, gap: i64) -> Option<Self> {
        let after = frames.partition_point(|&known| known <= frame);
        // Depth falls linearly from the known frame on, over the longest gap.
        let alone = |at: usize| {
            let away = ((frames[at] - frame).abs() - step).max(0);
            let held = 1.0 - away as f64 / gap.max(1) as f64;
            (held > 0.0).then_some(Self { before: at, after: at, share: 0.0, held })
        };
        match (after.checked_sub(1), after < frames.len()) {
            (None, false) => None,
            (None, true) => alone(0),
            (Some(before), false) => alone(before),
            (Some(before), true) => {
                let span = frames[after] - frames[before];
                let share = (frame - frames[before]) as f64 / span as f64;
                match span <= gap {
                    true => Some(Self { before, after, share, held: 1.0 }),
                    false if share < 0.5 => alone(before),
                    false => alone(after),
                }
            }
        }
    }
}

/// The value at a share of the way between the second and the third of four equally spaced values, by a cubic that rises and
/// falls only where they do [FritschButland1984].
pub(crate) fn monotone([a, b, c, d]: [f64; 4], share: f64) -> f64 {
    let slope =
        |left: f64, right: f64| if left * right <= 0.0 { 0.0 } else { 2.0 * left * right / (left + right) };
    let (at_b, at_c) = (slope(b - a, c - b), slope(c - b, d - c));
    let (s, s2, s3) = (share, share * share, share * share * share);
    (2.0 * s3 - 3.0 * s2 + 1.0) * b
        + (s3 - 2.0 * s2 + s) * at_b
        + (3.0 * s2 - 2.0 * s3) * c
        + (s3 - s2) * at_c
}

#[cfg(test)]
mod tests {
    use super::monotone;

    #[test]
    fn a_depth_that_comes_from_nothing_never_falls_below_it() {
        for i in 0..=10 {
            let share = f64::from(i) / 10.0;
            let value = monotone([0.0, 0.0, 1.0, 1.2], share);
            assert!((0.0..=1.0).contains(&value), "{value} at {share}");
            assert!((monotone([1.0, 2.0, 3.0, 4.0], share) - (2.0 + share)).abs() < 1e-12);
        }
    }
}
