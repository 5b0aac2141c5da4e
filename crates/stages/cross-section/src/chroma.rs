//! Whether an image's colours were stored at half its size, as most video does (4:2:0).

use crate::picture::Picture;

/// Where colours were stored for blocks of two by two, neighbours in a block differ in colour by less than this share of what they differ in
/// brightness.
const SUBSAMPLED: f64 = 0.08;
/// Below this, levels², there is no noise to tell by.
const LEAST_NOISE: f64 = 0.5;
/// Pairs that differ by more lie on an edge; so dark or bright ones are clipped.
const MOST_STEP: f64 = 8.0;
const MIDDLE: std::ops::Range<f64> = 30.0..235.0;
const LEAST_PAIRS: usize = 1000;

/// Whether colours vary much less from pixel to pixel than brightness does; none where the image has too little noise to tell.
#[must_use]
pub fn is_subsampled(picture: &Picture<'_>) -> Option<bool> {
    let (mut luma, mut chroma, mut pairs) = (0.0, 0.0, 0usize);
    for y in 0..picture.height {
        for x in (0..picture.width - picture.width % 2).step_by(2) {
            let [one, other] = [x, x + 1].map(|x| components(picture.at(x, y)));
            let step = one[0] - other[0];
            if MIDDLE.contains(&one[0]) && step.abs() <= MOST_STEP {
                luma += step * step;
                chroma += 0.5 * ((one[1] - other[1]).powi(2) + (one[2] - other[2]).powi(2));
                pairs += 1;
            }
        }
    }
    let is_noisy = pairs >= LEAST_PAIRS && luma / pairs as f64 >= LEAST_NOISE;
    is_noisy.then_some(chroma < SUBSAMPLED * luma)
}

/// Brightness and the two differences of colour (Rec. ITU-R BT.601).
fn components(codes: [u8; 3]) -> [f64; 3] {
    let [r, g, b] = codes.map(f64::from);
    let luma = 0.299 * r + 0.587 * g + 0.114 * b;
    [luma, 0.564 * (b - luma), 0.713 * (r - luma)]
}
