//! Whether an image's colours were stored at half its size, as most video does (4:2:0).

/// Noise of pixel pairs inside blocks of two by two: where colours were stored for whole blocks, they differ less than brightness.
const SUBSAMPLED: f64 = 0.08;
/// Below this, levels², there is no noise to tell by.
const LEAST_NOISE: f64 = 0.5;
/// Pairs that differ by more lie on an edge; so dark or bright ones are clipped.
const MOST_STEP: f64 = 8.0;
const MIDDLE: std::ops::Range<f64> = 30.0..235.0;
const LEAST_PAIRS: usize = 1000;

/// Whether colours vary much less from pixel to pixel than brightness does; none where the image has too little noise to tell.
///
/// `rgb`: red, green and blue of each pixel, rows of `width` pixels from the top, as stored, 8 bits each.
#[must_use]
pub fn is_subsampled(width: usize, rgb: &[u8]) -> Option<bool> {
    let (mut luma, mut chroma, mut pairs) = (0.0, 0.0, 0usize);
    for row in rgb.chunks_exact(3 * width) {
        for pair in row.chunks_exact(6) {
            let [one, other] = [0, 3].map(|i| components([pair[i], pair[i + 1], pair[i + 2]]));
            let step = one[0] - other[0];
            if !MIDDLE.contains(&one[0]) || step.abs() > MOST_STEP {
                continue;
            }
            luma += step * step;
            chroma += 0.5 * ((one[1] - other[1]).powi(2) + (one[2] - other[2]).powi(2));
            pairs += 1;
        }
    }
    let is_noisy = pairs >= LEAST_PAIRS && luma / pairs as f64 >= LEAST_NOISE;
    is_noisy.then_some(chroma < SUBSAMPLED * luma)
}

/// Brightness and the two differences of colour (Rec. ITU-R BT.601).
fn components(rgb: [u8; 3]) -> [f64; 3] {
    let [r, g, b] = rgb.map(f64::from);
    let luma = 0.299 * r + 0.587 * g + 0.114 * b;
    [luma, 0.564 * (b - luma), 0.713 * (r - luma)]
}
