//! Masks of painted pixels against the true coverage.

use super::same::check_equal;
use super::{Metric, ScoreError};
use artifact::picture::Gray;

/// A mask and the truth that it should show.
#[derive(Debug, Clone)]
pub struct MaskPair {
    /// Where it stands, for messages: camera and frame.
    pub place: String,
    /// Share of every pixel that is covered with paint, 0–1.
    pub truth: Gray,
    /// The mask: painted from one half on; none where the result has no mask.
    pub result: Option<Gray>,
}

/// Coverage above which a pixel is paint, and below which it is not; those between lie on an edge.
const PAINT: f64 = 0.9;
const BARE: f64 = 0.1;
/// The bias of edges is looked for so near to one, px: what lies farther off is no edge in the wrong place.
const NEAR_EDGE: usize = 4;

/// Scores masks: `pixel_f1` over pixels with coverage over 90 % or under 10 %, pooled over all masks; `edge_bias_px`, how far the
/// edges of the paint lie too far out (positive in the context's `bias_px`) or in, in the mean; `missing` masks, whose
/// painted pixels all count as not found.
///
/// The bias is the area that the mask has too much within 4 px of a true edge, over the length of the edge: that of the
/// contour at one half of the coverage.
///
/// # Errors
/// Masks of another size than their image, and whatever the pictures' source refuses.
pub fn masks<E: From<ScoreError>>(
    pictures: impl IntoIterator<Item = Result<MaskPair, E>>,
) -> Result<Vec<Metric>, E> {
    let mut tally = Tally::default();
    for pair in pictures {
        tally.add(&pair?)?;
    }
    Ok(tally.metrics())
}

#[derive(Debug, Default)]
struct Tally {
    masks: usize,
    missing: usize,
    hits: usize,
    false_paint: usize,
    missed_paint: usize,
    edge_excess: f64,
    edge_length: f64,
}

impl Tally {
    fn add(&mut self, pair: &MaskPair) -> Result<(), ScoreError> {
        self.masks += 1;
        let Some(result) = &pair.result else {
            self.missing += 1;
            self.missed_paint += pair.truth.pixels.iter().filter(|&&coverage| coverage > PAINT).count();
            return Ok(());
        };
        let size = |picture: &Gray| format!("{} × {} px", picture.width, picture.height);
        check_equal(&format!("{}, image size", pair.place), &size(&pair.truth), &size(result))?;
        for (&coverage, &code) in pair.truth.pixels.iter().zip(&result.pixels) {
            let painted = code >= 0.5;
            self.hits += usize::from(coverage > PAINT && painted);
            self.missed_paint += usize::from(coverage > PAINT && !painted);
            self.false_paint += usize::from(coverage < BARE && painted);
        }
        self.add_edges(&pair.truth, result);
        Ok(())
    }

    fn add_edges(&mut self, truth: &Gray, result: &Gray) {
        let (near, length) = edges(truth);
        self.edge_length += length;
        let excess = |pixel: usize| result.pixels[pixel] - truth.pixels[pixel];
        self.edge_excess += (0..near.len()).filter(|&pixel| near[pixel]).map(excess).sum::<f64>();
    }

    fn metrics(&self) -> Vec<Metric> {
        let f1 = match 2 * self.hits + self.false_paint + self.missed_paint {
            0 => Err("neither truth nor result has a painted pixel".to_string()),
            whole => Ok(2.0 * self.hits as f64 / whole as f64),
        };
        let bias = self.edge_excess / self.edge_length;
        let value = match self.edge_length > 0.0 {
            true => Ok(bias.abs()),
            false => Err("no mask of the result has an edge of paint in the truth".to_string()),
        };
        let counts = [
            ("masks", self.masks),
            ("painted", self.hits + self.missed_paint),
            ("false_paint", self.false_paint),
            ("missed_paint", self.missed_paint),
        ];
        let metrics = vec![
            Metric::share("pixel_f1", f1),
            Metric::error("edge_bias_px", "px", value)
                .with("bias_px", bias)
                .with("edge_px", self.edge_length),
            Metric::count("missing", self.missing),
        ];
        let with_counts =
            |metric: Metric| counts.iter().fold(metric, |metric, &(key, count)| metric.with(key, count));
        metrics.into_iter().map(with_counts).collect()
    }
}

/// Which pixels lie near an edge, and how long the edges are, px.
fn edges(truth: &Gray) -> (Vec<bool>, f64) {
    let (width, height) = (truth.width, truth.height);
    let mut near = vec![false; width * height];
    let mut length = 0.0;
    for row in 0..height.saturating_sub(1) {
        for column in 0..width.saturating_sub(1) {
            let at = row * width + column;
            let corners = [at, at + 1, at + width + 1, at + width].map(|pixel| truth.pixels[pixel] - 0.5);
            let crossed = contour_length(corners);
            if crossed == 0.0 {
                continue;
            }
            length += crossed;
            for y in row.saturating_sub(NEAR_EDGE)..(row + 2 + NEAR_EDGE).min(height) {
                let columns = column.saturating_sub(NEAR_EDGE)..(column + 2 + NEAR_EDGE).min(width);
                near[y * width + columns.start..y * width + columns.end].fill(true);
            }
        }
    }
    (near, length)
}

/// The length of the zero contour in a unit square with values at its corners, in their order around it (marching squares).
fn contour_length(corners: [f64; 4]) -> f64 {
    const PLACES: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut crossings = Vec::with_capacity(4);
    for side in 0..4 {
        let (a, b) = (corners[side], corners[(side + 1) % 4]);
        if (a < 0.0) != (b < 0.0) {
            let share = a / (a - b);
            let (from, to) = (PLACES[side], PLACES[(side + 1) % 4]);
            crossings.push(nalgebra::Vector2::new(
                from[0] + share * (to[0] - from[0]),
                from[1] + share * (to[1] - from[1]),
            ));
        }
    }
    crossings.chunks_exact(2).map(|ends| (ends[1] - ends[0]).norm()).sum()
}
