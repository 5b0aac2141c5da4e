//! What the shell is made of.

use crate::Error;
use serde::{Deserialize, Serialize};

/// What the shell's energy is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// The paper's: stretching and bending [BickelBotsch2007, Eq. 4].
    #[default]
    Paper,
    /// Stretching and the variation of bending, soft around mouth and eyes ([`crate::SoftShell`]).
    SoftOpenings,
}

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
    /// The energy.
    pub model: Model,
    /// Stretching stiffness k_s, no unit (paper: 1).
    pub stretching: f64,
    /// Bending stiffness k_b, mm² (paper: 100). Only its ratio to the stretching counts: its root is the length, in
    /// mm, over which bending outweighs stretching.
    pub bending_mm2: f64,
    /// Stiffness k_t against the variation of bending, mm⁴, in the model with soft openings; the fourth root of its ratio to
    /// the stretching is a length.
    pub variation_mm4: f64,
    /// Share of that stiffness that is lost at the rim of an opening, from 0 to below 1.
    pub softening: f64,
    /// Distance from the rim over which the stiffness comes back, mm.
    pub softening_width_mm: f64,
    /// Boundary loops shorter than this, mm, are holes of the scan and no openings of the face.
    pub smallest_opening_mm: f64,
    /// Vertices, at most, that the model with soft openings is solved on.
    pub proxy_vertices: usize,
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
            model: Model::default(),
            stretching: 1.0,
            bending_mm2: 100.0,
            variation_mm4: 1e4,
            softening: 0.97,
            softening_width_mm: 18.0,
            smallest_opening_mm: 50.0,
            proxy_vertices: 40_000,
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
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let checks = [
            ("stretching", self.stretching, self.stretching == 0.0 || positive(self.stretching)),
            ("bending", self.bending_mm2, positive(self.bending_mm2)),
            ("stiffness against the variation of bending", self.variation_mm4, positive(self.variation_mm4)),
            ("softening width", self.softening_width_mm, positive(self.softening_width_mm)),
            (
                "cotangent limit",
                self.cotangent_limit,
                positive(self.cotangent_limit) && self.cotangent_limit >= 1.0,
            ),
        ];
        if let Some(&(name, value, _)) = checks.iter().find(|check| !check.2) {
            return Err(Error::Parameter { name, value });
        }
        match (0.0..1.0).contains(&self.softening) {
            true => Ok(()),
            false => Err(Error::Softening { value: self.softening }),
        }
    }
}
