//! From an image and a curve to sections.

use crate::curve::Curve;
use crate::fit::Fit;
use crate::paint::{Band, band};
use crate::params::Params;
use crate::picture::Picture;
use crate::problem::{CREASE, LN_LIGHT, LN_RATIO, LN_WIDTH, LOPSIDED, ROUND};
use artifact::{Curve2d, Section, SectionDeviation, SectionState};
use nalgebra::Vector2;

/// A valley must explain the image better than flat skin within so many px to each side …
const LOCAL_PX: f64 = 20.0;
/// … by this share of the gate.
const LOCAL_GATE: f64 = 0.75;
/// A section needs paint within so many px along the curve.
const GAP_PX: f64 = 5.0;

/// A wrinkle's paint in an image.
#[derive(Debug, Clone)]
pub struct Painted {
    /// Its first curve.
    pub curve: Curve,
    /// The painted pixels beside it.
    pub band: Band,
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
    pub debug: String,
}

/// The paint along a curve; none where the curve leaves the image or there is no paint.
#[must_use]
pub fn painted(picture: &Picture, light: &[f64; 256], curve: &Curve2d, params: &Params) -> Option<Painted> {
    let path = Curve::of(curve)?;
    let widest = curve.paint.iter().map(|width| width.left_px.max(width.right_px)).reduce(f64::max);
    let reach = widest.map_or(params.reach_px, |widest| (widest + 3.0).min(params.reach_px));
    let band = band(picture, light, &path, reach)?;
    Some(Painted { curve: path, band })
}

/// The sections of a wrinkle; none where there is too little paint.
#[must_use]
pub fn measure(painted: &Painted, params: &Params, albedo: f64) -> Option<Measured> {
    let Painted { curve, band } = painted;
    let fit = Fit::of(band, curve.len(), params, albedo)?;
    if std::env::var("DBG").is_ok() {
        let mid = fit.fields.len() / 2;
        let g: Vec<i64> = fit.gains.iter().map(|g| *g as i64).collect();
        eprintln!("DBG gain {:.0} px {} len {:.0} w {:.1} r {:.3} eps {:.2} misfit {:.4} gains {g:?} r {:?}", fit.gain, band.pixels.len(), curve.len(), fit.fields[mid][0].exp(), fit.fields[mid][1].exp(), fit.constants[0], fit.misfits[mid], fit.fields.iter().map(|f| (f[1].exp() * 100.0) as i64).collect::<Vec<_>>());
    }
    let count = (curve.len() / params.step_px).floor().max(1.0) as usize;
    let places = (0..=count).map(|i| curve.len() * i as f64 / count as f64);
    let paint = Coverage::of(band, curve.len());
    let sections = places.map(|x| section(&fit, curve, x, params, paint.near(x))).collect();
    let debug = ();let _=debug;
    Some(Measured { sections, model: fit.model.clone(), gain: fit.gain, debug: format!("cost {} const e k g t b {:?} misfit {:?}", fit.cost, fit.constants, fit.misfits) })
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
        self.0[cell] || x % GAP_PX < 0.5 * GAP_PX && cell > 0 && self.0[cell - 1] || self.0.get(cell + 1) == Some(&true)
    }
}

fn section(fit: &Fit, curve: &Curve, x: f64, params: &Params, is_covered: bool) -> Section {
    let ([w, d], deviation, crease, light) = {
        let (fields, deviations) = fit.at(x);
        let (w, ratio) = (fields[LN_WIDTH].exp(), fields[LN_RATIO].exp());
        let ratio_spread = ratio * deviations[1];
        let spread = SectionDeviation { w_px: w * deviations[0], d_px: w * ratio_spread.hypot(ratio * deviations[0]) };
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
        () if !is_covered => SectionState::Failed,
        () if fit.gain < params.gate || local_gain(fit, x) < LOCAL_GATE * params.gate => SectionState::Flat,
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
        tilt_rad: params.tilt_deg.map(f64::to_radians),
        deviation: Some(deviation).filter(|spread| spread.w_px.is_finite() && spread.d_px.is_finite()),
        residual: Some(fit.misfits[station] / light),
        state,
    }
}

fn local_gain(fit: &Fit, x: f64) -> f64 {
    let near = |station: usize| ((station as f64 + 0.5) * fit.spacing - x).abs() <= LOCAL_PX.max(fit.spacing);
    fit.gains.iter().enumerate().filter(|(station, _)| near(*station)).map(|(_, gain)| gain).sum()
}
