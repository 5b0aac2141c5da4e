//! The responses to every handle: a frame as one dense product.

use crate::product::Product;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Vertices that one task works on.
const ROWS: usize = 4096;
/// Vertices whose products for all frames stay in the cache.
const BLOCK: usize = 32;

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
        let mut out = Vec::new();
        self.deform_into(rest, frames, scale, &mut out);
        out
    }

    /// The same into arrays that were used before: a sequence of batches touches fresh memory only once.
    ///
    /// # Panics
    /// If the lengths disagree.
    pub fn deform_into(
        &self,
        rest: &[f32],
        frames: &[Vec<Vector3<f64>>],
        scale: f64,
        out: &mut Vec<Vec<f32>>,
    ) {
        assert_eq!(rest.len(), self.vertex_count() * 3, "three coordinates per vertex");
        out.resize_with(frames.len(), Vec::new);
        out.iter_mut().for_each(|frame| frame.resize(rest.len(), 0.0));
        let product = Product::new(frames.len() * 3, self.coefficients(frames));
        let mut slices: Vec<_> = out.iter_mut().map(|frame| frame.chunks_mut(ROWS * 3)).collect();
        let tasks: Vec<Vec<&mut [f32]>> = (0..self.vertex_count().div_ceil(ROWS))
            .map(|_| slices.iter_mut().filter_map(Iterator::next).collect())
            .collect();
        let basis_rows = self.values.par_chunks(ROWS * self.handle_count).zip(rest.par_chunks(ROWS * 3));
        tasks.into_par_iter().zip(basis_rows).for_each(|(mut out, (basis, rest))| {
            let mut products = vec![0f32; BLOCK * product.width()];
            let blocks = basis.chunks(BLOCK * self.handle_count).zip(rest.chunks(BLOCK * 3));
            for (block, (basis, rest)) in blocks.enumerate() {
                let products = &mut products[..rest.len() / 3 * product.width()];
                product.of_rows(basis, products);
                for (frame, out) in out.iter_mut().enumerate() {
                    let out = &mut out[block * BLOCK * 3..][..rest.len()];
                    product.place(rest, &products[frame * 3..], scale, out);
                }
            }
        });
    }

    /// Per handle its displacements in all frames.
    fn coefficients<'a>(&'a self, frames: &'a [Vec<Vector3<f64>>]) -> impl Iterator<Item = Vec<f32>> + 'a {
        frames
            .iter()
            .for_each(|frame| assert_eq!(frame.len(), self.handle_count, "one displacement per handle"));
        let of_handle = move |handle: usize| {
            frames.iter().flat_map(|frame| frame[handle].iter().map(|&x| x as f32)).collect::<Vec<_>>()
        };
        (0..self.handle_count).map(of_handle)
    }
}
