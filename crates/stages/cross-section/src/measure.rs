//! From an image and a curve to sections.

use crate::Picture;
use crate::albedo::combined_albedo;
use crate::curve::Curve;
use crate::fit::Fit;
use crate::ground::{Ground, Surface};
use crate::paint::{Band, band};
use crate::paper;
use crate::params::{Model, Params};
use crate::plan::station_count;
use crate::problem::{CREASE, LN_LIGHT, LN_RATIO, LN_WIDTH, LOPSIDED, ROUND};
use artifact::{Curve2d, Section, SectionDeviation, SectionState};
use nalgebra::Vector2;

/// A valley must explain the image better than flat skin within so many px to each side …
const LOCAL_PX: f64 = 20.0;
/// … by this share of the gate.
const LOCAL_GATE: f64 = 0.75;
/// Paint that reaches less far to both sides, px, does not show whether it is flat.
const NARROW_PX: f64 = 6.5;
/// No light on flat paint bends by more across it, as share of the light.
const MOST_BEND: f64 = 0.3;
/// Uneven light of 1 % on flat skin looks like a valley of this d/w …
const SHALLOWEST: f64 = 0.055;
/// … and up to this one where it is as wide …
const SHALLOW: f64 = 0.09;
/// … as this share of how far the paint reaches: its rims are not seen.
const WIDE: f64 = 0.85;
/// A valley on less than this share of the paint …
const PART: f64 = 0.5;
/// … must explain the image so many times better.
const PART_GATE: f64 = 3.0;
/// A section needs paint within so many px along the curve.
const GAP_PX: f64 = 5.0;

/// How the skin lies is asked so far beyond the paint, px …
const BESIDE_PX: f64 = 4.0;
/// … and no less and no farther from the curve than this.
const GROUND_PX: [f64; 2] = [10.0, 32.0];

/// A wrinkle's paint in an image.
#[derive(Debug, Clone)]
pub struct Painted {
    /// Its first curve.
    pub curve: Curve,
    /// The painted pixels beside it.
    pub band: Band,
    /// How the skin around it is seen, at even places from its start to its end; empty where that is not known.
    pub ground: Vec<Option<Ground>>,
}

impl Painted {
    /// The same, with how the skin around it is seen.
    #[must_use]
    pub fn over(mut self, surface: &Surface<'_>) -> Self {
        let widest = self.band.pixels.iter().map(|pixel| pixel.p.abs()).fold(0.0, f64::max);
        let reach = (widest + BESIDE_PX).clamp(GROUND_PX[0], GROUND_PX[1]);
        self.ground = surface.along(&self.curve, station_count(self.curve.len()), reach);
        self
    }
}

/// A measured wrinkle.
#[derive(Debug, Clone)]
pub struct Measured {
    /// Its sections, from the start of the curve to its end.
    pub sections: Vec<Section>,
    /// Per pixel of the band the light that the model says.
    pub model: Vec<f64>,
    /// By how much a valley explains the image better than flat skin: twice the gain in log-likelihood.
    pub gain: f64,
}

/// The paint along a curve; none where the curve leaves the image or there is no paint.
#[must_use]
pub fn painted(picture: &Picture, light: &[f64; 256], curve: &Curve2d, params: &Params) -> Option<Painted> {
    let path = Curve::of(curve)?;
    let widest = curve.paint.iter().map(|width| width.left_px.max(width.right_px)).reduce(f64::max);
    let reach = widest.map_or(params.reach_px, |widest| (widest + 3.0).min(params.reach_px));
    let band = band(picture, light, &path, reach)?;
    Some(Painted { curve: path, band, ground: Vec::new() })
}

/// The sections of a wrinkle. Those without paint are failed; all of them where there is too little.
///
/// `albedo`: the share of the light that the paint's brightest channel throws back, see [`estimate_albedo`](crate::estimate_albedo).
#[must_use]
pub fn measure(painted: &Painted, params: &Params, albedo: f64) -> Measured {
    let Painted { curve, band, ground } = painted;
    let places = places(curve, params);
    let paint = Coverage::of(band, curve.len());
    if params.model == Model::Paper {
        return measure_sharp(painted, params, &places, &paint);
    }
    let Some(fit) = Fit::of(band, curve.len(), ground, params, combined_albedo(band, albedo)) else {
        let sections = places.iter().map(|&x| failed_section(curve, x)).collect();
        return Measured { sections, model: vec![1.0; band.pixels.len()], gain: 0.0 };
    };
    let is_flat = is_uneven_light(&fit, params)
        || is_chance(&fit, params, places.iter().copied().filter(|&x| paint.near(x)));
    let sections =
        places.iter().map(|&x| section(&fit, curve, x, params, [paint.near(x), is_flat])).collect();
    Measured { sections, model: fit.model, gain: fit.gain }
}

/// Sections of a curve beside which there is no paint: all failed; none if it is no curve.
#[must_use]
pub fn failed(curve: &Curve2d, params: &Params) -> Vec<Section> {
    let Some(curve) = Curve::of(curve) else { return Vec::new() };
    places(&curve, params).into_iter().map(|x| failed_section(&curve, x)).collect()
}

/// Lengths along a curve at which it is measured.
fn places(curve: &Curve, params: &Params) -> Vec<f64> {
    let count = (curve.len() / params.step_px).floor().max(1.0);
    (0..=count as usize).map(|i| curve.len() * i as f64 / count).collect()
}

fn failed_section(curve: &Curve, x: f64) -> Section {
    let (u, at, right) = curve.at(x);
    Section {
        u,
        at: at.into(),
        normal: right.into(),
        w_px: 0.0,
        d_px: 0.0,
        epsilon: 0.0,
        kappa: 0.0,
        tilt_rad: None,
        deviation: None,
        residual: None,
        state: SectionState::Failed,
    }
}

/// The paper's fit has no gate: all that has paint is measured.
fn measure_sharp(painted: &Painted, params: &Params, places: &[f64], paint: &Coverage) -> Measured {
    let Painted { curve, band, .. } = painted;
    let fits = paper::fit(band, curve, places, params);
    let sections = places.iter().zip(&fits).map(|(&x, fit)| {
        let failed = failed_section(curve, x);
        fit.filter(|_| paint.near(x)).map_or(failed, |fit| Section {
            w_px: fit.w,
            d_px: fit.ratio * fit.w,
            residual: Some(fit.misfit),
            state: SectionState::Measured,
            ..failed
        })
    });
    let model = paper::model(band, curve, &fits);
    Measured { sections: sections.collect(), model, gain: 0.0 }
}

/// Where along a curve there is paint.
struct Coverage(Vec<bool>);

impl Coverage {
    fn of(band: &Band, length: f64) -> Self {
        let mut covered = vec![false; (length / GAP_PX) as usize + 2];
        for pixel in &band.pixels {
            covered[(pixel.x / GAP_PX) as usize] = true;
        }
        Self(covered)
    }

    fn near(&self, x: f64) -> bool {
        let cell = (x / GAP_PX) as usize;
        self.0[cell]
            || x % GAP_PX < 0.5 * GAP_PX && cell > 0 && self.0[cell - 1]
            || self.0.get(cell + 1) == Some(&true)
    }
}

fn section(fit: &Fit, curve: &Curve, x: f64, params: &Params, [is_covered, is_flat]: [bool; 2]) -> Section {
    let ([w, d], deviation, crease, light) = {
        let (fields, deviations) = fit.at(x);
        let (w, ratio) = (fields[LN_WIDTH].exp(), fields[LN_RATIO].exp());
        let ratio_spread = ratio * deviations[1];
        let spread =
            SectionDeviation { w_px: w * deviations[0], d_px: w * ratio_spread.hypot(ratio * deviations[0]) };
        ([w, ratio * w], spread, fields[CREASE], fields[LN_LIGHT].exp())
    };
    let (u, at, right) = curve.at(x);
    // Across the refined valley, not across the first curve.
    let step = 2.0;
    let ahead = |x: f64| {
        let (_, at, right) = curve.at(x);
        at + right * fit.at(x).0[CREASE]
    };
    let along = ahead((x + step).min(curve.len())) - ahead((x - step).max(0.0));
    let normal = Vector2::new(-along.y, along.x).try_normalize(1e-9).unwrap_or(right);
    let station = ((x / fit.spacing) as usize).min(fit.misfits.len().saturating_sub(2));
    let state = match () {
        () if !is_covered || fit.leans(x) => SectionState::Failed,
        // Too little is seen to say that there is no valley.
        () if fit.gain < params.gate && fit.half_width < NARROW_PX => SectionState::Failed,
        // Like no groove, but too dark for flat paint.
        () if fit.gain < params.gate && fit.smooth_bend > MOST_BEND => SectionState::Failed,
        () if fit.gain < params.gate || local_gain(fit, x) < LOCAL_GATE * params.gate => SectionState::Flat,
        () if is_flat => SectionState::Flat,
        () => SectionState::Measured,
    };
    let has_valley = state == SectionState::Measured;
    let valley = |value: f64| if has_valley { value } else { 0.0 };
    Section {
        u,
        at: (at + right * if has_valley { crease } else { 0.0 }).into(),
        normal: normal.into(),
        w_px: w,
        d_px: valley(d),
        epsilon: valley(fit.constants[ROUND]),
        kappa: valley(fit.constants[LOPSIDED]),
        tilt_rad: fit.tilt(x).or(params.tilt_deg.map(f64::to_radians)),
        deviation: Some(deviation).filter(|spread| spread.w_px.is_finite() && spread.d_px.is_finite()),
        residual: Some(fit.misfits[station] / light),
        state,
    }
}

/// Whether what looks like a valley may be uneven light on flat paint: too shallow, or shallow and as wide as the paint itself.
fn is_uneven_light(fit: &Fit, params: &Params) -> bool {
    let is_seen =
        |station: usize| local_gain(fit, (station as f64 + 0.5) * fit.spacing) >= LOCAL_GATE * params.gate;
    let seen: Vec<usize> = (0..fit.fields.len()).filter(|&station| is_seen(station)).collect();
    let middle = |field: usize| {
        let mut values: Vec<f64> = seen.iter().map(|&station| fit.fields[station][field]).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).map_or(0.0, |value| value.exp())
    };
    let (w, ratio) = (middle(LN_WIDTH), middle(LN_RATIO));
    ratio < SHALLOWEST || ratio < SHALLOW && w > WIDE * fit.half_width
}

/// Whether what looks like a valley on some of the paint may be chance: a long wrinkle has many places for it.
fn is_chance(fit: &Fit, params: &Params, covered: impl Iterator<Item = f64>) -> bool {
    let [seen, all] = covered.fold([0usize; 2], |[seen, all], x| {
        [seen + usize::from(local_gain(fit, x) >= LOCAL_GATE * params.gate), all + 1]
    });
    (seen as f64) < PART * all as f64 && fit.gain < PART_GATE * params.gate
}

fn local_gain(fit: &Fit, x: f64) -> f64 {
    let near = |station: usize| ((station as f64 + 0.5) * fit.spacing - x).abs() <= LOCAL_PX.max(fit.spacing);
    fit.gains.iter().enumerate().filter(|(station, _)| near(*station)).map(|(_, gain)| gain).sum()
}
