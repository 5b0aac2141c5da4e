//! What normals get wrong at large: their average is turned to that of the positions' normals.

use crate::Error;
use crate::surface::Surface;
use nalgebra::{Point3, UnitQuaternion, Vector3};
use operators::{CsMat, Factor, Ordering};
use sprs::TriMat;
use std::f64::consts::TAU;

/// Share of a vertex's area that an untrusted normal keeps in averages, so that they exist everywhere.
const FLOOR: f64 = 1e-4;

/// Averages fields over a surface.
pub(crate) struct Averages {
    factor: Factor,
    /// Areas times trust.
    weights: Vec<f64>,
}

impl Averages {
    /// Averages over waves shorter than `wavelength` mm, by one implicit step of smoothing, `(W + (Λ/2π)² L) f̄ = W f`, with areas
    /// weighed by `confidence`.
    pub(crate) fn over(
        points: &[Point3<f64>],
        surface: &Surface,
        confidence: &[f64],
        wavelength: f64,
    ) -> Result<Self, Error> {
        let weights: Vec<f64> =
            surface.mass.iter().zip(confidence).map(|(mass, c)| mass * c.max(FLOOR)).collect();
        let scale = (wavelength / TAU).powi(2);
        let mut entries =
            TriMat::with_capacity((points.len(), points.len()), 4 * surface.edges.len() + points.len());
        for &([i, j], weight) in &surface.edges {
            let (i, j, value) = (i as usize, j as usize, scale * weight);
            entries.add_triplet(i, j, -value);
            entries.add_triplet(j, i, -value);
            entries.add_triplet(i, i, value);
            entries.add_triplet(j, j, value);
        }
        weights.iter().enumerate().for_each(|(vertex, &weight)| entries.add_triplet(vertex, vertex, weight));
        let matrix: CsMat<f64> = entries.to_csr();
        let ordering = Ordering::nested_dissection(&matrix, points);
        Ok(Self { factor: Factor::new(&matrix, ordering.vertices())?, weights })
    }

    /// Two fields' averages, unit vectors.
    fn of(&self, fields: [&[Vector3<f64>]; 2]) -> [Vec<Vector3<f64>>; 2] {
        let order = self.factor.order();
        let mut columns = Vec::with_capacity(6 * order.len());
        for field in fields {
            for axis in 0..3 {
                columns.extend(order.iter().map(|&v| self.weights[v as usize] * field[v as usize][axis]));
            }
        }
        self.factor.solve_in_place(&mut columns, 6);
        [0, 1].map(|which| {
            let mut field = vec![Vector3::zeros(); order.len()];
            for (row, &vertex) in order.iter().enumerate() {
                let at = |axis: usize| columns[(3 * which + axis) * order.len() + row];
                field[vertex as usize] =
                    Vector3::new(at(0), at(1), at(2)).try_normalize(0.0).unwrap_or_else(Vector3::zeros);
            }
            field
        })
    }

    /// The measured normals, each turned as its surroundings' average must be turned to become that of the positions' normals
    /// [Nehab2005, Sec. 4.1]; and the mean angle of these turns, degrees.
    pub(crate) fn correct(
        &self,
        measured: &[Vector3<f64>],
        positions: &[Vector3<f64>],
    ) -> (Vec<Vector3<f64>>, f64) {
        let [from, to] = self.of([measured, positions]);
        let (mut sum, mut total) = (0.0, 0.0);
        let turned = measured.iter().zip(from.iter().zip(&to)).zip(&self.weights).map(
            |((normal, (from, to)), weight)| {
                let turn =
                    UnitQuaternion::rotation_between(from, to).unwrap_or_else(UnitQuaternion::identity);
                sum += weight * turn.angle().to_degrees();
                total += weight;
                turn * normal
            },
        );
        let turned = turned.collect();
        (turned, sum / total)
    }
}
