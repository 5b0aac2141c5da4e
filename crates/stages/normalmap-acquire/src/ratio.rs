//! The ratio image, and the exposure in it that is none of the wrinkles'.

use crate::blur::{blurred, leaning};
use crate::params::{Exposure, Params};
use crate::plane::{Plane, median};

/// Times that exposure and the weights of what follows it are found in turn.
const ROUNDS: usize = 4;
/// The power of the weight's fall.
const FALL: i32 = 4;
/// Brightenings are doubted later than darkenings, which wrinkles are.
const ABOVE: f64 = 2.5;

/// The ratio R = I'/I of linear light with its exposure taken out, and that exposure (log).
#[must_use]
pub(crate) fn ratio(
    neutral: &Plane,
    expression: &Plane,
    weight: &Plane,
    io: f64,
    params: &Params,
) -> [Plane; 2] {
    if params.exposure() == Exposure::None {
        return [expression.with(neutral, |e, n| e / n), neutral.map(|_| 0.0)];
    }
    let log = expression.with(neutral, |e, n| (e / n).ln());
    let middle = median(counted(&log, weight));
    let exposure = match params.exposure() {
        Exposure::Local => local(&log, weight, middle, params.exposure_io * io),
        _ => log.map(|_| middle),
    };
    let ratio = log.with(&exposure, |log, exposure| (log - exposure).exp());
    match params.exposure() {
        // A local exposure says nothing where nothing counts, and what stands there would be blurred into the rest.
        Exposure::Local => {
            [ratio.with(weight, |ratio, weight| if weight > 0.0 { ratio } else { 1.0 }), exposure]
        }
        _ => [ratio, exposure],
    }
}

/// Numbers of pixels that count for more than half.
pub(crate) fn counted<'a>(plane: &'a Plane, weight: &'a Plane) -> impl Iterator<Item = &'a f64> {
    plane.values.iter().zip(&weight.values).filter(|(_, weight)| **weight > 0.5).map(|(value, _)| value)
}

/// A smooth exposure that follows the skin, not its wrinkles; also where it falls towards the region's border, as shading does
/// at the jaw. It is smooth enough to be found over a coarser picture.
fn local(log: &Plane, weight: &Plane, middle: f64, sigma: f64) -> Plane {
    if sigma > 16.0 && log.width.min(log.height) > 64 {
        let coarse_weight = crate::blur::halved(weight);
        let sums = crate::blur::halved(&log.with(weight, |log, weight| log * weight));
        let coarse = sums.with(&coarse_weight, |sum, weight| if weight > 1e-6 { sum / weight } else { 0.0 });
        return crate::blur::doubled(
            &local(&coarse, &coarse_weight, middle, sigma / 2.0),
            log.width,
            log.height,
        );
    }
    let mut exposure = log.map(|_| middle);
    for _ in 0..ROUNDS {
        let off = log.with(&exposure, |log, exposure| log - exposure);
        let spread = 1.4826 * median(counted(&off.map(f64::abs), weight)) + 1e-6;
        let doubt = |off: f64| off / if off < 0.0 { spread } else { ABOVE * spread };
        let trust = off.with(weight, |off, weight| weight / (1.0 + doubt(off).powi(FALL)));
        exposure = leaning(log, &trust, sigma);
    }
    exposure
}

/// Noise of a blurred ratio: what a blur of `sigma` more takes away.
pub(crate) fn noise(ratio: &Plane, weight: &Plane, sigma: f64) -> f64 {
    let fine = ratio.with(&blurred(ratio, sigma), |value, smooth| (value - smooth).abs());
    1.4826 * median(counted(&fine, weight))
}
