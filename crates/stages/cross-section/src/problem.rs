//! The extended model of a wrinkle's image: all painted pixels of one wrinkle against values at stations along it.

use crate::blur::{Bell, COLUMNS, Table};
use crate::shading::{BEND, EPSILON, Groove, KAPPA, Lit, NODES, RATIO, SKEW, TILT, WIDTH};
use crate::skin::Group;
use crate::spline::Basis;
use crate::walls::Around;
use nalgebra::{DMatrix, DVector};

/// What varies along a wrinkle: ln w, ln(d/w), place of the crease beside the curve, ln of the light on open paint, and how that
/// rises across, curvature of the surroundings.
pub(crate) const FIELDS: usize = 6;
pub(crate) const LN_WIDTH: usize = 0;
pub(crate) const LN_RATIO: usize = 1;
pub(crate) const CREASE: usize = 2;
pub(crate) const LN_LIGHT: usize = 3;
pub(crate) const RISE: usize = 4;
pub(crate) const BENT: usize = 5;
/// What is the same all along it: ε, κ, g, t.
pub(crate) const CONSTANTS: usize = 4;
pub(crate) const ROUND: usize = 0;
pub(crate) const LOPSIDED: usize = 1;
pub(crate) const SKEWED: usize = 2;
pub(crate) const TILTED: usize = 3;
/// Columns of the tables behind the constants.
const SHARED: [usize; CONSTANTS] = [EPSILON, KAPPA, SKEW, TILT];
/// The curvature is per so many px.
const BEND_PX: f64 = 10.0;
/// The light's rise is per so many px.
pub(crate) const RISE_PX: f64 = 20.0;
/// Unknowns that one pixel hangs on: the fields at two stations, and the constants.
pub(crate) const LOCAL: usize = 2 * FIELDS + CONSTANTS;
/// Residuals beyond so many deviations count linearly [Huber1964].
const HUBER: f64 = 3.0;
/// Where unknowns may lie.
const BOUNDS: [[f64; 2]; FIELDS + CONSTANTS] = [
    [-0.5, 4.5],
    [-5.5, 0.7],
    [-30.0, 30.0],
    [-3.0, 1.5],
    [-1.0, 1.0],
    [-0.4, 0.4],
    [0.0, 0.85],
    [-0.6, 0.6],
    [-0.5, 0.5],
    [-2.0, 2.0],
];

/// A pixel between two stations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Row {
    /// The station before it.
    pub(crate) station: usize,
    /// How far it is on the way to the next, 0–1.
    pub(crate) share: f64,
    /// Distance from the curve, px.
    pub(crate) p: f64,
    pub(crate) light: f64,
    /// How many pixels it stands for.
    pub(crate) weight: f64,
}

/// What is known of a station before: its unknowns t and c are what is left.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Known {
    /// t.
    pub(crate) tilt: f64,
    /// c, 1/px.
    pub(crate) bend: f64,
    /// How the face runs on.
    pub(crate) around: Around,
}

/// A normal distribution of a sum of unknowns.
#[derive(Debug, Clone)]
pub(crate) struct Prior {
    pub(crate) terms: Vec<(usize, f64)>,
    pub(crate) mean: f64,
    pub(crate) deviation: f64,
}

/// What the image says, and what is known before.
pub(crate) struct Problem<'a> {
    /// Pixels, by their stations.
    pub(crate) rows: &'a [Row],
    /// Skin beside them.
    pub(crate) skin: &'a [Group],
    pub(crate) bases: [Basis; FIELDS],
    pub(crate) priors: Vec<Prior>,
    /// Which of the constants are free.
    pub(crate) free: [bool; CONSTANTS],
    /// Whether there is a valley at all.
    pub(crate) flat: bool,
    /// Deviation of the image's blur, px.
    pub(crate) blur: f64,
    pub(crate) albedo: f64,
    /// Largest distance from the crease, px.
    pub(crate) reach: f64,
    /// Deviation of a pixel, after the correlation of neighbours.
    pub(crate) noise: f64,
    /// … and of a cell of skin.
    pub(crate) skin_noise: f64,
    /// How far the crease may lie off the curve, px.
    pub(crate) aside: f64,
    /// ln of the largest width.
    pub(crate) widest: f64,
    /// What is known per station.
    pub(crate) ground: &'a [Known],
    pub(crate) places: &'a [f64; NODES],
    pub(crate) bell: &'a Bell,
}

/// Cost at a point, with its Gauss–Newton matrix and (half) gradient.
pub(crate) struct Normal {
    pub(crate) matrix: DMatrix<f64>,
    pub(crate) gradient: DVector<f64>,
}

impl Problem<'_> {
    /// Number of unknowns.
    pub(crate) fn count(&self) -> usize {
        self.first(FIELDS) + CONSTANTS
    }

    /// The first unknown of a field; of [`FIELDS`]: the first constant.
    pub(crate) fn first(&self, field: usize) -> usize {
        self.bases[..field].iter().map(|basis| basis.count).sum()
    }

    pub(crate) fn stations(&self) -> usize {
        self.bases[0].stations.len()
    }

    pub(crate) fn field(&self, unknowns: &[f64], field: usize, station: usize) -> f64 {
        self.bases[field].at(station, &unknowns[self.first(field)..])
    }

    pub(crate) fn constants<'u>(&self, unknowns: &'u [f64]) -> &'u [f64] {
        &unknowns[self.first(FIELDS)..]
    }

    /// Brings unknowns into their bounds.
    pub(crate) fn clamp(&self, unknowns: &mut [f64]) {
        for field in 0..FIELDS {
            let first = self.first(field);
            let [mut low, mut high] = BOUNDS[field];
            match field {
                LN_WIDTH => high = high.min(self.widest),
                CREASE => (low, high) = (-self.aside, self.aside),
                _ => {}
            }
            unknowns[first..first + self.bases[field].count].iter_mut().for_each(|x| *x = x.clamp(low, high));
        }
        let first = self.first(FIELDS);
        for constant in 0..CONSTANTS {
            let [low, high] = BOUNDS[FIELDS + constant];
            unknowns[first + constant] = unknowns[first + constant].clamp(low, high);
        }
    }

    pub(crate) fn tables(&self, unknowns: &[f64]) -> Vec<Table> {
        let constants = self.constants(unknowns);
        let mut tables: Vec<Table> = Vec::with_capacity(self.stations());
        let mut last: Option<Groove> = None;
        for station in 0..self.stations() {
            let groove = Groove {
                w: self.field(unknowns, LN_WIDTH, station).exp(),
                ratio: if self.flat { 0.0 } else { self.field(unknowns, LN_RATIO, station).exp() },
                epsilon: constants[ROUND],
                kappa: constants[LOPSIDED],
                bend: self.ground[station].bend + self.field(unknowns, BENT, station) / BEND_PX,
                skew: constants[SKEWED],
                tilt: self.ground[station].tilt + constants[TILTED],
                albedo: self.albedo,
                aside: if self.ground[station].around.relief.is_some() {
                    self.field(unknowns, CREASE, station)
                } else {
                    0.0
                },
            };
            let around = &self.ground[station].around;
            let is_same = last == Some(groove) && *around == self.ground[station - 1].around;
            let table = match (tables.last(), is_same) {
                (Some(table), true) => table.clone(),
                _ => {
                    let lit = Lit::of(&groove, around, self.places);
                    Table::of(&lit, self.blur, self.reach, self.bell)
                }
            };
            tables.push(table);
            last = Some(groove);
        }
        tables
    }

    /// The model's light and, per unknown of [`LOCAL`], its derivative.
    pub(crate) fn model(&self, row: &Row, ends: &Ends<'_>) -> (f64, [f64; LOCAL]) {
        let shares = [1.0 - row.share, row.share];
        let mix = |field: usize| shares[0] * ends.fields[0][field] + shares[1] * ends.fields[1][field];
        let (place, level) = (row.p - mix(CREASE), mix(LN_LIGHT).exp());
        let across = row.p / RISE_PX;
        let gain = level * (1.0 + mix(RISE) * across);
        let tap = ends.tables[0].tap(place);
        let sampled = ends.tables.map(|table| table.at(&tap));
        let both = |column: usize| shares[0] * sampled[0].0[column] + shares[1] * sampled[1].0[column];
        let (light, slope) = (both(0), shares[0] * sampled[0].1 + shares[1] * sampled[1].1);
        let mut by = [0.0; LOCAL];
        for end in 0..2 {
            let columns: &[f64; COLUMNS] = &sampled[end].0;
            let at = FIELDS * end;
            by[at + LN_WIDTH] = gain * shares[end] * columns[1 + WIDTH];
            by[at + LN_RATIO] = gain * shares[end] * columns[1 + RATIO];
            by[at + CREASE] = -gain * shares[end] * slope;
            by[at + LN_LIGHT] = gain * shares[end] * light;
            by[at + BENT] = gain * shares[end] * columns[1 + BEND] / BEND_PX;
            by[at + RISE] = level * shares[end] * light * across;
        }
        for (constant, column) in SHARED.into_iter().enumerate() {
            by[2 * FIELDS + constant] = gain * both(1 + column);
        }
        (gain * light, by)
    }

    pub(crate) fn ends<'t>(&self, unknowns: &[f64], tables: &'t [Table], station: usize) -> Ends<'t> {
        let next = (station + 1).min(self.stations() - 1);
        let fields = [station, next].map(|at| std::array::from_fn(|field| self.field(unknowns, field, at)));
        Ends { fields, tables: [&tables[station], &tables[next]] }
    }

    /// What the pixels say, by their stations.
    pub(crate) fn costs(&self, unknowns: &[f64]) -> Vec<f64> {
        let mut costs = vec![0.0; self.stations()];
        self.visit(unknowns, |row, light, _| {
            costs[row.station] += row.weight * huber((row.light - light) / self.noise).0;
        });
        costs
    }

    fn prior_cost(&self, unknowns: &[f64]) -> f64 {
        self.priors.iter().map(|prior| prior.residual(unknowns).powi(2)).sum()
    }

    /// All pixels with the model's light and its derivatives.
    pub(crate) fn visit(&self, unknowns: &[f64], visit: impl FnMut(&Row, f64, &[f64; LOCAL])) {
        self.visit_over(&self.tables(unknowns), unknowns, visit);
    }

    fn visit_over(
        &self,
        tables: &[Table],
        unknowns: &[f64],
        mut visit: impl FnMut(&Row, f64, &[f64; LOCAL]),
    ) {
        for chunk in self.rows.chunk_by(|one, other| one.station == other.station) {
            let ends = self.ends(unknowns, tables, chunk[0].station);
            for row in chunk {
                let (light, by) = self.model(row, &ends);
                visit(row, light, &by);
            }
        }
    }

    /// The cost, and the normal equations of its quadratic model.
    pub(crate) fn normal(&self, unknowns: &[f64]) -> (f64, Normal) {
        let count = self.count();
        let mut normal = Normal { matrix: DMatrix::zeros(count, count), gradient: DVector::zeros(count) };
        let mut cost = self.prior_cost(unknowns);
        let mut block = Block::new(0);
        let tables = self.tables(unknowns);
        self.visit_over(&tables, unknowns, |row, light, by| {
            if row.station != block.station {
                self.spread(&block, &mut normal);
                block = Block::new(row.station);
            }
            let residual = (row.light - light) / self.noise;
            let (value, weight) = huber(residual);
            cost += row.weight * value;
            block.add(by, residual / self.noise, row.weight * weight, self.noise);
        });
        self.spread(&block, &mut normal);
        for group in self.skin {
            let mut block = Block::new(group[0].station);
            cost += self.beside(group, &self.ends(unknowns, &tables, block.station), Some(&mut block));
            self.spread(&block, &mut normal);
        }
        for prior in &self.priors {
            prior.add(unknowns, &mut normal);
        }
        self.hold(&mut normal);
        (cost, normal)
    }

    /// From the fields at two stations to their coefficients.
    fn spread(&self, block: &Block, normal: &mut Normal) {
        let next = (block.station + 1).min(self.stations() - 1);
        let mut parts: Vec<(usize, usize, f64)> = Vec::with_capacity(8 * FIELDS + CONSTANTS);
        for (end, station) in [block.station, next].into_iter().enumerate() {
            for field in 0..FIELDS {
                let (first, weights) = self.bases[field].stations[station];
                let used = weights.into_iter().enumerate().filter(|(_, weight)| *weight != 0.0);
                let base = self.first(field) + first;
                parts.extend(used.map(|(k, weight)| (FIELDS * end + field, base + k, weight)));
            }
        }
        let first = self.first(FIELDS);
        parts.extend((0..CONSTANTS).map(|constant| (2 * FIELDS + constant, first + constant, 1.0)));
        for &(local, to, weight) in &parts {
            normal.gradient[to] += weight * block.gradient[local];
            for &(other, column, share) in &parts {
                let (low, high) = (local.min(other), local.max(other));
                normal.matrix[(to, column)] += weight * share * block.matrix[low][high];
            }
        }
    }

    /// Takes constants that are not free out of the equations.
    fn hold(&self, normal: &mut Normal) {
        let first = self.first(FIELDS);
        let count = self.count();
        let mut held: Vec<usize> = (0..CONSTANTS).filter(|&k| !self.free[k]).map(|k| first + k).collect();
        if self.flat {
            held.extend(0..self.first(LN_LIGHT));
        }
        for at in held {
            for k in 0..count {
                (normal.matrix[(at, k)], normal.matrix[(k, at)]) = (0.0, 0.0);
            }
            (normal.matrix[(at, at)], normal.gradient[at]) = (1.0, 0.0);
        }
    }
}

/// The fields and tables at the two ends of an interval.
pub(crate) struct Ends<'t> {
    fields: [[f64; FIELDS]; 2],
    tables: [&'t Table; 2],
}

/// The normal equations of the pixels between two stations; the upper triangle.
pub(crate) struct Block {
    station: usize,
    matrix: [[f64; LOCAL]; LOCAL],
    gradient: [f64; LOCAL],
}

impl Block {
    fn new(station: usize) -> Self {
        Self { station, matrix: [[0.0; LOCAL]; LOCAL], gradient: [0.0; LOCAL] }
    }

    pub(crate) fn add(&mut self, by: &[f64; LOCAL], residual: f64, weight: f64, noise: f64) {
        let scale = weight / (noise * noise);
        for i in 0..LOCAL {
            self.gradient[i] += weight * residual * by[i];
            let scaled = scale * by[i];
            for j in i..LOCAL {
                self.matrix[i][j] += scaled * by[j];
            }
        }
    }
}

impl Prior {
    fn residual(&self, unknowns: &[f64]) -> f64 {
        let sum: f64 = self.terms.iter().map(|&(at, weight)| weight * unknowns[at]).sum();
        (self.mean - sum) / self.deviation
    }

    fn add(&self, unknowns: &[f64], normal: &mut Normal) {
        let residual = self.residual(unknowns);
        for &(row, weight) in &self.terms {
            normal.gradient[row] += weight * residual / self.deviation;
            for &(column, share) in &self.terms {
                normal.matrix[(row, column)] += weight * share / (self.deviation * self.deviation);
            }
        }
    }
}

/// The cost of a residual in deviations, and the weight of its square.
pub(crate) fn huber(residual: f64) -> (f64, f64) {
    let off = residual.abs();
    match off <= HUBER {
        true => (residual * residual, 1.0),
        false => (HUBER * (2.0 * off - HUBER), HUBER / off),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shading::places;

    #[test]
    fn the_gradient_is_that_of_differences() {
        let rows: Vec<Row> = (0..400)
            .map(|i| {
                let (along, p) = (4.0 * f64::from(i) / 400.0, f64::from(i * 37 % 81) / 4.0 - 10.0);
                let light = 1.0 - 0.4 * (-p.abs() / 4.0).exp();
                Row { station: along as usize, share: along.fract(), p, light, weight: 1.0 }
            })
            .collect();
        let (nodes, bell) = (places(), Bell::new());
        let ground = vec![Known { tilt: 0.1, bend: -0.004, around: Around::default() }; 5];
        let beside = |from: f64, station: usize| -> Group {
            let row = |k: u32| {
                let p = from + 2.0 * f64::from(k) * from.signum();
                let light = 0.6 * (1.0 - 0.3 * (-p.abs() / 5.0).exp());
                Row { station, share: 0.5, p, light, weight: 2.0 }
            };
            (0..5).map(row).collect()
        };
        let skin = [beside(-9.0, 1), beside(9.0, 1), beside(10.0, 3)];
        let mut problem = Problem {
            rows: &rows,
            bases: std::array::from_fn(|field| Basis::new(32.0, 12.0 + 6.0 * field as f64, 5)),
            priors: vec![Prior { terms: vec![(0, 1.0), (1, -1.0)], mean: 0.1, deviation: 0.2 }],
            free: [true; CONSTANTS],
            flat: false,
            blur: 0.75,
            albedo: 0.2,
            reach: 14.0,
            noise: 0.5,
            skin: &skin,
            skin_noise: 0.1,
            aside: 9.0,
            widest: 4.0,
            ground: &ground,
            places: &nodes,
            bell: &bell,
        };
        let mut unknowns: Vec<f64> =
            (0..problem.count()).map(|k| 0.02 * ((k * 7 % 5) as f64 - 2.0)).collect();
        for (field, value) in [(LN_WIDTH, 1.6), (LN_RATIO, -0.9)] {
            let first = problem.first(field);
            unknowns[first..first + problem.bases[field].count].iter_mut().for_each(|x| *x += value);
        }
        let first = problem.first(FIELDS);
        unknowns[first..].copy_from_slice(&[0.3, 0.1, -0.1, 0.25]);
        let gradient = problem.normal(&unknowns).1.gradient;
        for k in 0..unknowns.len() {
            let cost = |by: f64| {
                let mut moved = unknowns.clone();
                moved[k] += by;
                problem.normal(&moved).0
            };
            let difference = (cost(1e-5) - cost(-1e-5)) / 2e-5;
            let found = -2.0 * gradient[k];
            assert!(
                (found - difference).abs() < 1e-2 * (1.0 + difference.abs()),
                "{k}: {found} {difference}"
            );
        }
        problem.free[ROUND] = false;
        assert_eq!(problem.normal(&unknowns).1.gradient[first + ROUND], 0.0);
    }
}
