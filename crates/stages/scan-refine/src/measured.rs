//! Measured normals, one per vertex.

use crate::Error;
use nalgebra::Vector3;

/// Normals as they were measured, in the axes of the mesh's coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// #V unit normals; zero where there is none.
    pub(crate) normals: Vec<Vector3<f64>>,
    /// #V shares of trust, 0 to 1; 0 where there is no normal.
    pub(crate) confidence: Vec<f64>,
}

impl Measured {
    /// Normals given per vertex, of any length; zero where none was measured.
    ///
    /// # Errors
    /// [`Error::NotFinite`] names the vertex; [`Error::NothingMeasured`] where all are zero.
    pub fn per_vertex(normals: Vec<Vector3<f64>>) -> Result<Self, Error> {
        if let Some(vertex) = normals.iter().position(|normal| !normal.iter().all(|x| x.is_finite())) {
            return Err(Error::NotFinite { vertex });
        }
        let normals: Vec<Vector3<f64>> =
            normals.iter().map(|normal| normal.try_normalize(1e-6).unwrap_or_else(Vector3::zeros)).collect();
        let confidence: Vec<f64> = normals.iter().map(|n| f64::from(u8::from(n.norm() > 0.5))).collect();
        match confidence.iter().any(|&confidence| confidence > 0.0) {
            true => Ok(Self { normals, confidence }),
            false => Err(Error::NothingMeasured { why: "all of them are zero" }),
        }
    }

    /// Multiplies the trust in each normal; `confidence`: #V, 0 to 1.
    ///
    /// # Errors
    /// [`Error::Count`], [`Error::Confidence`]; [`Error::NothingMeasured`] where nothing is left.
    pub fn weigh(&mut self, confidence: &[f64]) -> Result<(), Error> {
        let (count, vertex_count) = (confidence.len(), self.normals.len());
        if count != vertex_count {
            return Err(Error::Count { what: "confidences", count, vertex_count });
        }
        if let Some(vertex) = confidence.iter().position(|value| !(0.0..=1.0).contains(value)) {
            return Err(Error::Confidence { vertex, value: confidence[vertex] });
        }
        self.confidence.iter_mut().zip(confidence).for_each(|(sum, &value)| *sum *= value);
        match self.confidence.iter().any(|&confidence| confidence > 0.0) {
            true => Ok(()),
            false => Err(Error::NothingMeasured { why: "none of those measured is trusted" }),
        }
    }

    /// Share of the vertices that have a normal.
    #[must_use]
    pub fn coverage(&self) -> f64 {
        self.confidence.iter().filter(|&&value| value > 0.0).count() as f64
            / self.confidence.len().max(1) as f64
    }

    /// The mean angle to other normals, degrees, weighed by trust; vertices without one on either side are left out.
    #[must_use]
    pub fn mean_degrees(&self, others: &[Vector3<f64>]) -> f64 {
        let (mut sum, mut total) = (0.0, 0.0);
        for ((normal, other), &confidence) in self.normals.iter().zip(others).zip(&self.confidence) {
            if confidence > 0.0 && other.norm_squared() > 0.0 {
                sum += confidence * normal.angle(other).to_degrees();
                total += confidence;
            }
        }
        if total > 0.0 { sum / total } else { 0.0 }
    }
}
