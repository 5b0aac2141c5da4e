//! From a warp's numbers to the map that they describe.

use artifact::{Interpolant, Warp};
use operators::{Inverse, InvertParams, RbfMap, RbfSum};

/// The map that an interpolant describes, ready to be evaluated.
#[must_use]
pub fn map_of(interpolant: &Interpolant) -> RbfMap {
    let Interpolant { origin_mm, scale_mm, centers, weights, polynomial } = interpolant;
    RbfMap::new(&RbfSum { origin_mm: *origin_mm, scale_mm: *scale_mm, centers, weights, polynomial })
}

/// c⁻¹ of a warp; its search starts from the interpolant fitted the other way round.
#[must_use]
pub fn inverse_of(warp: &Warp, params: InvertParams) -> Inverse {
    Inverse::of(map_of(&warp.face_from_mocap), map_of(&warp.mocap_from_face), params)
}
