//! `baked-maps/1`: normal and displacement maps of one frame, baked onto another mesh; an index of the pictures beside it.

use crate::{Document, Kind, MeshRef, Violation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// Which maps there are and how their values are to be read. Texture coordinates are those of the mesh, v up; row 0 of a picture is
/// the top.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BakedMaps {
    /// The mesh that the maps belong to.
    pub mesh: MeshRef,
    /// The frame whose relief they show; absent where it came from a single mesh.
    pub frame: Option<i64>,
    /// Texels in a row and rows of each picture.
    pub size: usize,
    /// Which way green points.
    pub green: GreenAxis,
    /// A displacement picture's black lies so far along the normal, mm; below the surface it is negative.
    pub black_mm: f64,
    /// … and its white so far.
    pub white_mm: f64,
    /// The pictures of each tile, by rising number.
    pub tiles: Vec<BakedTile>,
}

/// Which way the green of a tangent-space normal map points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum GreenAxis {
    /// Along growing v, up in the picture.
    #[default]
    Opengl,
    /// Down in the picture.
    Directx,
}

impl GreenAxis {
    /// The names that programs say it by.
    pub const NAMES: [&'static str; 2] = ["opengl", "directx"];

    /// What a normal's y (up) is multiplied by before it becomes green, and green after it was decoded.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Opengl => 1.0,
            Self::Directx => -1.0,
        }
    }
}

impl FromStr for GreenAxis {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "opengl" => Ok(Self::Opengl),
            "directx" => Ok(Self::Directx),
            _ => Err("say opengl (up) or directx (down)".to_string()),
        }
    }
}

/// The pictures of a UDIM tile, in the same folder as the index.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BakedTile {
    /// 1001 + whole part of u + 10 × whole part of v.
    pub tile: u32,
    /// Normals in the tangent space of MikkTSpace [Mikkelsen2008], PNG.
    pub normal: String,
    /// Displacement along the mesh's interpolated unit normal, mm, OpenEXR.
    pub displacement_exr: String,
    /// The same between black and white, PNG of 16 bits.
    pub displacement: String,
}

impl Kind for BakedMaps {
    const NAME: &'static str = "baked-maps";
    const VERSION: u32 = 1;
}

impl Document for BakedMaps {
    fn check(&self) -> Result<(), Violation> {
        if !(self.black_mm.is_finite() && self.white_mm.is_finite() && self.black_mm < self.white_mm) {
            let what = format!("{} and {} are no range", self.black_mm, self.white_mm);
            return Err(Violation::new("black_mm, white_mm", what));
        }
        match self.tiles.windows(2).find(|pair| pair[0].tile >= pair[1].tile) {
            Some(pair) => {
                let what = format!("tile {} follows tile {}; they must rise", pair[1].tile, pair[0].tile);
                Err(Violation::new("tiles", what))
            }
            None => Ok(()),
        }
    }
}
