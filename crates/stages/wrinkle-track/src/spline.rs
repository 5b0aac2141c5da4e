//! Uniform cubic B-splines in the plane, as [`artifact::Curve2d`] defines them: parameter u from 0 to (control points − 3).

use nalgebra::{DMatrix, Matrix4, Vector2, Vector4};

/// A place in the image, px.
pub type Place = Vector2<f64>;

/// The span of a parameter, and the shares of its four control points.
fn shares(u: f64, controls: usize) -> (usize, Vector4<f64>) {
    let (span, v) = span(u, controls);
    (span, basis() * Vector4::new(1.0, v, v * v, v * v * v))
}

fn span(u: f64, controls: usize) -> (usize, f64) {
    let span = (u.max(0.0) as usize).min(controls.saturating_sub(4));
    (span, u - span as f64)
}

/// Rows: control points; columns: powers of v.
fn basis() -> Matrix4<f64> {
    Matrix4::new(
        1.0, -3.0, 3.0, -1.0, //
        4.0, 0.0, -6.0, 3.0, //
        1.0, 3.0, 3.0, -3.0, //
        0.0, 0.0, 0.0, 1.0,
    ) / 6.0
}

/// The place at a parameter; at least four control points.
#[must_use]
pub(crate) fn point(controls: &[Place], u: f64) -> Place {
    let (span, shares) = shares(u, controls.len());
    (0..4).map(|i| controls[span + i] * shares[i]).sum()
}

/// The derivative by the parameter.
#[must_use]
pub(crate) fn derivative(controls: &[Place], u: f64) -> Place {
    let (span, v) = span(u, controls.len());
    let shares = basis() * Vector4::new(0.0, 1.0, 2.0 * v, 3.0 * v * v);
    (0..4).map(|i| controls[span + i] * shares[i]).sum()
}

/// Places at `count` parameters, from the start to the end.
#[must_use]
pub(crate) fn sampled(controls: &[Place], count: usize) -> Vec<Place> {
    let end = controls.len() as f64 - 3.0;
    (0..count).map(|i| point(controls, end * i as f64 / (count - 1).max(1) as f64)).collect()
}

/// Weight of the control polygon's bends beside the pixels of a control point: where pixels are few, as in the corner of a slanting
/// end, or missing, the curve goes straight on. With 0.001 such ends hook; from 0.2 on it cuts the valley's own turns.
const STIFFNESS: f64 = 0.03;

/// The control points with the least `Σ wᵢ |pᵢ − v(uᵢ)|²` [BickelBotsch2007, Eq. 5]; none if that does not determine them.
#[must_use]
pub(crate) fn fit(parameters: &[f64], places: &[Place], weights: &[f64], count: usize) -> Option<Vec<Place>> {
    let mut normal = DMatrix::<f64>::zeros(count, count);
    let mut right = DMatrix::<f64>::zeros(count, 2);
    for ((u, place), weight) in parameters.iter().zip(places).zip(weights) {
        let (span, shares) = shares(*u, count);
        for i in 0..4 {
            for j in 0..4 {
                normal[(span + i, span + j)] += weight * shares[i] * shares[j];
            }
            right[(span + i, 0)] += weight * shares[i] * place.x;
            right[(span + i, 1)] += weight * shares[i] * place.y;
        }
    }
    let stiffness = STIFFNESS * weights.iter().sum::<f64>() / count as f64;
    for first in 0..count.saturating_sub(2) {
        let bend = [1.0, -2.0, 1.0];
        for i in 0..3 {
            for j in 0..3 {
                normal[(first + i, first + j)] += stiffness * bend[i] * bend[j];
            }
        }
    }
    let solved = normal.cholesky()?.solve(&right);
    let controls: Vec<Place> = (0..count).map(|i| Place::new(solved[(i, 0)], solved[(i, 1)])).collect();
    controls.iter().all(|control| control.iter().all(|x| x.is_finite())).then_some(controls)
}

/// The control points of the same curve from its other end.
#[must_use]
pub(crate) fn reversed(mut controls: Vec<Place>) -> Vec<Place> {
    controls.reverse();
    controls
}
