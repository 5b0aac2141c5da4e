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

    /// Two fields' averages, unit vectors; the fields are integrated over the vertices' areas and weighed.
    fn of(&self, fields: [&[Vector3<f64>]; 2]) -> [Vec<Vector3<f64>>; 2] {
        let order = self.factor.order();
        let mut columns = Vec::with_capacity(6 * order.len());
        for field in fields {
            for axis in 0..3 {
                columns.extend(order.iter().map(|&vertex| field[vertex as usize][axis]));
            }
        }
        self.factor.solve_in_place(&mut columns, 6);
        [0, 1].map(|which| {
            let mut field = vec![Vector3::zeros(); order.len()];
            for (row, &vertex) in order.iter().enumerate() {
                let at = |axis: usize| columns[(3 * which + axis) * order.len() + row];
                let sum = Vector3::new(at(0), at(1), at(2));
                field[vertex as usize] = sum.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
            }
            field
        })
    }

    /// The measured normals, each turned as its surroundings' average must be turned to become that of the positions' normals
    /// [Nehab2005, Sec. 4.1]; and the mean angle of these turns, degrees.
    ///
    /// The positions' normals are averaged as area vectors, not as unit vectors: those are linear in noise along any axis, and
    /// their mean is that of the surface without it, where unit normals of a rough surface lean towards the line of sight.
    pub(crate) fn correct(
        &self,
        measured: &[Vector3<f64>],
        points: &[Point3<f64>],
        surface: &Surface,
    ) -> (Vec<Vector3<f64>>, f64) {
        let mut areas = area_vectors(points, &surface.triangles);
        areas
            .iter_mut()
            .zip(&self.weights)
            .zip(&surface.mass)
            .for_each(|((area, weight), mass)| *area *= weight / mass);
        // The measured ones weigh as much as the areas that face their way, which is linear in noise, too.
        let seen: Vec<Vector3<f64>> = measured
            .iter()
            .zip(&areas)
            .map(|(normal, area)| match normal.norm_squared() > 0.0 {
                true => normal.dot(area).max(0.0) * normal,
                false => *area,
            })
            .collect();
        let [from, to] = self.of([&seen, &areas]);
        let turns: Vec<UnitQuaternion<f64>> = from
            .iter()
            .zip(&to)
            .map(|(from, to)| {
                UnitQuaternion::rotation_between(from, to).unwrap_or_else(UnitQuaternion::identity)
            })
            .collect();
        let angles = turns.iter().zip(&self.weights).map(|(turn, weight)| weight * turn.angle().to_degrees());
        let mean = angles.sum::<f64>() / self.weights.iter().sum::<f64>();
        (turns.iter().zip(measured).map(|(turn, normal)| turn * normal).collect(), mean)
    }
}

/// Per vertex a third of the area vectors of its triangles, mm².
fn area_vectors(points: &[Point3<f64>], triangles: &[[u32; 3]]) -> Vec<Vector3<f64>> {
    let mut sums = vec![Vector3::zeros(); points.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| points[vertex as usize]);
        let share = (b - a).cross(&(c - a)) / 6.0;
        triangle.iter().for_each(|&vertex| sums[vertex as usize] += share);
    }
    sums
}
