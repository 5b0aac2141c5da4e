//! `rbf-warp correspond`: picks → correspondence.

use anyhow::Context;
use artifact::Unit;
use artifact::picks::{self, PickPlace};
use rbf_warp::{Place, Snapped, correspond};
use serde::Serialize;
use stage::Run;
use std::path::{Path, PathBuf};

/// Snap picked points to the scan's vertices
#[derive(clap::Args)]
pub(crate) struct Correspond {
    #[command(flatten)]
    scan: stage::MeshOptions,
    /// Points picked on the mesh, in its unit: .pp (MeshLab) or .csv (marker,vertex or marker,x,y,z)
    #[arg(long, value_name = "FILE")]
    picks: PathBuf,
    /// Correspondence to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Refuse a pick that is farther from every vertex, mm
    #[arg(long, value_name = "MM", default_value_t = 3.0, allow_negative_numbers = true, value_parser = super::positive)]
    max_distance_mm: f64,
}

#[derive(Serialize)]
struct Parameters {
    unit: Unit,
    max_distance_mm: f64,
}

impl Correspond {
    pub(crate) fn run(self, run: &mut Run) -> anyhow::Result<()> {
        run.subcommand("correspond");
        let (mesh, reference) = self.scan.read(run)?;
        run.parameters(&Parameters { unit: reference.unit, max_distance_mm: self.max_distance_mm })?;
        let picks = read_picks(&self.picks, reference.unit)?;
        run.input("picks", &self.picks)?;
        let Snapped { correspondence, distances_mm } =
            correspond(&picks, &mesh.positions, reference, self.max_distance_mm).with_context(|| {
                format!("{}: cannot be snapped to {}", self.picks.display(), self.scan.mesh.display())
            })?;
        run.result("pairs", correspondence.pairs.len());
        run.result("largest_distance_mm", distances_mm.iter().copied().fold(0.0, f64::max));
        run.publish(vec![artifact::write_document(&self.out, &correspondence)?])
    }
}

/// Picks of any supported format, in mm.
fn read_picks(path: &Path, unit: Unit) -> anyhow::Result<Vec<(String, Place)>> {
    let place = |place| match place {
        PickPlace::Vertex(vertex) => Place::Vertex(vertex),
        PickPlace::Point(point) => Place::Point(point),
    };
    Ok(picks::read(path, unit)?.into_iter().map(|pick| (pick.marker, place(pick.place))).collect())
}
