//! The extended model fitted to the painted pixels of a wrinkle.

use crate::descent::{Minimum, descend};
use crate::ground::Ground;
use crate::paint::Band;
use crate::params::Params;
use crate::plan::{CORRELATED, PAINT_WIDTHS, Plan, RATIO};
use crate::problem::{CONSTANTS, FIELDS, Known, LN_RATIO, LN_WIDTH, Problem, ROUND, TILTED, huber};
use crate::ridge::ridge;
use crate::smooth::smooth_light;
use nalgebra::DMatrix;

/// Neighbouring pixels that share texture and misfit count as one, but at most so many where a valley is told from flat paint: beyond, it is
/// misfit.
const MOST_CORRELATED: f64 = 12.0;
/// A rounding must gain so much cost over a sharp crease.
const ROUNDING_GAIN: f64 = 10.0;
/// A view that leans more over the skin, as a tangent (70°), shows of a valley little but its rim.
const MOST_LEAN: f64 = 2.75;
/// Pixels that a fit needs.
const LEAST_PIXELS: usize = 60;

/// A fitted wrinkle, by its length.
pub(crate) struct Fit {
    /// Per station: ln w, ln(d/w), crease, ln of the light, its rise, curvature.
    pub(crate) fields: Vec<[f64; FIELDS]>,
    /// Deviations of ln w and ln(d/w), per station.
    pub(crate) deviations: Vec<[f64; 2]>,
    /// ε, κ, g, t.
    pub(crate) constants: [f64; CONSTANTS],
    /// By how much the valley explains the image better than flat paint, per station, and all over.
    pub(crate) gains: Vec<f64>,
    pub(crate) gain: f64,
    /// By how much smooth light would have to bend across the paint, as share of it.
    pub(crate) smooth_bend: f64,
    /// Root mean square misfit per station, as share of the light on open paint.
    pub(crate) misfits: Vec<f64>,
    /// How far the paint reaches to both sides, px.
    pub(crate) half_width: f64,
    /// Distance of stations, px.
    pub(crate) spacing: f64,
    /// Per pixel of the band the model's light.
    pub(crate) model: Vec<f64>,
    /// What geometry said, per station; empty where it said nothing.
    ground: Vec<Known>,
}

impl Fit {
    /// None where there is too little paint.
    pub(crate) fn of(
        band: &Band,
        length: f64,
        ground: &[Option<Ground>],
        params: &Params,
        albedo: f64,
    ) -> Option<Self> {
        if band.pixels.len() < LEAST_PIXELS {
            return None;
        }
        let plan = Plan::of(band, length, ground, params, albedo);
        let creases = ridge(&plan.rows, plan.stations);
        let mut flat = plan.problem(true);
        let base = plan.start(&flat, &creases, &[plan.ln_width, RATIO.ln(), 0.4]);
        let mut problem = plan.problem(false);
        let tried = plan.firsts(&creases).into_iter().map(|first| {
            let start = plan.moved_start(&problem, &creases, &first);
            descend(&problem, &start, 10, 0.5)
        });
        let mut best = tried.reduce(|best, other| if other.cost < best.cost { other } else { best })?;
        let noise = plan.noise(&problem, &best);
        (problem.noise, flat.noise) = (noise, noise);
        problem.skin_noise = plan.skin_noise(&problem, &best);
        best = descend(&problem, &best.unknowns, 15, 0.05);
        if problem.constants(&best.unknowns)[ROUND] < 0.6 {
            best = sharpened(&mut problem, best);
        }
        let flat_best = descend(&flat, &base, 6, 0.1);
        Some(plan.fit(band, &problem, &best, &flat, &flat_best))
    }

    /// The tilt of the view at a length along the wrinkle, rad, where geometry says it.
    pub(crate) fn tilt(&self, x: f64) -> Option<f64> {
        self.known_tilt(x).map(|known| (known + self.constants[TILTED]).atan())
    }

    /// Whether geometry says that the view leans too much there to show a valley's light.
    pub(crate) fn leans(&self, x: f64) -> bool {
        self.known_tilt(x).is_some_and(|known| known.abs() > MOST_LEAN)
    }

    /// The tangent of the tilt that geometry says.
    fn known_tilt(&self, x: f64) -> Option<f64> {
        let nearest = (x / self.spacing).round() as usize;
        self.ground.get(nearest.min(self.ground.len().saturating_sub(1))).map(|known| known.tilt)
    }

    /// Fields at a length along the wrinkle, with the deviations.
    pub(crate) fn at(&self, x: f64) -> ([f64; FIELDS], [f64; 2]) {
        let last = self.fields.len() - 1;
        let along = (x / self.spacing).clamp(0.0, last as f64);
        let station = (along as usize).min(last.saturating_sub(1));
        let (share, next) = (along - station as f64, (station + 1).min(last));
        let mix = |one: f64, other: f64| one + share * (other - one);
        let fields = std::array::from_fn(|k| mix(self.fields[station][k], self.fields[next][k]));
        (fields, [0, 1].map(|k| mix(self.deviations[station][k], self.deviations[next][k])))
    }
}

/// The fit with a sharp crease, unless the rounding explains enough.
fn sharpened(problem: &mut Problem<'_>, rounded: Minimum) -> Minimum {
    let first = problem.first(FIELDS);
    let mut start = rounded.unknowns.clone();
    start[first + ROUND] = 0.0;
    problem.free[ROUND] = false;
    let sharp = descend(problem, &start, 10, 0.1);
    if sharp.cost - rounded.cost < ROUNDING_GAIN {
        return sharp;
    }
    problem.free[ROUND] = true;
    rounded
}

impl Plan<'_> {
    fn fit(
        &self,
        band: &Band,
        problem: &Problem<'_>,
        best: &Minimum,
        flat: &Problem<'_>,
        flat_best: &Minimum,
    ) -> Fit {
        let unknowns = &best.unknowns;
        let fields =
            (0..self.stations).map(|at| std::array::from_fn(|k| problem.field(unknowns, k, at))).collect();
        let covariance = best.normal.matrix.clone().try_inverse();
        let deviation = |field, at| deviation(problem, covariance.as_ref(), field, at);
        let deviations =
            (0..self.stations).map(|at| [deviation(LN_WIDTH, at), deviation(LN_RATIO, at)]).collect();
        let seen = self.seen(problem, unknowns, band.pixels.len());
        let flat_costs = flat.costs(&flat_best.unknowns);
        let smooth = smooth_light(&self.rows, self.length, self.stations, problem.noise);
        let evidence = evidence(band, &seen.model);
        let gains = flat_costs.iter().zip(&seen.costs).map(|(flat, cost)| evidence * (flat - cost)).collect();
        let constants = problem.constants(unknowns);
        Fit {
            fields,
            deviations,
            constants: std::array::from_fn(|k| constants[k]),
            gain: evidence * (smooth.cost - seen.costs.iter().sum::<f64>()),
            smooth_bend: smooth.bend,
            gains,
            misfits: seen.misfits,
            half_width: PAINT_WIDTHS * self.ln_width.exp(),
            spacing: self.length / (self.stations - 1) as f64,
            model: seen.model,
            ground: if self.is_known { self.ground.clone() } else { Vec::new() },
        }
    }

    /// What the model says of `count` pixels.
    fn seen(&self, problem: &Problem<'_>, unknowns: &[f64], count: usize) -> Seen {
        let mut model = vec![0.0; count];
        let mut costs = vec![0.0; self.stations];
        let mut squares = vec![[0.0f64; 2]; self.stations];
        let mut place = self.order.iter();
        problem.visit(unknowns, |row, light, _| {
            if let Some(&pixel) = place.next() {
                model[pixel] = light;
            }
            let left = row.light - light;
            costs[row.station] += row.weight * huber(left / problem.noise).0;
            let sum = &mut squares[row.station];
            *sum = [sum[0] + 1.0, sum[1] + left * left];
        });
        let misfits = squares.iter().map(|[count, sum]| (sum / count.max(1.0)).sqrt()).collect();
        Seen { model, costs, misfits }
    }
}

/// What a model says of the pixels: the light of each; per station their cost and their root mean square misfit.
struct Seen {
    model: Vec<f64>,
    costs: Vec<f64>,
    misfits: Vec<f64>,
}

/// The deviation of a field at a station; infinite where the pixels do not say.
fn deviation(problem: &Problem<'_>, covariance: Option<&DMatrix<f64>>, field: usize, station: usize) -> f64 {
    let (first, weights) = problem.bases[field].stations[station];
    let at = problem.first(field) + first;
    let used = || (0..4).filter(|&k| weights[k] != 0.0);
    let sum = |covariance: &DMatrix<f64>| -> f64 {
        let pair = |j: usize, k: usize| weights[j] * weights[k] * covariance[(at + j, at + k)];
        used().flat_map(|j| used().map(move |k| (j, k))).map(|(j, k)| pair(j, k)).sum()
    };
    covariance.map_or(f64::INFINITY, sum).max(0.0).sqrt()
}

/// What the gain in likelihood is worth: the more what is left of neighbouring pixels is alike, the more of them count as
/// one. Of values that fall off alike along both axes, ((1 + ρ) / (1 − ρ))² do.
fn evidence(band: &Band, model: &[f64]) -> f64 {
    let left: Vec<f64> = band.pixels.iter().zip(model).map(|(pixel, light)| pixel.light - light).collect();
    let square = left.iter().map(|off| off * off).sum::<f64>() / left.len().max(1) as f64;
    let places = band.pixels.windows(2).enumerate();
    let beside = places.filter(|(_, pair)| {
        let [one, other] = [pair[0].place, pair[1].place];
        one[1] == other[1] && one[0] + 1 == other[0]
    });
    let (sum, count) =
        beside.fold((0.0, 0usize), |(sum, count), (at, _)| (sum + left[at] * left[at + 1], count + 1));
    let alike = (sum / count.max(1) as f64 / square.max(1e-12)).clamp(0.0, 0.9);
    let one = ((1.0 + alike) / (1.0 - alike)).powi(2);
    CORRELATED / one.min(MOST_CORRELATED)
}
