//! The normal equations, with the structure eliminated [TriggsMcLauchlanHartleyFitzgibbon2000, § 6.1].

use super::free::{Frame, Gauge, PARAMETERS};
use super::linear::ELEMENT;
use super::{Element, Loss, Scene};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, SMatrix};

type CameraBlock = SMatrix<f64, PARAMETERS, PARAMETERS>;
type CameraVector = SMatrix<f64, PARAMETERS, 1>;
type ElementBlock = SMatrix<f64, ELEMENT, ELEMENT>;
type ElementVector = SMatrix<f64, ELEMENT, 1>;
type MixedBlock = SMatrix<f64, PARAMETERS, ELEMENT>;

/// JᵀWJ and −JᵀWr in blocks: U per camera, V per element, W between the two.
pub(super) struct Normal {
    frames: Vec<Frame>,
    /// Where each camera's free parameters start.
    starts: Vec<usize>,
    size: usize,
    cameras: Vec<(CameraBlock, CameraVector)>,
    elements: Vec<ElementEquations>,
}

struct ElementEquations {
    /// How many of its parameters move.
    count: usize,
    block: ElementBlock,
    right: ElementVector,
    /// By camera, in order of the cameras.
    mixed: Vec<(usize, MixedBlock)>,
}

/// A step of all parameters.
pub(super) struct Step {
    pub(super) cameras: Vec<CameraVector>,
    pub(super) elements: Vec<ElementVector>,
    /// By how much the linear model says the cost falls.
    pub(super) predicted: f64,
}

impl Normal {
    /// The equations at the scene as it stands; none where a point is not in front of a camera that sees it.
    pub(super) fn of(
        scene: &Scene,
        order: &[Vec<usize>],
        gauge: &Gauge,
        loss: Loss,
        structure_moves: bool,
    ) -> Option<Self> {
        let frames: Vec<Frame> = (0..scene.cameras.len()).map(|c| gauge.frame(scene, c)).collect();
        let mut starts = Vec::with_capacity(frames.len());
        let mut size = 0;
        for frame in &frames {
            starts.push(size);
            size += frame.count;
        }
        let cameras = vec![(CameraBlock::zeros(), CameraVector::zeros()); frames.len()];
        let mut normal = Self { frames, starts, size, cameras, elements: Vec::with_capacity(order.len()) };
        for (element, seen) in order.iter().enumerate() {
            let count = match scene.structure[element] {
                _ if !structure_moves => 0,
                Element::Point(_) => 3,
                Element::Body { .. } => 6,
            };
            let equations = normal.add(scene, seen, count, loss)?;
            normal.elements.push(equations);
        }
        Some(normal)
    }

    fn add(&mut self, scene: &Scene, seen: &[usize], count: usize, loss: Loss) -> Option<ElementEquations> {
        let (block, right) = (ElementBlock::zeros(), ElementVector::zeros());
        let mut equations = ElementEquations { count, block, right, mixed: Vec::new() };
        for &o in seen {
            let observation = &scene.observations[o];
            let linear = scene.linear(observation)?;
            let weight = loss.weight(linear.residual.norm_squared());
            let camera = observation.camera;
            let by_camera = linear.by_camera * self.frames[camera].directions;
            let (block, right) = &mut self.cameras[camera];
            *block += weight * by_camera.transpose() * by_camera;
            *right -= weight * by_camera.transpose() * linear.residual;
            if count == 0 {
                continue;
            }
            let across = linear.by_element.transpose() * weight;
            equations.block += across * linear.by_element;
            equations.right -= across * linear.residual;
            if equations.mixed.last().is_none_or(|(last, _)| *last != camera) {
                equations.mixed.push((camera, MixedBlock::zeros()));
            }
            if let Some((_, mixed)) = equations.mixed.last_mut() {
                *mixed += (across * by_camera).transpose();
            }
        }
        Some(equations)
    }

    /// The step with the diagonal raised by the share `damping` [Marquardt1963]; none where the equations are singular.
    pub(super) fn step(&self, damping: f64) -> Option<Step> {
        let (reduced, right) = self.reduced(damping)?;
        let free = match self.size {
            0 => DVector::zeros(0),
            _ => scaled_cholesky(reduced)?.solve(&right),
        };
        let local = |c: usize| {
            let mut step = CameraVector::zeros();
            step.rows_mut(0, self.frames[c].count)
                .copy_from(&free.rows(self.starts[c], self.frames[c].count));
            step
        };
        let locals: Vec<CameraVector> = (0..self.frames.len()).map(local).collect();
        let elements = self.elements.iter().map(|e| e.step(&locals, damping)).collect::<Option<Vec<_>>>()?;
        let predicted = self.predicted(&locals, &elements, damping);
        let cameras = locals.iter().zip(&self.frames).map(|(step, frame)| frame.directions * step).collect();
        Some(Step { cameras, elements, predicted })
    }

    /// gᵀδ + λ δᵀDδ: with (H + λD) δ = g the model falls by 2 gᵀδ − δᵀHδ.
    fn predicted(&self, cameras: &[CameraVector], elements: &[ElementVector], damping: f64) -> f64 {
        let of_cameras = self.cameras.iter().zip(cameras).map(|((block, right), step)| {
            right.dot(step) + damping * step.component_mul(&block.diagonal()).dot(step)
        });
        let of_elements = self.elements.iter().zip(elements).map(|(element, step)| {
            element.right.dot(step) + damping * step.component_mul(&element.block.diagonal()).dot(step)
        });
        of_cameras.sum::<f64>() + of_elements.sum::<f64>()
    }

    /// S = U − Σ W V⁻¹ Wᵀ and its right-hand side, over the cameras' free parameters.
    fn reduced(&self, damping: f64) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let mut matrix = DMatrix::zeros(self.size, self.size);
        let mut right = DVector::zeros(self.size);
        for (c, (block, vector)) in self.cameras.iter().enumerate() {
            let (at, n) = (self.starts[c], self.frames[c].count);
            let damped = raised(block, damping);
            matrix.view_mut((at, at), (n, n)).copy_from(&damped.view((0, 0), (n, n)));
            right.rows_mut(at, n).copy_from(&vector.rows(0, n));
        }
        for element in self.elements.iter().filter(|element| element.count > 0 && !element.mixed.is_empty()) {
            let inverse = element.inverse(damping)?;
            for (i, (a, left)) in element.mixed.iter().enumerate() {
                let (at, n) = (self.starts[*a], self.frames[*a].count);
                let product = left * inverse;
                let mut part = right.rows_mut(at, n);
                part -= (product * element.right).rows(0, n);
                for (b, other) in &element.mixed[..=i] {
                    let (bt, m) = (self.starts[*b], self.frames[*b].count);
                    let mut part = matrix.view_mut((at, bt), (n, m));
                    part -= (product * other.transpose()).view((0, 0), (n, m));
                }
            }
        }
        // Cameras come in rising order in each element, so that all went below the diagonal.
        matrix.fill_upper_triangle_with_lower_triangle();
        Some((matrix, right))
    }

    /// The inverse of S: the covariance of the cameras' free parameters over the observations' variance; none where the
    /// observations do not determine them.
    pub(super) fn covariance(&self) -> Option<DMatrix<f64>> {
        if self.size == 0 {
            return Some(DMatrix::zeros(0, 0));
        }
        let (matrix, _) = self.reduced(0.0)?;
        let inverse = scaled_cholesky(matrix)?.inverse();
        inverse.iter().all(|x| x.is_finite()).then_some(inverse)
    }

    /// A camera's part of the covariance, over all of its parameters; what is held has none.
    pub(super) fn camera_covariance(&self, covariance: &DMatrix<f64>, camera: usize) -> CameraBlock {
        let (at, n) = (self.starts[camera], self.frames[camera].count);
        let mut local = CameraBlock::zeros();
        local.view_mut((0, 0), (n, n)).copy_from(&covariance.view((at, at), (n, n)));
        let directions = &self.frames[camera].directions;
        directions * local * directions.transpose()
    }

    /// How many parameters move.
    pub(super) fn parameter_count(&self) -> usize {
        let seen = self.elements.iter().filter(|element| !element.mixed.is_empty());
        self.size + seen.map(|element| element.count).sum::<usize>()
    }
}

impl ElementEquations {
    /// The inverse of the damped block over the parameters that move; zero elsewhere.
    fn inverse(&self, damping: f64) -> Option<ElementBlock> {
        let n = self.count;
        let damped = raised(&self.block, damping);
        let part = DMatrix::from(damped.view((0, 0), (n, n)));
        let mut inverse = ElementBlock::zeros();
        inverse.view_mut((0, 0), (n, n)).copy_from(&scaled_cholesky(part)?.inverse());
        Some(inverse)
    }

    fn step(&self, cameras: &[CameraVector], damping: f64) -> Option<ElementVector> {
        if self.count == 0 || self.mixed.is_empty() {
            return Some(ElementVector::zeros());
        }
        let coupled =
            |sum: ElementVector, (c, mixed): &(usize, MixedBlock)| sum - mixed.transpose() * cameras[*c];
        Some(self.inverse(damping)? * self.mixed.iter().fold(self.right, coupled))
    }
}

fn raised<const N: usize>(block: &SMatrix<f64, N, N>, damping: f64) -> SMatrix<f64, N, N> {
    let mut damped = *block;
    (0..N).for_each(|i| damped[(i, i)] *= 1.0 + damping);
    damped
}

/// D, and the factor of D⁻¹ A D⁻¹ with a unit diagonal: parameters have units as different as pixels and k₃.
struct Scaled {
    factor: Cholesky<f64, Dyn>,
    scale: DVector<f64>,
}

/// Share of itself that a diagonal element must keep in the factor; below it the row depends on those before.
const SINGULAR: f64 = 1e-14;

fn scaled_cholesky(mut matrix: DMatrix<f64>) -> Option<Scaled> {
    let scale = matrix.diagonal().map(f64::sqrt);
    if scale.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
        return None;
    }
    for (j, mut column) in matrix.column_iter_mut().enumerate() {
        column.iter_mut().zip(scale.iter()).for_each(|(x, s)| *x /= s * scale[j]);
    }
    let factor = Cholesky::new(matrix)?;
    let is_singular = factor.l_dirty().diagonal().iter().any(|d| d * d < SINGULAR);
    (!is_singular).then_some(Scaled { factor, scale })
}

impl Scaled {
    fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        self.factor.solve(&right.component_div(&self.scale)).component_div(&self.scale)
    }

    fn inverse(&self) -> DMatrix<f64> {
        let mut inverse = self.factor.inverse();
        for (j, mut column) in inverse.column_iter_mut().enumerate() {
            column.iter_mut().zip(self.scale.iter()).for_each(|(x, s)| *x /= s * self.scale[j]);
        }
        inverse
    }
}
