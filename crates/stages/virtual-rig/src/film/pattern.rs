//! Where in a pixel, and when in the exposure, samples are taken.

use super::lanes::{LANES, WIDE, Wide};

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

/// Samples of a pixel in parts of sixteen: sample `4 · block + time` of each. In a still image, the times are all the same and the
/// samples of all times form one lattice; else each time has a lattice of its own, whose mean is the pixel's centre too.
#[derive(Debug, Clone)]
pub(super) struct Pattern<const PARTS: usize> {
    pub(super) x: [Wide; PARTS],
    pub(super) y: [Wide; PARTS],
    /// Per time the sample nearest to the centre.
    pub(super) central: [usize; LANES],
    /// Width of the ramp at an edge of paint, px.
    pub(super) ramp_px: f64,
}

impl<const PARTS: usize> Pattern<PARTS> {
    /// The pattern of 16 · `PARTS` samples; `PARTS` is 1, or 4 for the same pattern in each quarter of the pixel.
    pub(super) fn new(moving: bool) -> Self {
        let mut pattern = Self {
            x: [[0.0; WIDE]; PARTS],
            y: [[0.0; WIDE]; PARTS],
            central: [0; LANES],
            ramp_px: ramp_px(WIDE * PARTS, moving),
        };
        for part in 0..PARTS {
            let [middle_x, middle_y, scale] = quarter(part, PARTS);
            for lane in 0..WIDE {
                let (block, time) = (lane / LANES, lane % LANES);
                let [x, y] = if moving { moving_sample(block, time) } else { still_sample(block, time) };
                pattern.x[part][lane] = middle_x + scale * x;
                pattern.y[part][lane] = middle_y + scale * y;
            }
        }
        pattern.central = std::array::from_fn(|time| pattern.nearest(time));
        pattern
    }

    /// A sample's place in the pixel.
    #[inline(always)]
    pub(super) fn place(&self, sample: usize) -> [f32; 2] {
        [self.x[sample / WIDE][sample % WIDE], self.y[sample / WIDE][sample % WIDE]]
    }

    fn nearest(&self, time: usize) -> usize {
        let distance = |sample: usize| {
            let [x, y] = self.place(sample);
            x.hypot(y)
        };
        (time..WIDE * PARTS)
            .step_by(LANES)
            .fold(time, |best, sample| if distance(sample) < distance(best) { sample } else { best })
    }
}

fn ramp_px(samples: usize, moving: bool) -> f64 {
    match moving {
        false => STILL_RAMP / (samples as f64).sqrt(),
        true => MOVING_RAMP / ((samples / LANES) as f64).sqrt(),
    }
}

/// Middle and scale of a quarter of the pixel, or of all of it.
fn quarter(index: usize, parts: usize) -> [f32; 3] {
    match parts {
        1 => [0.0, 0.0, 1.0],
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

    fn sums<const PARTS: usize>(moving: bool) -> [[f32; 2]; LANES] {
        let pattern = Pattern::<PARTS>::new(moving);
        let all = pattern.x.iter().chain(&pattern.y).flatten();
        assert!(all.into_iter().all(|place| place.abs() < 0.5));
        let sum =
            |axis: &[Wide; PARTS], time: usize| axis.as_flattened().iter().skip(time).step_by(LANES).sum();
        std::array::from_fn(|time| [sum(&pattern.x, time), sum(&pattern.y, time)])
    }

    #[test]
    fn patterns_are_centred_and_each_time_of_a_moving_one_is_too() {
        for sums in [sums::<1>(false), sums::<4>(false)] {
            let total = sums.iter().fold([0.0; 2], |total, sum| [total[0] + sum[0], total[1] + sum[1]]);
            assert_eq!(total, [0.0; 2]);
        }
        for sums in [sums::<1>(true), sums::<4>(true)] {
            assert_eq!(sums, [[0.0; 2]; LANES]);
        }
        assert_eq!(times().iter().sum::<f64>() / 4.0, 0.5);
    }

    #[test]
    fn sixteen_still_samples_lie_at_sixteen_heights_and_widths() {
        let pattern = Pattern::<1>::new(false);
        for axis in [pattern.x, pattern.y] {
            let mut places: Vec<i32> = axis.iter().flatten().map(|x| (32.0 * x) as i32).collect();
            places.sort_unstable();
            assert_eq!(places, (0..16).map(|i| 2 * i - 15).collect::<Vec<_>>());
        }
    }

    #[test]
    fn central_samples_are_near_the_centre() {
        for pattern in [Pattern::<1>::new(false), Pattern::<1>::new(true)] {
            for sample in pattern.central {
                let [x, y] = pattern.place(sample);
                assert!(x.hypot(y) < 0.29);
            }
        }
    }
}
