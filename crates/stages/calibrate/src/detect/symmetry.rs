//! Corners to the points about which the picture around them is symmetric.
//!
//! Where four squares meet, the picture turned by half a turn is the same picture, whatever the blur. Of a ChArUco board that holds
//! for the rims of the markers too, whose edges draw away a corner that is sought by its gradients.

use super::{DetectError, Image};
use nalgebra::{Matrix2, Vector2};
use opencv::prelude::{MatTraitConst, MatTraitConstManual};

/// Where a corner about is, and one square along the board's rows and columns there; px.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seed {
    pub(super) at: Vector2<f64>,
    pub(super) axes: [Vector2<f64>; 2],
}

impl Seed {
    /// How narrow a square is seen, px.
    pub(super) fn width_px(&self) -> f64 {
        let [across, down] = self.axes;
        across.perp(&down).abs() / across.norm().max(down.norm())
    }
}

/// A corner at its place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Corner {
    pub(super) at: Vector2<f64>,
    /// How alike the picture around it and the same turned by half a turn are: 1 if they are the same, 0 if by chance.
    pub(super) likeness: f64,
    /// How much it is a corner of squares: 1 where two opposite quarters are black and two white.
    pub(super) checker: f64,
}

/// Samples of the window per px.
const DENSITY: f64 = 1.5;
/// Reach of a window, px: fewer pixels are all noise; more only cost time.
const REACH_PX: [f64; 2] = [2.0, 12.0];
const STEPS: usize = 30;
/// Where a step ends the search, px.
const STILL_PX: f64 = 1e-4;
/// The longest step, as a share of the window's reach.
const STRIDE: f64 = 0.3;
/// Least ratio of the eigenvalues of the normal matrix, in the board's axes: along a mere edge nothing holds a point.
const HELD: f64 = 0.02;

/// The corner near a seed, from a window that reaches a share of a square to all sides; none where nothing there is symmetric.
///
/// Least squares of I(q + d) − I(q − d) over the window's offsets d, by Gauss–Newton; with J = 2 ∇I(q + d), which it is about at a
/// centre of symmetry.
pub(super) fn refine(image: &Image, seed: &Seed, reach: f64) -> Result<Option<Corner>, DetectError> {
    let gray = Gray::of(image)?;
    Ok(Window::of(seed, reach).settle(&gray, seed.at))
}

/// A window: offsets on one side of its middle, with weights.
struct Window {
    offsets: Vec<(Vector2<f64>, f64)>,
    axes: Matrix2<f64>,
}

impl Window {
    fn of(seed: &Seed, reach: f64) -> Self {
        // Each axis by itself: a board that leans has short squares.
        let axis = |axis: Vector2<f64>| {
            let length = axis.norm().max(1e-9);
            axis * ((reach * length).clamp(REACH_PX[0], REACH_PX[1]) / length)
        };
        let axes = seed.axes.map(axis);
        let [across, down] = axes.map(|axis| (DENSITY * axis.norm()).ceil() as i32);
        let place = |i: i32, j: i32| {
            let (a, b) = (f64::from(i) / f64::from(across), f64::from(j) / f64::from(down));
            (axes[0] * a + axes[1] * b, (1.0 - a * a) * (1.0 - b * b))
        };
        // Of each two that face each other one.
        let offsets = (-across..=across)
            .flat_map(|i| (0..=down).map(move |j| (i, j)))
            .filter(|&(i, j)| j > 0 || i > 0)
            .map(|(i, j)| place(i, j))
            .filter(|(_, weight)| *weight > 0.0)
            .collect();
        Self { offsets, axes: Matrix2::from_columns(&axes) }
    }

    fn settle(&self, gray: &Gray, start: Vector2<f64>) -> Option<Corner> {
        let into_window = self.axes.try_inverse()?;
        let mut at = start;
        for _ in 0..STEPS {
            let mut step = self.step(gray, at)?;
            let stride = (into_window * step).norm();
            if stride > STRIDE {
                step *= STRIDE / stride;
            }
            at += step;
            if (into_window * (at - start)).norm() > 1.0 {
                return None;
            }
            if step.norm() < STILL_PX {
                break;
            }
        }
        self.judged(gray, at)
    }

    fn step(&self, gray: &Gray, at: Vector2<f64>) -> Option<Vector2<f64>> {
        let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
        for (offset, weight) in &self.offsets {
            let (Some(here), Some(there)) = (gray.at(at + offset), gray.at(at - offset)) else { continue };
            let slope = here.1 - there.1;
            normal += slope * slope.transpose() * *weight;
            right -= slope * ((here.0 - there.0) * weight);
        }
        let held = (self.axes.transpose() * normal * self.axes).symmetric_eigenvalues();
        (held.min() > HELD * held.max()).then(|| normal.try_inverse().map(|inverse| inverse * right))?
    }

    fn judged(&self, gray: &Gray, at: Vector2<f64>) -> Option<Corner> {
        let into_window = self.axes.try_inverse()?;
        let pair = |(offset, weight): &(Vector2<f64>, f64)| {
            let quarter = (into_window * offset).product().signum();
            Some((gray.at(at + offset)?.0, gray.at(at - offset)?.0, quarter, *weight))
        };
        let pairs: Vec<_> = self.offsets.iter().filter_map(pair).collect();
        let total: f64 = pairs.iter().map(|(.., weight)| 2.0 * weight).sum();
        let mean = pairs.iter().map(|(a, b, _, weight)| weight * (a + b)).sum::<f64>() / total;
        let (mut product, mut square, mut checker, mut spread) = (0.0, 0.0, 0.0, 0.0);
        for (a, b, quarter, weight) in pairs {
            let [a, b] = [a - mean, b - mean];
            product += 2.0 * weight * a * b;
            square += weight * (a * a + b * b);
            checker += weight * quarter * (a + b);
            spread += weight * (a.abs() + b.abs());
        }
        (square > 0.0).then(|| Corner { at, likeness: product / square, checker: checker.abs() / spread })
    }
}

/// Grey values between pixels.
struct Gray<'a> {
    codes: &'a [u8],
    size: [i64; 2],
}

impl<'a> Gray<'a> {
    fn of(image: &'a Image) -> Result<Self, DetectError> {
        let size = [i64::from(image.cols()), i64::from(image.rows())];
        Ok(Self { codes: image.data_typed::<u8>()?, size })
    }

    /// Value and gradient, by cubic convolution [Keys1981]; none outside the image.
    fn at(&self, place: Vector2<f64>) -> Option<(f64, Vector2<f64>)> {
        let first = place.map(|x| x.floor() as i64);
        let [width, height] = self.size;
        let is_inside = first.x >= 0 && first.y >= 0 && first.x + 1 < width && first.y + 1 < height;
        if !is_inside {
            return None;
        }
        let share = place - first.map(|x| x as f64);
        let [(weights_x, slopes_x), (weights_y, slopes_y)] = [cubic(share.x), cubic(share.y)];
        let (mut value, mut gradient) = (0.0, Vector2::zeros());
        for j in 0..4 {
            let row = (first.y - 1 + j as i64).clamp(0, height - 1) * width;
            let (mut along, mut slope) = (0.0, 0.0);
            for i in 0..4 {
                let column = (first.x - 1 + i as i64).clamp(0, width - 1);
                let code = f64::from(self.codes[(row + column) as usize]);
                along += weights_x[i] * code;
                slope += slopes_x[i] * code;
            }
            value += weights_y[j] * along;
            gradient += Vector2::new(weights_y[j] * slope, slopes_y[j] * along);
        }
        Some((value, gradient))
    }
}

/// Weights of the four samples around a place between the middle two, and their derivatives.
fn cubic(t: f64) -> ([f64; 4], [f64; 4]) {
    let (t2, t3) = (t * t, t * t * t);
    let weights = [
        0.5 * (-t3 + 2.0 * t2 - t),
        0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
        0.5 * (-3.0 * t3 + 4.0 * t2 + t),
        0.5 * (t3 - t2),
    ];
    let slopes = [
        0.5 * (-3.0 * t2 + 4.0 * t - 1.0),
        0.5 * (9.0 * t2 - 10.0 * t),
        0.5 * (-9.0 * t2 + 8.0 * t + 1.0),
        0.5 * (3.0 * t2 - 2.0 * t),
    ];
    (weights, slopes)
}
