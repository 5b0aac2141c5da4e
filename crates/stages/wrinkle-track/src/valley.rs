//! A wrinkle's patch of paint as a valley curve [BickelBotsch2007, Sec. 5.1].

use crate::params::TrackParams;
use crate::region::Region;
use crate::spline::{self, Place};
use artifact::PaintWidth;
use nalgebra::Vector2;

/// A valley curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Valley {
    /// Control points, px.
    pub controls: Vec<Place>,
    /// How far the paint reaches to both sides.
    pub paint: Vec<PaintWidth>,
    /// Share of the curve that lies on paint, its ends left out.
    pub on_paint: f64,
    /// Whether the wrinkle bends so much that it goes along its skeleton.
    pub is_bent: bool,
}

/// Distance of the places at which the paint's width is measured, px.
const EVERY_PX: f64 = 4.0;
const CONTROLS: std::ops::RangeInclusive<usize> = 5..=12;
/// The paint's end is looked for in steps of this, px, no farther than that.
const RAY_STEP_PX: f64 = 0.25;
const RAY_MOST_PX: f64 = 200.0;

/// The valley curve of a region; `gray` is the light of its pixels (one each), `before` the same wrinkle's curve in another image,
/// whose direction is kept. None where the region is too small to have one.
#[must_use]
pub fn valley(
    region: &Region,
    gray: &[f64],
    before: Option<&[Place]>,
    params: &TrackParams,
) -> Option<Valley> {
    let places = region.places();
    let weights = weights(gray, params.most_weight);
    let axis = Axis::of(&places)?;
    let along: Vec<f64> = places.iter().map(|place| axis.along(place)).collect();
    let mut controls = curve(&along, &places, &weights, params)?;
    let is_bent = bend(&controls, &axis).max(axis.fold(region, &along)) > params.bent_deg.to_radians();
    if is_bent {
        controls = curve(&region.ways_from_end(), &places, &weights, params)?;
    }
    let controls = directed(controls, before);
    let (paint, on_paint) = paint_widths(region, &controls);
    Some(Valley { controls, paint, on_paint, is_bent })
}

/// `wᵢ = (g_max − g_min)/(gᵢ − g_min)` [BickelBotsch2007, Eq. 5], bounded; all alike where there is no difference.
fn weights(gray: &[f64], most: f64) -> Vec<f64> {
    let least = gray.iter().copied().fold(f64::INFINITY, f64::min);
    let range = gray.iter().copied().fold(f64::NEG_INFINITY, f64::max) - least;
    match range > 0.0 {
        true => gray.iter().map(|value| range / (value - least).max(range / most)).collect(),
        false => vec![1.0; gray.len()],
    }
}

/// The principal axis of some pixels.
struct Axis {
    center: Place,
    direction: Vector2<f64>,
}

impl Axis {
    /// The axis; it runs to the right, or down if it is steep.
    fn of(places: &[Place]) -> Option<Self> {
        let center = places.iter().sum::<Place>() / places.len() as f64;
        let mut spread = nalgebra::Matrix2::zeros();
        for place in places {
            let off = place - center;
            spread += off * off.transpose();
        }
        let eigen = spread.symmetric_eigen();
        let main = if eigen.eigenvalues[0] >= eigen.eigenvalues[1] { 0 } else { 1 };
        let direction: Vector2<f64> = eigen.eigenvectors.column(main).into();
        let leading = if direction.x.abs() >= direction.y.abs() { direction.x } else { direction.y };
        let is_axis = eigen.eigenvalues[main] > 0.0 && leading.is_finite();
        is_axis.then_some(Self { center, direction: direction * leading.signum() })
    }

    /// `xᵢ = (pᵢ − p̄)ᵀ a`.
    fn along(&self, place: &Place) -> f64 {
        (place - self.center).dot(&self.direction)
    }

    /// How far a wrinkle turns from its axis, by how much longer the way through it is than the distance of its ends: the angle at
    /// the ends of the circular arc for which that is so.
    fn fold(&self, region: &Region, along: &[f64]) -> f64 {
        let across = Vector2::new(-self.direction.y, self.direction.x);
        let sides: Vec<f64> =
            region.places().iter().map(|place| (place - self.center).dot(&across)).collect();
        let extent = |values: &[f64]| {
            values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
                - values.iter().copied().fold(f64::INFINITY, f64::min)
        };
        let [length, width] = [extent(along), extent(&sides)];
        // Straight strokes are not that wide: their skeleton need not be asked.
        if width < FLAT * length {
            return 0.0;
        }
        let way = region.ways_from_end().into_iter().fold(0.0, f64::max);
        let excess = way / length.hypot(width);
        std::f64::consts::FRAC_PI_3 * ((excess - 1.0) / (ARC_EXCESS - 1.0)).max(0.0)
    }
}

/// An arc that turns by 30° to its axis at both ends is so wide for its length.
const FLAT: f64 = 0.13;
/// An arc that turns by 60° at both ends is so much longer than the diagonal of its box: 2.094 R to √(1.732² + 0.5²) R.
const ARC_EXCESS: f64 = 1.162;

/// The largest angle between a curve and its axis.
fn bend(controls: &[Place], axis: &Axis) -> f64 {
    let end = controls.len() as f64 - 3.0;
    let angle = |i: usize| {
        let tangent = spline::derivative(controls, end * i as f64 / 32.0);
        let forward = tangent.dot(&axis.direction);
        (tangent - axis.direction * forward).norm().atan2(forward)
    };
    // The ends hang on few pixels.
    (3..=29).map(angle).fold(0.0, f64::max)
}

/// The curve over a parameter along the wrinkle, px.
fn curve(along: &[f64], places: &[Place], weights: &[f64], params: &TrackParams) -> Option<Vec<Place>> {
    let from = along.iter().copied().fold(f64::INFINITY, f64::min);
    let length = along.iter().copied().fold(f64::NEG_INFINITY, f64::max) - from;
    if length <= 0.0 {
        return None;
    }
    let count =
        ((length / params.px_per_control).ceil() as usize + 3).clamp(*CONTROLS.start(), *CONTROLS.end());
    let end = count as f64 - 3.0;
    let parameters: Vec<f64> = along.iter().map(|along| end * (along - from) / length).collect();
    spline::fit(&parameters, places, weights, count)
}

/// The curve in the direction of the one before.
fn directed(controls: Vec<Place>, before: Option<&[Place]>) -> Vec<Place> {
    let Some(before) = before.filter(|before| before.len() >= 4) else { return controls };
    let ends = |controls: &[Place]| {
        [spline::point(controls, 0.0), spline::point(controls, controls.len() as f64 - 3.0)]
    };
    let ([start, end], [old_start, old_end]) = (ends(&controls), ends(before));
    let straight = (start - old_start).norm() + (end - old_end).norm();
    let turned = (start - old_end).norm() + (end - old_start).norm();
    if turned < straight { spline::reversed(controls) } else { controls }
}

/// Where the paint ends on both sides of a curve, and the share of the curve that lies on it.
fn paint_widths(region: &Region, controls: &[Place]) -> (Vec<PaintWidth>, f64) {
    let end = controls.len() as f64 - 3.0;
    let outline = spline::sampled(controls, 33);
    let length: f64 = outline.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    let count = (length / EVERY_PX).ceil().max(2.0) as usize;
    let width = |i: usize| {
        let u = end * i as f64 / count as f64;
        let (at, tangent) = (spline::point(controls, u), spline::derivative(controls, u));
        let right = Vector2::new(-tangent.y, tangent.x).try_normalize(0.0).unwrap_or_else(Vector2::x);
        PaintWidth { u, left_px: reach(region, at, -right), right_px: reach(region, at, right) }
    };
    let widths: Vec<PaintWidth> = (0..=count).map(width).collect();
    // The very ends lie in the corners of slanting strokes.
    let inner = &widths[1..widths.len() - 1];
    let on_paint = inner.iter().filter(|width| width.left_px + width.right_px > 0.0).count();
    let share = on_paint as f64 / inner.len() as f64;
    (widths, share)
}

/// How far paint reaches from a place in a direction.
fn reach(region: &Region, from: Place, direction: Vector2<f64>) -> f64 {
    let mut before = region.cover(from);
    if before < 0.5 {
        return 0.0;
    }
    for step in 1..=(RAY_MOST_PX / RAY_STEP_PX) as usize {
        let way = step as f64 * RAY_STEP_PX;
        let cover = region.cover(from + direction * way);
        if cover < 0.5 {
            return way - RAY_STEP_PX * (0.5 - cover) / (before - cover);
        }
        before = cover;
    }
    RAY_MOST_PX
}
