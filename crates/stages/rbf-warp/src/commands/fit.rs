//! `rbf-warp fit`: markers + correspondence + scan → warp.

use anyhow::{Context, bail};
use artifact::{Correspondence, HeadTrajectories, Unit, WarpFit};
use rbf_warp::{Degree, FitParams, FittedWarp, RestFrame, Source, fit_warp};
use serde::Serialize;
use stage::Run;
use std::path::PathBuf;

/// Fit the warp from mocap space to face space
#[derive(clap::Args)]
pub(crate) struct Fit {
    /// Markers in head space: head-trajectories (.jsonl, - for standard input), .c3d, .trc or .csv
    #[arg(long, value_name = "FILE")]
    markers: PathBuf,
    /// Unit of the markers, where their file may not say it
    #[arg(long, value_name = "mm|cm|m")]
    marker_unit: Option<Unit>,
    /// Which vertex each marker sits on
    #[arg(long, value_name = "FILE")]
    correspondence: PathBuf,
    /// The scan that was picked on
    #[arg(long, value_name = "FILE")]
    mesh: PathBuf,
    /// Unit of the scan's coordinates; the correspondence says it too
    #[arg(long, value_name = "mm|cm|m")]
    unit: Option<Unit>,
    /// Take manifest; says the scan's unit, and to which session the warp belongs
    #[arg(long, value_name = "FILE")]
    take: Option<PathBuf>,
    /// Frame whose expression is that of the scan [auto: the one that a similarity carries closest to it]
    #[arg(long, value_name = "N|auto", default_value = "auto", allow_hyphen_values = true)]
    rest_frame: RestFrame,
    /// Polynomial part: quadratic (from 10 markers on), linear (from 4) or auto
    #[arg(long, value_name = "DEGREE", default_value = "quadratic")]
    degree: Degree,
    /// A marker missing at rest is taken from frames this far away at most
    #[arg(long, value_name = "FRAMES", default_value_t = FitParams::default().fill_frames, allow_negative_numbers = true)]
    fill_frames: u32,
    /// Look for folds on the scan this far from the markers, mm
    #[arg(long, value_name = "MM", default_value_t = FitParams::default().near_mm, allow_negative_numbers = true, value_parser = super::from_zero)]
    near_mm: f64,
    /// Warp to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(Serialize)]
struct Parameters {
    #[serde(flatten)]
    params: FitParams,
    /// As the user stated it; absent where the file's own word is taken.
    marker_unit: Option<Unit>,
}

impl Fit {
    pub(crate) fn run(self, run: &mut Run) -> anyhow::Result<()> {
        run.subcommand("fit");
        let params = self.params();
        run.parameters(&Parameters { params, marker_unit: self.marker_unit })?;
        let take = self.take.as_deref().map(|take| stage::load_take(run, take)).transpose()?;
        let correspondence: Correspondence = artifact::read_document(&self.correspondence)?;
        run.input("correspondence", &self.correspondence)?;
        let stated = [
            ("--unit", self.unit),
            ("the take manifest", take.as_ref().map(|(take, _)| take.mesh_unit)),
            ("the correspondence", Some(correspondence.mesh.unit)),
        ];
        let (mesh, reference) = run.mesh("mesh", &self.mesh, &stated)?;
        if let Some(mismatch) = correspondence.mesh.mismatch(&reference) {
            let file = self.correspondence.display();
            bail!("{file}: {mismatch}\n  to do: give the mesh that was picked on, or pick again on this one");
        }
        let trajectories = run.markers::<HeadTrajectories>(&self.markers, self.marker_unit)?;
        let take = take.map(|(_, reference)| reference);
        let take = super::agreed_take(&self.markers, trajectories.header.take.as_ref(), take)?;
        let source = Source { trajectories: run.input("markers", &self.markers)?, take };
        let fitted = run
            .timed("fit", || fit_warp(&trajectories, source, &correspondence, &mesh.positions, &params))
            .with_context(|| format!("{}: no warp onto {}", self.markers.display(), self.mesh.display()))?;
        report(run, &fitted);
        run.publish(vec![artifact::write_document(&self.out, &fitted.warp)?])
    }

    fn params(&self) -> FitParams {
        FitParams {
            degree: self.degree,
            rest_frame: self.rest_frame,
            fill_frames: self.fill_frames,
            near_mm: self.near_mm,
        }
    }
}

fn report(run: &mut Run, fitted: &FittedWarp) {
    fitted.warnings.iter().for_each(|warning| run.warn(warning.to_string()));
    let WarpFit { leave_one_out_mm, similarity_residual_mm, .. } = &fitted.warp.fit;
    let fit = &fitted.warp.fit;
    run.result("markers", fitted.warp.markers.len());
    run.result("rest_frame", fitted.warp.rest_frame);
    run.result("polynomial_rank", fit.polynomial_rank);
    run.result("condition", fit.condition);
    run.result("similarity_rms_mm", fit.similarity_rms_mm);
    run.result("similarity_scale", fit.similarity_scale);
    run.result("smallest_determinant", fit.smallest_determinant);
    let mut errors: Vec<(f64, &String)> = leave_one_out_mm.iter().map(|(id, error)| (*error, id)).collect();
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    if let Some((error, marker)) = errors.last() {
        run.result("leave_one_out_median_mm", errors[errors.len() / 2].0);
        run.result("leave_one_out_worst_mm", error);
        run.result("leave_one_out_worst_marker", marker);
    }
    run.result("leave_one_out_mm", leave_one_out_mm);
    run.result("similarity_residual_mm", similarity_residual_mm);
    run.result("leave_one_out_undefined", &fitted.irreplaceable);
    run.result("left_out", &fit.left_out);
}
