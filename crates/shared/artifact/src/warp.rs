//! `warp/1`: the smooth map from mocap space to face space and back [BickelBotsch2007, Eq. 1].

use crate::{Document, FileRef, Kind, MeshRef, TakeRef, Violation, finite};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A fitted space warp and everything needed to judge it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Warp {
    /// The map c from mocap (head) space to face space.
    pub face_from_mocap: Interpolant,
    /// An interpolant fitted the other way round: not the inverse of c, but where its search starts.
    pub mocap_from_face: Interpolant,
    /// Marker ids, in the order of the centers.
    pub markers: Vec<String>,
    /// The vertex of each marker.
    pub vertices: Vec<u32>,
    /// The mesh that the markers were placed on.
    pub mesh: MeshRef,
    /// Rest frame: the frame whose expression is closest to the scan.
    pub rest_frame: i64,
    /// The trajectories that the rest frame was taken from.
    pub trajectories: FileRef,
    /// The take that they belong to.
    pub take: Option<TakeRef>,
    /// How well it fits, for people and for `rbf-warp`'s messages.
    pub fit: WarpFit,
}

/// `c(x) = Σᵢ wᵢ ‖u − uᵢ‖³ + Σₖ aₖ pₖ(u)`, u = (x − origin) / scale, in mm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Interpolant {
    /// Coordinates are centred here first, mm …
    pub origin_mm: [f64; 3],
    /// … and divided by this, mm.
    pub scale_mm: f64,
    /// Centers uᵢ, n × 3, no unit.
    pub centers: Vec<[f64; 3]>,
    /// Weights wᵢ, n × 3, mm.
    pub weights: Vec<[f64; 3]>,
    /// Coefficients aₖ of the monomials 1, x, y, z, xx, yy, zz, xy, xz, yz of u: 1, 4 or 10 × 3, mm.
    pub polynomial: Vec<[f64; 3]>,
}

/// Diagnostics of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WarpFit {
    /// Condition number of the interpolation problem, after centring and scaling.
    pub condition: f64,
    /// Polynomial terms that the markers determine (10 for a full quadratic).
    pub polynomial_rank: usize,
    /// Root mean square residual of the best similarity between markers and vertices, mm.
    pub similarity_rms_mm: f64,
    /// Scale of that similarity; near 1 when both are in the unit that they say.
    pub similarity_scale: f64,
    /// Per marker its residual under that similarity, mm.
    pub similarity_residual_mm: BTreeMap<String, f64>,
    /// Per marker how far a warp fitted without it lands from its vertex, mm.
    pub leave_one_out_mm: BTreeMap<String, f64>,
    /// Smallest Jacobian determinant of c at the markers and on the mesh near them; not positive = folded over.
    pub smallest_determinant: f64,
    /// Markers of the trajectories that have no vertex, and pairs that were left out, with the reason.
    pub left_out: BTreeMap<String, String>,
}

impl Kind for Warp {
    const NAME: &'static str = "warp";
    const VERSION: u32 = 1;
}

impl Document for Warp {
    fn check(&self) -> Result<(), Violation> {
        check_interpolant("face_from_mocap", &self.face_from_mocap)?;
        check_interpolant("mocap_from_face", &self.mocap_from_face)?;
        crate::ids::check_marker_ids(&self.markers)?;
        let count = self.face_from_mocap.centers.len();
        if self.markers.len() != count || self.vertices.len() != count {
            let what = format!(
                "{} ids and {} vertices for {count} centers",
                self.markers.len(),
                self.vertices.len()
            );
            return Err(Violation::new("markers", what));
        }
        let fit = &self.fit;
        finite(
            "fit",
            [&fit.condition, &fit.similarity_rms_mm, &fit.similarity_scale, &fit.smallest_determinant],
        )?;
        let per_marker = fit.similarity_residual_mm.iter().chain(&fit.leave_one_out_mm);
        per_marker.into_iter().try_for_each(|(marker, x)| finite(&format!("fit, marker {marker}"), [x]))
    }
}

fn check_interpolant(place: &str, interpolant: &Interpolant) -> Result<(), Violation> {
    let Interpolant { origin_mm, scale_mm, centers, weights, polynomial } = interpolant;
    finite(place, origin_mm.iter().chain([scale_mm]))?;
    finite(place, centers.iter().chain(weights).chain(polynomial).flatten())?;
    if *scale_mm <= 0.0 {
        return Err(Violation::new(place, format!("scale_mm is {scale_mm}; it must be positive")));
    }
    if centers.len() != weights.len() || ![1, 4, 10].contains(&polynomial.len()) {
        let what = format!(
            "has {} centers, {} weights and {} polynomial terms",
            centers.len(),
            weights.len(),
            polynomial.len()
        );
        return Err(Violation::new(place, what));
    }
    Ok(())
}
