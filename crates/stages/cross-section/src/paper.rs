//! The paper's model, exactly: a sharp, symmetric profile under a uniform sky, fitted section by section.

use crate::curve::Curve;
use crate::paint::Band;
use crate::params::Params;

/// Entries of the table of horizons.
const ENTRIES: usize = 1024;
/// Sections are coupled to their neighbours by these deviations of the differences of ln w and ln(d/w) per section.
const CHANGES: [f64; 2] = [0.05, 0.1];
/// Deviation of the ratio of intensities.
const NOISE: f64 = 0.02;
/// Rounds of the fit: within each, the outer points m stay.
const ROUNDS: usize = 6;
/// Steps per round.
const STEPS: usize = 4;
/// Where ln w and ln(d/w) may lie.
const BOUNDS: [[f64; 2]; 2] = [[0.0, 4.0], [-4.6, 0.7]];

/// The light in a groove of the profile S(p) [BickelBotsch2007, Eq. 6 and 7].
///
/// A place of the profile is concave on its own side, so there its horizon is the ground; on the far side it is the line that grazes the
/// opposite bulge, at the distance t with `(2 − t) e^(−t) (u + t) = (t − 1) e^(−t) − (u − 1) e^(−u)`, u = |p|/w: the same for
/// all depths.
#[derive(Debug, Clone)]
pub struct SharpGroove {
    /// For even u in [0, 2]: the far horizon's slope over d/w, and where it grazes.
    horizon: Vec<[f64; 2]>,
}

impl Default for SharpGroove {
    fn default() -> Self {
        Self::new()
    }
}

impl SharpGroove {
    /// Makes the table of horizons.
    #[must_use]
    pub fn new() -> Self {
        let entry = |i: usize| graze(2.0 * i as f64 / (ENTRIES - 1) as f64);
        Self { horizon: (0..ENTRIES).map(entry).collect() }
    }

    /// `I(p) = ½ (sin β' + sin α')` at u = |p|/w for a depth of `ratio` widths, with its derivatives by u and by the ratio; 1 where all of
    /// the sky is seen. Beyond u = 2, the bulge, it is 1.
    #[must_use]
    pub fn light(&self, u: f64, ratio: f64) -> [f64; 3] {
        if u >= 2.0 {
            return [1.0, 0.0, 0.0];
        }
        let u = u.max(0.0);
        let fall = (-u).exp();
        let (ground, ground_by) = ((2.0 - u) * fall, (u - 3.0) * fall);
        let [far, grazing] = self.far(u);
        // The grazing point moves along the line of sight: only the place itself counts.
        let far_by = -(ground + far) / (u + grazing).max(1e-9);
        let (s, m) = (ratio * far, ratio * ground);
        let (near, away) = (1.0 / (1.0 + m * m), 1.0 / (1.0 + s * s));
        let lengths = (near * away).sqrt();
        let cosine = (1.0 - s * m) * lengths;
        let turn = -(s + m) * lengths;
        let (by_s, by_m) = (0.5 * turn * away, 0.5 * turn * near);
        let by_u = if u > 0.0 { ratio * (by_s * far_by + by_m * ground_by) } else { 0.0 };
        [0.5 * (1.0 + cosine), by_u, by_s * far + by_m * ground]
    }

    fn far(&self, u: f64) -> [f64; 2] {
        let along = 0.5 * u * (ENTRIES - 1) as f64;
        let entry = (along as usize).min(ENTRIES - 2);
        let share = along - entry as f64;
        [0, 1].map(|k| self.horizon[entry][k] * (1.0 - share) + self.horizon[entry + 1][k] * share)
    }
}

/// The slope over d/w of the steepest line from u on one side to the other, and the distance where it grazes.
fn graze(u: f64) -> [f64; 2] {
    let height = |t: f64| (t - 1.0) * (-t).exp();
    let ground = |t: f64| (2.0 - t) * (-t).exp();
    // Positive before the grazing point, negative behind it.
    let rest = |t: f64| ground(t) * (u + t) - (height(t) - height(u));
    let (mut low, mut high) = (0.0, 2.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if rest(middle) > 0.0 { low = middle } else { high = middle }
    }
    let t = 0.5 * (low + high);
    [ground(t), t]
}

/// Width, depth over width and misfit of a section.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SharpFit {
    /// Width, px.
    pub w: f64,
    /// Depth over width.
    pub ratio: f64,
    /// `I(m)`.
    pub ambient: f64,
    /// Root mean square misfit of `I(p)/I(m)`.
    pub misfit: f64,
}

/// The intensities across one section: distance from the curve and light.
type Samples = Vec<[f64; 2]>;

/// Fits d and w to all sections at once [BickelBotsch2007, Sec. 5.2]: least squares on `I(p)/I(m)` for |p| ≤ m = 2w, by
/// Levenberg–Marquardt with analytic derivatives; m follows w from round to round. Neighbouring sections are coupled by the differences of
/// ln w and ln(d/w). None for sections without paint.
pub(crate) fn fit(band: &Band, curve: &Curve, places: &[f64], params: &Params) -> Vec<Option<SharpFit>> {
    let groove = SharpGroove::new();
    let samples = sections(band, curve, places, params.step_px);
    let reach = |samples: &Samples| samples.iter().map(|[p, _]| p.abs()).fold(0.0, f64::max);
    let mut reaches: Vec<f64> = samples.iter().map(reach).filter(|reach| *reach > 0.0).collect();
    if reaches.is_empty() {
        return vec![None; places.len()];
    }
    let middle = reaches.len() / 2;
    let half = *reaches.select_nth_unstable_by(middle, f64::total_cmp).1;
    let mut unknowns = vec![[(0.5 * half).max(1.5).ln(), -1.2]; places.len()];
    for _ in 0..ROUNDS {
        let fixed: Vec<Frame> = samples
            .iter()
            .zip(&unknowns)
            .map(|(samples, [width, _])| Frame::of(samples, 2.0 * width.exp()))
            .collect();
        for _ in 0..STEPS {
            unknowns = step(&groove, &samples, &fixed, &unknowns);
        }
    }
    let result = |at: usize| {
        let [w, ratio] = unknowns[at].map(f64::exp);
        let frame = Frame::of(&samples[at], 2.0 * w);
        let squares: Vec<f64> = frame
            .inner(&samples[at])
            .map(|[p, light]| (light / frame.ambient - groove.light(p.abs() / w, ratio)[0]).powi(2))
            .collect();
        let misfit = (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt();
        (!samples[at].is_empty()).then_some(SharpFit { w, ratio, ambient: frame.ambient, misfit })
    };
    (0..places.len()).map(result).collect()
}

/// Per pixel the light that the nearest section says.
pub(crate) fn model(band: &Band, curve: &Curve, fits: &[Option<SharpFit>]) -> Vec<f64> {
    let groove = SharpGroove::new();
    let last = fits.len() - 1;
    let light = |fit: SharpFit, p: f64| fit.ambient * groove.light(p.abs() / fit.w, fit.ratio)[0];
    let nearest = |x: f64| fits[((x / curve.len() * last as f64).round() as usize).min(last)];
    band.pixels.iter().map(|pixel| nearest(pixel.x).map_or(1.0, |fit| light(fit, pixel.p))).collect()
}

/// Painted pixels by the nearest section.
fn sections(band: &Band, curve: &Curve, places: &[f64], step: f64) -> Vec<Samples> {
    let mut samples = vec![Vec::new(); places.len()];
    let last = places.len() - 1;
    for pixel in &band.pixels {
        let at = (pixel.x / curve.len() * last as f64).round() as usize;
        if (pixel.x - places[at.min(last)]).abs() <= step.max(1.0) {
            samples[at.min(last)].push([pixel.p, pixel.light]);
        }
    }
    samples
}

/// Up to where a section is compared, and the light there.
struct Frame {
    outer: f64,
    ambient: f64,
}

impl Frame {
    /// The light at m: the 80 % of what lies from 0.7 m to 1.3 m, or at the paint's end.
    fn of(samples: &Samples, outer: f64) -> Self {
        let reach = samples.iter().map(|[p, _]| p.abs()).fold(0.0, f64::max);
        let outer = outer.min(reach.max(1.0));
        let near = |p: f64| (0.7 * outer..=1.3 * outer).contains(&p.abs());
        let mut lights: Vec<f64> =
            samples.iter().filter(|[p, _]| near(*p)).map(|[_, light]| *light).collect();
        if lights.is_empty() {
            return Self { outer, ambient: 1.0 };
        }
        let place = lights.len() * 4 / 5;
        Self { outer, ambient: *lights.select_nth_unstable_by(place, f64::total_cmp).1 }
    }

    fn inner<'s>(&self, samples: &'s Samples) -> impl Iterator<Item = [f64; 2]> + use<'s> {
        let outer = self.outer;
        samples.iter().copied().filter(move |[p, _]| p.abs() <= outer)
    }
}

type Pair = [f64; 2];

/// One damped Gauss–Newton step: a block-tridiagonal system of 2 × 2 blocks, its coupling diagonal.
fn step(groove: &SharpGroove, samples: &[Samples], frames: &[Frame], unknowns: &[Pair]) -> Vec<Pair> {
    let count = unknowns.len();
    let coupling = CHANGES.map(|deviation| 1.0 / (deviation * deviation));
    let mut diagonal: Vec<[f64; 3]> = Vec::with_capacity(count);
    let mut right: Vec<Pair> = Vec::with_capacity(count);
    for at in 0..count {
        let [w, ratio] = unknowns[at].map(f64::exp);
        let (mut block, mut gradient) = ([1e-3, 0.0, 1e-3], [0.0; 2]);
        for [p, light] in frames[at].inner(&samples[at]) {
            let u = p.abs() / w;
            let [model, by_u, by_ratio] = groove.light(u, ratio);
            let by = [-by_u * u, by_ratio * ratio].map(|by| by / NOISE);
            let residual = (light / frames[at].ambient - model) / NOISE;
            block = [block[0] + by[0] * by[0], block[1] + by[0] * by[1], block[2] + by[1] * by[1]];
            gradient = [gradient[0] + by[0] * residual, gradient[1] + by[1] * residual];
        }
        for beside in [at.checked_sub(1), Some(at + 1).filter(|at| *at < count)].into_iter().flatten() {
            for k in 0..2 {
                block[2 * k] += coupling[k];
                gradient[k] += coupling[k] * (unknowns[beside][k] - unknowns[at][k]);
            }
        }
        // Damping: the model bends strongly where a start is poor.
        diagonal.push([1.05 * block[0], block[1], 1.05 * block[2]]);
        right.push(gradient);
    }
    let steps = solve(&diagonal, &right, coupling);
    let moved = |(unknown, step): (&Pair, &Pair)| {
        [0, 1].map(|k| (unknown[k] + step[k].clamp(-0.5, 0.5)).clamp(BOUNDS[k][0], BOUNDS[k][1]))
    };
    unknowns.iter().zip(&steps).map(moved).collect()
}

/// Solves for blocks `[[a, b], [b, c]]` on the diagonal and −coupling beside it, by elimination from the first to the last.
fn solve(diagonal: &[[f64; 3]], right: &[Pair], coupling: Pair) -> Vec<Pair> {
    let inverse = |[a, b, c]: [f64; 3]| {
        let determinant = (a * c - b * b).max(1e-12);
        [c / determinant, -b / determinant, a / determinant]
    };
    let times = |[a, b, c]: [f64; 3], [x, y]: Pair| [a * x + b * y, b * x + c * y];
    let mut inverses: Vec<[f64; 3]> = Vec::with_capacity(diagonal.len());
    let mut carried: Vec<Pair> = Vec::with_capacity(diagonal.len());
    for (block, right) in diagonal.iter().zip(right) {
        let (mut block, mut right) = (*block, *right);
        if let (Some(&[a, b, c]), Some(&before)) = (inverses.last(), carried.last()) {
            block = [
                block[0] - coupling[0] * a * coupling[0],
                block[1] - coupling[0] * b * coupling[1],
                block[2] - coupling[1] * c * coupling[1],
            ];
            let [x, y] = times([a, b, c], before);
            right = [right[0] + coupling[0] * x, right[1] + coupling[1] * y];
        }
        inverses.push(inverse(block));
        carried.push(right);
    }
    let mut solution = vec![[0.0; 2]; diagonal.len()];
    for at in (0..diagonal.len()).rev() {
        let mut right = carried[at];
        if let Some([x, y]) = solution.get(at + 1).copied() {
            right = [right[0] + coupling[0] * x, right[1] + coupling[1] * y];
        }
        solution[at] = times(inverses[at], right);
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_crease_has_its_closed_form() {
        let groove = SharpGroove::new();
        for (ratio, light) in [(0.2, 0.862), (0.5, 0.5), (1.0, 0.2)] {
            let found = groove.light(0.0, ratio)[0];
            assert!((found - 1.0 / (1.0 + 4.0 * ratio * ratio)).abs() < 1e-6 && (found - light).abs() < 5e-4);
        }
    }

    #[test]
    fn it_is_the_integral_over_the_sky() {
        // Rays over half a circle, weighted by the cosine to the normal, against a fine polyline.
        let groove = SharpGroove::new();
        let height = |u: f64| 0.6 * (u.abs() - 1.0) * (-u.abs()).exp();
        for u in [0.1, 0.5, 1.0, 1.7] {
            let slope: f64 = 0.6 * (2.0 - u) * f64::exp(-u);
            let lean = slope.atan();
            let rays = 4000;
            let sum: f64 = (0..rays)
                .map(|ray| std::f64::consts::PI * (f64::from(ray) + 0.5) / f64::from(rays))
                .filter(|angle| {
                    (1..4000).all(|i| {
                        let x = u + 0.002 * f64::from(i) * angle.cos().signum();
                        height(x) <= height(u) + 1e-9 + (x - u) * angle.tan()
                    })
                })
                .map(|angle| (angle.sin() * lean.cos() - angle.cos() * lean.sin()).max(0.0))
                .sum();
            let brute = 0.5 * sum * std::f64::consts::PI / f64::from(rays);
            let light = groove.light(u, 0.6)[0];
            assert!((light - brute).abs() < 2e-3, "{u}: {light} {brute}");
        }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let groove = SharpGroove::new();
        let step = 1e-4;
        for (u, ratio) in [(0.05, 0.3), (0.6, 0.7), (1.3, 0.2), (1.9, 0.9)] {
            let [_, by_u, by_ratio] = groove.light(u, ratio);
            let difference = |du: f64, dr: f64| {
                (groove.light(u + du, ratio + dr)[0] - groove.light(u - du, ratio - dr)[0]) / (2.0 * step)
            };
            assert!((difference(step, 0.0) - by_u).abs() < 2e-3 * (1.0 + by_u.abs()), "{u} {ratio} {by_u}");
            assert!((difference(0.0, step) - by_ratio).abs() < 1e-4, "{u} {ratio} {by_ratio}");
        }
    }

    #[test]
    fn coupled_sections_are_solved_exactly() {
        let (diagonal, right) =
            (vec![[5.0, 1.0, 6.0]; 4], vec![[1.0, 2.0], [0.0, -1.0], [3.0, 0.5], [1.0, 1.0]]);
        let coupling = [1.0, 0.5];
        let x = solve(&diagonal, &right, coupling);
        for at in 0..4usize {
            let beside = |other: Option<&Pair>, k: usize| other.map_or(0.0, |other| coupling[k] * other[k]);
            let before = at.checked_sub(1).and_then(|at| x.get(at));
            let a = 5.0 * x[at][0] + x[at][1] - beside(before, 0) - beside(x.get(at + 1), 0);
            let b = x[at][0] + 6.0 * x[at][1] - beside(before, 1) - beside(x.get(at + 1), 1);
            assert!((a - right[at][0]).abs() < 1e-12 && (b - right[at][1]).abs() < 1e-12);
        }
    }
}
