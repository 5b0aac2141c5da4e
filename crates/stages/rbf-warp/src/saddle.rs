//! The saddle-point system of interpolation by kernels plus polynomials [Carr2001, Eq. 7].
//!
//! `[Φ B; Bᵀ 0] [w; b] = [y; 0]`, Φᵢⱼ = ‖uᵢ − uⱼ‖³, B = polynomials at the centers. r³ is conditionally positive
//! definite of order 2, so Φ is positive definite on the null space of Bᵀ as soon as B holds the linear terms: solved by
//! a Cholesky factor there, with two steps of refinement.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector3};

/// Steps of iterative refinement: the second one no longer changes anything in tests.
const REFINEMENTS: usize = 2;

/// Share of the largest sensitivity below which a center's own equation is all that fixes a term.
const ALONE: f64 = 1e-10;

/// A factored system; #centers = n, #terms = r.
pub(crate) struct Saddle {
    kernel: DMatrix<f64>,
    terms: DMatrix<f64>,
    /// n × r, orthonormal, spans the terms.
    range: DMatrix<f64>,
    /// n × (n − r), orthonormal, what is orthogonal to them.
    null: DMatrix<f64>,
    upper: DMatrix<f64>,
    /// Of nullᵀ Φ null; absent where n = r.
    factor: Option<Cholesky<f64, Dyn>>,
}

impl Saddle {
    /// Factors the system; `None` if Φ is not positive definite on the null space.
    pub(crate) fn factor(kernel: DMatrix<f64>, terms: DMatrix<f64>) -> Option<Self> {
        let (n, r) = terms.shape();
        let qr = terms.clone().qr();
        let mut q_transposed = DMatrix::identity(n, n);
        qr.q_tr_mul(&mut q_transposed);
        let range = q_transposed.rows(0, r).transpose();
        let null = q_transposed.rows(r, n - r).transpose();
        let factor = match n == r {
            true => None,
            false => Some(Cholesky::new(null.tr_mul(&(&kernel * &null)))?),
        };
        Some(Self { kernel, terms, range, null, upper: qr.r(), factor })
    }

    /// Weights (n × 3) and polynomial coefficients (r × 3) for values y (n × 3); `None` if the terms are dependent.
    pub(crate) fn solve(&self, y: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let (mut w, mut b) = self.solve_once(y)?;
        for _ in 0..REFINEMENTS {
            let residual = y - &self.kernel * &w - &self.terms * &b;
            let (dw, db) = self.solve_once(&residual)?;
            w += dw;
            b += db;
        }
        Some((w, b))
    }

    fn solve_once(&self, y: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let w = match &self.factor {
            Some(factor) => &self.null * factor.solve(&self.null.tr_mul(y)),
            None => DMatrix::zeros(y.nrows(), y.ncols()),
        };
        let b = self.upper.solve_upper_triangular(&self.range.tr_mul(&(y - &self.kernel * &w)))?;
        Some((w, b))
    }

    /// Per center how far an interpolant without it lands from its value [Rippa1999, Eq. 13]: wᵢ / (A⁻¹)ᵢᵢ, A = the
    /// saddle matrix. The terms stay the same. `None` where the others do not determine them.
    pub(crate) fn leave_one_out(&self, weights: &DMatrix<f64>) -> Vec<Option<f64>> {
        let n = weights.nrows();
        let Some(factor) = &self.factor else { return vec![None; n] };
        let inverse = factor.solve(&self.null.transpose());
        let diagonal = DVector::from_fn(n, |i, _| self.null.row(i).transpose().dot(&inverse.column(i)));
        let largest = diagonal.max();
        let error = |i: usize| (diagonal[i] > ALONE * largest).then(|| weights.row(i).norm() / diagonal[i]);
        (0..n).map(error).collect()
    }

    /// Condition number of the saddle matrix, in the 2-norm.
    pub(crate) fn condition(&self) -> f64 {
        let (n, r) = self.terms.shape();
        let mut matrix = DMatrix::zeros(n + r, n + r);
        matrix.view_mut((0, 0), (n, n)).copy_from(&self.kernel);
        matrix.view_mut((0, n), (n, r)).copy_from(&self.terms);
        matrix.view_mut((n, 0), (r, n)).copy_from(&self.terms.transpose());
        let eigenvalues = matrix.symmetric_eigenvalues().abs();
        eigenvalues.max() / eigenvalues.min()
    }
}

/// Φᵢⱼ = ‖uᵢ − uⱼ‖³
pub(crate) fn triharmonic(u: &[Vector3<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(u.len(), u.len(), |i, j| (u[i] - u[j]).norm().powi(3))
}
