//! The bright point of a dark picture, to a fraction of a pixel.

use nalgebra::Vector2;

/// What counts as the bright point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlobParams {
    /// Share of the way from the background to the brightest pixel from which a pixel belongs to a blob.
    pub threshold: f64,
    /// How far the brightest pixel must rise over the background, in standard deviations of the noise.
    pub rise: f64,
    /// Smallest area of a blob, pixels.
    pub least_area: usize,
    /// Largest area of a blob, as a share of the picture.
    pub most_area: f64,
    /// A second blob with more than this share of the first one's light makes the picture ambiguous.
    pub rival: f64,
}

impl Default for BlobParams {
    fn default() -> Self {
        Self { threshold: 0.25, rise: 12.0, least_area: 3, most_area: 0.02, rival: 0.3 }
    }
}

/// A grey picture in linear light; row 0 is the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Luminance {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Light, row after row; only its proportions matter.
    pub values: Vec<f64>,
}

/// What a picture shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shown {
    /// One bright point, at this pixel.
    Point(Vector2<f64>),
    /// Nothing bright enough.
    Nothing,
    /// More than one bright point, or one cut off by the picture's edge, or too large a patch.
    Unclear,
}

/// Pixels around a blob whose light belongs to it too: its blurred rim.
const RIM: usize = 2;

/// The bright point of a picture: the centroid of the light over the background, in and around the blob.
///
/// The centroid is of linear light; a saturated disc's is right too, since its rim alone is weighed in part.
///
/// # Panics
/// If the values are not as many as the size says.
#[must_use]
pub fn bright_point(picture: &Luminance, params: &BlobParams) -> Shown {
    assert_eq!(picture.values.len(), picture.width * picture.height, "one value per pixel");
    let (background, noise) = background(&picture.values);
    let peak = picture.values.iter().fold(f64::NEG_INFINITY, |peak, value| peak.max(*value));
    if peak - background <= params.rise * noise {
        return Shown::Nothing;
    }
    let threshold = background + params.threshold * (peak - background);
    let mut blobs = blobs(picture, threshold);
    blobs.retain(|blob| blob.area >= params.least_area);
    blobs.sort_by(|a, b| b.light.total_cmp(&a.light));
    let Some(first) = blobs.first() else { return Shown::Nothing };
    let is_rivalled = blobs.get(1).is_some_and(|second| second.light > params.rival * first.light);
    let is_large = first.area as f64 > params.most_area * picture.values.len() as f64;
    if is_rivalled || is_large || first.touches_edge(picture) {
        return Shown::Unclear;
    }
    Shown::Point(first.centroid(picture, background, noise))
}

/// Values looked at to learn the background: a part of them does as well as all.
const BACKGROUND_SAMPLES: usize = 8192;
/// Standard deviations of a normal distribution in its median absolute deviation.
const MAD: f64 = 1.4826;

/// Median of the picture, and the standard deviation of its noise by the median absolute deviation, at least a thousandth of the
/// full range of the values: pictures without noise exist.
fn background(values: &[f64]) -> (f64, f64) {
    let step = (values.len() / BACKGROUND_SAMPLES).max(1);
    let mut some: Vec<f64> = values.iter().step_by(step).copied().collect();
    let middle = median(&mut some);
    let mut off: Vec<f64> = some.iter().map(|value| (value - middle).abs()).collect();
    (middle, (MAD * median(&mut off)).max(1e-3 * middle.abs()).max(1e-6))
}

fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() {
        return 0.0;
    }
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Pixels above the threshold that touch.
struct Blob {
    area: usize,
    light: f64,
    /// First and last column, first and last row.
    columns: [usize; 2],
    rows: [usize; 2],
}

fn blobs(picture: &Luminance, threshold: f64) -> Vec<Blob> {
    let mut taken = vec![false; picture.values.len()];
    let mut found = Vec::new();
    for start in 0..picture.values.len() {
        if picture.values[start] > threshold && !taken[start] {
            found.push(flood(picture, threshold, start, &mut taken));
        }
    }
    found
}

fn flood(picture: &Luminance, threshold: f64, start: usize, taken: &mut [bool]) -> Blob {
    let (width, height) = (picture.width, picture.height);
    let mut blob = Blob { area: 0, light: 0.0, columns: [width, 0], rows: [height, 0] };
    let mut open = vec![start];
    taken[start] = true;
    while let Some(at) = open.pop() {
        let (x, y) = (at % width, at / width);
        blob.area += 1;
        blob.light += picture.values[at];
        blob.columns = [blob.columns[0].min(x), blob.columns[1].max(x)];
        blob.rows = [blob.rows[0].min(y), blob.rows[1].max(y)];
        for ny in y.saturating_sub(1)..(y + 2).min(height) {
            for nx in x.saturating_sub(1)..(x + 2).min(width) {
                let next = ny * width + nx;
                if picture.values[next] > threshold && !taken[next] {
                    taken[next] = true;
                    open.push(next);
                }
            }
        }
    }
    blob
}

impl Blob {
    fn touches_edge(&self, picture: &Luminance) -> bool {
        let touches = |[first, last]: [usize; 2], count: usize| first == 0 || last + 1 == count;
        touches(self.columns, picture.width) || touches(self.rows, picture.height)
    }

    /// Light below three deviations of the noise is left out, so that the dark around the blob does not pull.
    fn centroid(&self, picture: &Luminance, background: f64, noise: f64) -> Vector2<f64> {
        let span =
            |[first, last]: [usize; 2], count: usize| first.saturating_sub(RIM)..(last + RIM + 1).min(count);
        let (mut sum, mut moment) = (0.0, Vector2::zeros());
        for y in span(self.rows, picture.height) {
            for x in span(self.columns, picture.width) {
                let light = picture.values[y * picture.width + x] - background;
                if light > 3.0 * noise {
                    sum += light;
                    moment += light * Vector2::new(x as f64, y as f64);
                }
            }
        }
        moment / sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A disc with antialiased rim on a dark picture with a pattern for noise.
    fn picture(discs: &[(f64, f64, f64)]) -> Luminance {
        let (width, height) = (80, 60);
        let value = |i: usize| {
            let (x, y) = ((i % width) as f64, (i / width) as f64);
            let covered = |&(cx, cy, r): &(f64, f64, f64)| {
                let inside = |k: usize| {
                    let (dx, dy) = ((k % 16) as f64 / 16.0 - 0.46875, (k / 16) as f64 / 16.0 - 0.46875);
                    ((x + dx - cx).powi(2) + (y + dy - cy).powi(2) < r * r) as u32
                };
                f64::from((0..256).map(inside).sum::<u32>()) / 256.0
            };
            0.01 + 0.001 * ((i * 7919 % 13) as f64 / 6.0 - 1.0) + discs.iter().map(covered).sum::<f64>()
        };
        Luminance { width, height, values: (0..width * height).map(value).collect() }
    }

    #[test]
    fn the_middle_of_a_disc_is_found_to_a_hundredth_of_a_pixel() {
        for (x, y) in [(40.0, 30.0), (20.3, 41.7), (61.77, 11.12)] {
            let Shown::Point(at) = bright_point(&picture(&[(x, y, 3.3)]), &BlobParams::default()) else {
                panic!("not found at {x}, {y}");
            };
            assert!((at - Vector2::new(x, y)).norm() < 0.01, "{at} for {x}, {y}");
        }
    }

    #[test]
    fn what_is_no_single_point_is_not_guessed() {
        let shown = |discs: &[_]| bright_point(&picture(discs), &BlobParams::default());
        assert_eq!(shown(&[]), Shown::Nothing);
        assert_eq!(shown(&[(20., 20., 3.), (50., 40., 3.)]), Shown::Unclear);
        assert_eq!(shown(&[(0., 20., 3.)]), Shown::Unclear, "cut off by the edge");
        assert_eq!(shown(&[(40., 30., 25.)]), Shown::Unclear, "as large as a lamp");
        assert!(
            matches!(shown(&[(20., 20., 4.), (50., 40., 1.2)]), Shown::Point(_)),
            "a small glint is passed over"
        );
    }
}
