//! `wrinkles-2d/1`: valley curves of painted wrinkles in the images, over frames [BickelBotsch2007, Sec. 5.1].

use crate::finite::within;
use crate::ids::{Known, PerCamera};
use crate::{Kind, Rate, Stream, TakeRef, Violation, finite};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The kind of wrinkle curves.
pub struct Wrinkles2d;

/// What holds for all frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wrinkles2dHeader {
    /// Camera ids.
    pub cameras: Vec<String>,
    /// The wrinkles.
    pub wrinkles: Vec<Wrinkle>,
    /// Frames per second of the mocap clock; absent where the source did not say.
    pub rate: Option<Rate>,
    /// The take.
    pub take: Option<TakeRef>,
}

/// A wrinkle that keeps its id over time and in all cameras.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wrinkle {
    /// Wrinkle id.
    pub id: String,
    /// Name of the colour that it is painted in; absent for a wrinkle without paint, such as one drawn by hand.
    pub paint: Option<String>,
}

/// The ids that frames may name, of kinds with cameras and wrinkles.
pub(crate) fn known<'a>(cameras: &'a [String], wrinkles: &'a [Wrinkle]) -> Known<'a> {
    Known { cameras, thing: "wrinkle", things: wrinkles.iter().map(|wrinkle| &wrinkle.id).collect() }
}

/// All curves in one frame, in memory and in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wrinkles2dFrame {
    /// Absolute frame number.
    pub frame: i64,
    /// Per camera id, per wrinkle id its curve. No entry of a camera: it has no image of the frame; no entry of a wrinkle: it is
    /// not to be seen.
    pub curves: PerCamera<Curve2d>,
}

/// A valley curve in an image: a uniform cubic B-spline of the parameter u from 0 to (number of control points − 3).
///
/// Between u = k and k + 1, with v = u − k and control points P, the curve is
/// `⅙ [(1−v)³ Pₖ + (3v³ − 6v² + 4) Pₖ₊₁ + (−3v³ + 3v² + 3v + 1) Pₖ₊₂ + v³ Pₖ₊₃]`. It starts and ends short of its first and last
/// control points. Its *right* side is the one on the right in the image when one goes along it: the side of the tangent (x, y)
/// turned to (−y, x), y running down.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Curve2d {
    /// Control points, px, at least four; pixel (0, 0) is the centre of the top-left pixel.
    pub controls: Vec<[f64; 2]>,
    /// Where the curve comes from; seen where nothing is said.
    #[serde(default, skip_serializing_if = "CurveState::is_seen")]
    pub state: CurveState,
    /// How sure the tracker is, 0–1; 1 where nothing is said.
    #[serde(default = "sure", skip_serializing_if = "is_sure")]
    pub confidence: f64,
    /// Where the paint ends on both sides, at rising u; empty where there is none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub paint: Vec<PaintWidth>,
}

impl Curve2d {
    /// The parameter of its end, which is how many spans it has.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.controls.len().saturating_sub(3) as f64
    }

    /// The place at a parameter, px.
    ///
    /// # Panics
    /// With fewer than four control points, which no file holds.
    #[must_use]
    pub fn at(&self, u: f64) -> [f64; 2] {
        self.blended(u, |v, w| {
            [
                w * w * w,
                3.0 * v * v * v - 6.0 * v * v + 4.0,
                -3.0 * v * v * v + 3.0 * v * v + 3.0 * v + 1.0,
                v * v * v,
            ]
        })
    }

    /// The derivative by the parameter, px.
    ///
    /// # Panics
    /// As [`Curve2d::at`].
    #[must_use]
    pub fn derivative(&self, u: f64) -> [f64; 2] {
        self.blended(u, |v, w| {
            [-3.0 * w * w, 9.0 * v * v - 12.0 * v, -9.0 * v * v + 6.0 * v + 3.0, 3.0 * v * v]
        })
    }

    /// The sum of the four control points of a span by sixths, which follow from v and 1 − v.
    fn blended(&self, u: f64, sixths: impl Fn(f64, f64) -> [f64; 4]) -> [f64; 2] {
        let span = (u.max(0.0) as usize).min(self.controls.len() - 4);
        let v = u - span as f64;
        let sixths = sixths(v, 1.0 - v);
        let controls = &self.controls[span..span + 4];
        [0, 1].map(|axis| (0..4).map(|i| sixths[i] * controls[i][axis]).sum::<f64>() / 6.0)
    }
}

/// Where a curve comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CurveState {
    /// Found in the image.
    #[default]
    Seen,
    /// Not found; kept from frames before.
    Held,
    /// Drawn or moved by a person.
    Edited,
}

impl CurveState {
    #[allow(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
    fn is_seen(&self) -> bool {
        *self == Self::Seen
    }
}

fn sure() -> f64 {
    1.0
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn is_sure(confidence: &f64) -> bool {
    *confidence == 1.0
}

/// How far the paint reaches at one place of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PaintWidth {
    /// Parameter of the curve.
    pub u: f64,
    /// From the curve to the end of the paint on its left side, px.
    pub left_px: f64,
    /// The same on its right side, px.
    pub right_px: f64,
}

impl Kind for Wrinkles2d {
    const NAME: &'static str = "wrinkles-2d";
    const VERSION: u32 = 1;
}

impl Stream for Wrinkles2d {
    type Header = Wrinkles2dHeader;
    type Frame = Wrinkles2dFrame;
    type Line = Wrinkles2dFrame;

    fn check(header: &Wrinkles2dHeader) -> Result<(), Violation> {
        header.rate.map_or(Ok(()), |rate| rate.check("rate"))?;
        known(&header.cameras, &header.wrinkles).check()
    }

    fn encode(header: &Wrinkles2dHeader, frame: &Wrinkles2dFrame) -> Result<Wrinkles2dFrame, Violation> {
        check_frame(header, frame)?;
        Ok(frame.clone())
    }

    fn decode(header: &Wrinkles2dHeader, line: Wrinkles2dFrame) -> Result<Wrinkles2dFrame, Violation> {
        check_frame(header, &line)?;
        Ok(line)
    }

    fn number(frame: &Wrinkles2dFrame) -> i64 {
        frame.frame
    }
}

fn check_frame(header: &Wrinkles2dHeader, frame: &Wrinkles2dFrame) -> Result<(), Violation> {
    known(&header.cameras, &header.wrinkles).check_values(frame.frame, &frame.curves, check_curve)
}

fn check_curve(place: &str, curve: &Curve2d) -> Result<(), Violation> {
    let spans = match curve.controls.len() {
        count @ 4.. => (count - 3) as f64,
        count => return Err(Violation::new(place, format!("{count} control points make no cubic curve"))),
    };
    finite(&format!("{place}, controls"), curve.controls.iter().flatten())?;
    within(place, "the confidence", curve.confidence, 0.0..=1.0)?;
    let place = format!("{place}, paint");
    for width in &curve.paint {
        within(&place, "u", width.u, 0.0..=spans)?;
        within(&place, "left_px", width.left_px, 0.0..f64::INFINITY)?;
        within(&place, "right_px", width.right_px, 0.0..f64::INFINITY)?;
    }
    check_rising(&place, "u", curve.paint.iter().map(|width| width.u))
}

/// Refuses parameters that do not rise.
pub(crate) fn check_rising(
    place: &str,
    name: &str,
    values: impl Iterator<Item = f64> + Clone,
) -> Result<(), Violation> {
    match values.clone().zip(values.skip(1)).find(|(before, after)| before >= after) {
        Some((before, after)) => {
            Err(Violation::new(place, format!("{name} {after} follows {name} {before}; they must rise")))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_what_its_documentation_says() {
        let controls = vec![[0.0, 6.0], [6.0, 0.0], [12.0, 0.0], [18.0, 6.0], [24.0, 0.0]];
        let curve = Curve2d { controls, state: CurveState::Seen, confidence: 1.0, paint: vec![] };
        // By hand: (1 4 1)/6 at the knots, (1 23 23 1)/48 between them.
        for (u, at) in [(0.0, [6.0, 1.0]), (0.5, [9.0, 0.25]), (1.0, [12.0, 1.0]), (2.0, [18.0, 4.0])] {
            assert!(
                (0..2).all(|axis| (curve.at(u)[axis] - at[axis]).abs() < 1e-12),
                "{u}: {:?}",
                curve.at(u)
            );
        }
        let (step, u) = (1e-6, 1.3);
        for axis in 0..2 {
            let slope = (curve.at(u + step)[axis] - curve.at(u - step)[axis]) / (2.0 * step);
            assert!((curve.derivative(u)[axis] - slope).abs() < 1e-6);
        }
        assert!(curve.end() == 2.0);
    }
}
