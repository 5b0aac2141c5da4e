//! What the user may say.

use clap::{ArgGroup, Parser};
use scan_refine::Params;
use std::path::PathBuf;

/// Refine a scan by measured normals: its shape at large stays, its relief becomes that of the normals
///
/// Maps hold n = 2c - 1 and are read as plain data, never as sRGB; v grows upwards in the picture. Black, white and mid-grey
/// texels are unset.
#[derive(Parser)]
#[command(version, override_usage = "scan-refine --mesh FILE --unit UNIT --out FILE <NORMALS>…",
          group = ArgGroup::new("measured").required(true))]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) scan: stage::MeshOptions,
    /// Where to write the refined scan, in the same unit
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// Normal map in the axes of the scan's coordinates (PNG or JPEG, 8 or 16 bits)
    #[arg(long, value_name = "FILE", group = "measured", help_heading = "Normals")]
    pub(crate) object_map: Option<PathBuf>,
    /// Normal map in the scan's tangent space (PNG or JPEG, 8 or 16 bits)
    #[arg(long, value_name = "FILE", group = "measured", help_heading = "Normals")]
    pub(crate) tangent_map: Option<PathBuf>,
    /// Green of the tangent-space map points down (DirectX); it points up in OpenGL's convention
    #[arg(long, conflicts_with_all = ["object_map", "vertex_normals"], help_heading = "Normals")]
    pub(crate) directx: bool,
    /// Normals per vertex in the axes of the scan's coordinates (.npy, V x 3, f32); zero where there is none
    #[arg(long, value_name = "FILE", group = "measured", help_heading = "Normals")]
    pub(crate) vertex_normals: Option<PathBuf>,
    /// Trust in each vertex's normal, 0 to 1 (.npy, V x 1, f32)
    #[arg(long, value_name = "FILE", help_heading = "Normals")]
    pub(crate) confidence: Option<PathBuf>,
    /// Wavelength at which positions and normals weigh the same; shorter waves come from the normals
    #[arg(long, value_name = "MM", default_value_t = Params::default().crossover_mm)]
    pub(crate) crossover_mm: f64,
    /// The same as the paper's weight of the positions, between 0 and 1, with lengths in mm
    #[arg(long, value_name = "WEIGHT", conflicts_with = "crossover_mm")]
    pub(crate) lambda: Option<f64>,
    /// Wavelength above which the normals' average is turned to that of the positions' normals; 0 leaves it
    #[arg(long, value_name = "MM", default_value_t = Params::default().bias_mm)]
    pub(crate) bias_mm: f64,
    /// Passes; each further one starts from the surface that the one before found
    #[arg(long, value_name = "N", default_value_t = Params::default().iterations)]
    pub(crate) iterations: usize,
    #[command(flatten)]
    pub(crate) common: stage::Common,
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}
