//! Bundle adjustment: cameras and structure that reproject best [TriggsMcLauchlanHartleyFitzgibbon2000].
//!
//! A [`Scene`] holds cameras, the structure they look at (free points, or poses of a rigid body such as a board) and
//! observations. [`adjust`] minimises Σ ρ(‖projection − pixel‖²) by Levenberg–Marquardt [Marquardt1963] with analytic
//! derivatives; the structure is eliminated, so that the dense part has the size of the cameras only.
//!
//! ```
//! use calibrate::bundle::{Element, Free, Observation, Params, Scene, adjust};
//! use camera::{BrownConrady, Camera, Lens};
//! use nalgebra::{Isometry3, Point3, Vector2, Vector3};
//! let lens = Lens { focal_px: Vector2::new(800., 800.), center_px: Vector2::new(320., 240.), distortion: BrownConrady::default() };
//! let at = |x| Camera { image_size: [640, 480], lens, cam_from_world: Isometry3::translation(x, 0., 1000.) };
//! let mut scene = Scene::new(vec![at(0.), at(-300.)], vec![Free::POSE; 2]);
//! for i in 0..12 {
//!     let point = Point3::new(40. * (i % 4) as f64, 60. * (i / 4) as f64, 15. * ((i * 5) % 7) as f64);
//!     let element = scene.structure.len();
//!     for camera in 0..2 {
//!         let pixel = scene.cameras[camera].project(&point).unwrap();
//!         scene.observations.push(Observation { camera, element, point: 0, pixel });
//!     }
//!     scene.structure.push(Element::Point(point + Vector3::new(2., -1., 3.)));
//! }
//! let adjusted = adjust(&scene, &Params::default())?;
//! assert!(adjusted.converged && adjusted.rms_px < 1e-6);
//! # Ok::<(), calibrate::bundle::Error>(())
//! ```

mod error;
mod free;
mod linear;
mod loss;
mod normal;

pub use error::Error;
pub use free::{Focal, Free};
pub use loss::Loss;

use artifact::CameraDeviation;
use camera::Camera;
use free::{CENTER, FOCAL, Gauge, PARAMETERS, SHIFT, TURN};
use linear::{moved_camera, moved_element};
use nalgebra::{Isometry3, Point3, SMatrix, Vector2};
use normal::{Normal, Step};
use serde::{Deserialize, Serialize};

/// What cameras look at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Element {
    /// A point, in world space, mm.
    Point(Point3<f64>),
    /// The scene's rigid body, e.g. the board at one instant.
    Body {
        /// Its pose.
        world_from_body: Isometry3<f64>,
    },
}

/// A point that a camera sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Index of the camera.
    pub camera: usize,
    /// Index of the element of the structure.
    pub element: usize,
    /// Which of the body's points; 0 for a free point.
    pub point: usize,
    /// Where it is seen, px.
    pub pixel: Vector2<f64>,
}

/// Cameras, structure and observations.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The cameras as far as they are known.
    pub cameras: Vec<Camera>,
    /// What may change of each.
    pub free: Vec<Free>,
    /// The points of the rigid body in its own space, mm.
    pub body: Vec<Point3<f64>>,
    /// What is seen, as far as it is known.
    pub structure: Vec<Element>,
    /// Who sees what where.
    pub observations: Vec<Observation>,
}

impl Scene {
    /// Cameras that see nothing yet.
    #[must_use]
    pub fn new(cameras: Vec<Camera>, free: Vec<Free>) -> Self {
        Self { cameras, free, body: Vec::new(), structure: Vec::new(), observations: Vec::new() }
    }

    /// Takes away the observations of points that are not in front of their camera, and says how many: a rough start may
    /// have some.
    pub fn drop_behind(&mut self) -> usize {
        let before = self.observations.len();
        let in_front: Vec<bool> =
            self.observations.iter().map(|seen| self.residual(seen).is_some()).collect();
        let mut keep = in_front.iter();
        self.observations.retain(|_| keep.next() == Some(&true));
        before - self.observations.len()
    }
}

/// Parameters of [`adjust`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Params {
    /// What a residual costs.
    pub loss: Loss,
    /// Whether the structure moves; if not, cameras are fitted to it as it stands.
    pub structure_moves: bool,
    /// Steps at most, rejected ones included.
    pub max_steps: usize,
}

impl Default for Params {
    fn default() -> Self {
        Self { loss: Loss::Squares, structure_moves: true, max_steps: 200 }
    }
}

/// An adjusted scene.
#[derive(Debug, Clone)]
pub struct Adjusted {
    /// The cameras, in the scene's order.
    pub cameras: Vec<Camera>,
    /// The structure, in the scene's order.
    pub structure: Vec<Element>,
    /// projection − pixel per observation, px.
    pub residuals: Vec<Vector2<f64>>,
    /// Root mean square of the residuals' lengths, px; every observation counts alike.
    pub rms_px: f64,
    /// The same per camera; none for a camera that sees nothing.
    pub camera_rms_px: Vec<Option<f64>>,
    /// Standard deviations per camera, from the residuals' spread; what was held has 0. None for all where the observations
    /// do not determine the cameras. Where nothing ties the structure to the world, the first camera that sees something and
    /// may move is held (and, with nothing but free points, the next one's distance from it), and the others' deviations are
    /// relative to it.
    pub deviations: Option<Vec<CameraDeviation>>,
    /// Steps that were tried.
    pub steps: usize,
    /// Whether the cost stopped falling before the steps ran out.
    pub converged: bool,
}

/// Relative fall of the cost under which it has stopped falling; far from a minimum a step of the method brings far more.
const CONVERGED: f64 = 1e-12;
/// Damping at the start, as a share of the diagonal [MadsenNielsenTingleff2004, § 3.2].
const START_DAMPING: f64 = 1e-4;
/// Damping over which no step can help any more.
const MAX_DAMPING: f64 = 1e16;

/// The scene with the cost Σ ρ(‖projection − pixel‖²) at its minimum near the start, over all that is free.
///
/// Levenberg–Marquardt with Nielsen's damping [MadsenNielsenTingleff2004, § 3.2]; a robust loss acts as weights that are
/// renewed with each step. Nothing is drawn by chance: the same scene gives the same bits.
///
/// # Errors
/// If indices are out of range, an element is seen too little to have a place, or at the start a point is not in front of a
/// camera that sees it.
pub fn adjust(scene: &Scene, params: &Params) -> Result<Adjusted, Error> {
    error::check(scene, params.structure_moves)?;
    let mut walk = Walk::start(scene, params)?;
    walk.run();
    Ok(walk.finish())
}

/// The descent.
struct Walk {
    scene: Scene,
    params: Params,
    gauge: Gauge,
    /// Per element its observations, cameras rising.
    order: Vec<Vec<usize>>,
    normal: Normal,
    cost: f64,
    steps: usize,
    converged: bool,
}

impl Walk {
    fn start(scene: &Scene, params: &Params) -> Result<Self, Error> {
        let mut order = vec![Vec::new(); scene.structure.len()];
        for (o, seen) in scene.observations.iter().enumerate() {
            order[seen.element].push(o);
        }
        order.iter_mut().for_each(|seen| seen.sort_by_key(|&o| scene.observations[o].camera));
        let gauge = Gauge::of(scene, params.structure_moves);
        let behind = || error::behind(scene);
        let normal =
            Normal::of(scene, &order, &gauge, params.loss, params.structure_moves).ok_or_else(behind)?;
        let cost = cost(scene, params.loss).ok_or_else(behind)?;
        Ok(Self {
            scene: scene.clone(),
            params: *params,
            gauge,
            order,
            normal,
            cost,
            steps: 0,
            converged: false,
        })
    }

    fn run(&mut self) {
        let (mut damping, mut growth) = (START_DAMPING, 2.0);
        while self.steps < self.params.max_steps && !self.converged && damping < MAX_DAMPING {
            self.steps += 1;
            let step = self.normal.step(damping);
            let tried = step.as_ref().and_then(|step| self.tried(step));
            match (step, tried) {
                (Some(step), Some((scene, cost))) if cost <= self.cost => {
                    let gain = (self.cost - cost) / step.predicted;
                    damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).clamp(1.0 / 3.0, 2.0);
                    growth = 2.0;
                    self.converged = self.cost - cost <= CONVERGED * self.cost || cost == 0.0;
                    self.accept(scene, cost);
                }
                (step, _) => {
                    // A step that promises nothing and gives nothing: this is the minimum, to rounding.
                    self.converged = step.is_some_and(|step| step.predicted.abs() <= CONVERGED * self.cost);
                    damping *= growth;
                    growth *= 2.0;
                }
            }
        }
    }

    fn tried(&self, step: &Step) -> Option<(Scene, f64)> {
        let mut scene = self.scene.clone();
        let cameras = scene.cameras.iter_mut().zip(&step.cameras);
        cameras.for_each(|(camera, step)| *camera = moved_camera(camera, step));
        let elements = scene.structure.iter_mut().zip(&step.elements);
        elements.for_each(|(element, step)| *element = moved_element(element, step));
        let cost = cost(&scene, self.params.loss)?;
        (cost.is_finite() && scene.cameras.iter().all(|camera| camera.lens.focal_px.min() > 0.0))
            .then_some((scene, cost))
    }

    fn accept(&mut self, scene: Scene, cost: f64) {
        let Params { loss, structure_moves, .. } = self.params;
        // The cost was found, so that every point is in front.
        if let Some(normal) = Normal::of(&scene, &self.order, &self.gauge, loss, structure_moves) {
            (self.scene, self.cost, self.normal) = (scene, cost, normal);
        }
    }

    fn finish(self) -> Adjusted {
        let observations = &self.scene.observations;
        let residuals: Vec<Vector2<f64>> =
            observations.iter().map(|seen| self.scene.residual(seen).unwrap_or_default()).collect();
        let of = |c: usize| {
            let seen = observations.iter().zip(&residuals).filter(move |(seen, _)| seen.camera == c);
            root_mean_square(seen.map(|(_, residual)| residual))
        };
        Adjusted {
            camera_rms_px: (0..self.scene.cameras.len()).map(of).collect(),
            rms_px: root_mean_square(residuals.iter()).unwrap_or(0.0),
            deviations: self.deviations(&residuals),
            cameras: self.scene.cameras,
            structure: self.scene.structure,
            residuals,
            steps: self.steps,
            converged: self.converged,
        }
    }

    fn deviations(&self, residuals: &[Vector2<f64>]) -> Option<Vec<CameraDeviation>> {
        let covariance = self.normal.covariance()?;
        let squares = |residual: &Vector2<f64>| {
            let squared = residual.norm_squared();
            self.params.loss.weight(squared) * squared
        };
        let spare =
            (2 * residuals.len()).checked_sub(self.normal.parameter_count()).filter(|spare| *spare > 0)?;
        let variance = residuals.iter().map(squares).sum::<f64>() / spare as f64;
        let of = |c| deviation(&(self.normal.camera_covariance(&covariance, c) * variance));
        Some((0..self.scene.cameras.len()).map(of).collect())
    }
}

fn deviation(covariance: &SMatrix<f64, PARAMETERS, PARAMETERS>) -> CameraDeviation {
    let spread = |i: usize| covariance[(i, i)].max(0.0).sqrt();
    CameraDeviation {
        focal_px: [0, 1].map(|i| spread(FOCAL + i)),
        center_px: [0, 1].map(|i| spread(CENTER + i)),
        rotation_rad: [0, 1, 2].map(|i| spread(TURN + i)),
        translation_mm: [0, 1, 2].map(|i| spread(SHIFT + i)),
    }
}

fn cost(scene: &Scene, loss: Loss) -> Option<f64> {
    scene.observations.iter().map(|seen| Some(loss.cost(scene.residual(seen)?.norm_squared()))).sum()
}

fn root_mean_square<'a>(residuals: impl Iterator<Item = &'a Vector2<f64>>) -> Option<f64> {
    let (sum, count) = residuals.fold((0.0, 0_usize), |(sum, count), r| (sum + r.norm_squared(), count + 1));
    (count > 0).then(|| (sum / count as f64).sqrt())
}
