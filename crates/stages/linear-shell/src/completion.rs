//! Missing and soft handles without refactoring.

use crate::Error;
use nalgebra::{DMatrix, DVector, Vector3};

/// The handles' Schur complement `S`: the shell's energy as a function of the handles alone, `½ Dᵀ S D`, the rest of the
/// surface being at its minimum. Where a frame lacks a handle, the handle goes where that energy is least; where a
/// handle is soft, its spring pulls against it. Either costs one solve of at most n × n, and gives what refactoring
/// with other constraints would.
#[derive(Debug, Clone, PartialEq)]
pub struct Completion {
    schur: DMatrix<f64>,
}

impl Completion {
    /// From the rows of S, n × n.
    #[must_use]
    pub fn new(schur: &[Vec<f64>]) -> Self {
        Self { schur: DMatrix::from_fn(schur.len(), schur.len(), |row, column| schur[row][column]) }
    }

    /// The rows of S.
    #[must_use]
    pub fn rows(&self) -> Vec<Vec<f64>> {
        self.schur.row_iter().map(|row| row.iter().copied().collect()).collect()
    }

    /// The matrix S.
    pub(crate) fn schur(&self) -> &DMatrix<f64> {
        &self.schur
    }

    /// Displacements of all handles, mm. `given`: per handle its displacement, mm, or `None` where it is missing;
    /// `weights`: per handle `None` if it is met exactly, or the stiffness of its spring relative to `S_ii`.
    ///
    /// With u the missing and soft handles and k the exact ones: `(S_uu + W) D_u = W D̂_u − S_uk D_k`, W = 0 where
    /// missing.
    ///
    /// # Errors
    /// [`Error::NothingPrescribed`] if no handle has a value.
    ///
    /// # Panics
    /// If the lengths are not the number of handles.
    pub fn complete(
        &self,
        given: &[Option<Vector3<f64>>],
        weights: &[Option<f64>],
    ) -> Result<Vec<Vector3<f64>>, Error> {
        let count = self.schur.nrows();
        assert!(given.len() == count && weights.len() == count, "one entry per handle");
        if given.iter().all(Option::is_none) {
            return Err(Error::NothingPrescribed);
        }
        let exact = |i: &usize| given[*i].is_some() && weights[*i].is_none();
        let (known, unknown): (Vec<usize>, Vec<usize>) = (0..count).partition(exact);
        let mut all: Vec<Vector3<f64>> = given.iter().map(|value| value.unwrap_or_default()).collect();
        if unknown.is_empty() {
            return Ok(all);
        }
        let spring = |i: usize| match (given[i], weights[i]) {
            (Some(_), Some(weight)) => weight * self.schur[(i, i)],
            _ => 0.0,
        };
        let mut system = self.schur.select_rows(&unknown).select_columns(&unknown);
        unknown.iter().enumerate().for_each(|(row, &i)| system[(row, row)] += spring(i));
        let factor = system.cholesky().ok_or(Error::NothingPrescribed)?;
        for axis in 0..3 {
            let pull = |&i: &usize| {
                let from_known: f64 = known.iter().map(|&k| self.schur[(i, k)] * all[k][axis]).sum();
                spring(i) * all[i][axis] - from_known
            };
            let rhs = DVector::from_iterator(unknown.len(), unknown.iter().map(pull));
            let solved = factor.solve(&rhs);
            unknown.iter().zip(solved.iter()).for_each(|(&i, &value)| all[i][axis] = value);
        }
        Ok(all)
    }
}
