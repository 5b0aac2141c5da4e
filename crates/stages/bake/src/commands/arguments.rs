//! What the user may say.

use artifact::{GreenAxis, Unit};
use bake::Params;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, Parser};
use std::path::PathBuf;

/// Bake a wrinkled mesh into normal and displacement maps of a low-resolution mesh
///
/// Both must lie on each other. A single wrinkled mesh is given by `--high`; a frame of a sequence by `--mesh`, `--wrinkled` and
/// `--frame`. A low-resolution mesh in the neutral pose is moved along with `--large-scale` first.
#[derive(Parser)]
#[command(version, override_usage = "bake --low FILE --high FILE --unit UNIT --out FOLDER\n       \
          bake --low FILE --mesh FILE --wrinkled FILE --frame N [--large-scale FILE] --out FOLDER",
          group = ArgGroup::new("relief").required(true).args(["high", "wrinkled"]))]
pub(crate) struct Arguments {
    /// Low-resolution mesh with texture coordinates (.obj), or a skinned character where it was bound (.glb, .gltf); normals in the
    /// file are not read: skin is smooth, but for smoothing groups
    #[arg(long, value_name = "FILE")]
    pub(crate) low: PathBuf,
    /// Unit of the low-resolution mesh [default: that of the wrinkled one; m for .glb and .gltf]
    #[arg(long, value_name = "UNIT")]
    pub(crate) low_unit: Option<Unit>,
    /// Mesh of the character that is baked onto [default: that of the most vertices]
    #[arg(long, value_name = "NAME")]
    pub(crate) low_mesh: Option<String>,
    /// Wrinkled mesh (.obj, .ply)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["mesh", "frame", "large_scale"])]
    pub(crate) high: Option<PathBuf>,
    /// Unit of the meshes' coordinates: mm, cm or m
    #[arg(long)]
    pub(crate) unit: Option<Unit>,
    /// Rest mesh of the sequence (.obj, .ply)
    #[arg(long, value_name = "FILE", requires = "wrinkled")]
    pub(crate) mesh: Option<PathBuf>,
    /// Wrinkled sequence (wrinkled.json)
    #[arg(long, value_name = "FILE", requires_all = ["mesh", "frame"])]
    pub(crate) wrinkled: Option<PathBuf>,
    /// Frame of the sequence
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(crate) frame: Option<i64>,
    /// Sequence without wrinkles (large-scale.json): moves the low-resolution mesh from the rest pose to that of the frame
    #[arg(long, value_name = "FILE", requires = "wrinkled")]
    pub(crate) large_scale: Option<PathBuf>,
    /// Folder to write to: maps.json, and per UDIM tile a normal map (PNG) and a displacement map (OpenEXR, PNG of 16 bits)
    #[arg(long, value_name = "FOLDER")]
    pub(crate) out: PathBuf,
    /// Texels in a row and rows of each map
    #[arg(long, value_name = "N", default_value_t = Params::default().size)]
    pub(crate) size: usize,
    /// Samples in a row and rows within a texel
    #[arg(long, value_name = "N", default_value_t = Params::default().samples)]
    pub(crate) samples: usize,
    /// How far from the low-resolution mesh the wrinkled surface is looked for, to both sides
    #[arg(long, value_name = "MM", default_value_t = Params::default().reach_mm)]
    pub(crate) reach_mm: f64,
    /// By how many texels the maps grow beyond the edges of what is unwrapped
    #[arg(long, value_name = "N", default_value_t = Params::default().padding)]
    pub(crate) padding: usize,
    /// Which way green points
    #[arg(long, value_name = "GREEN", default_value = "opengl", value_parser = green())]
    pub(crate) green: GreenAxis,
    /// Bits of the normal maps
    #[arg(long, value_name = "BITS", value_parser = ["8", "16"], default_value = "16")]
    pub(crate) bits: String,
    /// Also write the tangent of each corner, triangle after triangle (.npy, 3F x 4: x, y, z and the bitangent's sign)
    #[arg(long, value_name = "FILE")]
    pub(crate) tangents: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) common: stage::Common,
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

/// The ways that green may point, for the help.
fn green() -> impl TypedValueParser<Value = GreenAxis> {
    let known = [
        PossibleValue::new("opengl").help("Up in the picture (Blender, Unity, glTF)"),
        PossibleValue::new("directx").help("Down in the picture (Unreal)"),
    ];
    PossibleValuesParser::new(known).try_map(|name| name.parse::<GreenAxis>())
}
