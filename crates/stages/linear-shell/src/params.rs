//! What the shell is made of.

use crate::Error;
use serde::{Deserialize, Serialize};

/// What to do with a part of the mesh that no handle holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FreeComponents {
    /// Refuse the mesh and name the part.
    #[default]
    Refuse,
    /// Let the part stay where it is.
    Hold,
}

/// What to do with vertices where several fans of triangles meet in a point only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BowTies {
    /// Refuse the mesh and name the vertex.
    #[default]
    Refuse,
    /// Take the fans as hinged there: they share the vertex's displacement and nothing else.
    Join,
}

/// Parameters of the shell; the defaults are the paper's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Params {
    /// Stretching stiffness k_s, no unit (paper: 1).
    pub stretching: f64,
    /// Bending stiffness k_b, mm² (paper: 100). Only its ratio to the stretching counts: its root is the length, in
    /// mm, over which bending outweighs stretching.
    pub bending_mm2: f64,
    /// Largest cotangent that is taken at its word; no unit.
    pub cotangent_limit: f64,
    /// Parts without a handle.
    pub free_components: FreeComponents,
    /// Bow-tie vertices.
    pub bow_ties: BowTies,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            stretching: 1.0,
            bending_mm2: 100.0,
            cotangent_limit: 1e4,
            free_components: FreeComponents::default(),
            bow_ties: BowTies::default(),
        }
    }
}

impl Params {
    /// Whether the numbers make a shell.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first that does not.
    pub fn check(&self) -> Result<(), Error> {
        let refuse = |name, value| Err(Error::Parameter { name, value });
        match self {
            Self { stretching, .. } if !(stretching.is_finite() && *stretching >= 0.0) => {
                refuse("stretching", *stretching)
            }
            Self { bending_mm2, .. } if !(bending_mm2.is_finite() && *bending_mm2 > 0.0) => {
                refuse("bending", *bending_mm2)
            }
            Self { cotangent_limit, .. } if !(cotangent_limit.is_finite() && *cotangent_limit >= 1.0) => {
                refuse("cotangent limit", *cotangent_limit)
            }
            _ => Ok(()),
        }
    }
}
