//! `rbf-warp apply`: points through the warp, or back.

use anyhow::bail;
use artifact::{Unit, Warp};
use mesh::Mesh;
use operators::{InvertParams, Preimage, RbfMap};
use rbf_warp::{inverse_of, map_of};
use serde::Serialize;
use stage::Run;
use std::path::PathBuf;

/// Points that the summary lists.
const LISTED: usize = 1000;

/// Map the points of a mesh from mocap space to face space, or back
#[derive(clap::Args)]
pub(crate) struct Apply {
    /// The warp
    #[arg(long, value_name = "FILE")]
    warp: PathBuf,
    /// Mesh whose vertices are mapped (.obj, .ply)
    #[arg(long, value_name = "FILE")]
    points: PathBuf,
    /// Unit of its coordinates, and of those that are written
    #[arg(long, value_name = "mm|cm|m")]
    unit: Option<Unit>,
    /// Map from face space back to mocap space
    #[arg(long)]
    inverse: bool,
    /// Back: a point is found when the warp carries it this close to where it should go, mm
    #[arg(long, value_name = "MM", default_value_t = InvertParams::default().tolerance_mm, allow_negative_numbers = true, value_parser = super::positive, requires = "inverse")]
    tolerance_mm: f64,
    /// Back: write the closest place where no preimage is found, instead of failing
    #[arg(long, requires = "inverse")]
    keep_unconverged: bool,
    /// Mesh to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

#[derive(Serialize)]
struct Parameters {
    unit: Unit,
    inverse: bool,
    keep_unconverged: bool,
    invert: Newton,
}

#[derive(Serialize)]
struct Newton {
    tolerance_mm: f64,
    evaluations: u32,
}

impl Apply {
    pub(crate) fn run(self, run: &mut Run) -> anyhow::Result<()> {
        run.subcommand("apply");
        let warp: Warp = artifact::read_document(&self.warp)?;
        run.input("warp", &self.warp)?;
        let (mut mesh, reference) = run.mesh("points", &self.points, &[("--unit", self.unit)])?;
        if warp.mesh.file.sha256 == reference.file.sha256
            && let Some(mismatch) = warp.mesh.mismatch(&reference)
        {
            bail!("{}: {mismatch}\n  to do: say the unit that the file is in", self.warp.display());
        }
        let invert = InvertParams { tolerance_mm: self.tolerance_mm, ..InvertParams::default() };
        invert.check().map_err(anyhow::Error::msg)?;
        let InvertParams { tolerance_mm, evaluations } = invert;
        let newton = Newton { tolerance_mm, evaluations };
        let (inverse, keep_unconverged) = (self.inverse, self.keep_unconverged);
        run.parameters(&Parameters { unit: reference.unit, inverse, keep_unconverged, invert: newton })?;
        run.result("points", mesh.positions.len());
        run.result("instruction_set", RbfMap::instruction_set());
        if self.inverse {
            self.invert(run, &warp, &mut mesh, invert)?;
        } else {
            let map = map_of(&warp.face_from_mocap);
            run.timed("evaluate", || map.map_all(&mut mesh.positions));
        }
        run.publish(vec![artifact::write_mesh(&self.out, &mesh, reference.unit)?])
    }

    fn invert(
        &self,
        run: &mut Run,
        warp: &Warp,
        mesh: &mut Mesh,
        params: InvertParams,
    ) -> anyhow::Result<()> {
        let inverse = inverse_of(warp, params);
        let found = run.timed("invert", || inverse.preimages(&mesh.positions));
        let lost: Vec<usize> = (0..found.len()).filter(|&i| !inverse.is_found(&found[i])).collect();
        let worst = |preimages: &mut dyn Iterator<Item = &Preimage>| {
            preimages.map(|preimage| preimage.residual_mm).fold(0.0, f64::max)
        };
        let worst_found = worst(&mut found.iter().filter(|preimage| inverse.is_found(preimage)));
        let worst_lost = worst(&mut lost.iter().map(|&i| &found[i]));
        let folded = found.iter().filter(|preimage| preimage.determinant <= 0.0).count();
        run.result("residual_mm", worst_found);
        run.result("unconverged", lost.len());
        run.result("unconverged_worst_mm", worst_lost);
        run.result("unconverged_vertices", &lost[..lost.len().min(LISTED)]);
        run.result("folded", folded);
        if folded > 0 {
            run.warn(format!("the warp is folded over at {folded} of {} points", found.len()));
        }
        if !lost.is_empty() {
            let some: Vec<String> = lost.iter().take(5).map(ToString::to_string).collect();
            let what = format!(
                "{} of {} points have no preimage within {} mm (worst: {worst_lost:.3e} mm), e.g. vertices {}",
                lost.len(),
                found.len(),
                params.tolerance_mm,
                some.join(", ")
            );
            if !self.keep_unconverged {
                let points = self.points.display();
                bail!(
                    "{points}: {what}\n  to do: leave out what is far from the markers, or say --keep-unconverged"
                );
            }
            run.warn(what);
        }
        mesh.positions.iter_mut().zip(&found).for_each(|(point, found)| *point = found.point);
        Ok(())
    }
}
