//! `paint-model/1`: what the paints of wrinkles look like, learnt from an image whose paint somebody marked
//! [BickelBotsch2007, Sec. 5.1].

use crate::finite::within;
use crate::ids::check_ids;
use crate::{Document, Kind, TakeRef, Violation, finite};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One classifier per paint. All look at x = (ln((G + floor)/(R + floor)), ln((B + floor)/(G + floor))) of linear light, in
/// which white is 1; a pixel shows the paint whose decision is the largest, if that is above 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PaintModel {
    /// The take that it was learnt from.
    pub take: Option<TakeRef>,
    /// What is added to linear light before its logarithm.
    pub floor: f64,
    /// The paints.
    pub paints: Vec<LearntPaint>,
}

/// A paint's classifier: the decision is Σ coefficient · exp(−gamma |x − ratios|²) + bias over the support.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LearntPaint {
    /// Name of the paint.
    pub id: String,
    /// Red, green, blue that stand for it in masks.
    pub mark: [u8; 3],
    /// Width of the kernel: exp(−gamma d²).
    pub gamma: f64,
    /// What a training pixel on the wrong side cost.
    pub c: f64,
    /// Share of pixels told rightly that the classifier had not seen, the mean of paint and other pixels; edges of the paint do
    /// not count.
    pub score: f64,
    /// What is added to the sum.
    pub bias: f64,
    /// The support.
    pub support: Vec<SupportPixel>,
}

/// A term of a classifier.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SupportPixel {
    /// Its place: ln(G/R), ln(B/G).
    pub ratios: [f64; 2],
    /// Its weight, above 0 for paint.
    pub coefficient: f64,
}

impl Kind for PaintModel {
    const NAME: &'static str = "paint-model";
    const VERSION: u32 = 1;
}

impl Document for PaintModel {
    fn check(&self) -> Result<(), Violation> {
        within("the model", "floor", self.floor, f64::MIN_POSITIVE..=1.0)?;
        if self.paints.is_empty() {
            return Err(Violation::new("paints", "there is none"));
        }
        check_ids("paints", "paint", self.paints.iter().map(|paint| &paint.id))?;
        for paint in &self.paints {
            let place = format!("paint {}", paint.id);
            within(&place, "gamma", paint.gamma, f64::MIN_POSITIVE..f64::INFINITY)?;
            within(&place, "c", paint.c, f64::MIN_POSITIVE..f64::INFINITY)?;
            within(&place, "score", paint.score, 0.0..=1.0)?;
            finite(&format!("{place}, bias"), [&paint.bias])?;
            let numbers = |pixel: &SupportPixel| [pixel.ratios[0], pixel.ratios[1], pixel.coefficient];
            let all: Vec<f64> = paint.support.iter().flat_map(numbers).collect();
            finite(&format!("{place}, support"), &all)?;
        }
        Ok(())
    }
}
