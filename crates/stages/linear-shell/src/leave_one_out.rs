//! How well each handle is predicted by the others: a mis-picked or slipping marker shows here.

use crate::Completion;
use nalgebra::{DMatrix, DVector, Vector3};

/// Leave-one-out errors, gathered over frames; in each frame, of the handles that have a value.
#[derive(Debug, Clone, PartialEq)]
pub struct LeaveOneOut {
    handles: Vec<Sums>,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Sums {
    square: f64,
    worst: f64,
    frames: usize,
}

/// A handle's error over the frames that it was seen in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandleError {
    /// Root mean square, mm.
    pub rms_mm: f64,
    /// Largest, mm.
    pub worst_mm: f64,
}

impl LeaveOneOut {
    /// For `count` handles.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self { handles: vec![Sums::default(); count] }
    }

    /// Adds a frame: per handle where it was told to go, mm, or `None`.
    ///
    /// With `S` reduced to the handles k that were seen, `S' = S_kk − S_ku S_uu⁻¹ S_uk`, the energy without handle i puts
    /// it at `D_i − (S' D)_i / S'_ii`: the distance is `‖(S' D)_i‖ / S'_ii`, and no handle needs a solve of its own.
    pub fn add(&mut self, completion: &Completion, told: &[Option<Vector3<f64>>]) {
        let (seen, missing): (Vec<usize>, Vec<usize>) = (0..told.len()).partition(|&i| told[i].is_some());
        // One handle alone has nothing to be predicted from.
        if seen.len() < 2 {
            return;
        }
        let Some(schur) = reduced(completion.schur(), &seen, &missing) else { return };
        let axis = |axis: usize| {
            let values = seen.iter().map(|&i| told[i].unwrap_or_default()[axis]);
            &schur * DVector::from_iterator(seen.len(), values)
        };
        let pull = [axis(0), axis(1), axis(2)];
        for (row, &i) in seen.iter().enumerate() {
            let error = Vector3::new(pull[0][row], pull[1][row], pull[2][row]).norm() / schur[(row, row)];
            let sums = &mut self.handles[i];
            sums.square += error * error;
            sums.worst = sums.worst.max(error);
            sums.frames += 1;
        }
    }

    /// Per handle its error; `None` where it was never seen beside another.
    #[must_use]
    pub fn errors(&self) -> Vec<Option<HandleError>> {
        let error = |sums: &Sums| HandleError {
            rms_mm: (sums.square / sums.frames as f64).sqrt(),
            worst_mm: sums.worst,
        };
        self.handles.iter().map(|sums| (sums.frames > 0).then(|| error(sums))).collect()
    }
}

/// The energy as a function of the seen handles alone, the missing ones being at its minimum.
fn reduced(schur: &DMatrix<f64>, seen: &[usize], missing: &[usize]) -> Option<DMatrix<f64>> {
    let rows = schur.select_rows(seen);
    let among_seen = rows.select_columns(seen);
    if missing.is_empty() {
        return Some(among_seen);
    }
    let across = rows.select_columns(missing);
    let factor = schur.select_rows(missing).select_columns(missing).cholesky()?;
    Some(among_seen - &across * factor.solve(&across.transpose()))
}
