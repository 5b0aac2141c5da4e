//! How much two cameras' changes have in common: canonical correlation.

use crate::course::{COMPONENTS, Point};
use nalgebra::{DMatrix, DVector};

/// Correlations are kept below this: two cameras are never one.
const MOST: f64 = 0.9999;
/// Resistance of the covariances, as a share of their trace: components without variance must not count.
const RIDGE: f64 = 1e-9;

/// Sums over pairs of changes.
pub(crate) struct Pairs {
    count: usize,
    xx: DMatrix<f64>,
    yy: DMatrix<f64>,
    xy: DMatrix<f64>,
    x: DVector<f64>,
    y: DVector<f64>,
}

/// How much two series have in common.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Likeness {
    /// Log-likelihood ratio of "related" over "unrelated", −n/2 Σ log(1 − ρ²), nats.
    pub(crate) nats: f64,
    /// The largest canonical correlation.
    pub(crate) correlation: f64,
    pub(crate) count: usize,
}

impl Pairs {
    pub(crate) fn new() -> Self {
        let (square, column) = (DMatrix::zeros(COMPONENTS, COMPONENTS), DVector::zeros(COMPONENTS));
        Self { count: 0, xx: square.clone(), yy: square.clone(), xy: square, x: column.clone(), y: column }
    }

    pub(crate) fn add(&mut self, x: &Point, y: &Point) {
        self.count += 1;
        for a in 0..COMPONENTS {
            self.x[a] += x[a];
            self.y[a] += y[a];
            for b in 0..COMPONENTS {
                self.xx[(a, b)] += x[a] * x[b];
                self.yy[(a, b)] += y[a] * y[b];
                self.xy[(a, b)] += x[a] * y[b];
            }
        }
    }

    /// Canonical correlations [Hotelling1936]: the singular values of Lx⁻¹ Σxy Ly⁻ᵀ, with Σxx = Lx Lxᵀ. Only the first so
    /// many components take part that there are ten pairs for each.
    pub(crate) fn likeness(&self) -> Likeness {
        let Some(Whitened { both, .. }) = self.whitened() else { return Likeness::default() };
        let squares = (&both * both.transpose()).symmetric_eigenvalues();
        let squares: Vec<f64> = squares.iter().map(|square| square.clamp(0.0, MOST * MOST)).collect();
        let nats = -0.5 * self.count as f64 * squares.iter().map(|square| (1.0 - square).ln()).sum::<f64>();
        let correlation = squares.iter().copied().fold(0.0, f64::max).sqrt();
        Likeness { nats, correlation, count: self.count }
    }

    /// The canonical variates: which combinations of changes the two have in common.
    pub(crate) fn variates(&self) -> Vec<Variate> {
        let Some(Whitened { both, lx, ly }) = self.whitened() else { return Vec::new() };
        let n = self.count as f64;
        let svd = both.svd(true, true);
        let (Some(u), Some(v)) = (svd.u, svd.v_t) else { return Vec::new() };
        let variate = |k: usize| {
            let axis = |l: &DMatrix<f64>, unit: DVector<f64>| {
                Some(l.transpose().solve_upper_triangular(&unit)? * n.sqrt())
            };
            // `both` has the reference's components as rows.
            let (x, y) = (axis(&lx, v.row(k).transpose())?, axis(&ly, u.column(k).into_owned())?);
            let mean = |axis: &DVector<f64>, sum: &DVector<f64>| axis.dot(&sum.rows(0, axis.len())) / n;
            let means = [mean(&x, &self.x), mean(&y, &self.y)];
            let axes = [x, y].map(|axis| axis.iter().copied().collect());
            Some(Variate { axes, means, correlation: svd.singular_values[k].clamp(0.0, MOST) })
        };
        (0..svd.singular_values.len()).filter_map(variate).collect()
    }

    fn whitened(&self) -> Option<Whitened> {
        let used = (self.count / 10).min(COMPONENTS);
        let n = self.count as f64;
        let part = |m: &DMatrix<f64>, a: &DVector<f64>, b: &DVector<f64>| {
            let m = m - a * b.transpose() / n;
            m.view((0, 0), (used, used)).into_owned()
        };
        let factor = |mut m: DMatrix<f64>| {
            let ridge = RIDGE * m.trace() / used as f64 + f64::MIN_POSITIVE;
            (0..used).for_each(|i| m[(i, i)] += ridge);
            Some(m.cholesky()?.l())
        };
        if used == 0 {
            return None;
        }
        let lx = factor(part(&self.xx, &self.x, &self.x))?;
        let ly = factor(part(&self.yy, &self.y, &self.y))?;
        let left = lx.solve_lower_triangular(&part(&self.xy, &self.x, &self.y))?;
        let both = ly.solve_lower_triangular(&left.transpose())?;
        Some(Whitened { both, lx, ly })
    }
}

/// Ly⁻¹ Σyx Lx⁻ᵀ, and what whitens either side.
struct Whitened {
    both: DMatrix<f64>,
    lx: DMatrix<f64>,
    ly: DMatrix<f64>,
}

/// A combination of changes that two cameras have in common, of variance 1 in both.
#[derive(Debug, Clone)]
pub(crate) struct Variate {
    axes: [Vec<f64>; 2],
    means: [f64; 2],
    correlation: f64,
}

impl Variate {
    /// Log-likelihood ratio of "related" over "unrelated" of one pair of changes, nats.
    pub(crate) fn nats(&self, x: &[f64], y: &[f64]) -> f64 {
        let value = |side: usize, change: &[f64]| {
            self.axes[side].iter().zip(change).map(|(a, b)| a * b).sum::<f64>() - self.means[side]
        };
        let (u, v, r) = (value(0, x), value(1, y), self.correlation);
        let rest = 1.0 - r * r;
        -0.5 * rest.ln() - r * (r * (u * u + v * v) - 2.0 * u * v) / (2.0 * rest)
    }
}
