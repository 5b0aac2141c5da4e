//! The polynomial part, cut down to what the centers determine.
//!
//! A face is nearly an ellipsoid, and centers that lie on a quadric cannot tell its equation, times any factor, from
//! zero: the ten terms are then linearly dependent, and the factor decides what happens off the surface. So the terms
//! are kept in order of degree, and of each degree only the combinations that the centers tell apart.

use nalgebra::{DMatrix, Matrix3, Matrix6, Vector3, Vector6};

/// Singular value below which a combination of terms counts as not determined.
///
/// Of the block whose rows are the centers (coordinates in units of the set's radius) and whose columns are a degree's
/// forms of unit norm, without what lower degrees explain. An error e in the picks changes the coefficient that belongs to
/// a singular value s by about e / s, so this bounds how much errors are multiplied: at the limit, 1 mm becomes 7 mm per
/// squared radius. Markers on real faces have 0.68 (90 of them), 0.53 (41), 0.21 (20); 90 markers that follow an
/// ellipsoid to 1 mm have 0.14.
pub const UNDETERMINED: f64 = 0.15;

/// Factors that make the norm of a quadratic form's coefficients independent of rotation (Frobenius).
const FORM: [f64; 6] =
    [1.0, 1.0, 1.0, std::f64::consts::SQRT_2, std::f64::consts::SQRT_2, std::f64::consts::SQRT_2];

/// A space of polynomials, as coefficients of the ten monomials.
pub(crate) struct PolynomialSpace {
    /// 10 × rank: what the centers determine.
    pub(crate) kept: DMatrix<f64>,
    /// 10 × (0–2): linear terms that they do not.
    pub(crate) weak_linear: DMatrix<f64>,
}

impl PolynomialSpace {
    /// The determined part of all polynomials up to linear or quadratic order. `u`: centers with zero mean and unit root
    /// mean square norm.
    pub(crate) fn of(u: &[Vector3<f64>], quadratic: bool) -> Self {
        let scatter = u.iter().map(|u| u * u.transpose()).sum::<Matrix3<f64>>();
        let eigen = scatter.symmetric_eigen();
        let (mut kept, mut weak) = (vec![unit(0)], Vec::new());
        for (i, &variance) in eigen.eigenvalues.iter().enumerate() {
            let direction = eigen.eigenvectors.column(i);
            let column = std::array::from_fn(|k| if (1..4).contains(&k) { direction[k - 1] } else { 0.0 });
            if variance.max(0.0).sqrt() >= UNDETERMINED { kept.push(column) } else { weak.push(column) }
        }
        if quadratic {
            let linear = columns(&kept);
            kept.extend(determined_forms(u, &linear));
        }
        Self { kept: columns(&kept), weak_linear: columns(&weak) }
    }

    /// Every term: what centers that are not degenerate determine.
    pub(crate) fn with_weak_kept(self) -> Self {
        let columns: Vec<_> = self.kept.column_iter().chain(self.weak_linear.column_iter()).collect();
        Self { kept: DMatrix::from_columns(&columns), weak_linear: DMatrix::zeros(10, 0) }
    }
}

/// The quadratic forms that the centers tell apart from each other and from the linear terms.
fn determined_forms(u: &[Vector3<f64>], linear: &DMatrix<f64>) -> Vec<[f64; 10]> {
    let monomials = monomials(u);
    let on_centers = (&monomials * linear).qr().q();
    let mut forms = monomials.columns(4, 6).into_owned();
    forms.column_iter_mut().zip(FORM).for_each(|(mut column, factor)| column *= factor);
    let rest = &forms - &on_centers * on_centers.tr_mul(&forms);
    let gram: Matrix6<f64> = rest.tr_mul(&rest).fixed_view::<6, 6>(0, 0).into_owned();
    let eigen = gram.symmetric_eigen();
    let determined = |i: &usize| eigen.eigenvalues[*i].max(0.0).sqrt() >= UNDETERMINED;
    let column = |i: usize| {
        let form: Vector6<f64> = eigen.eigenvectors.column(i).into_owned();
        std::array::from_fn(|k| if k < 4 { 0.0 } else { FORM[k - 4] * form[k - 4] })
    };
    (0..6).filter(determined).map(column).collect()
}

/// The ten monomials at each point: #u × 10.
pub(crate) fn monomials(u: &[Vector3<f64>]) -> DMatrix<f64> {
    let row = |u: &Vector3<f64>| {
        let (x, y, z) = (u.x, u.y, u.z);
        [1.0, x, y, z, x * x, y * y, z * z, x * y, x * z, y * z]
    };
    DMatrix::from_row_iterator(u.len(), 10, u.iter().flat_map(row))
}

fn unit(term: usize) -> [f64; 10] {
    std::array::from_fn(|k| f64::from(u8::from(k == term)))
}

fn columns(columns: &[[f64; 10]]) -> DMatrix<f64> {
    DMatrix::from_iterator(10, columns.len(), columns.iter().flatten().copied())
}
