//! What a fit starts from: pixels by stations, priors, starts.

use crate::blur::Bell;
use crate::descent::{Minimum, descend};
use crate::ground::Ground;
use crate::paint::{Band, Pixel};
use crate::params::Params;
use crate::problem::{
    CONSTANTS, CREASE, FIELDS, Known, LN_LIGHT, LN_RATIO, LN_WIDTH, Prior, Problem, ROUND, Row, TILTED,
};
use crate::relief::Relief;
use crate::ridge::half_width;
use crate::shading::{NODES, places};
use crate::skin::{Group, collapsed, groups};
use crate::spline::Basis;
use crate::walls::{Around, SECTORS, Skyline, Walls};

/// Distance of the stations at which the model is computed, px.
const STATION_PX: f64 = 10.0;
/// Distances of the splines' knots, px: ln w, ln(d/w), crease, ln of the light, its rise, curvature of the surroundings.
const KNOTS_PX: [f64; FIELDS] = [50.0, 28.0, 16.0, 40.0, 60.0, 60.0];
/// Deviations of the differences of neighbouring coefficients: of these fields first ones, of the crease second ones, px.
const CHANGES: [f64; FIELDS] = [0.15, 0.6, 0.5, 0.15, 0.05, 0.03];
/// Paint reaches so many widths to each side, about …
pub(crate) const PAINT_WIDTHS: f64 = 1.6;
/// … but for this deviation of the logarithm.
const WIDTH_SPREAD: f64 = 0.4;
/// A valley so many times wider is not to be told from uneven light: the paint does not reach its rims.
const WIDEST: f64 = 2.4;
/// d/w before anything is known, and the deviation of its logarithm.
pub(crate) const RATIO: f64 = 0.3;
const RATIO_SPREAD: f64 = 1.2;
/// Deviation of the light's rise across the wrinkle.
const RISE_SPREAD: f64 = 0.04;
/// Deviation of the curvature of the surroundings, per 10 px.
const BEND_SPREAD: f64 = 0.03;
/// Means and deviations of ε, κ, g, t.
const CONSTANT_PRIORS: [[f64; 2]; CONSTANTS] = [[0.4, 0.3], [0.0, 0.12], [0.0, 0.06], [0.0, 0.3]];
/// Deviations of what geometry says of t and of the curvature, per 10 px.
const GROUND_SPREADS: [f64; 2] = [0.025, 0.008];
/// No view on a wrinkle leans more, as a tangent: beyond, it shows nothing.
const MOST_TILT: f64 = 3.0;
/// The first curve is off the crease by so much, px.
const CREASE_SPREAD: f64 = 2.0;
/// … and never by more than this, px, and this share of how far the paint reaches.
const ASIDE_PX: f64 = 2.5;
const ASIDE: f64 = 0.3;
/// Neighbouring pixels share texture and misfit: so many of them count as one in the fit.
pub(crate) const CORRELATED: f64 = 3.0;
/// Noise as share of the light on open paint: at first, and the least.
pub(crate) const NOISE: [f64; 2] = [0.02, 0.004];

/// Noise of cells of skin as share of its light: at first, and the least.
const SKIN_NOISE: [f64; 2] = [0.03, 0.006];
/// So many of neighbouring cells count as one.
const SKIN_CORRELATED: f64 = 20.0;
/// Cells that tell their noise.
const LEAST_CELLS: usize = 20;

/// Starts: share of the expected width, ε, and the side to which the crease lies of what is dark, with a view from there.
///
/// A round bottom is brighter than its walls, and the wall that faces the camera looks the widest: the middle of what is dark is then
/// none of the valley's.
const STARTS: [[f64; 3]; 8] = [
    [0.55, 0.1, 0.0],
    [1.0, 0.1, 0.0],
    [0.55, 0.5, 0.0],
    [1.0, 0.5, 0.0],
    [0.75, 0.15, 1.0],
    [0.75, 0.15, -1.0],
    [0.75, 0.5, 1.0],
    [0.75, 0.5, -1.0],
];

/// Creases so many widths apart are two.
const ELSEWHERE: f64 = 0.25;
/// A groove elsewhere is not followed to the end if it costs so much more: it never won.
const BEHIND: f64 = 20.0;

/// The best groove that is the same everywhere.
pub(crate) struct First {
    /// ln w, ln(d/w), ε.
    groove: [f64; 3],
    /// How far its crease lies off the middle of what is dark, px.
    crease: f64,
    tilt: f64,
}

/// What a fit starts from.
pub(crate) struct Plan<'a> {
    pub(crate) length: f64,
    pub(crate) stations: usize,
    pub(crate) rows: Vec<Row>,
    /// Skin beside the paint.
    pub(crate) skin: Vec<Group>,
    /// Per row its pixel in the band.
    pub(crate) order: Vec<usize>,
    reach: f64,
    pub(crate) ln_width: f64,
    params: &'a Params,
    albedo: f64,
    places: [f64; NODES],
    bell: Bell,
    /// Per station what geometry says; nothing where it says nothing.
    pub(crate) ground: Vec<Known>,
    skyline: Skyline,
    pub(crate) is_known: bool,
}

/// How many stations a length has.
pub(crate) fn station_count(length: f64) -> usize {
    (length / STATION_PX).round().max(1.0) as usize + 1
}

/// What geometry says, where it says nothing that of the nearest place where it does.
fn filled(ground: &[Option<Ground>], count: usize) -> Option<Vec<Known>> {
    let known: Vec<(usize, Known)> = ground
        .iter()
        .enumerate()
        .filter_map(|(at, ground)| {
            let ground = ground.as_ref()?;
            let tilt = ground.tilt_rad.tan().clamp(-MOST_TILT, MOST_TILT);
            Some((
                at,
                Known {
                    tilt,
                    bend: if ground.relief.is_some() { 0.0 } else { ground.bend_per_px },
                    around: Around { walls: Walls::of(&ground.skyline), relief: ground.relief },
                },
            ))
        })
        .collect();
    let nearest = |at: usize| {
        known.iter().min_by_key(|(other, _)| other.abs_diff(at)).map(|(_, ground)| ground.clone())
    };
    (0..count).map(nearest).collect()
}

/// The mean of what geometry says of the skyline.
fn mean_skyline(ground: &[Option<Ground>]) -> Skyline {
    let known = || ground.iter().flatten();
    let count = known().count().max(1) as f64;
    let mean =
        |side: usize, sector: usize| known().map(|ground| ground.skyline[side][sector]).sum::<f64>() / count;
    [0, 1].map(|side| std::array::from_fn::<f64, SECTORS, _>(|sector| mean(side, sector)))
}

impl<'a> Plan<'a> {
    pub(crate) fn of(
        band: &Band,
        length: f64,
        ground: &[Option<Ground>],
        params: &'a Params,
        albedo: f64,
    ) -> Self {
        let stations = station_count(length);
        let intervals = (stations - 1) as f64;
        let row = |pixel: &Pixel| {
            let along = (pixel.x / length * intervals).clamp(0.0, intervals);
            let station = (along as usize).min(intervals as usize - 1);
            Row { station, share: along - station as f64, p: pixel.p, light: pixel.light, weight: 1.0 }
        };
        let all: Vec<Row> = band.pixels.iter().map(row).collect();
        let mut order: Vec<usize> = (0..all.len()).collect();
        order.sort_by_key(|&pixel| all[pixel].station);
        let rows: Vec<Row> = order.iter().map(|&pixel| all[pixel]).collect();
        let skin = groups(&band.skin, intervals as usize, row);
        let reach = rows.iter().chain(skin.iter().flatten()).map(|row| row.p.abs()).fold(0.0, f64::max) + 4.0;
        let half = half_width(rows.iter().map(|row| (row.station, row.p)));
        let ln_width = (half / PAINT_WIDTHS).max(1.5).ln();
        let skyline = mean_skyline(ground);
        let ground = filled(ground, stations).filter(|_| params.tilt_deg.is_none());
        let is_known = ground.is_some();
        let ground = ground.unwrap_or_else(|| vec![Known::default(); stations]);
        Self {
            length,
            stations,
            rows,
            skin,
            order,
            reach,
            ln_width,
            params,
            albedo,
            places: places(),
            bell: Bell::new(),
            ground,
            skyline,
            is_known,
        }
    }

    fn blur(&self) -> f64 {
        (self.params.lens_blur_px.powi(2) + 1.0 / 12.0).sqrt()
    }

    pub(crate) fn problem(&self, flat: bool) -> Problem<'_> {
        let bases = KNOTS_PX.map(|spacing| Basis::new(self.length, spacing, self.stations));
        let mut problem =
            self.bare(&self.rows, if flat { &[] } else { &self.skin }, bases, &self.ground, flat);
        problem.priors = self.priors(&problem);
        problem
    }

    fn bare<'p>(
        &'p self,
        rows: &'p [Row],
        skin: &'p [Group],
        bases: [Basis; FIELDS],
        ground: &'p [Known],
        flat: bool,
    ) -> Problem<'p> {
        let mut free = [!flat; CONSTANTS];
        free[TILTED] &= self.params.tilt_deg.is_none();
        Problem {
            rows,
            bases,
            priors: Vec::new(),
            free,
            flat,
            blur: self.blur(),
            albedo: self.albedo,
            reach: self.reach,
            noise: NOISE[0] * CORRELATED.sqrt(),
            skin,
            skin_noise: SKIN_NOISE[0],
            aside: ASIDE_PX + ASIDE * PAINT_WIDTHS * self.ln_width.exp(),
            widest: self.ln_width + WIDEST.ln(),
            ground,
            places: &self.places,
            bell: &self.bell,
        }
    }

    fn priors(&self, problem: &Problem<'_>) -> Vec<Prior> {
        let mut priors = Vec::new();
        let values = [
            Some((self.ln_width, WIDTH_SPREAD)),
            Some((RATIO.ln(), RATIO_SPREAD)),
            Some((0.0, CREASE_SPREAD)),
            None,
            Some((0.0, RISE_SPREAD)),
            Some((0.0, if self.is_known { GROUND_SPREADS[1] } else { BEND_SPREAD })),
        ];
        for (field, value) in values.into_iter().enumerate() {
            let (first, count) = (problem.first(field), problem.bases[field].count);
            if let Some((mean, deviation)) = value {
                priors.extend((first..first + count).map(|at| Prior {
                    terms: vec![(at, 1.0)],
                    mean,
                    deviation: deviation * (count as f64).sqrt(),
                }));
            }
            let stencil: &[f64] = if field == CREASE { &[1.0, -2.0, 1.0] } else { &[-1.0, 1.0] };
            for at in first..(first + count + 1).saturating_sub(stencil.len()) {
                let terms = stencil.iter().enumerate().map(|(k, weight)| (at + k, *weight)).collect();
                priors.push(Prior { terms, mean: 0.0, deviation: CHANGES[field] });
            }
        }
        let first = problem.first(FIELDS);
        for (constant, [mean, deviation]) in CONSTANT_PRIORS.into_iter().enumerate() {
            if problem.free[constant] {
                let known = self.is_known && constant == TILTED;
                let deviation = if known { GROUND_SPREADS[0] } else { deviation };
                priors.push(Prior { terms: vec![(first + constant, 1.0)], mean, deviation });
            }
        }
        priors
    }

    /// Unknowns with the same groove everywhere, its crease along the ridge.
    pub(crate) fn start(&self, problem: &Problem<'_>, creases: &[f64], groove: &[f64; 3]) -> Vec<f64> {
        let mut unknowns = vec![0.0; problem.count()];
        let [ln_width, ln_ratio, epsilon] = *groove;
        for (field, value) in [(LN_WIDTH, ln_width), (LN_RATIO, ln_ratio), (LN_LIGHT, 0.0)] {
            let first = problem.first(field);
            unknowns[first..first + problem.bases[field].count].fill(value);
        }
        let first = problem.first(CREASE);
        let count = problem.bases[CREASE].count;
        for k in 0..count {
            // A coefficient's place is one knot before its index.
            let along = (k as f64 - 1.0) / (count as f64 - 3.0) * (creases.len() - 1) as f64;
            unknowns[first + k] = creases[(along.round().max(0.0) as usize).min(creases.len() - 1)];
        }
        let first = problem.first(FIELDS);
        unknowns[first + ROUND] = epsilon;
        if let Some(tilt) = self.params.tilt_deg {
            unknowns[first + TILTED] = tilt.to_radians().tan();
        }
        unknowns
    }

    /// Unknowns with a groove everywhere, its crease beside the ridge.
    pub(crate) fn moved_start(&self, problem: &Problem<'_>, creases: &[f64], first: &First) -> Vec<f64> {
        let creases: Vec<f64> = creases.iter().map(|crease| crease + first.crease).collect();
        let mut start = self.start(problem, &creases, &first.groove);
        if problem.free[TILTED] {
            start[problem.first(FIELDS) + TILTED] = first.tilt;
        }
        start
    }

    /// The best groove that is the same everywhere, from several starts; and the best one whose crease lies elsewhere.
    pub(crate) fn firsts(&self, creases: &[f64]) -> Vec<First> {
        let rows = self.collapsed(creases);
        let aside =
            |row: &Row| creases[row.station] + row.share * (creases[row.station + 1] - creases[row.station]);
        let skin = collapsed(&self.skin, aside);
        let bases = std::array::from_fn(|_| Basis::constant(2));
        let count = self.ground.len() as f64;
        let mean = |of: fn(&Known) -> f64| self.ground.iter().map(of).sum::<f64>() / count;
        let reliefs: Vec<Relief> = self.ground.iter().filter_map(|known| known.around.relief).collect();
        let walls = if self.is_known { Walls::of(&self.skyline) } else { None };
        let around = Around { walls, relief: Relief::mean(&reliefs) };
        let ground = Known { tilt: mean(|known| known.tilt), bend: mean(|known| known.bend), around };
        let ground = [ground.clone(), ground];
        let mut problem = self.bare(&rows, &skin, bases, &ground, false);
        problem.priors = self.priors(&problem);
        let crease = problem.first(CREASE);
        let descended = STARTS.map(|[width, epsilon, side]| {
            let ln_width = self.ln_width + f64::ln(width);
            let mut start = self.start(&problem, &[0.0; 2], &[ln_width, RATIO.ln(), epsilon]);
            start[crease] = 0.4 * side * ln_width.exp();
            if problem.free[TILTED] && !self.is_known {
                start[problem.first(FIELDS) + TILTED] = 0.5 * side;
            }
            descend(&problem, &start, 10, 1.0)
        });
        let mut sorted: Vec<Minimum> = descended.into_iter().collect();
        sorted.sort_by(|one, other| one.cost.total_cmp(&other.cost));
        let apart = |one: &Minimum, other: &Minimum| {
            (one.unknowns[crease] - other.unknowns[crease]).abs() > ELSEWHERE * one.unknowns[LN_WIDTH].exp()
        };
        let is_near = |other: &Minimum| other.cost - sorted[0].cost < BEHIND;
        let other = sorted.iter().position(|other| apart(&sorted[0], other) && is_near(other));
        let found = [Some(0), other].into_iter().flatten().map(|at| &sorted[at]);
        let first = |best: &Minimum| {
            let constants = problem.constants(&best.unknowns);
            let groove = [best.unknowns[0], best.unknowns[1], constants[ROUND]];
            First { groove, crease: best.unknowns[crease], tilt: constants[TILTED] }
        };
        found.map(first).collect()
    }

    /// The mean light by distance from the ridge, in steps of half a pixel.
    fn collapsed(&self, creases: &[f64]) -> Vec<Row> {
        let count = (4.0 * self.reach) as usize + 1;
        let mut sums = vec![[0.0f64; 3]; count];
        for row in &self.rows {
            let crease = creases[row.station] + row.share * (creases[row.station + 1] - creases[row.station]);
            let p = row.p - crease;
            let bin = ((p + self.reach) * 2.0).round();
            if bin >= 0.0 && (bin as usize) < count {
                let sum = &mut sums[bin as usize];
                *sum = [sum[0] + 1.0, sum[1] + p, sum[2] + row.light];
            }
        }
        let row = |[weight, p, light]: &[f64; 3]| {
            (*weight > 0.0).then(|| Row {
                station: 0,
                share: 0.0,
                p: p / weight,
                light: light / weight,
                weight: *weight,
            })
        };
        sums.iter().filter_map(row).collect()
    }

    /// The deviation of a cell of skin: robust, from the residuals.
    pub(crate) fn skin_noise(&self, problem: &Problem<'_>, best: &Minimum) -> f64 {
        let mut off: Vec<f64> = problem.left_of_skin(&best.unknowns).into_iter().map(f64::abs).collect();
        if off.len() < LEAST_CELLS {
            return SKIN_NOISE[0];
        }
        let middle = off.len() / 2;
        let median = *off.select_nth_unstable_by(middle, f64::total_cmp).1;
        (1.4826 * median).max(SKIN_NOISE[1]) * SKIN_CORRELATED.sqrt()
    }

    /// The deviation of a pixel: robust, from the residuals.
    pub(crate) fn noise(&self, problem: &Problem<'_>, best: &Minimum) -> f64 {
        let mut off: Vec<f64> = Vec::with_capacity(self.rows.len());
        problem.visit(&best.unknowns, |row, light, _| off.push((row.light - light).abs()));
        let middle = off.len() / 2;
        let median = *off.select_nth_unstable_by(middle, f64::total_cmp).1;
        (1.4826 * median).max(NOISE[1]) * CORRELATED.sqrt()
    }
}
