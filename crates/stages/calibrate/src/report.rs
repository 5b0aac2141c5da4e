//! How good a calibration is, in numbers.

use crate::bundle::{Adjusted, Loss};
use crate::joint::Residual;
use artifact::CameraRig;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Cells along x and y that coverage is counted in.
pub const CELLS: [usize; 2] = [8, 6];
/// Weight under which an observation counts as an outlier.
const OUTLIER: f64 = 0.5;

/// What was found, in numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Root mean square reprojection error over all cameras, radial, px; outliers included.
    pub rms_px: f64,
    /// Per camera id.
    pub cameras: BTreeMap<String, CameraReport>,
    /// Instants that were used.
    pub frames: usize,
    /// Observations that were used.
    pub corners: usize,
    /// Observations that count less than half.
    pub outliers: usize,
    /// Views whose corners the detector had numbered from the board's other end.
    pub renumbered_views: usize,
    /// From which length on a residual counts less than its square, px; absent where all count alike.
    pub scale_px: Option<f64>,
    /// Steps of the last adjustment.
    pub steps: usize,
    /// Whether it came to an end.
    pub converged: bool,
}

/// One camera.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CameraReport {
    /// Views of the board.
    pub views: usize,
    /// Corners in them.
    pub corners: usize,
    /// Corners that count less than half.
    pub outliers: usize,
    /// Root mean square reprojection error, radial, px.
    pub rms_px: f64,
    /// Its median.
    pub median_px: f64,
    /// Share of the image's cells (8 × 6) that show at least one corner.
    pub coverage: f64,
}

/// Median residual, px, beyond which a camera is not calibrated whatever the noise.
const MISFIT_PX: f64 = 4.0;

impl Report {
    /// The camera that fits worst, if most of what it saw fits with nothing that the others see: its images are mirrored, say, or
    /// were taken at other times.
    #[must_use]
    pub fn misfit(&self) -> Option<(&String, &CameraReport)> {
        let worst = self.cameras.iter().max_by(|a, b| a.1.median_px.total_cmp(&b.1.median_px));
        worst.filter(|(_, camera)| 2 * camera.outliers > camera.corners || camera.median_px > MISFIT_PX)
    }
}

pub(crate) fn report(
    rig: &CameraRig,
    residuals: &[Residual],
    adjusted: &Adjusted,
    loss: Loss,
    renumbered_views: usize,
) -> Report {
    let camera = |id: &String| {
        let own: Vec<&Residual> = residuals.iter().filter(|residual| residual.camera == *id).collect();
        (id.clone(), camera_report(rig.cameras[id].camera.image_size, &own))
    };
    Report {
        rms_px: adjusted.rms_px,
        cameras: rig.cameras.keys().map(camera).collect(),
        frames: residuals.iter().map(|residual| residual.frame).collect::<BTreeSet<_>>().len(),
        corners: residuals.len(),
        outliers: residuals.iter().filter(|residual| residual.weight < OUTLIER).count(),
        renumbered_views,
        scale_px: loss.scale_px(),
        steps: adjusted.steps,
        converged: adjusted.converged,
    }
}

fn camera_report(image_size: [u32; 2], own: &[&Residual]) -> CameraReport {
    let mut sizes: Vec<f64> = own.iter().map(|residual| residual.error.norm()).collect();
    sizes.sort_by(f64::total_cmp);
    let squares = sizes.iter().fold(0.0, |sum, size| sum + size * size);
    let cells: BTreeSet<[usize; 2]> = own.iter().filter_map(|residual| cell(image_size, residual)).collect();
    CameraReport {
        views: own.iter().map(|residual| residual.frame).collect::<BTreeSet<_>>().len(),
        corners: own.len(),
        outliers: own.iter().filter(|residual| residual.weight < OUTLIER).count(),
        rms_px: (squares / sizes.len().max(1) as f64).sqrt(),
        median_px: sizes.get(sizes.len() / 2).copied().unwrap_or(0.0),
        coverage: cells.len() as f64 / (CELLS[0] * CELLS[1]) as f64,
    }
}

/// The cell of the image that a corner lies in; none outside.
pub(crate) fn cell(image_size: [u32; 2], residual: &Residual) -> Option<[usize; 2]> {
    let at =
        [0, 1].map(|axis| (residual.pixel[axis] + 0.5) / f64::from(image_size[axis]) * CELLS[axis] as f64);
    let is_inside = (0..2).all(|axis| (0.0..CELLS[axis] as f64).contains(&at[axis]));
    is_inside.then(|| at.map(|x| x as usize))
}
