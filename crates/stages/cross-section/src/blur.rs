//! A groove's brightness as an image shows it: blurred by the lens and by the area of pixels, sampled at even distances.

use crate::shading::{Lit, PARAMETERS};

/// Samples per pixel of a table.
const DENSITY: f64 = 2.0;
/// Standard deviations beyond which a Gaussian is nothing.
const TAIL: f64 = 4.2;
/// Columns of a table: brightness, and its derivatives by a groove's parameters.
pub(crate) const COLUMNS: usize = 1 + PARAMETERS;

/// Brightness by the distance from the crease, with derivatives.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    from: f64,
    rows: Vec<[f64; COLUMNS]>,
}

impl Table {
    /// Of places from `−reach` to `reach`, px, blurred by a Gaussian of deviation `sigma`, px.
    pub(crate) fn of(lit: &Lit, sigma: f64, reach: f64, bell: &Bell) -> Self {
        let count = (2.0 * reach * DENSITY).ceil() as usize + 5;
        let from = -(count as f64 - 1.0) / (2.0 * DENSITY);
        let spans = Spans::of(lit);
        let mut first = 0;
        let rows =
            (0..count).map(|row| spans.sample(lit, from + row as f64 / DENSITY, sigma, &mut first, bell));
        Self { from, rows: rows.collect() }
    }

    /// How samples are weighted at a place: the same in all tables of one reach.
    pub(crate) fn tap(&self, place: f64) -> Tap {
        let last = self.rows.len() as f64 - 3.0;
        let along = ((place - self.from) * DENSITY).clamp(1.0, last - 1e-9);
        let row = along as usize;
        let v = along - row as f64;
        let weights = [
            0.5 * v * (v * (2.0 - v) - 1.0),
            0.5 * (v * v * (3.0 * v - 5.0) + 2.0),
            0.5 * v * (v * (4.0 - 3.0 * v) + 1.0),
            0.5 * v * v * (v - 1.0),
        ];
        let lean = [
            0.5 * (v * (4.0 - 3.0 * v) - 1.0),
            0.5 * v * (9.0 * v - 10.0),
            0.5 * (v * (8.0 - 9.0 * v) + 1.0),
            0.5 * v * (3.0 * v - 2.0),
        ];
        Tap { row: row - 1, weights, lean }
    }

    /// All columns at a tap, and the derivative of the brightness by the place.
    pub(crate) fn at(&self, tap: &Tap) -> ([f64; COLUMNS], f64) {
        let mut all = [0.0; COLUMNS];
        let mut slope = 0.0;
        for (k, values) in self.rows[tap.row..tap.row + 4].iter().enumerate() {
            all.iter_mut().zip(values).for_each(|(sum, value)| *sum += tap.weights[k] * value);
            slope += tap.lean[k] * values[0];
        }
        (all, DENSITY * slope)
    }
}

/// Four samples around a place with their weights, and those of the derivative. Cubic between samples (Catmull–Rom), constant beyond
/// the ends; linear in the samples, so that interpolated derivatives are those of the interpolated brightness.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tap {
    row: usize,
    weights: [f64; 4],
    lean: [f64; 4],
}

/// Between two nodes brightness is linear; what a fixed place sees change is the change of the nodes' brightness less what their motion
/// carries past it. Values at both ends of each span.
struct Spans {
    ends: Vec<[[f64; COLUMNS]; 2]>,
    /// What lies left and right of all nodes.
    beyond: [[f64; COLUMNS]; 2],
}

impl Spans {
    fn of(lit: &Lit) -> Self {
        let span = |i: usize| {
            let width = lit.at[i + 1] - lit.at[i];
            let slope = (lit.light[i + 1] - lit.light[i]) / width.max(1e-9);
            [i, i + 1].map(|node| {
                let mut columns = [0.0; COLUMNS];
                columns[0] = lit.light[node];
                for k in 0..PARAMETERS {
                    columns[1 + k] = lit.light_by[node][k] - slope * lit.at_by[node][k];
                }
                columns
            })
        };
        let still = |node: usize| {
            let mut columns = [0.0; COLUMNS];
            columns[0] = lit.light[node];
            columns[1..].copy_from_slice(&lit.light_by[node]);
            columns
        };
        Self { ends: (0..lit.count - 1).map(span).collect(), beyond: [still(0), still(lit.count - 1)] }
    }

    /// The brightness around a place under a Gaussian. `first`: a node that lies before its reach, for rising places.
    fn sample(&self, lit: &Lit, place: f64, sigma: f64, first: &mut usize, bell: &Bell) -> [f64; COLUMNS] {
        let last = lit.count - 1;
        let (low, high) = (place - TAIL * sigma, place + TAIL * sigma);
        while *first + 1 < lit.count && lit.at[*first + 1] < low {
            *first += 1;
        }
        let mut sum = [0.0; COLUMNS];
        let mut at = *first;
        let within = 1.0 / sigma;
        let (mut area, mut height) = bell.at((lit.at[at] - place) * within);
        // Beyond the outermost nodes nothing changes.
        add(&mut sum, &self.beyond[0], area);
        while at < last && lit.at[at] < high {
            let (next_area, next_height) = bell.at((lit.at[at + 1] - place) * within);
            let width = lit.at[at + 1] - lit.at[at];
            let weight = next_area - area;
            let far = match width > 1e-9 {
                true => ((place - lit.at[at]) * weight - sigma * (next_height - height)) / width,
                false => 0.5 * weight,
            };
            add(&mut sum, &self.ends[at][0], weight - far);
            add(&mut sum, &self.ends[at][1], far);
            (area, height) = (next_area, next_height);
            at += 1;
        }
        add(&mut sum, &self.beyond[1], if at == last { 1.0 - area } else { 0.0 });
        sum
    }
}

fn add(sum: &mut [f64; COLUMNS], values: &[f64; COLUMNS], weight: f64) {
    sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
}

/// Entries per deviation of the table of the normal distribution.
const ENTRIES: f64 = 64.0;
/// Deviations beyond which the normal distribution is 0 or 1.
const FAR: f64 = 6.0;

/// The normal distribution, tabulated: a fit asks for it a million times.
#[derive(Debug, Clone)]
pub(crate) struct Bell(Vec<(f64, f64)>);

impl Bell {
    pub(crate) fn new() -> Self {
        Self((0..=(2.0 * FAR * ENTRIES) as usize).map(|entry| gauss(entry as f64 / ENTRIES - FAR)).collect())
    }

    /// The distribution up to x, and its density there: three terms of Taylor's series from the nearest entry, within 1e-9 of it.
    fn at(&self, x: f64) -> (f64, f64) {
        if x.abs() >= FAR {
            return (f64::from(u8::from(x > 0.0)), 0.0);
        }
        let entry = ((x + FAR) * ENTRIES + 0.5) as usize;
        let (area, height) = self.0[entry];
        let middle = entry as f64 / ENTRIES - FAR;
        let off = x - middle;
        let bend = middle * middle - 1.0;
        let (half, third) = (0.5 * off, off / 3.0);
        (
            area + height * off * (1.0 - half * (middle - third * bend)),
            height * (1.0 - off * (middle - half * (bend - third * middle * (bend - 2.0)))),
        )
    }
}

/// The normal distribution up to x, and its density there.
fn gauss(x: f64) -> (f64, f64) {
    let bell = (-0.5 * x * x).exp() / (2.0 * std::f64::consts::PI).sqrt();
    // The rational approximation of Abramowitz and Stegun, 26.2.17: off by 7.5e-8 at most.
    let t = 1.0 / (1.0 + 0.231_641_9 * x.abs());
    let tail = bell
        * t
        * (0.319_381_530
            + t * (-0.356_563_782 + t * (1.781_477_937 + t * (-1.821_255_978 + t * 1.330_274_429))));
    (if x > 0.0 { 1.0 - tail } else { tail }, bell)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shading::{Groove, places};
    use crate::walls::Around;

    #[test]
    fn a_table_holds_the_blurred_light() {
        let groove = Groove {
            w: 5.0,
            ratio: 0.5,
            epsilon: 0.0,
            kappa: 0.1,
            bend: 0.0,
            skew: 0.0,
            tilt: 0.2,
            albedo: 0.0,
            aside: 0.0,
        };
        let lit = Lit::of(&groove, &Around::default(), &places());
        let table = Table::of(&lit, 0.8, 15.0, &Bell::new());
        let sharp = |q: f64| {
            let after = lit.at[..lit.count].partition_point(|at| *at < q).clamp(1, lit.count - 1);
            let share = ((q - lit.at[after - 1]) / (lit.at[after] - lit.at[after - 1])).clamp(0.0, 1.0);
            lit.light[after - 1] + share * (lit.light[after] - lit.light[after - 1])
        };
        for place in [-14.0, -3.3, -0.2, 0.0, 0.7, 6.1] {
            let weights: Vec<(f64, f64)> = (-800..=800)
                .map(|k| 0.005 * f64::from(k))
                .map(|off| (off, (-0.5 * (off / 0.8_f64).powi(2)).exp()))
                .collect();
            let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
            let wanted: f64 = weights.iter().map(|(off, weight)| weight / sum * sharp(place + off)).sum();
            let (columns, _) = table.at(&table.tap(place));
            assert!((columns[0] - wanted).abs() < 1e-3, "{place}: {} {wanted}", columns[0]);
        }
    }

    #[test]
    fn the_normal_distribution_is_right() {
        let bell = Bell::new();
        for (x, area) in [(0.0, 0.5), (1.0, 0.841_344_746), (-2.0, 0.022_750_132), (7.0, 1.0)] {
            assert!((bell.at(x).0 - area).abs() < 1e-7);
        }
        for x in (0..1190).map(|i| 0.01 * f64::from(i) - 5.95) {
            let ((area, height), (known, density)) = (bell.at(x), gauss(x));
            assert!((area - known).abs() < 2e-7 && (height - density).abs() < 2e-9, "{x}");
        }
    }
}
