//! Rows of the response basis times the coefficients of a few frames, in f32, on whatever vector width there is.

use pulp::{Arch, NullaryFnOnce, Simd, WithSimd};

/// Rows of a tile: with `VECTORS` vectors each, their sums stay in the sixteen registers that most machines have, or in the
/// thirty-two of those with vectors of sixteen lanes.
const TILE: usize = 4;
const WIDE_TILE: usize = 8;
const VECTORS: usize = 3;
/// Columns that a whole number of vectors fills, on any machine (sixteen lanes at most).
const LANES: usize = 16;

/// `B C` for a few rows of B at a time.
pub(crate) struct Product {
    /// n × `width` coefficients, row after row, filled up with zeros.
    coefficients: Vec<f32>,
    width: usize,
    arch: Arch,
}

impl Product {
    /// `rows`: per handle its coefficients, all of one length.
    pub(crate) fn new<'a>(columns: usize, rows: impl Iterator<Item = Vec<f32>> + 'a) -> Self {
        let width = columns.next_multiple_of(LANES);
        let padded = rows.flat_map(|mut row| {
            row.resize(width, 0.0);
            row
        });
        Self { coefficients: padded.collect(), width, arch: Arch::new() }
    }

    /// Columns of the product, padding included.
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// Writes the products of some rows of the basis (n values each), `width` columns each.
    pub(crate) fn of_rows(&self, basis: &[f32], products: &mut [f32]) {
        self.arch.dispatch(Job { product: self, basis, products });
    }

    /// `scale · (rest + d)` of one frame: `products` holds d of every vertex, [`Product::width`] apart.
    pub(crate) fn place(&self, rest: &[f32], products: &[f32], scale: f64, out: &mut [f32]) {
        self.arch.dispatch(Place { rest, products, stride: self.width, scale, out });
    }
}

struct Place<'a> {
    rest: &'a [f32],
    products: &'a [f32],
    stride: usize,
    scale: f64,
    out: &'a mut [f32],
}

impl NullaryFnOnce for Place<'_> {
    type Output = ();

    /// Four lanes for three coordinates: the fourth is written over by the next vertex, so the last one goes alone.
    #[inline(always)]
    fn call(self) {
        let Self { rest, products, stride, scale, out } = self;
        let deformed = |rest: f32, d: f32| ((f64::from(rest) + f64::from(d)) * scale) as f32;
        let last = (rest.len() / 3).saturating_sub(1);
        for vertex in 0..last {
            let rest: &[f32] = &rest[vertex * 3..][..4];
            let d: &[f32] = &products[vertex * stride..][..4];
            let four: [f32; 4] = std::array::from_fn(|i| deformed(rest[i], d[i]));
            out[vertex * 3..][..4].copy_from_slice(&four);
        }
        for axis in 0..out.len() - last * 3 {
            out[last * 3 + axis] = deformed(rest[last * 3 + axis], products[last * stride + axis]);
        }
    }
}

struct Job<'a> {
    product: &'a Product,
    basis: &'a [f32],
    products: &'a mut [f32],
}

impl WithSimd for Job<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match S::F32_LANES == LANES {
            true => self.by_tiles::<S, WIDE_TILE>(simd),
            false => self.by_tiles::<S, TILE>(simd),
        }
    }
}

impl Job<'_> {
    /// Tiles of `R` rows.
    #[inline(always)]
    fn by_tiles<S: Simd, const R: usize>(self, simd: S) {
        let Self { product: Product { coefficients, width, .. }, basis, products } = self;
        let handles = coefficients.len() / width;
        let tiles = products.chunks_mut(R * width).zip(basis.chunks(R * handles)).enumerate();
        for (number, (products, rows)) in tiles {
            // A glance at the tile after the next has the memory fetch it meanwhile.
            let ahead = basis.get((number + 2) * R * handles..).unwrap_or_default();
            ahead.iter().take(R * handles).step_by(LANES).for_each(|value| {
                std::hint::black_box(*value);
            });
            let mut column = 0;
            while column < *width {
                let left = (width - column) / S::F32_LANES;
                let step = match (left >= VECTORS, products.len() == R * width) {
                    (true, true) => tile::<S, R, VECTORS>(simd, coefficients, *width, column, rows, products),
                    (false, true) => tile::<S, R, 1>(simd, coefficients, *width, column, rows, products),
                    (_, false) => rows_left(simd, coefficients, *width, column, rows, products),
                };
                column += step;
            }
        }
    }
}

/// The last rows, too few for a tile, one by one.
#[inline(always)]
fn rows_left<S: Simd>(
    simd: S,
    coefficients: &[f32],
    width: usize,
    column: usize,
    basis: &[f32],
    products: &mut [f32],
) -> usize {
    let handles = coefficients.len() / width;
    for (products, basis) in products.chunks_exact_mut(width).zip(basis.chunks_exact(handles)) {
        tile::<S, 1, 1>(simd, coefficients, width, column, basis, products);
    }
    S::F32_LANES
}

/// `R` rows and `V` vectors of columns from `column` on; returns the number of these columns.
#[inline(always)]
fn tile<S: Simd, const R: usize, const V: usize>(
    simd: S,
    coefficients: &[f32],
    width: usize,
    column: usize,
    basis: &[f32],
    products: &mut [f32],
) -> usize {
    let columns = V * S::F32_LANES;
    let handles = coefficients.len() / width;
    let rows: [&[f32]; R] = std::array::from_fn(|row| &basis[row * handles..][..handles]);
    let mut sums = [[simd.splat_f32s(0.0); V]; R];
    for (handle, coefficients) in coefficients.chunks_exact(width).enumerate() {
        let (vectors, _) = S::as_simd_f32s(&coefficients[column..column + columns]);
        for row in 0..R {
            let response = simd.splat_f32s(rows[row][handle]);
            for vector in 0..V {
                sums[row][vector] = simd.mul_add_e_f32s(response, vectors[vector], sums[row][vector]);
            }
        }
    }
    for row in 0..R {
        let (out, _) = S::as_mut_simd_f32s(&mut products[row * width + column..][..columns]);
        out.copy_from_slice(&sums[row]);
    }
    columns
}
