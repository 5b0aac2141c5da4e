//! How a camera's coarse picture changes: its main components over the exposures.

use crate::timeline::Paced;
use crate::{CELL_COUNT, Error, flash};
use nalgebra::{DMatrix, SymmetricEigen};

/// Components kept: a face, a head and what hangs on them move in about so many ways.
pub(crate) const COMPONENTS: usize = 12;

pub(crate) type Point = [f64; COMPONENTS];

/// The main components of a camera's pictures.
pub(crate) struct Course {
    /// By exposure; none where it was dropped, or where a flash hides what moves.
    points: Vec<Option<Point>>,
}

impl Course {
    /// The coarse pictures, projected on the eigenvectors of their covariance of the largest eigenvalues.
    pub(crate) fn of(camera: &Paced) -> Result<Self, Error> {
        let cells: Option<Vec<&[f32]>> = camera
            .recording
            .images
            .iter()
            .map(|image| image.reading.as_ref().map(|reading| &reading.cells[..]))
            .collect();
        let cells = cells.ok_or_else(|| Error::NotRead(camera.id().to_string()))?;
        let mean: Vec<f64> = (0..CELL_COUNT)
            .map(|cell| cells.iter().map(|row| f64::from(row[cell])).sum::<f64>() / cells.len().max(1) as f64)
            .collect();
        let axes = main_axes(&cells, &mean);
        let count = camera.cadence.exposures.last().map_or(0, |last| last + 1);
        let mut points = vec![None; usize::try_from(count).unwrap_or(0)];
        let lit = flash::lit(camera);
        for (i, (row, exposure)) in cells.iter().zip(&camera.cadence.exposures).enumerate() {
            if !(camera.cadence.repeats[i] || lit[i]) {
                points[*exposure as usize] = Some(std::array::from_fn(|axis| {
                    (0..CELL_COUNT).map(|cell| axes[(cell, axis)] * (f64::from(row[cell]) - mean[cell])).sum()
                }));
            }
        }
        Ok(Self { points })
    }

    /// Exposures, dropped ones counted.
    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }

    pub(crate) fn point(&self, exposure: i64) -> Option<&Point> {
        self.points.get(usize::try_from(exposure).ok()?)?.as_ref()
    }

    /// Between exposures: the cubic through the four around [Keys1981, a = −1/2]; none where one of them is missing.
    pub(crate) fn at(&self, exposure: f64) -> Option<Point> {
        let floor = exposure.floor();
        let (first, t) = (floor as i64, exposure - floor);
        if t == 0.0 {
            return self.point(first).copied();
        }
        let weights = [
            ((-0.5 * t + 1.0) * t - 0.5) * t,
            (1.5 * t - 2.5) * t * t + 1.0,
            ((-1.5 * t + 2.0) * t + 0.5) * t,
            (0.5 * t - 0.5) * t * t,
        ];
        let mut point = [0.0; COMPONENTS];
        for (tap, weight) in (first - 1..).zip(weights) {
            let value = self.point(tap)?;
            point.iter_mut().zip(value).for_each(|(sum, value)| *sum += weight * value);
        }
        Some(point)
    }
}

/// Axes of the largest variance, `CELL_COUNT` × `COMPONENTS`, largest first.
fn main_axes(cells: &[&[f32]], mean: &[f64]) -> DMatrix<f64> {
    let mut covariance = DMatrix::<f64>::zeros(CELL_COUNT, CELL_COUNT);
    let mut row = vec![0.0; CELL_COUNT];
    for cells in cells {
        row.iter_mut().zip(cells.iter().zip(mean)).for_each(|(x, (cell, mean))| *x = f64::from(*cell) - mean);
        for a in 0..CELL_COUNT {
            for b in 0..=a {
                covariance[(a, b)] += row[a] * row[b];
            }
        }
    }
    covariance.fill_upper_triangle_with_lower_triangle();
    let eigen = SymmetricEigen::new(covariance);
    let mut order: Vec<usize> = (0..CELL_COUNT).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]).then(a.cmp(b)));
    DMatrix::from_fn(CELL_COUNT, COMPONENTS, |cell, axis| eigen.eigenvectors[(cell, order[axis])])
}
