//! One marker in one frame: the point whose images are nearest to what the cameras saw.

use crate::view::View;
use camera::nearest_to_lines;
use nalgebra::{Matrix3, Point3, Unit, Vector2, Vector3};

/// Gauss–Newton steps at most; two or three are usual, more where Huber's weights change.
const MAX_STEPS: usize = 20;
/// A step below this has converged, mm: it is far below any noise, and where all views agree the next one would be its square
/// over the distance.
const CONVERGED_MM: f64 = 1e-5;
/// Where the steps are used up, a last one below this will do, mm.
const NEARLY_MM: f64 = 1e-2;
/// Residuals beyond so many standard deviations weigh less [Huber1964].
const HUBER: f64 = 2.0;
/// How far off a point of confidence 0 may be, px; one of confidence c by 1 − c of it. Where a share of a dot is hidden, the
/// centre of the rest is off by about that share of the dot's width.
const UNSURE_PX: f64 = 2.5;
/// For how many residuals the spread of all stands in the estimate of a point's own.
const PRIOR: f64 = 4.0;
/// Rays that all meet at less than this are parallel, rad (0.1°): depth is then known to centimetres at best.
const LEAST_ANGLE: f64 = 1.745e-3;

/// How a camera saw the marker.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sight<'a> {
    pub(crate) camera: usize,
    view: &'a View,
    pixel: Vector2<f64>,
    ray: Unit<Vector3<f64>>,
    /// Inverse variance, relative to a sure view's.
    weight: f64,
}

impl<'a> Sight<'a> {
    /// A sight; none where the camera's lens folds.
    pub(crate) fn new(
        camera: usize,
        view: &'a View,
        pixel: Vector2<f64>,
        confidence: f64,
        scale: Scale,
    ) -> Option<Self> {
        let doubt = UNSURE_PX * (1.0 - confidence) / scale.spread;
        let weight = 1.0 / (1.0 + doubt * doubt);
        Some(Self { camera, view, pixel, ray: view.ray(pixel)?, weight })
    }

    pub(crate) fn ray(&self) -> (Point3<f64>, Unit<Vector3<f64>>) {
        (self.view.eye, self.ray)
    }
}

/// What residuals mean, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    /// Standard deviation of a sure point, per axis.
    pub(crate) noise: f64,
    /// Standard deviation of residuals per axis: the noise, and what calibration and curved skin add to it.
    pub(crate) spread: f64,
    /// A view whose reprojection error is larger is an outlier.
    pub(crate) outlier: f64,
}

/// A triangulated point.
#[derive(Debug, Clone)]
pub(crate) struct Fix {
    pub(crate) position: Point3<f64>,
    /// mm², from the noise.
    pub(crate) covariance: Matrix3<f64>,
    /// The variance of a view that the residuals speak for, as a multiple of the noise's: where views disagree by more than noise,
    /// the point is off by more.
    pub(crate) doubt: f64,
    /// Cameras used, with their residuals (seen − projected), px.
    pub(crate) used: Vec<(usize, Vector2<f64>)>,
    /// Cameras left out as outliers, with their residuals; infinite for a point behind the camera.
    pub(crate) dropped: Vec<(usize, Vector2<f64>)>,
}

/// The point that minimises Σ ρ(wᵢ ‖seenᵢ − projectᵢ(x)‖²) with Huber's ρ, by Gauss–Newton from the point nearest to the
/// rays [HartleyZisserman2004, § 12]. While a view is off by more than the scale's outlier, the view without which the rest
/// agrees best is left out. None from fewer than two views that agree, from parallel rays, and for points behind a camera.
pub(crate) fn triangulate_point(sights: &[Sight], scale: Scale) -> Option<Fix> {
    let mut kept = sights.to_vec();
    let mut fit = refine(kept.iter(), scale);
    while kept.len() > 2 && !fit.as_ref().is_some_and(|fit| fit.worst(kept.iter()) <= scale.outlier) {
        let without = |out: usize| {
            let rest = || kept.iter().enumerate().filter(move |(i, _)| *i != out).map(|(_, sight)| sight);
            let fit = refine(rest(), scale)?;
            Some((fit.worst(rest()), out, fit))
        };
        let (_, out, better) = (0..kept.len()).filter_map(without).min_by(|a, b| a.0.total_cmp(&b.0))?;
        kept.remove(out);
        fit = Some(better);
    }
    let fit = fit.filter(|fit| fit.worst(kept.iter()) <= scale.outlier)?;
    let off = |sight: &Sight| fit.residual(sight).unwrap_or(Vector2::repeat(f64::INFINITY));
    let is_kept = |sight: &Sight| kept.iter().any(|kept| kept.camera == sight.camera);
    Some(Fix {
        position: fit.position,
        covariance: fit.information.try_inverse()? * (scale.noise * scale.noise),
        doubt: fit.variance(&kept, scale) / (scale.noise * scale.noise),
        used: kept.iter().filter_map(|sight| Some((sight.camera, fit.residual(sight)?))).collect(),
        dropped: sights.iter().filter(|sight| !is_kept(sight)).map(|s| (s.camera, off(s))).collect(),
    })
}

struct Fit {
    position: Point3<f64>,
    /// Σ w Jᵀ J, without Huber's weights: of the noise that is usual.
    information: Matrix3<f64>,
}

impl Fit {
    fn residual(&self, sight: &Sight) -> Option<Vector2<f64>> {
        Some(sight.pixel - sight.view.pixel(&self.position)?)
    }

    /// Variance of a sure view, px²: of the point's own residuals, and of the spread of all as if it were that of some more.
    fn variance(&self, sights: &[Sight], scale: Scale) -> f64 {
        let square = |sight: &Sight| Some(sight.weight * self.residual(sight)?.norm_squared());
        let squares: f64 = sights.iter().filter_map(square).sum();
        // Three coordinates were fitted.
        let freedom = 2.0 * sights.len() as f64 - 3.0;
        // One less, for what is asked of it is its inverse: so the mean squared error over it is right.
        (PRIOR * scale.spread * scale.spread + squares) / (PRIOR + freedom - 1.0)
    }

    /// Largest reprojection error, px; partly hidden dots may be off by more.
    fn worst<'a>(&self, sights: impl Iterator<Item = &'a Sight<'a>>) -> f64 {
        let off = |sight: &Sight| match self.residual(sight) {
            Some(residual) => residual.norm() * sight.weight.sqrt(),
            None => f64::INFINITY,
        };
        sights.map(off).fold(0.0, f64::max)
    }
}

fn refine<'a>(sights: impl Iterator<Item = &'a Sight<'a>> + Clone, scale: Scale) -> Option<Fit> {
    if !has_parallax(sights.clone()) {
        return None;
    }
    let mut position = nearest_to_lines(sights.clone().map(Sight::ray))?;
    for round in 1..=MAX_STEPS {
        let (normal, right, information) = equations(sights.clone(), &position, scale)?;
        let step = normal.cholesky()?.solve(&right);
        position += step;
        let enough = if round < MAX_STEPS { CONVERGED_MM } else { NEARLY_MM };
        if step.norm() < enough {
            let is_before = |sight: &Sight| sight.ray.dot(&(position - sight.view.eye)) > 0.0;
            return sights.clone().all(is_before).then_some(Fit { position, information });
        }
    }
    None
}

/// Whether two of the rays stand at an angle.
fn has_parallax<'a>(mut sights: impl Iterator<Item = &'a Sight<'a>>) -> bool {
    let parallel = LEAST_ANGLE.cos();
    let first = sights.next().map(|sight| sight.ray);
    // If two rays differ by an angle, one of them differs from the first by half of it at least.
    first.is_some_and(|first| sights.any(|sight| first.dot(&sight.ray).abs() < parallel))
}

/// Σ h w Jᵀ J, Σ h w Jᵀ r and Σ w Jᵀ J with Huber's weights h.
fn equations<'a>(
    sights: impl Iterator<Item = &'a Sight<'a>>,
    position: &Point3<f64>,
    scale: Scale,
) -> Option<(Matrix3<f64>, Vector3<f64>, Matrix3<f64>)> {
    let (mut normal, mut right, mut information) = (Matrix3::zeros(), Vector3::zeros(), Matrix3::zeros());
    for sight in sights {
        let (pixel, slopes) = sight.view.project(position)?;
        let residual = sight.pixel - pixel;
        let size = residual.norm() * sight.weight.sqrt();
        let huber = (HUBER * scale.spread / size.max(f64::MIN_POSITIVE)).min(1.0);
        let square = sight.weight * slopes.tr_mul(&slopes);
        information += square;
        normal += huber * square;
        right += huber * sight.weight * slopes.tr_mul(&residual);
    }
    Some((normal, right, information))
}
