//! Adding up terms into a gradient and a matrix of 3 × 3 blocks.

use crate::energy::Term;
use crate::patch::Spring;
use nalgebra::{Matrix3, Point3, Vector3};

/// Terms added up into a gradient and a matrix.
pub(crate) struct Sum<'a> {
    pub(crate) free_count: u32,
    pub(crate) starts: &'a [usize],
    pub(crate) rows: &'a [u32],
    pub(crate) values: &'a mut [f64],
    pub(crate) energy: f64,
    pub(crate) gradient: Vec<f64>,
}

impl Sum<'_> {
    pub(crate) fn add<const N: usize>(&mut self, vertices: &[u32; N], term: &Term<N>) {
        self.energy += term.energy;
        for (j, &column) in vertices.iter().enumerate() {
            if column >= self.free_count {
                continue;
            }
            (0..3).for_each(|c| self.gradient[3 * column as usize + c] += term.gradient[j][c]);
            for (i, &row) in vertices.iter().enumerate() {
                if row < self.free_count {
                    self.add_block(row, column, &term.hessian[i][j]);
                }
            }
        }
    }

    fn add_block(&mut self, row: u32, column: u32, block: &Matrix3<f64>) {
        let range = self.starts[column as usize]..self.starts[column as usize + 1];
        let height = 3 * range.len();
        let blocks = &self.rows[range.clone()];
        let place = blocks.iter().position(|&other| other == row).unwrap_or(0);
        let first = 9 * range.start + 3 * place;
        for c in 0..3 {
            let into = &mut self.values[first + c * height..first + c * height + 3];
            (0..3).for_each(|r| into[r] += block[(r, c)]);
        }
    }

    pub(crate) fn add_spring(&mut self, vertex: u32, at: Point3<f64>, spring: &Spring) {
        let (stretch, twice) = (spring.stretch(&at), 2.0 * spring.stiffness);
        if stretch == Vector3::zeros() && spring.plane.is_some() {
            return;
        }
        self.energy += spring.stiffness * stretch.norm_squared();
        (0..3).for_each(|c| self.gradient[3 * vertex as usize + c] += twice * stretch[c]);
        let along = spring.plane.map_or(Matrix3::identity(), |normal| normal * normal.transpose());
        self.add_block(vertex, vertex, &(along * twice));
    }
}
