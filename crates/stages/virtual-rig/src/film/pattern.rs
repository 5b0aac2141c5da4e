//! Where in a pixel, and when in the exposure, samples are taken.

use super::lanes::{LANES, Lanes};

/// One corner of each square of samples, in 1/32 px: one square per time. A square's four turns by 90° have their mean in
/// the pixel's centre and spread alike along all directions. Over all times, the sixteen samples lie at sixteen different
/// heights and widths, no two nearer than 5.6/32 px; within a time, no two (across pixels too) nearer than 10/32 px.
const SIXTEEN: [[f32; 2]; 4] = [[1.0, 11.0], [3.0, -7.0], [5.0, 15.0], [9.0, -13.0]];
/// The same for 64 samples, in 1/128 px: four squares per time; the distances are 11/128 and 20/128 px.
const SIXTY_FOUR: [[f32; 2]; 16] = [
    [21.0, -5.0],
    [29.0, -57.0],
    [11.0, -41.0],
    [49.0, 53.0],
    [7.0, -13.0],
    [61.0, -17.0],
    [27.0, 31.0],
    [35.0, -1.0],
    [37.0, -15.0],
    [43.0, 25.0],
    [47.0, -63.0],
    [59.0, 9.0],
    [23.0, 19.0],
    [33.0, 55.0],
    [45.0, 39.0],
    [3.0, 51.0],
];
/// The square that lies nearest to the pixel's centre: that time's first four blocks.
pub(super) const CENTRAL_TIME: usize = 1;

/// Samples of a pixel in blocks of four: sample `4 · block + time`.
#[derive(Debug, Clone)]
pub(super) struct Pattern<const BLOCKS: usize> {
    pub(super) x: [Lanes; BLOCKS],
    pub(super) y: [Lanes; BLOCKS],
}

impl<const BLOCKS: usize> Pattern<BLOCKS> {
    /// The pattern of 4 · `BLOCKS` samples; `BLOCKS` is 4 or 16.
    pub(super) fn new() -> Self {
        let mut pattern = Self { x: [[0.0; LANES]; BLOCKS], y: [[0.0; LANES]; BLOCKS] };
        let (squares, unit): (&[[f32; 2]], f32) =
            if BLOCKS == 4 { (&SIXTEEN, 1.0 / 32.0) } else { (&SIXTY_FOUR, 1.0 / 128.0) };
        for (index, square) in squares.iter().enumerate() {
            let (time, part) = (index * LANES / squares.len(), index % (squares.len() / LANES));
            for (turn, [x, y]) in turns(*square).into_iter().enumerate() {
                pattern.x[4 * part + turn][time] = unit * x;
                pattern.y[4 * part + turn][time] = unit * y;
            }
        }
        pattern
    }
}

/// A point and its turns by 90°, 180° and 270°.
fn turns([x, y]: [f32; 2]) -> [[f32; 2]; 4] {
    [[x, y], [-y, x], [-x, -y], [y, -x]]
}

/// Shares of the exposure at which the four times lie: the middles of its quarters.
pub(super) fn times() -> [f64; LANES] {
    std::array::from_fn(|time| (time as f64 + 0.5) / LANES as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const BLOCKS: usize>() {
        let pattern = Pattern::<BLOCKS>::new();
        for time in 0..LANES {
            for axis in [&pattern.x, &pattern.y] {
                let sum: f32 = axis.iter().map(|block| block[time]).sum();
                assert_eq!(sum, 0.0, "the mean of time {time} is the centre");
                assert!(axis.iter().all(|block| block[time].abs() < 0.5));
            }
        }
    }

    #[test]
    fn each_time_is_centred_on_the_pixel() {
        check::<4>();
        check::<16>();
        assert_eq!(times().iter().sum::<f64>() / 4.0, 0.5);
    }

    fn levels<const BLOCKS: usize>() {
        let pattern = Pattern::<BLOCKS>::new();
        let count = 4 * BLOCKS as i32;
        for axis in [pattern.x, pattern.y] {
            let mut places: Vec<i32> =
                axis.iter().flatten().map(|x| ((2 * count) as f32 * x) as i32).collect();
            places.sort_unstable();
            assert_eq!(places, (0..count).map(|i| 2 * i + 1 - count).collect::<Vec<_>>());
        }
    }

    #[test]
    fn all_samples_lie_at_different_heights_and_widths() {
        levels::<4>();
        levels::<16>();
    }
}
