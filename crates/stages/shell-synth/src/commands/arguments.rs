//! What the user may say.

use anyhow::bail;
use artifact::{FrameRange, Unit};
use clap::{Parser, ValueEnum};
use shell_synth::{Params, Solver, Track};
use std::path::PathBuf;

/// Adds measured wrinkles to an animated face mesh, and lets a nonlinear thin shell raise the bulges between them
///
/// Reads the scan, a sequence without wrinkles (`large-scale`) and valley curves on the scan (`valleys`), at the sequence's
/// rate or less often; writes the sequence with wrinkles (`wrinkled`): a PC2 vertex cache in the mesh's unit and an index.
#[derive(Parser)]
#[command(name = "shell-synth", version)]
pub(crate) struct Arguments {
    /// The scan in its rest pose (.obj, .ply)
    #[arg(long, value_name = "FILE")]
    pub(crate) mesh: PathBuf,
    /// Unit of the mesh's coordinates; the sequence says it, so this only checks it
    #[arg(long, value_name = "mm|cm|m")]
    pub(crate) unit: Option<Unit>,
    /// The sequence without wrinkles (large-scale/1)
    #[arg(long, value_name = "FILE.json")]
    pub(crate) large_scale: PathBuf,
    /// Valley curves on the scan (valleys/1)
    #[arg(long, value_name = "FILE")]
    pub(crate) valleys: PathBuf,
    /// The index of the sequence with wrinkles (wrinkled/1) to write; the vertex cache stands beside it
    #[arg(long, value_name = "FILE.json")]
    pub(crate) out: PathBuf,
    /// Write per frame and region how the solve went, as a table
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) report: Option<PathBuf>,
    /// Halve edges where the mesh is too coarse for a valley, and write the finer scan here (.obj, .ply); the sequence then is of that
    /// mesh. Its first vertices are the scan's; a table beside it (.csv) names for each other one the two that it is the middle of
    #[arg(long, value_name = "FILE")]
    pub(crate) refine: Option<PathBuf>,
    /// Edges across a valley (2 w) that --refine makes, at least
    #[arg(long, value_name = "COUNT", default_value_t = 6.0)]
    pub(crate) refine_edges: f64,
    /// Where other options' defaults come from; `paper` is the published method
    #[arg(long, value_enum, default_value_t = Preset::Default)]
    preset: Preset,
    /// How the energy is minimised
    #[arg(long, value_enum)]
    solver: Option<SolverChoice>,
    /// How far a valley's vertices slide towards the crease, 0 (along the normal only) to 1 (walls as long as at rest)
    /// [default: 0.6; preset paper: 0]
    #[arg(long, value_name = "SHARE")]
    slide: Option<f64>,
    /// What becomes of creases that wander over the skin
    #[arg(long, value_enum)]
    track: Option<TrackChoice>,
    /// Stiffness of edges k_e, per mm [default: 300]
    #[arg(long, value_name = "K")]
    edge_stiffness: Option<f64>,
    /// Stiffness of dihedral angles k_b [default: 20; preset paper: 2]
    #[arg(long, value_name = "K")]
    bending_stiffness: Option<f64>,
    /// Stiffness of areas k_a, per mm² [default: 30000]
    #[arg(long, value_name = "K")]
    area_stiffness: Option<f64>,
    /// Share of its stiffness with which the skin resists being stretched or shortened as the large-scale motion does
    /// [default: 0.005; preset paper: 1]
    #[arg(long, value_name = "SHARE")]
    resistance: Option<f64>,
    /// How far a valley reaches, in its widths
    #[arg(long, value_name = "WIDTHS", default_value_t = Params::default().influence_widths)]
    influence_widths: f64,
    /// … and at most, mm
    #[arg(long, value_name = "MM", default_value_t = Params::default().influence_mm)]
    influence: f64,
    /// Depth, mm, below which a valley loses its hold of the skin, so that wrinkles come and go without a jump
    #[arg(long, value_name = "MM", default_value_t = Params::default().fade_depth_mm)]
    fade_depth: f64,
    /// Step of a vertex, mm, at which the solve stops
    #[arg(long, value_name = "MM", default_value_t = Params::default().step_mm)]
    step: f64,
    /// Edge length of the coarse level, mm
    #[arg(long, value_name = "MM", default_value_t = Params::default().coarse_edge_mm)]
    coarse_edge: f64,
    /// Longest gap, in frames, that valleys are interpolated over
    #[arg(long, value_name = "FRAMES", default_value_t = Params::default().longest_gap)]
    longest_gap: u32,
    /// Keep both sides of a fold from going through each other, where a deep valley closes
    #[arg(long)]
    self_contact: bool,
    /// Start every frame anew, never from the one before
    #[arg(long)]
    cold: bool,
    /// Frames to make, both ends included
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    pub(crate) frames: Option<FrameRange>,
    /// Continue what an interrupted run left
    #[arg(long)]
    pub(crate) resume: bool,
    #[command(flatten)]
    common: stage::Common,
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

impl Arguments {
    /// Refuses what clap cannot see.
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        if self.out.extension().is_none_or(|ending| ending != "json") {
            bail!("{}: --out names the sequence's index; give it the ending .json", self.out.display());
        }
        if !(2.0..=32.0).contains(&self.refine_edges) {
            bail!("--refine-edges: {} is not between 2 and 32", self.refine_edges);
        }
        if self.resume && artifact::is_standard_stream(&self.valleys) {
            bail!("--resume: valleys from a pipe cannot be recognised again; give a file");
        }
        Ok(())
    }

    /// Every file that will be written.
    pub(crate) fn outputs(&self) -> Vec<PathBuf> {
        let finer = self.refine.iter().flat_map(|path| [path.clone(), path.with_extension("csv")]);
        [self.out.clone(), self.samples()].into_iter().chain(self.report.clone()).chain(finer).collect()
    }

    /// The vertex cache.
    pub(crate) fn samples(&self) -> PathBuf {
        self.out.with_extension("pc2")
    }

    pub(crate) fn params(&self) -> Params {
        let preset = match self.preset {
            Preset::Default => Params::default(),
            Preset::Paper => Params::paper(),
        };
        Params {
            edge_stiffness: self.edge_stiffness.unwrap_or(preset.edge_stiffness),
            bending_stiffness: self.bending_stiffness.unwrap_or(preset.bending_stiffness),
            area_stiffness: self.area_stiffness.unwrap_or(preset.area_stiffness),
            solver: self.solver.map_or(preset.solver, |choice| match choice {
                SolverChoice::CoarseToFine => Solver::CoarseToFine,
                SolverChoice::Paper => Solver::Paper,
            }),
            slide: self.slide.unwrap_or(preset.slide),
            track: self.track.map_or(preset.track, |choice| match choice {
                TrackChoice::Steady => Track::Steady,
                TrackChoice::AsFound => Track::AsFound,
            }),
            resistance: self.resistance.unwrap_or(preset.resistance),
            influence_widths: self.influence_widths,
            influence_mm: self.influence,
            fade_depth_mm: self.fade_depth,
            step_mm: self.step,
            coarse_edge_mm: self.coarse_edge,
            longest_gap: self.longest_gap,
            warm_start: preset.warm_start && !self.cold,
            self_contact: self.self_contact,
            ..preset
        }
    }
}

#[derive(Clone, Copy, ValueEnum)]
enum Preset {
    /// What is best on faces whose true surface is known
    Default,
    /// The paper's solver, k_b = 2, vertices moved along normals only, creases as they were found
    Paper,
}

#[derive(Clone, Copy, ValueEnum)]
enum SolverChoice {
    /// Coarse to fine, until steps are small
    CoarseToFine,
    /// Gauss–Newton on the mesh itself until the energy falls by less than 1e-5 of itself; k_e whatever the edge length
    Paper,
}

#[derive(Clone, Copy, ValueEnum)]
enum TrackChoice {
    /// Each crease stays in one place of the skin, at the median of where it was found
    Steady,
    /// Each crease is where it was found
    AsFound,
}
