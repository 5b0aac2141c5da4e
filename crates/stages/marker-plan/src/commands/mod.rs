//! The binary's parts: arguments, the list of picks, the picture.

mod sheet;

use anyhow::bail;
use artifact::{Staged, Unit};
use clap::Parser;
use marker_plan::{Params, Plan, plan};
use mesh::Mesh;
use stage::Run;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Skin further from any marker than this, mm, moves on its own between them.
const LARGEST_GAP_MM: f64 = 20.0;
/// Faces further from their mirror images than this, mm, are hardly symmetric.
const LARGEST_ASYMMETRY_MM: f64 = 3.0;

/// Proposes where on a face its markers should be painted
///
/// Reads a scan whose mouth and eyes are open; writes a list of markers (picks, for `rbf-warp correspond`) and a
/// picture for whoever paints them.
#[derive(Parser)]
#[command(name = "marker-plan", version)]
pub(crate) struct Arguments {
    /// The scan (.obj, .ply)
    #[arg(long, value_name = "FILE")]
    mesh: PathBuf,
    /// Unit of the scan's coordinates; there is no default
    #[arg(long, value_name = "mm|cm|m")]
    unit: Option<Unit>,
    /// List of markers to write: marker, vertex, position in the scan's unit, mirror image
    #[arg(long, value_name = "FILE.csv")]
    out: PathBuf,
    /// Picture to write: the face from three sides with numbered dots
    #[arg(long, value_name = "FILE.png")]
    picture: Option<PathBuf>,
    /// Markers in all
    #[arg(long, default_value_t = Params::default().count)]
    count: usize,
    /// Of them beside the edge of the lips: 0, 2 (corners), 4 (and middles) or 8 (and quarter points)
    #[arg(long, default_value_t = Params::default().lip_points)]
    lip_points: usize,
    /// Of them at the edges of the lids: 0, 4 (middles) or 8 (and quarter points of the upper lids)
    #[arg(long, default_value_t = Params::default().lid_points)]
    lid_points: usize,
    /// How many times closer markers stand near the lips than on the cheeks
    #[arg(long, value_name = "TIMES", default_value_t = Params::default().lip_density)]
    lip_density: f64,
    /// The same near the lids
    #[arg(long, value_name = "TIMES", default_value_t = Params::default().lid_density)]
    lid_density: f64,
    /// The same at the throat, the angle of the jaw and before the ears
    #[arg(long, value_name = "TIMES", default_value_t = Params::default().outskirt_density)]
    outskirt_density: f64,
    /// Distance from lips and lids over which that falls off
    #[arg(long, value_name = "MM", default_value_t = Params::default().falloff_mm)]
    falloff_mm: f64,
    /// Least distance between two markers: closer dots merge in the images
    #[arg(long, value_name = "MM", default_value_t = Params::default().least_distance_mm)]
    least_distance_mm: f64,
    /// Least distance from where the scan ends
    #[arg(long, value_name = "MM", default_value_t = Params::default().border_mm)]
    border_mm: f64,
    /// Largest distance between a marker's mirror image and its partner; beyond it the marker stands alone
    #[arg(long, value_name = "MM", default_value_t = Params::default().asymmetry_mm)]
    asymmetry_mm: f64,
    /// Boundary loops shorter than this are holes of the scan, not mouth or eyes
    #[arg(long, value_name = "MM", default_value_t = Params::default().smallest_opening_mm)]
    smallest_opening_mm: f64,
    /// Any vertex on the mouth's rim, where mouth and eyes cannot be told by themselves
    #[arg(long, value_name = "VERTEX", requires = "eyes")]
    mouth: Option<u32>,
    /// Any vertex on each eye's rim
    #[arg(long, value_name = "VERTEX,VERTEX", value_delimiter = ',', num_args = 1, requires = "mouth")]
    eyes: Option<Vec<u32>>,
    #[command(flatten)]
    common: stage::Common,
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

impl Arguments {
    fn params(&self) -> anyhow::Result<Params> {
        let eyes = match self.eyes.as_deref() {
            None => None,
            Some(&[one, other]) => Some([one, other]),
            Some(_) => bail!("--eyes: name two vertices, one on each eye's rim, with a comma between them"),
        };
        Ok(Params {
            count: self.count,
            lip_points: self.lip_points,
            lid_points: self.lid_points,
            lip_density: self.lip_density,
            lid_density: self.lid_density,
            outskirt_density: self.outskirt_density,
            falloff_mm: self.falloff_mm,
            least_distance_mm: self.least_distance_mm,
            border_mm: self.border_mm,
            asymmetry_mm: self.asymmetry_mm,
            smallest_opening_mm: self.smallest_opening_mm,
            mouth: self.mouth,
            eyes,
        })
    }
}

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    let params = arguments.params()?;
    run.parameters(&params)?;
    let (mesh, reference) = run.mesh("mesh", &arguments.mesh, &[("--unit", arguments.unit)])?;
    let outputs: Vec<&Path> = [Some(&arguments.out), arguments.picture.as_ref()]
        .into_iter()
        .flatten()
        .map(PathBuf::as_path)
        .collect();
    run.check_outputs(&outputs)?;
    let plan = run.timed("plan", || plan(&mesh, &params))?;
    report(run, &plan);
    let list = list(&plan, &mesh, reference.unit)?;
    let mut staged: Vec<Staged> = vec![artifact::stage_bytes(&arguments.out, list.as_bytes())?];
    if let Some(path) = &arguments.picture {
        staged.push(run.timed("picture", || sheet::draw(path, &plan, &mesh))?);
    }
    run.publish(staged)
}

fn report(run: &mut Run, plan: &Plan) {
    let rounded = |mm: f64| (mm * 1e3).round() / 1e3;
    run.result("markers", plan.markers.len());
    run.result(
        "pairs",
        plan.markers.iter().enumerate().filter(|(i, marker)| marker.mirror.is_some_and(|m| m > *i)).count(),
    );
    run.result("asymmetry_mm", rounded(plan.asymmetry_mm));
    run.result("least_distance_mm", rounded(plan.least_distance_mm));
    run.result("largest_gap_mm", rounded(plan.largest_gap_mm));
    if plan.asymmetry_mm > LARGEST_ASYMMETRY_MM {
        run.warn(format!(
            "the face is {:.1} mm from its mirror image; the plan may be askew",
            plan.asymmetry_mm
        ));
    }
    if plan.largest_gap_mm > LARGEST_GAP_MM {
        run.warn(format!(
            "some skin is {:.0} mm from the nearest marker; more markers (--count) leave no gap over {LARGEST_GAP_MM:.0} mm",
            plan.largest_gap_mm
        ));
    }
}

/// Picks as `rbf-warp correspond` reads them.
fn list(plan: &Plan, mesh: &Mesh, unit: Unit) -> anyhow::Result<String> {
    let mut text = String::from("marker,vertex,x,y,z,mirror\n");
    for marker in &plan.markers {
        let at = mesh.positions[marker.vertex as usize] / unit.in_mm();
        let mirror = marker.mirror.map_or("", |mirror| plan.markers[mirror].marker.as_str());
        writeln!(text, "{},{},{},{},{},{mirror}", marker.marker, marker.vertex, at.x, at.y, at.z)?;
    }
    Ok(text)
}
