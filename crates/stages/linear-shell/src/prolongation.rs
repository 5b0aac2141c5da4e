//! From the proxy's vertices to all of the scan's.

use crate::{Error, Proxy, Surface};
use operators::{Factor, Ordering};

/// The smoothest continuation of a field that is known at the proxy's vertices: `dᵀ L M⁻¹ L d` at its least on the scan. The
/// known values are as dense as the proxy, so each place depends on its surroundings only, and the factor is small.
pub(crate) struct Prolongation {
    factor: Factor,
    vertex_count: usize,
    /// The scan's vertices that the proxy has.
    known: Vec<u32>,
    /// Per unknown, in the factor's order, where its entries in `couplings` start.
    starts: Vec<usize>,
    /// (proxy vertex, entry of the matrix).
    couplings: Vec<(u32, f64)>,
}

impl Prolongation {
    /// For a proxy of a surface. Vertices of the surface that stand still are known, too: they are 0.
    pub(crate) fn new(
        surface: &Surface,
        proxy: &Proxy,
        still: &[u32],
        ordering: &Ordering,
    ) -> Result<Self, Error> {
        let vertex_count = surface.points.len();
        let mut of_proxy = vec![u32::MAX; vertex_count];
        proxy.vertices.iter().enumerate().for_each(|(at, &vertex)| of_proxy[vertex as usize] = at as u32);
        let mut free: Vec<bool> = of_proxy.iter().map(|&at| at == u32::MAX).collect();
        still.iter().for_each(|&vertex| free[vertex as usize] = false);
        let order: Vec<u32> =
            ordering.vertices().iter().copied().filter(|&vertex| free[vertex as usize]).collect();
        let factor = Factor::new(&surface.stiffness, &order)?;
        let (mut starts, mut couplings) = (vec![0], Vec::new());
        for &vertex in factor.order() {
            let row = surface.stiffness.indptr().outer_inds_sz(vertex as usize);
            let entries = surface.stiffness.indices()[row.clone()].iter().zip(&surface.stiffness.data()[row]);
            let known = entries.filter(|&(&other, _)| of_proxy[other] != u32::MAX && !free[other]);
            couplings.extend(known.map(|(&other, &entry)| (of_proxy[other], entry)));
            starts.push(couplings.len());
        }
        Ok(Self { factor, vertex_count, known: proxy.vertices.clone(), starts, couplings })
    }

    /// Fields of the scan, #V each, from fields of the proxy.
    pub(crate) fn prolong(&self, coarse: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let rows = self.factor.order().len();
        let mut columns = Vec::with_capacity(rows * coarse.len());
        for field in coarse {
            let pull = |ends: &[usize]| {
                let couplings = &self.couplings[ends[0]..ends[1]];
                -couplings.iter().map(|&(at, entry)| entry * field[at as usize]).sum::<f64>()
            };
            columns.extend(self.starts.windows(2).map(pull));
        }
        self.factor.solve_in_place(&mut columns, coarse.len());
        let spread = |(field, column): (&Vec<f64>, &[f64])| {
            let mut all = vec![0.0; self.vertex_count];
            self.factor.order().iter().zip(column).for_each(|(&vertex, &value)| all[vertex as usize] = value);
            self.known.iter().zip(field).for_each(|(&vertex, &value)| all[vertex as usize] = value);
            all
        };
        coarse.iter().zip(columns.chunks_exact(rows)).map(spread).collect()
    }

    /// Stored entries of the factor.
    pub(crate) fn stored_count(&self) -> usize {
        self.factor.stored_count()
    }
}
