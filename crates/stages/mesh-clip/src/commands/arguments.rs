//! What the user may say.

use clap::{ArgGroup, Parser};
use mesh_clip::Region;
use std::path::PathBuf;

/// Cut faces out of a mesh and write which vertex became which
///
/// Order of the work: slit along the cuts; select by set, region and mask; drop faces until the surface is a manifold;
/// keep the largest component. A closed cut followed by --keep-largest-component takes out what lies behind closed lips
/// or lids.
#[derive(Parser)]
#[command(version, override_usage = "mesh-clip --mesh FILE --unit UNIT --out FILE --map FILE <WHAT GOES>…",
          group = ArgGroup::new("what").required(true).multiple(true))]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) scan: stage::MeshOptions,
    /// Where to write what is left, in the same unit
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,
    /// Where to write the map between old and new vertices (vertex-map/1)
    #[arg(long, value_name = "FILE")]
    pub(crate) map: PathBuf,
    /// Keep only faces all of whose vertices are in this set (vertex-set/1); may be repeated
    #[arg(long, value_name = "FILE", group = "what", help_heading = "What goes")]
    pub(crate) keep: Vec<PathBuf>,
    /// Remove faces all of whose vertices are in this set (vertex-set/1); may be repeated
    #[arg(long, value_name = "FILE", group = "what", help_heading = "What goes")]
    pub(crate) remove: Vec<PathBuf>,
    /// For everything that is removed: one vertex in it is enough
    #[arg(long, help_heading = "What goes")]
    pub(crate) touching: bool,
    /// Keep only faces inside a ball, e.g. 0,-30,10,105 (mm)
    #[arg(long, value_name = "X,Y,Z,R", value_parser = sphere, allow_hyphen_values = true, group = "what",
          help_heading = "What goes")]
    pub(crate) keep_sphere: Vec<Region>,
    /// Remove faces inside a box (mm)
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", value_parser = boxed, allow_hyphen_values = true,
          group = "what", help_heading = "What goes")]
    pub(crate) remove_box: Vec<Region>,
    /// Keep only faces above a plane, e.g. z=-40 (mm)
    #[arg(long, value_name = "AXIS=MM", value_parser = above, group = "what", help_heading = "What goes")]
    pub(crate) keep_above: Vec<Region>,
    /// Keep only faces below a plane, e.g. y=85 (mm)
    #[arg(long, value_name = "AXIS=MM", value_parser = below, group = "what", help_heading = "What goes")]
    pub(crate) keep_below: Vec<Region>,
    /// Remove faces whose centre falls on a dark texel of this picture (PNG over the texture coordinates)
    #[arg(long, value_name = "FILE", group = "what", help_heading = "What goes")]
    pub(crate) uv_mask: Option<PathBuf>,
    /// Texels darker than this (0 to 1) are dark
    #[arg(long, value_name = "LEVEL", default_value_t = 0.5, help_heading = "What goes")]
    pub(crate) mask_level: f64,
    /// Slit along a path (vertex-path/1), doubling its vertices; may be repeated
    #[arg(long, value_name = "FILE", group = "what", help_heading = "What goes")]
    pub(crate) cut_along: Vec<PathBuf>,
    /// Slit along the shortest way through these vertices (0-based), e.g. 12,90,731; closed where the last is the first
    #[arg(long, value_name = "V,V,…", value_parser = vertices, group = "what", help_heading = "What goes")]
    pub(crate) cut: Vec<Vertices>,
    /// Remove faces whose centre is closer than half of this to a cut (mm)
    #[arg(long, value_name = "MM", default_value_t = 0.0, help_heading = "What goes")]
    pub(crate) slit_width_mm: f64,
    /// Drop faces until no edge has more than two and no vertex is a bow tie
    #[arg(long, group = "what", help_heading = "What goes")]
    pub(crate) drop_non_manifold: bool,
    /// Keep only the component of the largest area
    #[arg(long, group = "what", help_heading = "What goes")]
    pub(crate) keep_largest_component: bool,
    #[command(flatten)]
    pub(crate) common: stage::Common,
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

/// Vertices of one cut.
#[derive(Debug, Clone)]
pub(crate) struct Vertices(pub(crate) Vec<u32>);

fn vertices(text: &str) -> Result<Vertices, String> {
    let index =
        |word: &str| word.trim().parse::<u32>().map_err(|_| format!("'{word}' is not a vertex index"));
    let vertices: Vec<u32> = text.split(',').map(index).collect::<Result<_, _>>()?;
    match vertices.len() < 2 || vertices.windows(2).any(|pair| pair[0] == pair[1]) {
        true => Err("a cut needs at least two vertices, none twice in a row".to_string()),
        false => Ok(Vertices(vertices)),
    }
}

fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let number = |word: &str| match word.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!("'{word}' is not a number")),
    };
    let numbers: Vec<f64> = text.split(',').map(number).collect::<Result<_, _>>()?;
    let count = numbers.len();
    numbers.try_into().map_err(|_| format!("{count} numbers where {N} are needed"))
}

fn sphere(text: &str) -> Result<Region, String> {
    let [x, y, z, radius_mm] = numbers(text)?;
    Ok(Region::Sphere { center_mm: [x, y, z], radius_mm })
}

fn boxed(text: &str) -> Result<Region, String> {
    let [x0, y0, z0, x1, y1, z1] = numbers(text)?;
    Ok(Region::Box { low_mm: [x0, y0, z0], high_mm: [x1, y1, z1] })
}

fn plane(text: &str) -> Result<(usize, f64), String> {
    let (axis, value) = text.split_once('=').ok_or("say e.g. y=-110")?;
    let axis = ["x", "y", "z"]
        .iter()
        .position(|name| *name == axis.trim())
        .ok_or(format!("'{axis}' is not x, y or z"))?;
    let [value_mm] = numbers(value)?;
    Ok((axis, value_mm))
}

fn above(text: &str) -> Result<Region, String> {
    plane(text).map(|(axis, value_mm)| Region::Above { axis, value_mm })
}

fn below(text: &str) -> Result<Region, String> {
    plane(text).map(|(axis, value_mm)| Region::Below { axis, value_mm })
}
