//! From patches of paint to dots: a patch that several markers are expected in is shared out among them.

use crate::blobs::Blob;
use crate::center::{Patch, Spot};
use crate::track::Prediction;
use crate::tracker::Stray;

/// Markers are expected in a patch if their prediction lies this near to its pixels, px.
const INSIDE_PX: f64 = 1.5;
/// A patch holds several dots if it is larger than the largest of them by this factor.
const SEVERAL: f64 = 1.3;

/// A dot, or a marker's share of several that touch.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Dot {
    pub(crate) spot: Spot,
    /// The largest share of paint of its pixels.
    pub(crate) peak: f64,
    /// The patch that it was found in.
    pub(crate) blob: usize,
    /// Whether the patch holds other dots too.
    pub(crate) shared: bool,
}

/// The dots of the patches.
pub(crate) fn dots(
    patches: &[Option<Patch>],
    found: &[Blob],
    predictions: &[Option<Prediction>],
    guards: &[Stray],
) -> Vec<Dot> {
    let mut all = Vec::new();
    for (blob, patch) in patches.iter().enumerate() {
        let Some(patch) = patch else { continue };
        let Some(whole) = patch.spot() else { continue };
        let peak = found[blob].peak;
        let expected: Vec<Spot> = predictions
            .iter()
            .flatten()
            .filter(|p| p.facing && is_beside(&found[blob], p.at))
            .map(|p| Spot { at: p.at, area: p.area })
            .chain(
                guards
                    .iter()
                    .map(|guard| Spot { at: guard.at, area: guard.area })
                    .filter(|spot| is_beside(&found[blob], spot.at)),
            )
            .collect();
        let largest = expected.iter().map(|spot| spot.area).fold(0.0, f64::max);
        if expected.len() >= 2 && whole.area > SEVERAL * largest {
            let parts = patch.share(&expected).into_iter().flatten();
            all.extend(parts.map(|spot| Dot { spot, peak, blob, shared: true }));
        } else {
            all.push(Dot { spot: whole, peak, blob, shared: false });
        }
    }
    all
}

fn is_beside(blob: &Blob, at: [f64; 2]) -> bool {
    let [left, top, right, bottom] = blob.bounds.map(f64::from);
    let inside = |x: f64, low: f64, high: f64| x >= low - INSIDE_PX && x <= high + INSIDE_PX;
    inside(at[0], left, right)
        && inside(at[1], top, bottom)
        && blob.runs.iter().any(|run| {
            let x = at[0].clamp(f64::from(run.first), f64::from(run.end - 1));
            (x - at[0]).hypot(f64::from(run.y) - at[1]) <= INSIDE_PX
        })
}
