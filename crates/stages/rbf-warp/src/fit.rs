//! Fitting an interpolant to pairs of points [BickelBotsch2007, Sec. 4.1].

use crate::params::Degree;
use crate::polynomial::{PolynomialSpace, monomials};
use crate::saddle::{Saddle, triharmonic};
use crate::{Error, Result};
use artifact::Interpolant;
use nalgebra::{DMatrix, Point3, Similarity3, Vector3};

/// Distance, in units of the set's radius, below which two centers are one: far below any marker's size.
const COINCIDENT: f64 = 1e-6;

/// Points and their images, by marker.
#[derive(Debug, Clone, Copy)]
pub struct Pairs<'a> {
    /// Marker ids, for messages.
    pub markers: &'a [String],
    /// Centers, n points, mm.
    pub from: &'a [Point3<f64>],
    /// Where they go, n points, mm.
    pub to: &'a [Point3<f64>],
    /// The space that the centers are in, for messages.
    pub space: &'static str,
}

/// A fitted interpolant and what is known about it.
#[derive(Debug, Clone)]
pub struct InterpolantFit {
    /// The interpolant.
    pub interpolant: Interpolant,
    /// Polynomial terms that the centers determine …
    pub polynomial_rank: usize,
    /// … of so many: 4 or 10.
    pub polynomial_terms: usize,
    /// Condition number of the saddle-point matrix in centred and scaled coordinates (2-norm).
    pub condition: f64,
    /// Per center how far a fit without it lands from its image, mm; `None` where the others do not determine the
    /// polynomial. Equal to a refit with the same polynomial terms.
    pub leave_one_out_mm: Vec<Option<f64>>,
    /// The best similarity `to_from_from` [Horn1987]; undetermined terms follow it.
    pub similarity: Similarity3<f64>,
}

/// The triharmonic interpolant through all pairs, `c(x) = Σᵢ wᵢ ‖x − cᵢ‖³ + q(x)` [BickelBotsch2007, Eq. 1].
///
/// What is interpolated is the difference from the best similarity, which the polynomial takes up again: where the
/// centers do not determine the polynomial (they lie on a plane, or on a quadric as faces nearly do), the missing part
/// follows the similarity instead of noise. Where they determine it, this changes nothing.
///
/// # Errors
/// Fewer than 4 pairs, or fewer than 10 for [`Degree::Quadratic`]; two centers in one place; all on a line.
///
/// # Panics
/// If the lengths differ.
pub fn fit_interpolant(pairs: Pairs<'_>, degree: Degree) -> Result<InterpolantFit> {
    let n = pairs.from.len();
    assert!(pairs.to.len() == n && pairs.markers.len() == n, "points come in pairs with a name");
    let quadratic = degree.is_quadratic_for(n)?;
    let (origin, scale) = centre_and_radius(pairs.from);
    let u: Vec<Vector3<f64>> = pairs.from.iter().map(|point| (point - origin) / scale).collect();
    refuse_coincident(pairs, &u)?;
    let similarity = camera::fit_similarity(pairs.from, pairs.to, None)
        .map_err(|cause| Error::Degenerate { space: pairs.space, cause: cause.to_string() })?;
    let rest = pairs.from.iter().zip(pairs.to).flat_map(|(from, to)| {
        let difference = to - similarity * from;
        [difference.x, difference.y, difference.z]
    });
    let rest = DMatrix::from_row_iterator(n, 3, rest);
    let solved = Solved::of(&u, &rest, quadratic).ok_or(Error::Unsolvable { space: pairs.space })?;
    let mut polynomial = solved.polynomial;
    add_similarity(&mut polynomial, &similarity, &origin, scale);
    let polynomial_terms = if quadratic { 10 } else { 4 };
    let interpolant = Interpolant {
        origin_mm: origin.into(),
        scale_mm: scale,
        centers: u.iter().map(|&u| u.into()).collect(),
        weights: rows(&solved.weights),
        polynomial: rows(&polynomial)[..polynomial_terms].to_vec(),
    };
    Ok(InterpolantFit {
        interpolant,
        polynomial_rank: solved.rank,
        polynomial_terms,
        condition: solved.condition,
        leave_one_out_mm: solved.leave_one_out_mm,
        similarity,
    })
}

/// Centroid and root mean square distance from it.
fn centre_and_radius(points: &[Point3<f64>]) -> (Point3<f64>, f64) {
    let n = points.len() as f64;
    let centre = Point3::from(points.iter().map(|point| point.coords).sum::<Vector3<f64>>() / n);
    let square = points.iter().map(|point| (point - centre).norm_squared()).sum::<f64>() / n;
    // All points in one place: any scale shows them as coincident.
    (centre, if square > 0.0 { square.sqrt() } else { 1.0 })
}

fn refuse_coincident(pairs: Pairs<'_>, u: &[Vector3<f64>]) -> Result<()> {
    let together = |i: &usize| (0..*i).find(|&j| (u[*i] - u[j]).norm() <= COINCIDENT);
    match (0..u.len()).find_map(|i| together(&i).map(|j| (j, i))) {
        Some((first, second)) => Err(Error::Coincident {
            first: pairs.markers[first].clone(),
            second: pairs.markers[second].clone(),
            space: pairs.space,
        }),
        None => Ok(()),
    }
}

struct Solved {
    weights: DMatrix<f64>,
    /// 10 × 3
    polynomial: DMatrix<f64>,
    rank: usize,
    condition: f64,
    leave_one_out_mm: Vec<Option<f64>>,
}

impl Solved {
    fn of(u: &[Vector3<f64>], y: &DMatrix<f64>, quadratic: bool) -> Option<Self> {
        let space = PolynomialSpace::of(u, quadratic);
        if space.weak_linear.ncols() == 0 {
            return Self::within(u, y, &space);
        }
        Self::within(u, y, &space).or_else(|| Self::within(u, y, &space.with_weak_kept()))
    }

    /// Solves in a space of polynomials. A weak linear direction z stays in as part of the kernel, `Φ + λ z zᵀ`: without
    /// it Φ need not be positive definite, since r³ ≈ ρ³ + 3/2 ρ (zᵢ − zⱼ)² adds −3 ρ zᵢ zⱼ for centers just off a plane;
    /// λ = 3 max ρ makes up for that, and a finite λ keeps the slope along z small.
    fn within(u: &[Vector3<f64>], y: &DMatrix<f64>, space: &PolynomialSpace) -> Option<Self> {
        let monomials = monomials(u);
        let weak = &monomials * &space.weak_linear;
        let mut kernel = triharmonic(u);
        let lambda = 3.0 * kernel.max().cbrt();
        kernel += lambda * &weak * weak.transpose();
        let saddle = Saddle::factor(kernel, &monomials * &space.kept)?;
        let (weights, coefficients) = saddle.solve(y)?;
        let weak_coefficients = lambda * weak.tr_mul(&weights);
        Some(Self {
            polynomial: &space.kept * coefficients + &space.weak_linear * weak_coefficients,
            rank: space.kept.ncols(),
            condition: saddle.condition(),
            leave_one_out_mm: saddle.leave_one_out(&weights),
            weights,
        })
    }
}

/// S(origin + scale u) = S(origin) + scale s R u
fn add_similarity(
    polynomial: &mut DMatrix<f64>,
    similarity: &Similarity3<f64>,
    origin: &Point3<f64>,
    scale: f64,
) {
    let constant = similarity * origin;
    for value in 0..3 {
        polynomial[(0, value)] += constant[value];
    }
    for axis in 0..3 {
        let image = similarity * (Vector3::ith(axis, scale));
        for value in 0..3 {
            polynomial[(1 + axis, value)] += image[value];
        }
    }
}

fn rows(matrix: &DMatrix<f64>) -> Vec<[f64; 3]> {
    matrix.row_iter().map(|row| [row[0], row[1], row[2]]).collect()
}
