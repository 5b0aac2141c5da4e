//! Regions: free vertices that hang together, each solved for by itself.

use crate::stamp::Claim;
use crate::surface::{NONE, Surface};
use mesh::Forest;
use std::collections::BTreeSet;

/// From this hold on a vertex is fixed.
pub(crate) const FIXED: f64 = 0.999;
/// Below this freedom a vertex keeps its place.
const LEAST_FREEDOM: f64 = 0.02;

/// A part of the mesh that is solved for by itself.
pub(crate) struct Region {
    /// Free vertices, rising.
    pub(crate) free: Vec<u32>,
    /// Creases that let them go.
    pub(crate) creases: BTreeSet<u32>,
}

/// Whether the energy decides where a vertex goes. Boundary vertices stay with the large-scale motion.
fn is_free(surface: &Surface, claim: &Claim) -> bool {
    claim.hold < FIXED
        && (claim.freedom >= LEAST_FREEDOM || claim.hold > 0.0)
        && !surface.boundary[claim.vertex as usize]
}

/// Free vertices that share hinges, each group by itself, by its lowest vertex. `claim_of`: per vertex its claim.
pub(crate) fn regions(surface: &Surface, claims: &[Claim], claim_of: &[u32]) -> Vec<Region> {
    let free: Vec<bool> = claims.iter().map(|claim| is_free(surface, claim)).collect();
    let mut groups = Forest::new(claims.len());
    for at in (0..claims.len() as u32).filter(|&at| free[at as usize]) {
        for_hinged(surface, claims[at as usize].vertex, |vertex| {
            let other = claim_of[vertex as usize];
            if other != NONE && free[other as usize] {
                groups.join(at, other);
            }
        });
    }
    let mut number = vec![NONE; claims.len()];
    let mut regions: Vec<Region> = Vec::new();
    for (at, claim) in claims.iter().enumerate().filter(|(at, _)| free[*at]) {
        let number = &mut number[groups.root(at as u32) as usize];
        if *number == NONE {
            *number = regions.len() as u32;
            regions.push(Region { free: Vec::new(), creases: BTreeSet::new() });
        }
        let region = &mut regions[*number as usize];
        region.free.push(claim.vertex);
        region.creases.insert(claim.crease);
    }
    regions
}

/// Calls `with` for every vertex that shares a hinge with a vertex.
fn for_hinged(surface: &Surface, vertex: u32, mut with: impl FnMut(u32)) {
    for &triangle in surface.around(vertex) {
        for side in surface.sides[triangle as usize] {
            let around = surface.hinges[side as usize].vertices;
            around.into_iter().filter(|&other| other != NONE).for_each(&mut with);
        }
    }
}
