//! A smooth map of space: value and Jacobian of a sum of triharmonic kernels and a quadratic [BickelBotsch2007, Eq. 1].

use crate::rbf_kernel::{BLOCK, Columns, Terms};
use nalgebra::{Matrix3, Point3, Vector3};
use rayon::prelude::*;

/// What a map adds up: centers, weights and coefficients, as files hold them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RbfSum<'a> {
    /// Coordinates are centred here first, mm …
    pub origin_mm: [f64; 3],
    /// … and divided by this, mm.
    pub scale_mm: f64,
    /// Centers uᵢ, n × 3, no unit.
    pub centers: &'a [[f64; 3]],
    /// Weights wᵢ, n × 3, mm.
    pub weights: &'a [[f64; 3]],
    /// Coefficients of 1, x, y, z, xx, yy, zz, xy, xz, yz of u, mm; the first 1, 4 or all 10.
    pub polynomial: &'a [[f64; 3]],
}

/// `c(x) = Σᵢ wᵢ ‖u − uᵢ‖³ + q(u)`, u = (x − origin) / scale, ready to be evaluated.
#[derive(Debug, Clone)]
pub struct RbfMap {
    origin: Point3<f64>,
    scale: f64,
    terms: Terms,
}

impl RbfMap {
    /// The map that a sum describes.
    #[must_use]
    pub fn new(sum: &RbfSum) -> Self {
        let RbfSum { origin_mm, scale_mm, centers, weights, polynomial } = *sum;
        let row = |(c, w): (&[f64; 3], &[f64; 3])| [c[0], c[1], c[2], w[0], w[1], w[2]];
        let rows = centers.iter().zip(weights).map(row).collect();
        let mut padded = [[0.0; 3]; 10];
        padded.iter_mut().zip(polynomial).for_each(|(to, from)| *to = *from);
        Self { origin: origin_mm.into(), scale: scale_mm, terms: Terms { rows, polynomial: padded } }
    }

    /// The image of one point, mm → mm; the same bits as in [`RbfMap::map_all`].
    #[must_use]
    pub fn at(&self, point: &Point3<f64>) -> Point3<f64> {
        let mut point = [*point];
        self.map_block(&mut point);
        point[0]
    }

    /// The image of one point (mm) and the Jacobian ∂c/∂x there (no unit).
    #[must_use]
    pub fn with_jacobian(&self, point: &Point3<f64>) -> (Point3<f64>, Matrix3<f64>) {
        let mut at = [[0.0; BLOCK]; 3];
        let mut out = [[0.0; BLOCK]; 12];
        put(&mut at, 0, &self.normalised(point));
        self.terms.values_and_derivatives(&at, 1, &mut out);
        (take(&out, 0).into(), take_jacobian(&out, 0) / self.scale)
    }

    /// Replaces points by their images, mm → mm. Points × centers, spread over the threads; the result does not depend
    /// on their number.
    pub fn map_all(&self, points: &mut [Point3<f64>]) {
        points.par_chunks_mut(BLOCK).for_each(|block| self.map_block(block));
    }

    fn map_block(&self, points: &mut [Point3<f64>]) {
        let mut at = [[0.0; BLOCK]; 3];
        let mut out = [[0.0; BLOCK]; 3];
        points.iter().enumerate().for_each(|(i, point)| put(&mut at, i, &self.normalised(point)));
        self.terms.values(&at, points.len(), &mut out);
        points.iter_mut().enumerate().for_each(|(i, point)| *point = take(&out, i).into());
    }

    /// The instruction set that maps are evaluated with here; across instruction sets results agree to rounding only.
    #[must_use]
    pub fn instruction_set() -> &'static str {
        crate::rbf_kernel::instruction_set()
    }

    /// Centers, mm, in their order.
    #[must_use]
    pub fn centers(&self) -> Vec<Point3<f64>> {
        self.terms.rows.iter().map(|row| self.restored(&Vector3::new(row[0], row[1], row[2]))).collect()
    }

    /// Length that coordinates are divided by, mm.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    pub(crate) fn terms(&self) -> &Terms {
        &self.terms
    }

    /// u = (x − origin) / scale
    pub(crate) fn normalised(&self, point: &Point3<f64>) -> Vector3<f64> {
        (point - self.origin) / self.scale
    }

    /// x = origin + scale u
    pub(crate) fn restored(&self, u: &Vector3<f64>) -> Point3<f64> {
        self.origin + u * self.scale
    }
}

pub(crate) fn put(columns: &mut Columns<3>, i: usize, u: &Vector3<f64>) {
    for axis in 0..3 {
        columns[axis][i] = u[axis];
    }
}

/// The three values of point `i`, mm.
pub(crate) fn take<const N: usize>(columns: &Columns<N>, i: usize) -> Vector3<f64> {
    Vector3::new(columns[0][i], columns[1][i], columns[2][i])
}

/// ∂c/∂u of point `i`, mm.
pub(crate) fn take_jacobian(columns: &Columns<12>, i: usize) -> Matrix3<f64> {
    Matrix3::from_fn(|value, axis| columns[3 + 3 * value + axis][i])
}
