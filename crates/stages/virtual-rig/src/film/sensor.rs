//! From light on the sensor to stored values.

use super::exposure::Exposure;
use super::noise::{Grain, Noise};
use super::params::Sensor;
use super::transfer::Codes;
use crate::Error;
use rayon::prelude::*;

/// The blur's kernel ends this many standard deviations from its middle.
const KERNEL_REACH: f64 = 4.0;
/// Rows per job.
const ROWS: usize = 16;

/// What a sensor delivers: 8-bit RGB, row by row. Lens blur in linear light, noise, gain, transfer function, rounding; the
/// same bytes for any number of threads.
///
/// # Errors
/// [`Error::Parameter`] if the sensor's parameters make no sense.
pub fn develop(exposure: &Exposure, sensor: &Sensor, grain: Grain) -> Result<Vec<u8>, Error> {
    sensor.check()?;
    let codes = Codes::of(sensor.transfer);
    Ok(store(exposure, sensor, grain, |light| codes.of_light(light)))
}

/// Blurs, adds noise, and stores each value by `code`.
fn store<T: Copy + Default + Send>(
    exposure: &Exposure,
    sensor: &Sensor,
    grain: Grain,
    code: impl Fn(f32) -> T + Sync,
) -> Vec<T> {
    let width = exposure.size[0] as usize;
    let blurred = blur(exposure, sensor.lens_blur_px);
    let noise = (sensor.noise_at_mid_grey > 0.0).then(|| Noise::of(sensor, grain));
    let gain = sensor.gain as f32;
    let mut stored = vec![T::default(); 3 * exposure.radiance.len()];
    let jobs = stored.par_chunks_mut(3 * width * ROWS).zip(blurred.par_chunks(width * ROWS)).enumerate();
    jobs.for_each(|(job, (stored, lights))| {
        let first = (job * ROWS * width) as u64;
        for (index, (stored, light)) in stored.chunks_exact_mut(3).zip(lights).enumerate() {
            let light = light.map(|x| gain * x);
            let noisy = noise.as_ref().map_or(light, |noise| noise.add(light, first + index as u64));
            stored.iter_mut().zip(noisy).for_each(|(stored, light)| *stored = code(light));
        }
    });
    stored
}

/// The image under a Gaussian blur. The image is continued as in a mirror, so that light is neither lost nor won.
fn blur(exposure: &Exposure, deviation_px: f64) -> Vec<[f32; 3]> {
    let [width, height] = exposure.size.map(|side| side as usize);
    let kernel = kernel(deviation_px);
    if kernel.len() == 1 {
        return exposure.radiance.clone();
    }
    let mut across = vec![[0.0; 3]; width * height];
    let rows = across.par_chunks_mut(width * ROWS).zip(exposure.radiance.par_chunks(width * ROWS));
    rows.for_each_init(Vec::new, |wide, (to, from)| {
        for (to, from) in to.chunks_mut(width).zip(from.chunks(width)) {
            blur_row(from, to, &kernel, wide);
        }
    });
    let mut both = vec![[0.0; 3]; width * height];
    both.par_chunks_mut(width).enumerate().for_each(|(row, to)| {
        for (index, &weight) in kernel.iter().enumerate() {
            let from = width * mirrored(row as isize + index as isize - kernel.len() as isize / 2, height);
            accumulate(to, &across[from..from + width], weight);
        }
    });
    both
}

fn blur_row(from: &[[f32; 3]], to: &mut [[f32; 3]], kernel: &[f32], wide: &mut Vec<[f32; 3]>) {
    let reach = kernel.len() as isize / 2;
    let width = from.len();
    wide.clear();
    wide.extend((-reach..0).map(|column| from[mirrored(column, width)]));
    wide.extend_from_slice(from);
    wide.extend((width as isize..width as isize + reach).map(|column| from[mirrored(column, width)]));
    for (index, &weight) in kernel.iter().enumerate() {
        accumulate(to, &wide[index..index + width], weight);
    }
}

fn accumulate(to: &mut [[f32; 3]], from: &[[f32; 3]], weight: f32) {
    for (to, from) in to.as_flattened_mut().iter_mut().zip(from.as_flattened()) {
        *to += weight * from;
    }
}

/// The pixel that a place outside the image shows, mirrored at the image's border.
fn mirrored(place: isize, size: usize) -> usize {
    let size = size as isize;
    let folded = place.rem_euclid(2 * size);
    folded.min(2 * size - 1 - folded) as usize
}

/// Weights of a sampled Gaussian, with sum 1; only the middle one without blur.
fn kernel(deviation_px: f64) -> Vec<f32> {
    if deviation_px == 0.0 {
        return vec![1.0];
    }
    let reach = (KERNEL_REACH * deviation_px).ceil() as i32;
    let raw: Vec<f64> =
        (-reach..=reach).map(|x| (-0.5 * (f64::from(x) / deviation_px).powi(2)).exp()).collect();
    let sum: f64 = raw.iter().sum();
    raw.iter().map(|weight| (weight / sum) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Transfer;

    fn exposure(size: [u32; 2], light: impl Fn(usize, usize) -> f32) -> Exposure {
        let width = size[0] as usize;
        let count = width * size[1] as usize;
        Exposure {
            size,
            radiance: (0..count).map(|i| [light(i % width, i / width); 3]).collect(),
            depth_mm: vec![1.0; count],
            covers: vec![],
        }
    }

    const GRAIN: Grain = Grain { seed: 1, camera: 2, frame: 3 };

    fn moments(values: &[f64]) -> [f64; 2] {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        [mean, (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()]
    }

    #[test]
    fn a_blur_keeps_the_sum_and_spreads_as_asked() {
        let spot = exposure([40, 30], |x, y| if (x, y) == (20, 15) { 1.0 } else { 0.0 });
        let blurred = blur(&spot, 1.5);
        let sum = |f: &dyn Fn(f64, f64) -> f64| -> f64 {
            let place = |i: usize| ((i % 40) as f64 - 20.0, (i / 40) as f64 - 15.0);
            blurred.iter().enumerate().map(|(i, light)| f64::from(light[1]) * f(place(i).0, place(i).1)).sum()
        };
        assert!((sum(&|_, _| 1.0) - 1.0).abs() < 1e-5);
        assert!((sum(&|x, _| x * x) - 2.25).abs() < 0.01 && (sum(&|_, y| y * y) - 2.25).abs() < 0.01);
        assert!(sum(&|x, _| x).abs() < 1e-5 && sum(&|_, y| y).abs() < 1e-5);
    }

    #[test]
    fn light_at_the_border_is_not_lost() {
        let corner = exposure([5, 4], |x, y| if (x, y) == (0, 3) { 1.0 } else { 0.0 });
        let sum: f32 = blur(&corner, 2.0).iter().map(|light| light[0]).sum();
        assert!((sum - 1.0).abs() < 1e-5);
    }

    #[test]
    fn mirrors_repeat_the_border_pixel() {
        assert_eq!([-3, -2, -1, 0, 3, 4, 5, 8].map(|place| mirrored(place, 4)), [2, 1, 0, 0, 3, 3, 2, 0]);
    }

    fn noise_in(light: f32, grain: Grain) -> Vec<f64> {
        let sensor = Sensor {
            lens_blur_px: 0.0,
            noise_at_mid_grey: 0.02,
            transfer: Transfer::Linear,
            ..Sensor::default()
        };
        store(&exposure([200, 150], |_, _| light), &sensor, grain, f64::from)
    }

    #[test]
    fn noise_is_as_strong_as_asked_and_half_of_it_grows_with_the_light() {
        for light in [0.05, 0.18, 0.72] {
            let [mean, deviation] = moments(&noise_in(light, GRAIN));
            let expected = 0.18 * 0.02 * (0.5 + 0.5 * f64::from(light) / 0.18).sqrt();
            assert!((mean - f64::from(light)).abs() < 5.0 * expected / 300.0, "{light}: mean {mean}");
            assert!((deviation / expected - 1.0).abs() < 0.01, "{light}: {deviation} for {expected}");
        }
    }

    #[test]
    fn noise_is_normal_and_its_channels_and_neighbours_know_nothing_of_each_other() {
        let values = noise_in(0.18, GRAIN);
        let [mean, deviation] = moments(&values);
        let z: Vec<f64> = values.iter().map(|x| (x - mean) / deviation).collect();
        let mean_of = |f: &dyn Fn(usize) -> f64, count: usize| (0..count).map(f).sum::<f64>() / count as f64;
        assert!(mean_of(&|i| z[i].powi(3), z.len()).abs() < 0.05);
        assert!((mean_of(&|i| z[i].powi(4), z.len()) - 3.0).abs() < 0.1);
        for lag in [1, 2, 3, 600] {
            let correlation = mean_of(&|i| z[i] * z[i + lag], z.len() - lag);
            assert!(correlation.abs() < 0.015, "lag {lag}: {correlation}");
        }
    }

    #[test]
    fn each_image_has_its_own_noise_and_always_the_same() {
        let first = noise_in(0.18, GRAIN);
        assert_eq!(first, noise_in(0.18, GRAIN));
        for other in [
            Grain { seed: 2, ..GRAIN },
            Grain { camera: 3, ..GRAIN },
            Grain { frame: 4, ..GRAIN },
            Grain { frame: -3, ..GRAIN },
        ] {
            let second = noise_in(0.18, other);
            let both = first.iter().zip(&second).map(|(x, y)| (x - 0.18) * (y - 0.18)).sum::<f64>();
            let correlation = both / first.iter().map(|x| (x - 0.18).powi(2)).sum::<f64>();
            assert!(correlation.abs() < 0.015, "{other:?}: {correlation}");
        }
    }

    #[test]
    fn gain_and_transfer_set_the_stored_value() {
        let sensor = Sensor { gain: 2.0, ..Sensor::ideal() };
        assert_eq!(develop(&exposure([4, 3], |_, _| 0.09), &sensor, GRAIN).unwrap(), vec![118; 36]);
        assert_eq!(develop(&exposure([4, 3], |_, _| 0.8), &sensor, GRAIN).unwrap(), vec![255; 36]);
    }
}
