//! The responses to every handle: a frame as one dense product.

use nalgebra::Vector3;
use rayon::prelude::*;

/// Vertices that one task works on.
const ROWS: usize = 4096;

/// The response basis, #V × n: how far each vertex goes when a handle goes 1. In f32: the loss is 1e-5 mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Basis {
    values: Vec<f32>,
    handle_count: usize,
}

impl Basis {
    /// From #V × n values, row after row.
    ///
    /// # Panics
    /// If the length is no multiple of the handle count.
    #[must_use]
    pub fn new(values: Vec<f32>, handle_count: usize) -> Self {
        assert!(
            handle_count > 0 && values.len().is_multiple_of(handle_count),
            "rows of one value per handle"
        );
        Self { values, handle_count }
    }

    /// #V × n values, row after row.
    #[must_use]
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Number of vertices.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.values.len() / self.handle_count
    }

    /// Deformed coordinates of several frames at once: per frame #V × 3 values `scale · (rest + B D)`, vertex after vertex.
    ///
    /// `rest`: #V × 3, mm; `frames`: per frame the displacements of all handles, mm; `scale`: 1 / (mm in the unit of the
    /// result). A batch reads the basis once, so a few frames cost little more than one.
    ///
    /// # Panics
    /// If the lengths disagree.
    #[must_use]
    pub fn deform(&self, rest: &[f32], frames: &[Vec<Vector3<f64>>], scale: f64) -> Vec<Vec<f32>> {
        assert_eq!(rest.len(), self.vertex_count() * 3, "three coordinates per vertex");
        let width = frames.len() * 3;
        let coefficients = self.coefficients(frames);
        let mut out: Vec<Vec<f32>> = frames.iter().map(|_| vec![0.0; rest.len()]).collect();
        let mut slices: Vec<_> = out.iter_mut().map(|frame| frame.chunks_mut(ROWS * 3)).collect();
        let tasks: Vec<Vec<&mut [f32]>> = (0..self.vertex_count().div_ceil(ROWS))
            .map(|_| slices.iter_mut().filter_map(Iterator::next).collect())
            .collect();
        let basis_rows = self.values.par_chunks(ROWS * self.handle_count).zip(rest.par_chunks(ROWS * 3));
        tasks.into_par_iter().zip(basis_rows).for_each(|(mut out, (basis, rest))| {
            let mut sums = vec![0f32; width];
            for (row, responses) in basis.chunks_exact(self.handle_count).enumerate() {
                sums.fill(0.0);
                for (&response, columns) in responses.iter().zip(coefficients.chunks_exact(width)) {
                    sums.iter_mut().zip(columns).for_each(|(sum, column)| *sum += response * column);
                }
                for (frame, sums) in out.iter_mut().zip(sums.chunks_exact(3)) {
                    for axis in 0..3 {
                        let at = row * 3 + axis;
                        frame[at] = ((f64::from(rest[at]) + f64::from(sums[axis])) * scale) as f32;
                    }
                }
            }
        });
        out
    }

    /// Handle displacements as n rows of 3 × frames columns.
    fn coefficients(&self, frames: &[Vec<Vector3<f64>>]) -> Vec<f32> {
        let mut coefficients = Vec::with_capacity(self.handle_count * frames.len() * 3);
        for handle in 0..self.handle_count {
            for frame in frames {
                assert_eq!(frame.len(), self.handle_count, "one displacement per handle");
                coefficients.extend(frame[handle].iter().map(|&x| x as f32));
            }
        }
        coefficients
    }
}
