//! Where in a pixel, and when in the exposure, samples are taken.

use super::lanes::{LANES, Lanes};

/// Step of the still pattern's lattice: sample i lies in column i and row 5 i of sixteen. Of all such lattices, its points
/// are farthest apart, and along an edge of any direction they are spread most evenly.
const LATTICE_STEP: usize = 5;
/// The moving pattern: one corner per time, in px, and whether x and y are changed over. The corner, a point half a
/// pixel aside, and the opposites of both are a time's samples. Over all pixels, they form a nearly hexagonal lattice.
const CORNERS: [([f32; 2], bool); LANES] =
    [([0.125, 0.25], false), ([0.125, 0.25], true), ([0.125, -0.25], true), ([0.125, -0.25], false)];
/// Width of the ramp at an edge of paint over the samples' spacing. Wider ramps place dots better and soften edges; with
/// these, the error of a dot of 4 px is below 0.01 px, and pixel footprint and ramp together are 1.06 (still) or 1.12
/// (moving) times as wide as the footprint alone.
const STILL_RAMP: f64 = 1.5;
const MOVING_RAMP: f64 = 1.0;

/// Samples of a pixel in blocks of four: sample `4 · block + time`. In a still image, the times are all the same and the
/// samples of all times form one lattice; else each time has a lattice of its own, whose mean is the pixel's centre too.
#[derive(Debug, Clone)]
pub(super) struct Pattern<const BLOCKS: usize> {
    pub(super) x: [Lanes; BLOCKS],
    pub(super) y: [Lanes; BLOCKS],
    /// Per time the block of the sample nearest to the centre.
    pub(super) central: [usize; LANES],
    /// Width of the ramp at an edge of paint, px.
    pub(super) ramp_px: f64,
}

impl<const BLOCKS: usize> Pattern<BLOCKS> {
    /// The pattern of 4 · `BLOCKS` samples; `BLOCKS` is 4, or 16 for the same pattern in each quarter of the pixel.
    pub(super) fn new(moving: bool) -> Self {
        let mut pattern = Self {
            x: [[0.0; LANES]; BLOCKS],
            y: [[0.0; LANES]; BLOCKS],
            central: [0; LANES],
            ramp_px: ramp_px(4 * BLOCKS, moving),
        };
        for block in 0..BLOCKS {
            for time in 0..LANES {
                let [x, y] =
                    if moving { moving_sample(block % 4, time) } else { still_sample(block % 4, time) };
                let [middle_x, middle_y, scale] = quarter(block / 4, BLOCKS);
                pattern.x[block][time] = middle_x + scale * x;
                pattern.y[block][time] = middle_y + scale * y;
            }
        }
        pattern.central = std::array::from_fn(|time| pattern.nearest(time));
        pattern
    }

    fn nearest(&self, time: usize) -> usize {
        let distance = |block: usize| self.x[block][time].hypot(self.y[block][time]);
        (1..BLOCKS).fold(0, |best, block| if distance(block) < distance(best) { block } else { best })
    }
}

fn ramp_px(samples: usize, moving: bool) -> f64 {
    match moving {
        false => STILL_RAMP / (samples as f64).sqrt(),
        true => MOVING_RAMP / ((samples / LANES) as f64).sqrt(),
    }
}

/// Middle and scale of a quarter of the pixel, or of all of it.
fn quarter(index: usize, blocks: usize) -> [f32; 3] {
    match blocks {
        4 => [0.0, 0.0, 1.0],
        _ => [(index % 2) as f32 / 2.0 - 0.25, (index / 2) as f32 / 2.0 - 0.25, 0.5],
    }
}

fn still_sample(block: usize, time: usize) -> [f32; 2] {
    let index = LANES * block + time;
    // The shift of two rows makes the lattice its own opposite.
    [index, (LATTICE_STEP * index + 2) % 16].map(|place| (2.0 * place as f32 - 15.0) / 32.0)
}

fn moving_sample(block: usize, time: usize) -> [f32; 2] {
    let ([x, y], changed_over) = CORNERS[time];
    let [x, y] = [[x, y], [x - 0.5, y], [-x, -y], [0.5 - x, -y]][block];
    if changed_over { [y, x] } else { [x, y] }
}

/// Shares of the exposure at which the four times lie: the middles of its quarters.
pub(super) fn times() -> [f64; LANES] {
    std::array::from_fn(|time| (time as f64 + 0.5) / LANES as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sums<const BLOCKS: usize>(moving: bool) -> [[f32; 2]; LANES] {
        let pattern = Pattern::<BLOCKS>::new(moving);
        let all = pattern.x.iter().chain(&pattern.y).flatten();
        assert!(all.into_iter().all(|place| place.abs() < 0.5));
        let sum = |axis: &[Lanes; BLOCKS], time: usize| axis.iter().map(|block| block[time]).sum();
        std::array::from_fn(|time| [sum(&pattern.x, time), sum(&pattern.y, time)])
    }

    #[test]
    fn patterns_are_centred_and_each_time_of_a_moving_one_is_too() {
        for sums in [sums::<4>(false), sums::<16>(false)] {
            let total = sums.iter().fold([0.0; 2], |total, sum| [total[0] + sum[0], total[1] + sum[1]]);
            assert_eq!(total, [0.0; 2]);
        }
        for sums in [sums::<4>(true), sums::<16>(true)] {
            assert_eq!(sums, [[0.0; 2]; LANES]);
        }
        assert_eq!(times().iter().sum::<f64>() / 4.0, 0.5);
    }

    #[test]
    fn sixteen_still_samples_lie_at_sixteen_heights_and_widths() {
        let pattern = Pattern::<4>::new(false);
        for axis in [pattern.x, pattern.y] {
            let mut places: Vec<i32> = axis.iter().flatten().map(|x| (32.0 * x) as i32).collect();
            places.sort_unstable();
            assert_eq!(places, (0..16).map(|i| 2 * i - 15).collect::<Vec<_>>());
        }
    }

    #[test]
    fn central_samples_are_near_the_centre() {
        for pattern in [Pattern::<4>::new(false), Pattern::<4>::new(true)] {
            for (time, &block) in pattern.central.iter().enumerate() {
                assert!(pattern.x[block][time].hypot(pattern.y[block][time]) < 0.29);
            }
        }
    }
}
