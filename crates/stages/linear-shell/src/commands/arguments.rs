//! What the user may say.

use anyhow::bail;
use artifact::{Axis, FrameRange, SequenceForm, Unit};
use clap::{Parser, ValueEnum};
use linear_shell::{BowTies, FreeComponents, Model, Params};
use serde::Serialize;
use std::path::PathBuf;

/// Deforms a scan so that it follows marker displacements, as a linear thin shell
///
/// Reads a mesh and `handles`; writes a sequence: a PC2 vertex cache in the mesh's unit and an index
/// (`large-scale`) with its frame numbers.
#[derive(Parser)]
#[command(name = "linear-shell", version)]
pub(crate) struct Arguments {
    /// The scan in its rest pose (.obj, .ply)
    #[arg(long, value_name = "FILE")]
    pub(crate) mesh: PathBuf,
    /// Unit of the mesh's coordinates; where the handles say it, this only checks it
    #[arg(long, value_name = "mm|cm|m")]
    pub(crate) unit: Option<Unit>,
    /// Handle displacements (handles/1); `-` reads standard input
    #[arg(long, value_name = "FILE")]
    pub(crate) handles: PathBuf,
    /// The sequence's index (large-scale/1) to write; the vertex cache stands beside it
    #[arg(long, value_name = "FILE.json")]
    pub(crate) out: PathBuf,
    /// Form of the sequence
    #[arg(long, value_enum, default_value_t = Format::Pc2)]
    pub(crate) format: Format,
    /// The mesh's axis that points up; USD states it
    #[arg(long, value_enum, required_if_eq("format", "usda"))]
    up: Option<UpChoice>,
    /// Vertices to keep still, e.g. the neck (vertex-set/1)
    #[arg(long, value_name = "FILE")]
    pub(crate) held: Option<PathBuf>,
    /// Solve every frame, or take the handles' responses once and combine them
    #[arg(long, value_enum, default_value_t = Mode::Basis)]
    pub(crate) mode: Mode,
    /// The shell's energy
    #[arg(long, value_enum, default_value_t = ModelChoice::Paper)]
    model: ModelChoice,
    /// What displacements are measured from before they bend the shell
    #[arg(long, value_enum, default_value_t = Reference::Rest)]
    pub(crate) reference: Reference,
    /// Stretching stiffness k_s
    #[arg(long, default_value_t = Params::default().stretching)]
    pub(crate) stretching: f64,
    /// Bending stiffness k_b of the paper's model, mm²; only its ratio to the stretching counts
    #[arg(long, default_value_t = Params::default().bending_mm2)]
    pub(crate) bending: f64,
    /// Stiffness k_t against the variation of bending, mm⁴, of the model with soft openings
    #[arg(long, default_value_t = Params::default().variation_mm4)]
    variation: f64,
    /// Share of k_t that is lost at the rims of mouth and eyes
    #[arg(long, value_name = "SHARE", default_value_t = Params::default().softening)]
    softening: f64,
    /// Distance from those rims over which it comes back, mm
    #[arg(long, value_name = "MM", default_value_t = Params::default().softening_width_mm)]
    softening_width: f64,
    /// Boundary loops shorter than this, mm, are holes of the scan, not mouth or eyes
    #[arg(long, value_name = "MM", default_value_t = Params::default().smallest_opening_mm)]
    smallest_opening: f64,
    /// Vertices, at most, that soft openings are solved on; the rest of the scan follows smoothly
    #[arg(long, value_name = "COUNT", default_value_t = Params::default().proxy_vertices)]
    proxy_vertices: usize,
    /// Largest cotangent taken at its word; triangles beyond it are tempered and counted
    #[arg(long, default_value_t = Params::default().cotangent_limit)]
    pub(crate) cotangent_limit: f64,
    /// Parts of the mesh without a handle
    #[arg(long, value_enum, default_value_t = FreeChoice::Refuse)]
    free_components: FreeChoice,
    /// Vertices where fans of triangles meet in a point only
    #[arg(long, value_enum, default_value_t = BowTieChoice::Refuse)]
    bow_ties: BowTieChoice,
    /// Meet every handle softly, with a spring of this stiffness relative to the surface's own (1 = as stiff)
    #[arg(long, value_name = "WEIGHT")]
    pub(crate) soft: Option<f64>,
    /// Frames to make, both ends included
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    pub(crate) frames: Option<FrameRange>,
    /// Continue what an interrupted run left
    #[arg(long)]
    pub(crate) resume: bool,
    /// Folder where elimination orders and response bases are kept, by content
    #[arg(long, value_name = "DIR")]
    pub(crate) cache: Option<PathBuf>,
    /// Write the response basis too (response-basis/1 and a .npy beside it)
    #[arg(long, value_name = "FILE.json")]
    pub(crate) basis: Option<PathBuf>,
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
        if let Some(weight) = self.soft.filter(|weight| !(weight.is_finite() && *weight > 0.0)) {
            bail!("--soft {weight}: the weight must be a positive number");
        }
        if self.out.extension().is_none_or(|ending| ending != "json") {
            bail!("{}: --out names the sequence's index; give it the ending .json", self.out.display());
        }
        if self.resume && artifact::is_standard_stream(&self.handles) {
            bail!("--resume: handles from a pipe cannot be recognised again; give a file");
        }
        Ok(())
    }

    /// The file, or the folder of per-frame files, that holds the samples.
    pub(crate) fn samples(&self) -> PathBuf {
        self.out.with_extension(match self.format {
            Format::Pc2 => "pc2",
            Format::Usda => "usda",
            Format::Obj | Format::Ply | Format::Npy => "",
        })
    }

    /// Every file that will be written.
    pub(crate) fn outputs(&self) -> Vec<PathBuf> {
        let basis = self.basis.iter().flat_map(|basis| [basis.clone(), basis.with_extension("npy")]);
        [self.out.clone(), self.samples()].into_iter().chain(basis).collect()
    }

    pub(crate) fn up(&self) -> Axis {
        match self.up {
            Some(UpChoice::Z) => Axis::Z,
            _ => Axis::Y,
        }
    }

    pub(crate) fn params(&self) -> Params {
        Params {
            model: match self.model {
                ModelChoice::Paper => Model::Paper,
                ModelChoice::SoftOpenings => Model::SoftOpenings,
            },
            variation_mm4: self.variation,
            softening: self.softening,
            softening_width_mm: self.softening_width,
            smallest_opening_mm: self.smallest_opening,
            proxy_vertices: self.proxy_vertices,
            stretching: self.stretching,
            bending_mm2: self.bending,
            cotangent_limit: self.cotangent_limit,
            free_components: match self.free_components {
                FreeChoice::Refuse => FreeComponents::Refuse,
                FreeChoice::Hold => FreeComponents::Hold,
            },
            bow_ties: match self.bow_ties {
                BowTieChoice::Refuse => BowTies::Refuse,
                BowTieChoice::Join => BowTies::Join,
            },
        }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// One vertex cache
    Pc2,
    /// One OBJ per frame, in a folder
    Obj,
    /// One PLY per frame, in a folder
    Ply,
    /// The displacement field, #V × 3 in mm, one NumPy array (float64) per frame, in a folder; in direct mode as
    /// precise as the solve, in basis mode as float32
    Npy,
    /// One USD layer with the points over time
    Usda,
}

impl Format {
    /// How the index names it.
    pub(crate) fn form(self) -> SequenceForm {
        match self {
            Self::Pc2 => SequenceForm::Pc2,
            Self::Obj => SequenceForm::Obj,
            Self::Ply => SequenceForm::Ply,
            Self::Npy => SequenceForm::Npy,
            Self::Usda => SequenceForm::Usda,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Mode {
    /// The handles' responses once; a frame is one dense product
    Basis,
    /// Three substitutions per frame; less memory
    Direct,
}

#[derive(Clone, Copy, ValueEnum)]
enum ModelChoice {
    /// The paper's: stretching and bending
    Paper,
    /// Stretching and the variation of bending, soft around mouth and eyes
    SoftOpenings,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Reference {
    /// From the rest pose
    Rest,
    /// From the affine motion that all handles make in the mean: for takes that were not stabilised
    Affine,
}

#[derive(Clone, Copy, ValueEnum)]
enum UpChoice {
    Y,
    Z,
}

#[derive(Clone, Copy, ValueEnum)]
enum FreeChoice {
    /// Stop and name the part
    Refuse,
    /// Keep it where it is
    Hold,
}

#[derive(Clone, Copy, ValueEnum)]
enum BowTieChoice {
    /// Stop and name the vertex
    Refuse,
    /// Hinge the fans there
    Join,
}
