//! The command line.

use super::tile::Tile;
use anyhow::bail;
use artifact::{FrameRange, Unit};
use clap::{Args, Parser, Subcommand, ValueEnum};
use preview::{Axes, Backdrop, CloseUp, ColorMap, SignedAxis, ValueRange, View};
use serde::Serialize;
use std::path::PathBuf;

/// Draws a mesh, poses of it, or frames of a sequence as a shaded PNG.
///
/// Several pictures make a contact sheet. Colours show how far vertices moved from rest, or how far they are from a
/// reference, in millimetres.
#[derive(Debug, Parser)]
#[command(name = "preview", version, max_term_width = 100)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    #[command(flatten)]
    pub(crate) drawing: Option<Drawing>,
    #[command(flatten)]
    common: stage::Common,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Tile(Tile),
}

impl stage::Arguments for Arguments {
    fn common(&self) -> &stage::Common {
        &self.common
    }
}

/// What is drawn, and how.
#[derive(Debug, Args)]
pub(crate) struct Drawing {
    /// The (rest) mesh
    #[arg(long, value_name = "OBJ")]
    pub(crate) mesh: PathBuf,
    /// Unit of the mesh's coordinates (and of poses, references and bare caches): mm, cm or m
    #[arg(long)]
    pub(crate) unit: Option<Unit>,
    /// Draw frames of this sequence (large-scale.json or a PC2 cache) instead of the rest mesh
    #[arg(long, value_name = "FILE", conflicts_with = "pose")]
    pub(crate) sequence: Option<PathBuf>,
    /// Draw these meshes (same vertices as the rest mesh) instead of the rest mesh
    #[arg(long, value_name = "OBJ", num_args = 1..)]
    pub(crate) pose: Vec<PathBuf>,
    /// Frames to draw, e.g. 1,5,9 or 1001-1010 [default: up to nine, evenly spaced]
    #[arg(
        long,
        value_name = "FRAMES",
        value_delimiter = ',',
        requires = "sequence",
        allow_hyphen_values = true
    )]
    pub(crate) frames: Vec<FrameRange>,
    /// Draw only so many of the frames, evenly spaced
    #[arg(long, value_name = "N", requires = "sequence", value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) count: Option<u32>,
    /// What error is measured against: a mesh, or a sequence with the same frames
    #[arg(long, value_name = "FILE")]
    pub(crate) reference: Option<PathBuf>,
    /// Colour of the surface [default: error with --reference, else plain]
    #[arg(long, value_name = "WHAT")]
    pub(crate) color: Option<Coloring>,
    /// Values of the first and last colour, e.g. 0-5 [default: 0 to the 99th percentile, rounded up]
    #[arg(long, value_name = "MM-MM")]
    pub(crate) range_mm: Option<ValueRange>,
    /// Colour map
    #[arg(long, value_name = "MAP", default_value = "ember")]
    pub(crate) map: MapName,
    /// front, three-quarter, left, right, back (sides of the face) or azimuth,elevation in degrees; may be repeated
    #[arg(long, value_name = "VIEW", default_value = "front", allow_hyphen_values = true)]
    pub(crate) view: Vec<View>,
    /// Axis that points up
    #[arg(long, value_name = "AXIS", default_value = "+y", allow_hyphen_values = true)]
    pub(crate) up: SignedAxis,
    /// Axis that the face looks along (with --up z: -y)
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, default_value = "+z", default_value_ifs = [("up", "z", "-y"), ("up", "+z", "-y")])]
    pub(crate) front: SignedAxis,
    /// Mark the handle vertices of this file with dots
    #[arg(long, value_name = "JSONL")]
    pub(crate) handles: Option<PathBuf>,
    /// Width and height of a picture, pixels, e.g. 720 or 600x800
    #[arg(long, value_name = "PX", default_value = "720", value_parser = parse_size)]
    pub(crate) size: [u32; 2],
    /// Pictures per row [default: as many as look well]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) columns: Option<u32>,
    /// Show this box of the rest mesh only: x0,y0,z0,x1,y1,z1 in mm
    #[arg(long, value_name = "BOX", value_parser = parse_numbers::<6>, allow_hyphen_values = true, conflicts_with_all = ["focus", "zoom"])]
    pub(crate) crop: Option<[f64; 6]>,
    /// Magnify so many times around --focus
    #[arg(long, value_name = "TIMES", requires = "focus", value_parser = parse_zoom)]
    pub(crate) zoom: Option<f64>,
    /// Point that stands in the middle: x,y,z in mm
    #[arg(long, value_name = "POINT", value_parser = parse_numbers::<3>, allow_hyphen_values = true)]
    pub(crate) focus: Option<[f64; 3]>,
    /// Draw the edges of the polygons
    #[arg(long)]
    pub(crate) wireframe: bool,
    /// What stands behind
    #[arg(long, value_name = "SHADE", default_value = "light")]
    pub(crate) background: BackdropName,
    /// Written on top of the sheet
    #[arg(long, default_value = "")]
    pub(crate) title: String,
    /// The picture, PNG
    #[arg(long, value_name = "PNG")]
    pub(crate) out: PathBuf,
}

impl Drawing {
    /// What colours mean; refuses what does not go together.
    pub(crate) fn coloring(&self) -> anyhow::Result<Coloring> {
        let has_reference = self.reference.is_some();
        let wanted = self.color.unwrap_or(if has_reference { Coloring::Error } else { Coloring::Plain });
        match (wanted, has_reference) {
            (Coloring::Error, false) => {
                bail!("--color error has nothing to measure against\n  to do: give --reference")
            }
            (Coloring::Plain | Coloring::Displacement, true) => {
                bail!("--reference is of use only with --color error\n  to do: leave one of the two away")
            }
            _ => Ok(wanted),
        }
    }

    pub(crate) fn axes(&self) -> Result<Axes, preview::Error> {
        Axes::new(self.up, self.front)
    }

    pub(crate) fn close_up(&self) -> anyhow::Result<CloseUp> {
        if let Some([x0, y0, z0, x1, y1, z1]) = self.crop {
            if x0 > x1 || y0 > y1 || z0 > z1 {
                bail!(
                    "--crop: the second corner must not lie below the first one in any coordinate\n  to do: exchange the coordinates"
                );
            }
            return Ok(CloseUp::Box([x0, y0, z0], [x1, y1, z1]));
        }
        let zoom = self.zoom.unwrap_or(1.0);
        Ok(self.focus.map_or(CloseUp::None, |focus| CloseUp::Point { focus, zoom }))
    }
}

/// What the colour of the surface shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Coloring {
    /// Nothing: clay
    Plain,
    /// How far each vertex is from its place at rest
    Displacement,
    /// How far each vertex is from its place in the reference
    Error,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum MapName {
    /// Violet, green, yellow
    Viridis,
    /// Clay, orange, dark red
    Ember,
}

impl From<MapName> for ColorMap {
    fn from(name: MapName) -> Self {
        match name {
            MapName::Viridis => Self::Viridis,
            MapName::Ember => Self::Ember,
        }
    }
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum BackdropName {
    /// Nearly white
    Light,
    /// Nearly black
    Dark,
}

impl From<BackdropName> for Backdrop {
    fn from(name: BackdropName) -> Self {
        match name {
            BackdropName::Light => Self::Light,
            BackdropName::Dark => Self::Dark,
        }
    }
}

pub(crate) fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let side = |part: &str| match part.trim().parse::<u32>() {
        Ok(pixels) if (16..=8192).contains(&pixels) => Ok(pixels),
        _ => Err(format!("'{text}' is not a size; say e.g. 720 or 600x800, each side 16 to 8192")),
    };
    match text.split_once('x') {
        Some((width, height)) => Ok([side(width)?, side(height)?]),
        None => side(text).map(|side| [side, side]),
    }
}

fn parse_numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let numbers: Option<Vec<f64>> = text
        .split(',')
        .map(|part| part.trim().parse().ok().filter(|number: &f64| number.is_finite()))
        .collect();
    numbers
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| format!("'{text}' is not {N} numbers with commas between"))
}

fn parse_zoom(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(zoom) if (0.01..=1000.0).contains(&zoom) => Ok(zoom),
        _ => Err(format!("'{text}' is not a magnification from 0.01 to 1000")),
    }
}
