//! How well each handle is predicted by the others: a mis-picked or slipping marker shows here.

use crate::Completion;
use nalgebra::Vector3;

/// Leave-one-out errors, gathered over frames in which every handle has a value.
#[derive(Debug, Clone, PartialEq)]
pub struct LeaveOneOut {
    squares: Vec<f64>,
    worst: Vec<f64>,
    frames: usize,
}

impl LeaveOneOut {
    /// For `count` handles.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self { squares: vec![0.0; count], worst: vec![0.0; count], frames: 0 }
    }

    /// Adds a frame. Without handle i the energy puts it at `D_i − (S D)_i / S_ii`, so the distance is
    /// `‖(S D)_i‖ / S_ii`: no solve is needed.
    pub fn add(&mut self, completion: &Completion, handles: &[Vector3<f64>]) {
        let schur = completion.schur();
        for i in 0..handles.len() {
            let pull: Vector3<f64> = (0..handles.len()).map(|k| schur[(i, k)] * handles[k]).sum();
            let error = pull.norm() / schur[(i, i)];
            self.squares[i] += error * error;
            self.worst[i] = self.worst[i].max(error);
        }
        self.frames += 1;
    }

    /// Frames added.
    #[must_use]
    pub fn frame_count(&self) -> usize {
        self.frames
    }

    /// Per handle the root mean square over the frames, mm.
    #[must_use]
    pub fn rms_mm(&self) -> Vec<f64> {
        self.squares.iter().map(|square| (square / self.frames.max(1) as f64).sqrt()).collect()
    }

    /// Per handle the largest error, mm.
    #[must_use]
    pub fn worst_mm(&self) -> &[f64] {
        &self.worst
    }
}
