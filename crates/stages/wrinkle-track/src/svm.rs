//! A support vector machine with a soft margin of squared slack and a Gaussian kernel [CortesVapnik1995].
//!
//! With squared slack the dual is that of a hard margin with `K + I/C` for a kernel: minimise
//! `½ Σ αᵢ αⱼ yᵢ yⱼ (Kᵢⱼ + δᵢⱼ/C) − Σ αᵢ` over `α ≥ 0`, `Σ αᵢ yᵢ = 0`. It is solved two multipliers at a time (sequential
//! minimal optimisation), the pair chosen by second-order information [FanChenLin2005].

use crate::Error;
use artifact::SupportPixel;

/// A place in the space of features: ln(G/R), ln(B/G).
pub type Ratios = [f64; 2];

/// What a training pixel looks like, and whether it is paint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Its place.
    pub ratios: Ratios,
    /// Whether it is paint.
    pub paint: bool,
}

impl Sample {
    fn sign(&self) -> f64 {
        if self.paint { 1.0 } else { -1.0 }
    }
}

/// What can be chosen about a machine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SvmParams {
    /// Cost of squared slack.
    pub c: f64,
    /// Kernel exp(−gamma d²).
    pub gamma: f64,
    /// The solution is good enough when no condition of optimality is off by more.
    pub tolerance: f64,
}

/// A trained machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Svm {
    gamma: f64,
    bias: f64,
    support: Vec<SupportPixel>,
}

/// Steps per sample after which a problem counts as unsolvable.
const STEPS_PER_SAMPLE: usize = 20_000;

/// Above the largest third derivative of exp(−x²) along a line, |8x³ − 12x| exp(−x²) at x = 0.5246.
const THIRD_DERIVATIVE: f64 = 3.91;

impl Svm {
    /// The machine of some samples; the bytes of the result hang on their order, the decision only to the tolerance.
    ///
    /// # Errors
    /// [`Error::OneClass`] if all samples are paint or none is; [`Error::Unsolved`] if the tolerance is out of reach.
    pub fn train(samples: &[Sample], params: SvmParams) -> Result<Self, Error> {
        let painted = samples.iter().filter(|sample| sample.paint).count();
        if painted == 0 || painted == samples.len() {
            return Err(Error::OneClass);
        }
        let kernel = Kernel::of(samples, params);
        let (alpha, bias) = minimize(samples, &kernel, params.tolerance)?;
        let support = samples.iter().zip(&alpha).filter(|(_, alpha)| **alpha > 0.0);
        let term = |(sample, alpha): (&Sample, &f64)| SupportPixel {
            ratios: sample.ratios,
            coefficient: sample.sign() * alpha,
        };
        Ok(Self { gamma: params.gamma, bias, support: support.map(term).collect() })
    }

    /// A machine that was trained before.
    #[must_use]
    pub fn new(gamma: f64, bias: f64, support: Vec<SupportPixel>) -> Self {
        Self { gamma, bias, support }
    }

    /// The decision at a place; above 0 it is paint.
    #[must_use]
    pub fn decide(&self, at: Ratios) -> f64 {
        let term = |pixel: &SupportPixel| pixel.coefficient * gaussian(self.gamma, at, pixel.ratios);
        self.support.iter().map(term).sum::<f64>() + self.bias
    }

    /// What the decision cannot leave within `radius` of a place: its least and largest value, by the first and second derivatives
    /// there and a bound of the third.
    #[must_use]
    pub fn bounds(&self, at: Ratios, radius: f64) -> [f64; 2] {
        let (mut value, mut slope, mut bend, mut size) = (self.bias, [0.0; 2], [0.0; 3], 0.0);
        for SupportPixel { ratios, coefficient } in &self.support {
            let off = [at[0] - ratios[0], at[1] - ratios[1]];
            let term = coefficient * gaussian(self.gamma, at, *ratios);
            let steep = -2.0 * self.gamma * term;
            value += term;
            size += coefficient.abs();
            slope = [slope[0] + steep * off[0], slope[1] + steep * off[1]];
            let curved = |a: f64, b: f64| -2.0 * self.gamma * steep * a * b;
            bend[0] += steep + curved(off[0], off[0]);
            bend[1] += curved(off[0], off[1]);
            bend[2] += steep + curved(off[1], off[1]);
        }
        // No direction bends more than the root of the sum of squares.
        let most_bend = (bend[0] * bend[0] + 2.0 * bend[1] * bend[1] + bend[2] * bend[2]).sqrt();
        let third = THIRD_DERIVATIVE * self.gamma.powf(1.5) * size;
        let reach = radius * (slope[0].hypot(slope[1]) + radius * (0.5 * most_bend + radius * third / 6.0));
        [value - reach, value + reach]
    }

    /// What is added to the sum.
    #[must_use]
    pub fn bias(&self) -> f64 {
        self.bias
    }

    /// The terms of the sum.
    #[must_use]
    pub fn support(&self) -> &[SupportPixel] {
        &self.support
    }
}

fn squared(a: Ratios, b: Ratios) -> f64 {
    (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)
}

fn gaussian(gamma: f64, a: Ratios, b: Ratios) -> f64 {
    (-gamma * squared(a, b)).exp()
}

/// `yᵢ yⱼ (Kᵢⱼ + δᵢⱼ/C)`, row after row.
struct Kernel {
    values: Vec<f64>,
    count: usize,
}

impl Kernel {
    fn of(samples: &[Sample], params: SvmParams) -> Self {
        let count = samples.len();
        let mut values = vec![0.0; count * count];
        for (i, a) in samples.iter().enumerate() {
            values[i * count + i] = 1.0 + 1.0 / params.c;
            for (j, b) in samples[..i].iter().enumerate() {
                let value = a.sign() * b.sign() * gaussian(params.gamma, a.ratios, b.ratios);
                values[i * count + j] = value;
                values[j * count + i] = value;
            }
        }
        Self { values, count }
    }

    fn row(&self, i: usize) -> &[f64] {
        &self.values[i * self.count..(i + 1) * self.count]
    }
}

/// The multipliers and the bias.
fn minimize(samples: &[Sample], kernel: &Kernel, tolerance: f64) -> Result<(Vec<f64>, f64), Error> {
    let signs: Vec<f64> = samples.iter().map(Sample::sign).collect();
    let mut alpha = vec![0.0; samples.len()];
    let mut gradient = vec![-1.0; samples.len()];
    for _ in 0..STEPS_PER_SAMPLE * samples.len() {
        let (first, most) = most_violating(&signs, &alpha, &gradient);
        let (second, least) = second_order(&signs, &alpha, &gradient, kernel, first, most);
        if most - least <= tolerance {
            return Ok((alpha, 0.5 * (most + least)));
        }
        let Some(second) = second else { break };
        step(&signs, &mut alpha, &mut gradient, kernel, [first, second]);
    }
    Err(Error::Unsolved)
}

/// The multiplier that is most willing to grow along its sign, and how willing.
fn most_violating(signs: &[f64], alpha: &[f64], gradient: &[f64]) -> (usize, f64) {
    let mut best = (0, f64::NEG_INFINITY);
    for (i, sign) in signs.iter().enumerate() {
        let will = -sign * gradient[i];
        if (*sign > 0.0 || alpha[i] > 0.0) && will > best.1 {
            best = (i, will);
        }
    }
    best
}

/// Its partner: the one with which the objective falls most; and the least will of all that could be one.
fn second_order(
    signs: &[f64],
    alpha: &[f64],
    gradient: &[f64],
    kernel: &Kernel,
    first: usize,
    most: f64,
) -> (Option<usize>, f64) {
    let row = kernel.row(first);
    let (mut partner, mut gain, mut least) = (None, 0.0, f64::INFINITY);
    for (j, sign) in signs.iter().enumerate() {
        if *sign > 0.0 && alpha[j] <= 0.0 {
            continue;
        }
        let will = -sign * gradient[j];
        least = least.min(will);
        let apart = most - will;
        if apart <= 0.0 {
            continue;
        }
        let bend = curvature(kernel, row, signs, first, j);
        if apart * apart / bend > gain {
            (partner, gain) = (Some(j), apart * apart / bend);
        }
    }
    (partner, least)
}

/// The second derivative along a pair: above 2/C but for rounding.
fn curvature(kernel: &Kernel, row: &[f64], signs: &[f64], i: usize, j: usize) -> f64 {
    (row[i] + kernel.row(j)[j] - 2.0 * signs[i] * signs[j] * row[j]).max(f64::MIN_POSITIVE)
}

/// Moves a pair to its optimum, both multipliers staying at 0 or above.
fn step(signs: &[f64], alpha: &mut [f64], gradient: &mut [f64], kernel: &Kernel, [i, j]: [usize; 2]) {
    let bend = curvature(kernel, kernel.row(i), signs, i, j);
    let mut length = (signs[j] * gradient[j] - signs[i] * gradient[i]) / bend;
    // αᵢ grows by yᵢ·length, αⱼ by −yⱼ·length.
    for (sign, value) in [(signs[i], alpha[i]), (-signs[j], alpha[j])] {
        if sign < 0.0 {
            length = length.min(value);
        }
    }
    let [grown_i, grown_j] = [signs[i] * length, -signs[j] * length];
    // What was cut off at 0 lies at 0, not beside it.
    alpha[i] = if alpha[i] + grown_i <= 0.0 { 0.0 } else { alpha[i] + grown_i };
    alpha[j] = if alpha[j] + grown_j <= 0.0 { 0.0 } else { alpha[j] + grown_j };
    let (row_i, row_j) = (kernel.row(i), kernel.row(j));
    for (k, value) in gradient.iter_mut().enumerate() {
        *value += row_i[k] * grown_i + row_j[k] * grown_j;
    }
}
