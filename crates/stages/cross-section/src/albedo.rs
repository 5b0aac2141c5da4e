//! How much light the paint throws back onto itself, told by its channels.

use crate::paint::Band;

/// Deviation of the log-ratio of a pixel's channels.
const NOISE: f64 = 0.05;
/// Deviation of the albedo before anything is known; paint that nothing is known of is taken for dark.
const SPREAD: f64 = 0.3;
/// No paint throws back more.
const MOST: f64 = 0.8;
/// Rounds: how much sky a point sees follows from its brightness once the albedo is known.
const ROUNDS: usize = 12;

/// The share of the light that the brightest channel of these paints throws back.
///
/// Bounces brighten a channel the more the more of the light it throws back: down in a valley the ratio of two channels of one paint
/// drifts by ρ (1 − E) times the difference of their albedos, which no single bounce-free light can do. A regression over all paints of an
/// image, each with a ratio of its own; ρ is 0 where nothing drifts.
#[must_use]
pub fn estimate_albedo<'a>(bands: impl Iterator<Item = &'a Band>) -> f64 {
    let bands: Vec<&Band> = bands.filter(|band| band.pixels.len() > 50).collect();
    let mut albedo = 0.0;
    for _ in 0..ROUNDS {
        let mut sums = [0.0, 0.0];
        for band in &bands {
            let [drift, square] = drift(band, albedo);
            sums = [sums[0] + drift, sums[1] + square];
        }
        albedo = (sums[0] / (sums[1] + (NOISE / SPREAD).powi(2))).clamp(0.0, MOST);
    }
    albedo
}

/// The albedo of a paint's combined light, [`Band::pixels`], from that of its brightest channel.
pub(crate) fn combined_albedo(band: &Band, albedo: f64) -> f64 {
    let most = band.color.iter().fold(1e-12, |most: f64, light| most.max(*light));
    let square: f64 = band.color.iter().map(|light| light * light).sum();
    albedo * band.color.iter().map(|light| light * light * light / most).sum::<f64>() / square.max(1e-12)
}

/// Sums of a regression of the channels' log-ratio on what they should drift by for an albedo of one: products and squares.
fn drift(band: &Band, albedo: f64) -> [f64; 2] {
    let (most, least) = extremes(&band.color);
    let own = combined_albedo(band, albedo);
    let count = band.pixels.len() as f64;
    let scale = albedo.max(0.05);
    // E from B = E / (1 − ρ (1 − E)); the drift of ln B from channel to channel, per unit of albedo.
    let hidden = |light: f64| {
        let light = light.clamp(0.0, 1.0);
        let hidden = 1.0 - light * (1.0 - own) / (1.0 - own * light);
        ((1.0 - scale * least / most * hidden) / (1.0 - scale * hidden)).ln() / scale
    };
    let points = || band.pixels.iter().map(|pixel| [hidden(pixel.light), pixel.ratio]);
    let mean = points().fold([0.0; 2], |sum, [x, y]| [sum[0] + x / count, sum[1] + y / count]);
    points().fold([0.0; 2], |sum, [x, y]| {
        let x = x - mean[0];
        [sum[0] + x * (y - mean[1]), sum[1] + x * x]
    })
}

/// The largest and the smallest of three.
pub(crate) fn extremes(color: &[f64; 3]) -> (f64, f64) {
    let most = color.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = color.iter().copied().fold(f64::INFINITY, f64::min);
    (most, least)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::Pixel;
    use crate::shading::with_bounces;

    fn painted(albedo: f64) -> Band {
        let color = [0.05, 0.35, 0.1];
        let pixel = |i: usize| {
            let seen = 1.0 - 0.5 * (-((i % 40) as f64 - 20.0).abs() / 6.0).exp();
            let lit = color.map(|channel: f64| channel * with_bounces(seen, albedo * channel / 0.35)[0]);
            let square: f64 = color.iter().map(|channel| channel * channel).sum();
            let light = (0..3).map(|k| lit[k] * color[k]).sum::<f64>() / square;
            Pixel {
                x: i as f64 / 40.0,
                p: (i % 40) as f64 - 20.0,
                light,
                ratio: (lit[1] / lit[0]).ln(),
                place: [0, 0],
            }
        };
        Band { pixels: (0..4000).map(pixel).collect(), color, skin: vec![], saturated: 0, black: 0 }
    }

    #[test]
    fn the_drift_of_the_channels_tells_the_albedo() {
        for albedo in [0.0, 0.2, 0.5] {
            let found = estimate_albedo([painted(albedo)].iter());
            assert!((found - albedo).abs() < 0.06 * (albedo + 0.1), "{albedo}: {found}");
        }
    }
}
