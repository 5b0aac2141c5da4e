//! Picks → vertices: each picked place becomes the nearest vertex of the scan.

use crate::{Error, Result};
use artifact::{Correspondence, MeshRef, Pair};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::Point3;
use std::collections::BTreeMap;

/// Where a user clicked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// On a vertex, 0-based.
    Vertex(u32),
    /// Anywhere in face space, mm.
    Point(Point3<f64>),
}

/// A correspondence, and how far the picks were moved.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapped {
    /// The artifact.
    pub correspondence: Correspondence,
    /// Per pair the distance between pick and vertex, mm.
    pub distances_mm: Vec<f64>,
}

/// Snaps each pick to its nearest vertex. `positions`: #V points, mm, of the mesh that `mesh` refers to.
///
/// # Errors
/// If a pick is farther than `max_distance_mm` from every vertex, names a vertex that is not there, is not finite; if a
/// marker is picked twice, or two markers share a vertex; if there is nothing to snap.
pub fn correspond(
    picks: &[(String, Place)],
    positions: &[Point3<f64>],
    mesh: MeshRef,
    max_distance_mm: f64,
) -> Result<Snapped> {
    if picks.is_empty() {
        return Err(Error::Nothing { what: "no marker was picked" });
    }
    let points: Vec<[f64; 3]> = positions.iter().map(|&point| point.into()).collect();
    let tree = ImmutableKdTree::<f64, 3>::new_from_slice(&points)
        .map_err(|_| Error::Nothing { what: "the mesh has no usable vertices" })?;
    let (mut pairs, mut distances_mm) = (Vec::new(), Vec::new());
    for (marker, place) in picks {
        let (vertex, distance_mm) = match *place {
            Place::Vertex(vertex) => (vertex, 0.0),
            Place::Point(point) if point.iter().all(|x| x.is_finite()) => {
                let nearest = tree.query(&point.into()).nearest_one::<SquaredEuclidean<f64>>().execute();
                (nearest.item, nearest.distance.sqrt())
            }
            Place::Point(_) => return Err(Error::NotFinite { marker: marker.clone() }),
        };
        let Some(position) = positions.get(vertex as usize) else {
            let vertex_count = positions.len();
            return Err(Error::NoSuchVertex { marker: marker.clone(), vertex, vertex_count });
        };
        if distance_mm > max_distance_mm {
            let (marker, limit_mm) = (marker.clone(), max_distance_mm);
            return Err(Error::FarPick { marker, vertex, distance_mm, limit_mm });
        }
        pairs.push(Pair { marker: marker.clone(), vertex, position_mm: (*position).into() });
        distances_mm.push(distance_mm);
    }
    refuse_doubles(&pairs)?;
    Ok(Snapped { correspondence: Correspondence { mesh, pairs }, distances_mm })
}

fn refuse_doubles(pairs: &[Pair]) -> Result<()> {
    let (mut markers, mut vertices) = (BTreeMap::new(), BTreeMap::new());
    for Pair { marker, vertex, .. } in pairs {
        if markers.insert(marker, ()).is_some() {
            return Err(Error::PickedTwice { marker: marker.clone() });
        }
        if let Some(first) = vertices.insert(*vertex, marker) {
            let (first, second) = (String::clone(first), marker.clone());
            return Err(Error::SameVertex { first, second, vertex: *vertex });
        }
    }
    Ok(())
}
