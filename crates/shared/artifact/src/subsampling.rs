//! Whether an image's colours were stored at half its size, as most video does (4:2:0).

/// Noise of pixel pairs inside blocks of two by two: where colours were stored for whole blocks, they differ less than brightness.
const SUBSAMPLED: f64 = 0.08;
/// Below this, levels², there is no noise to tell by.
const LEAST_NOISE: f64 = 0.5;
/// Third differences along rows, where colours were stretched smoothly from half the size: of decoded video and JPEG at most 0.23 of
/// brightness's, of images with all their colours at least 0.55. Some ways to fill in a sensor's mosaic are as coarse.
const STRETCHED: f64 = 0.35;
/// Third differences that rounding to whole levels makes by itself, levels²: of brightness, and of colour.
const ROUNDED: [f64; 2] = [0.74, 0.68];
const LEAST_THIRD: f64 = 3.0;
/// Grey images have no colours that could be stored at any size.
const LEAST_COLOR: f64 = 0.05;
/// Neighbours that differ by more lie on an edge; so dark or bright ones are clipped.
const MOST_STEP: f64 = 8.0;
const MIDDLE: std::ops::Range<f64> = 30.0..235.0;
const LEAST_RUNS: usize = 1000;

/// Whether colours vary much less from pixel to pixel than brightness does, be it that blocks of two by two share them or that they
/// were stretched smoothly; none where the image has too little noise to tell.
///
/// `rgb`: red, green and blue of each pixel, rows of `width` pixels from the top, as stored, 8 bits each.
#[must_use]
pub fn is_subsampled(width: usize, rgb: &[u8]) -> Option<bool> {
    let pairs = Noise::of(width, rgb, [1.0, -1.0], 2).filter(|noise| noise.luma >= LEAST_NOISE);
    let is_shared = pairs.map(|noise| noise.chroma < SUBSAMPLED * noise.luma);
    let thirds = Noise::of(width, rgb, [1.0, -3.0, 3.0, -1.0], 1);
    let thirds = thirds.filter(|noise| noise.luma >= LEAST_THIRD && noise.chroma >= LEAST_COLOR);
    let is_stretched = thirds.map(|noise| noise.chroma - ROUNDED[1] < STRETCHED * (noise.luma - ROUNDED[0]));
    is_shared.into_iter().chain(is_stretched).reduce(|one, other| one || other)
}

/// Mean squares of differences between neighbours, levels².
struct Noise {
    luma: f64,
    chroma: f64,
}

impl Noise {
    /// Of runs of pixels away from edges, which begin every `step` pixels; none where there are too few.
    fn of<const N: usize>(width: usize, rgb: &[u8], weights: [f64; N], step: usize) -> Option<Self> {
        let (mut luma, mut chroma, mut runs) = (0.0, 0.0, 0usize);
        for row in rgb.chunks_exact(3 * width) {
            for run in row.windows(3 * N).step_by(3 * step) {
                let all: [[f64; 3]; N] =
                    std::array::from_fn(|i| components([run[3 * i], run[3 * i + 1], run[3 * i + 2]]));
                let is_edge = all.windows(2).any(|pair| (pair[0][0] - pair[1][0]).abs() > MOST_STEP);
                if !MIDDLE.contains(&all[0][0]) || is_edge {
                    continue;
                }
                let [y, blue, red] = [0, 1, 2].map(|k| (0..N).map(|i| weights[i] * all[i][k]).sum::<f64>());
                luma += y * y;
                chroma += 0.5 * (blue * blue + red * red);
                runs += 1;
            }
        }
        let count = runs as f64;
        (runs >= LEAST_RUNS).then_some(Self { luma: luma / count, chroma: chroma / count })
    }
}

/// Brightness and the two differences of colour (Rec. ITU-R BT.601).
fn components(rgb: [u8; 3]) -> [f64; 3] {
    let [r, g, b] = rgb.map(f64::from);
    let luma = 0.299 * r + 0.587 * g + 0.114 * b;
    [luma, 0.564 * (b - luma), 0.713 * (r - luma)]
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: usize = 120;

    /// Skin with noise; colours averaged over pairs of columns, and blended between them if so asked.
    fn image(noise: f64, halved: Option<bool>) -> Vec<u8> {
        let mut state = 7u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        let mut rgb = Vec::new();
        for _ in 0..SIZE {
            let row: Vec<[f64; 3]> =
                (0..SIZE).map(|_| [180.0, 140.0, 110.0].map(|level| level + noise * random())).collect();
            let color = |x: usize, k: usize| {
                let own = |x: usize| row[x][k] - (0.299 * row[x][0] + 0.587 * row[x][1] + 0.114 * row[x][2]);
                let block = |i: usize| 0.5 * (own(2 * i) + own(2 * i + 1));
                let next = if x.is_multiple_of(2) {
                    (x / 2).saturating_sub(1)
                } else {
                    (x / 2 + 1).min(SIZE / 2 - 1)
                };
                match halved {
                    None => own(x),
                    Some(false) => block(x / 2),
                    Some(true) => 0.75 * block(x / 2) + 0.25 * block(next),
                }
            };
            for x in 0..SIZE {
                let luma = 0.299 * row[x][0] + 0.587 * row[x][1] + 0.114 * row[x][2];
                rgb.extend((0..3).map(|k| (luma + color(x, k)).round() as u8));
            }
        }
        rgb
    }

    #[test]
    fn colours_at_half_the_size_are_found_however_they_were_stretched() {
        assert_eq!(is_subsampled(SIZE, &image(5.0, None)), Some(false));
        assert_eq!(is_subsampled(SIZE, &image(5.0, Some(false))), Some(true));
        assert_eq!(is_subsampled(SIZE, &image(5.0, Some(true))), Some(true));
        assert_eq!(is_subsampled(SIZE, &image(0.0, Some(true))), None);
    }
}
