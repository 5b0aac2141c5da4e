//! What the times of a video's frames tell.

use crate::line::median;

/// Frames further apart than so many usual distances have lost ones between them.
const GAP: f64 = 1.5;
/// Distances within this share of the median are usual.
const USUAL: f64 = 0.4;

/// What the times of a video's frames tell.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameTimes {
    /// Frames a second, where none is lost; none of fewer than two frames.
    pub rate_hz: Option<f64>,
    /// All times, s, if there are gaps between them; even ones say nothing that the frames' numbers do not.
    pub uneven_s: Option<Vec<f64>>,
}

/// Looks at the times that a container gives its frames, s, rising; none where it gives no time, as OpenCV does for the last
/// ones of codecs that look ahead: they are taken to go on evenly.
#[must_use]
pub fn frame_times(times: &[Option<f64>]) -> FrameTimes {
    let steps: Vec<f64> = times.windows(2).filter_map(|pair| Some(pair[1]? - pair[0]?)).collect();
    let usual = median(&steps);
    // Containers round times to a millisecond: the median is coarse, the mean of those around it is fine.
    let near: Vec<f64> = steps.iter().copied().filter(|step| (step / usual - 1.0).abs() < USUAL).collect();
    let step = near.iter().sum::<f64>() / near.len() as f64;
    if !(step.is_finite() && step > 0.0) {
        return FrameTimes { rate_hz: None, uneven_s: None };
    }
    let uneven_s = steps.iter().any(|other| *other > GAP * step).then(|| {
        let mut last = -step;
        times
            .iter()
            .map(|time| {
                last = time.unwrap_or(last + step);
                last
            })
            .collect()
    });
    FrameTimes { rate_hz: Some(1.0 / step), uneven_s }
}

#[cfg(test)]
mod tests {
    use super::frame_times;

    #[test]
    fn only_gaps_make_times_tell_something() {
        let times = |numbers: &[u32]| -> Vec<Option<f64>> {
            // As Matroska rounds.
            numbers.iter().map(|n| Some((f64::from(*n) * 1001.0 / 60.0).round() / 1000.0)).collect()
        };
        let even = frame_times(&times(&(0..200).collect::<Vec<_>>()));
        assert!((even.rate_hz.unwrap() / (60_000.0 / 1001.0) - 1.0).abs() < 1e-3 && even.uneven_s.is_none());
        let mut gap = times(&[0, 1, 2, 3, 5, 6, 7, 8]);
        gap.push(None);
        let uneven = frame_times(&gap).uneven_s.unwrap();
        assert!((uneven[8] - 9.0 * 1001.0 / 60_000.0).abs() < 2e-3, "{uneven:?}");
        assert_eq!(frame_times(&[Some(0.0)]).rate_hz, None);
    }
}
