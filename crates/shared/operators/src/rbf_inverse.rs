//! The inverse of a smooth map of space: Newton's method per point, on the analytic Jacobian.

use crate::rbf_kernel::BLOCK;
use crate::rbf_map::{RbfMap, put, take, take_jacobian};
use nalgebra::{Matrix3, Point3, Vector3};
use rayon::prelude::*;

/// The search goes on to this fraction of the tolerance: Newton's last step is nearly free, and an inverse that is exact
/// to rounding composes better.
const POLISH: f64 = 1e-3;
/// Longest step, in units of the marker set's radius: farther away the linear model means little.
const LONGEST_STEP: f64 = 0.5;
/// A step that does not help is halved so often, then the search gives up.
const HALVINGS: u32 = 12;
/// Steps of the second attempt, which follows the solution from a center to the point.
const CONTINUATION: usize = 16;

/// Parameters of an inversion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InvertParams {
    /// A point counts as found when c carries it this close to where it should go, mm.
    pub tolerance_mm: f64,
    /// Evaluations per point and attempt.
    pub evaluations: u32,
}

impl Default for InvertParams {
    fn default() -> Self {
        Self { tolerance_mm: 1e-6, evaluations: 40 }
    }
}

impl InvertParams {
    /// Whether the values make sense.
    ///
    /// # Errors
    /// Names the one that does not.
    pub fn check(&self) -> Result<(), String> {
        if !(self.tolerance_mm.is_finite() && self.tolerance_mm > 0.0) {
            return Err(format!("tolerance_mm is {}; it must be positive", self.tolerance_mm));
        }
        match self.evaluations {
            0 => Err("evaluations is 0; it must be positive".to_string()),
            _ => Ok(()),
        }
    }
}

/// Where a point comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preimage {
    /// The point x, mm.
    pub point: Point3<f64>,
    /// ‖c(x) − y‖, mm.
    pub residual_mm: f64,
    /// det ∂c/∂x there; not positive = the warp is folded over.
    pub determinant: f64,
}

/// c⁻¹: from face space to mocap space.
#[derive(Debug, Clone)]
pub struct Inverse {
    forward: RbfMap,
    backward: RbfMap,
    anchors: Vec<Anchor>,
    params: InvertParams,
}

/// A center and its image (mm): a preimage that is known.
#[derive(Debug, Clone, Copy, Default)]
struct Anchor {
    center: Vector3<f64>,
    image: Vector3<f64>,
}

impl Anchor {
    /// Of all centers that are not on a folded-over sheet, or of all where every one is.
    fn of(map: &RbfMap) -> Vec<Self> {
        let (mut upright, mut all) = (Vec::new(), Vec::new());
        for center in map.centers() {
            let (image, jacobian) = map.with_jacobian(&center);
            let anchor = Self { center: map.normalised(&center), image: image.coords };
            all.push(anchor);
            if jacobian.determinant() > 0.0 {
                upright.push(anchor);
            }
        }
        if upright.is_empty() { all } else { upright }
    }
}

impl Inverse {
    /// The inverse of `forward`; `backward` is where the search starts.
    #[must_use]
    pub fn of(forward: RbfMap, backward: RbfMap, params: InvertParams) -> Self {
        let anchors = Anchor::of(&forward);
        Self { forward, backward, anchors, params }
    }

    /// Whether a preimage is close enough to be one.
    #[must_use]
    pub fn is_found(&self, preimage: &Preimage) -> bool {
        preimage.residual_mm <= self.params.tolerance_mm
    }

    /// Preimages of points, mm → mm.
    ///
    /// Newton's method on c(x) = y with halved steps, started from the interpolant fitted the other way round. Points where it fails or
    /// ends on a folded-over sheet are tried once more by continuation from the nearest center. Where that fails too
    /// (y may have no preimage), the closest point found is returned with its residual: ask [`Inverse::is_found`].
    /// The result does not depend on the number of threads.
    #[must_use]
    pub fn preimages(&self, points: &[Point3<f64>]) -> Vec<Preimage> {
        points.par_chunks(BLOCK).flat_map_iter(|block| self.block(block)).collect()
    }

    fn block(&self, points: &[Point3<f64>]) -> Vec<Preimage> {
        let targets: Vec<Vector3<f64>> = points.iter().map(|point| point.coords).collect();
        let mut starts = points.to_vec();
        self.backward.map_all(&mut starts);
        let starts: Vec<_> = starts.iter().map(|start| self.forward.normalised(start)).collect();
        let mut found = self.newton(&targets, &starts);
        let failed: Vec<usize> = (0..points.len()).filter(|&i| !self.is_good(&found[i])).collect();
        if !failed.is_empty() {
            let targets: Vec<_> = failed.iter().map(|&i| targets[i]).collect();
            let again = self.continuation(&targets);
            for (&i, again) in failed.iter().zip(again) {
                if self.is_better(&again, &found[i]) {
                    found[i] = again;
                }
            }
        }
        found.iter().map(|search| self.preimage(search)).collect()
    }

    fn preimage(&self, search: &Search) -> Preimage {
        Preimage {
            point: self.forward.restored(&search.best),
            residual_mm: search.residual.norm(),
            determinant: search.jacobian.determinant() / self.forward.scale().powi(3),
        }
    }

    fn converged(&self, search: &Search) -> bool {
        search.residual.norm() <= self.params.tolerance_mm
    }

    fn is_good(&self, search: &Search) -> bool {
        self.converged(search) && search.jacobian.determinant() > 0.0
    }

    fn is_better(&self, a: &Search, b: &Search) -> bool {
        let rank = |search: &Search| (self.converged(search), search.jacobian.determinant() > 0.0);
        match rank(a).cmp(&rank(b)) {
            std::cmp::Ordering::Equal => a.residual.norm() < b.residual.norm(),
            order => order.is_gt(),
        }
    }

    /// Follows the preimage along the straight line from the image of the nearest anchor.
    fn continuation(&self, targets: &[Vector3<f64>]) -> Vec<Search> {
        let nearest = |target: &Vector3<f64>| {
            let distance = |anchor: &Anchor| (anchor.image - target).norm_squared();
            let nearer = |a: &&Anchor, b: &&Anchor| distance(a).total_cmp(&distance(b));
            self.anchors.iter().min_by(nearer).copied().unwrap_or_default()
        };
        let from: Vec<Anchor> = targets.iter().map(nearest).collect();
        let mut at: Vec<Vector3<f64>> = from.iter().map(|anchor| anchor.center).collect();
        for step in 1..CONTINUATION {
            let share = step as f64 / CONTINUATION as f64;
            let way: Vec<_> =
                targets.iter().zip(&from).map(|(target, anchor)| anchor.image.lerp(target, share)).collect();
            at = self.newton(&way, &at).into_iter().map(|search| search.best).collect();
        }
        self.newton(targets, &at)
    }

    /// All searches of a block side by side: one batched evaluation per round.
    fn newton(&self, targets: &[Vector3<f64>], starts: &[Vector3<f64>]) -> Vec<Search> {
        let goal = self.params.tolerance_mm * POLISH;
        let mut searches: Vec<Search> =
            targets.iter().zip(starts).map(|(target, start)| Search::new(*target, *start)).collect();
        let mut active: Vec<usize> = (0..searches.len()).collect();
        let mut at = [[0.0; BLOCK]; 3];
        let mut out = [[0.0; BLOCK]; 12];
        for _ in 0..self.params.evaluations {
            active.iter().enumerate().for_each(|(lane, &i)| put(&mut at, lane, &searches[i].trial));
            self.forward.terms().values_and_derivatives(&at, active.len(), &mut out);
            for (lane, &i) in active.iter().enumerate() {
                searches[i].advance(take(&out, lane), take_jacobian(&out, lane), goal);
            }
            active.retain(|&i| !searches[i].done);
            if active.is_empty() {
                break;
            }
        }
        searches
    }
}

/// The search for one point, in centred and scaled coordinates.
struct Search {
    target: Vector3<f64>,
    /// Best point so far, what is missing there (mm), and the Jacobian there (mm).
    best: Vector3<f64>,
    residual: Vector3<f64>,
    jacobian: Matrix3<f64>,
    /// Newton's step from there, and the point to try next.
    step: Vector3<f64>,
    trial: Vector3<f64>,
    halvings: u32,
    done: bool,
}

impl Search {
    fn new(target: Vector3<f64>, start: Vector3<f64>) -> Self {
        Self {
            target,
            best: start,
            residual: Vector3::repeat(f64::INFINITY),
            jacobian: Matrix3::zeros(),
            step: Vector3::zeros(),
            trial: start,
            halvings: 0,
            done: false,
        }
    }

    /// Takes in value and Jacobian at the trial point: a better one becomes the base of the next step, a worse one halves
    /// the step.
    fn advance(&mut self, value: Vector3<f64>, jacobian: Matrix3<f64>, goal: f64) {
        let residual = self.target - value;
        // A value that is no number is no improvement.
        let improved = residual.norm_squared() < self.residual.norm_squared();
        if !improved {
            self.halvings += 1;
            self.step *= 0.5;
            self.trial = self.best + self.step;
            self.done = self.halvings > HALVINGS;
            return;
        }
        (self.best, self.residual, self.jacobian, self.halvings) = (self.trial, residual, jacobian, 0);
        if residual.norm() <= goal {
            self.done = true;
            return;
        }
        match newton_step(&jacobian, &residual) {
            Some(step) => {
                self.step = step;
                self.trial = self.best + step;
            }
            None => self.done = true,
        }
    }
}

fn newton_step(jacobian: &Matrix3<f64>, residual: &Vector3<f64>) -> Option<Vector3<f64>> {
    let step = jacobian.lu().solve(residual)?;
    let length = step.norm();
    length.is_finite().then(|| if length > LONGEST_STEP { step * (LONGEST_STEP / length) } else { step })
}
