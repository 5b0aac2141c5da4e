//! What the skin is made of, and how wrinkles are put into it.

use crate::Error;
use serde::{Deserialize, Serialize};

/// How the energy is minimised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Solver {
    /// Coarse to fine; stops at a small step.
    #[default]
    CoarseToFine,
    /// The paper's: Gauss–Newton on the mesh itself until the energy falls by less than 1e-5 of itself; stiffnesses as
    /// they are, whatever the edge length.
    Paper,
}

/// What becomes of creases that wander over the skin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Track {
    /// Each crease stays where it is on the skin: at the weighted median of where it was found.
    #[default]
    Steady,
    /// Each crease is where it was found in each frame.
    AsFound,
}

/// Parameters of the synthesis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Params {
    /// Stiffness of edges k_e, per mm (paper: 300); for edges of 0.3 mm, and scaled with their length but in the paper's solver.
    pub edge_stiffness: f64,
    /// Stiffness of dihedral angles k_b (paper: 2).
    pub bending_stiffness: f64,
    /// Stiffness of areas k_a, per mm² (paper: 30 000).
    pub area_stiffness: f64,
    /// How the energy is minimised.
    pub solver: Solver,
    /// How far the vertices of a valley slide towards its crease: 0, the paper's, moves them along the normal only and stretches the
    /// walls; at 1 the walls are as long as at rest.
    pub slide: f64,
    /// What becomes of creases that wander.
    pub track: Track,
    /// Share of the stiffness with which skin resists being shortened or stretched as far as the large-scale motion does; 1 is the
    /// paper's shell, which works against the motion.
    pub resistance: f64,
    /// How far a valley reaches, in its own widths w, …
    pub influence_widths: f64,
    /// … and at most, mm.
    pub influence_mm: f64,
    /// Depth, mm, below which a valley loses its hold of the skin, so that wrinkles come and go without a jump.
    pub fade_depth_mm: f64,
    /// Share of a valley's width beside its rim over which its hold is loosened.
    pub rim_share: f64,
    /// Step, mm, at which the descent stops.
    pub step_mm: f64,
    /// Edge length, mm, of the coarsest level; a mesh that is not finer than two thirds of it has none. Every other level has edges 2.4
    /// times shorter than the level before.
    pub coarse_edge_mm: f64,
    /// Longest gap, in frames, that valleys are interpolated over; before and after a longer one they fade.
    pub longest_gap: u32,
    /// Start from the frame before where that gives the same result.
    pub warm_start: bool,
    /// Keep both sides of a fold from going through each other.
    pub self_contact: bool,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            edge_stiffness: 300.0,
            bending_stiffness: 20.0,
            area_stiffness: 30_000.0,
            solver: Solver::default(),
            slide: 0.6,
            track: Track::default(),
            resistance: 0.005,
            influence_widths: 4.0,
            influence_mm: 12.0,
            fade_depth_mm: 0.1,
            rim_share: 0.15,
            step_mm: 2e-3,
            coarse_edge_mm: 0.6,
            longest_gap: 12,
            warm_start: true,
            self_contact: false,
        }
    }
}

impl Params {
    /// The paper's: its solver, its stiffness against bending, the full price for every strain, vertices that move along normals only, creases
    /// as they were found.
    #[must_use]
    pub fn paper() -> Self {
        Self {
            bending_stiffness: 2.0,
            solver: Solver::Paper,
            slide: 0.0,
            track: Track::AsFound,
            rim_share: 0.0,
            resistance: 1.0,
            warm_start: false,
            ..Self::default()
        }
    }

    /// Whether the numbers make a shell.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first that does not.
    pub fn check(&self) -> Result<(), Error> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let checks = [
            ("edge stiffness", self.edge_stiffness, positive(self.edge_stiffness)),
            ("bending stiffness", self.bending_stiffness, positive(self.bending_stiffness)),
            ("area stiffness", self.area_stiffness, positive(self.area_stiffness)),
            (
                "influence in widths",
                self.influence_widths,
                self.influence_widths >= 1.5 && self.influence_widths <= 20.0,
            ),
            ("influence", self.influence_mm, positive(self.influence_mm)),
            ("fading depth", self.fade_depth_mm, positive(self.fade_depth_mm)),
            ("resistance", self.resistance, (1e-4..=1.0).contains(&self.resistance)),
            ("slide", self.slide, (0.0..=1.0).contains(&self.slide)),
            ("rim share", self.rim_share, (0.0..=0.5).contains(&self.rim_share)),
            ("step", self.step_mm, positive(self.step_mm)),
            ("coarse edge length", self.coarse_edge_mm, positive(self.coarse_edge_mm)),
        ];
        match checks.iter().find(|check| !check.2) {
            Some(&(name, value, _)) => Err(Error::Parameter { name, value }),
            None => Ok(()),
        }
    }
}
