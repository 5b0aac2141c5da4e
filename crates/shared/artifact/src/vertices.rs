//! `vertex-set/1` (a region of a mesh), `vertex-path/1` (a line along its edges) and `vertex-map/1` (which vertex
//! became which).

use crate::{Document, Kind, MeshRef, Violation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A set of vertices of a mesh: a region to hold, to clip, to score.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VertexSet {
    /// The mesh.
    pub mesh: MeshRef,
    /// What the set is, for people, e.g. `neck`.
    pub name: String,
    /// Vertex indices, 0-based, rising.
    pub vertices: Vec<u32>,
}

impl Kind for VertexSet {
    const NAME: &'static str = "vertex-set";
    const VERSION: u32 = 1;
}

impl Document for VertexSet {
    fn check(&self) -> Result<(), Violation> {
        check_rising("vertices", &self.vertices, self.mesh.vertex_count)
    }
}

/// A line along the edges of a mesh, e.g. between closed lips: where to cut it open.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VertexPath {
    /// The mesh.
    pub mesh: MeshRef,
    /// What the line is, for people, e.g. `mouth`.
    pub name: String,
    /// Vertex indices, 0-based, in order along the line; between two of them it takes the shortest way along edges.
    /// The line is closed where the last is the first again.
    pub vertices: Vec<u32>,
}

impl Kind for VertexPath {
    const NAME: &'static str = "vertex-path";
    const VERSION: u32 = 1;
}

impl Document for VertexPath {
    fn check(&self) -> Result<(), Violation> {
        if self.vertices.len() < 2 {
            return Err(Violation::new("vertices", "a path needs at least two"));
        }
        if let Some(pair) = self.vertices.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(Violation::new("vertices", format!("vertex {} follows itself", pair[0])));
        }
        check_range("vertices", &self.vertices, self.mesh.vertex_count)
    }
}

/// Which vertex became which when a mesh was cut: the map and its inverse.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VertexMapping {
    /// The mesh before.
    pub old: MeshRef,
    /// The mesh after.
    pub new: MeshRef,
    /// Per old vertex its new index, of its first copy where a slit doubled it; null where it is gone.
    pub new_from_old: Vec<Option<u32>>,
    /// Per new vertex its old index: rising, and after that the copies that slits made.
    pub old_from_new: Vec<u32>,
}

impl Kind for VertexMapping {
    const NAME: &'static str = "vertex-map";
    const VERSION: u32 = 1;
}

impl Document for VertexMapping {
    fn check(&self) -> Result<(), Violation> {
        check_range("old_from_new", &self.old_from_new, self.old.vertex_count)?;
        if self.new_from_old.len() != self.old.vertex_count
            || self.old_from_new.len() != self.new.vertex_count
        {
            return Err(Violation::new("new_from_old", "the map's length is not the mesh's vertex count"));
        }
        check_order(&self.old_from_new)?;
        let has_first_copy =
            |new: usize, old: u32| self.new_from_old[old as usize].is_some_and(|first| first as usize <= new);
        let unmapped = |pair: &(usize, &u32)| !has_first_copy(pair.0, *pair.1);
        if let Some((new, old)) = self.old_from_new.iter().enumerate().find(unmapped) {
            let what = format!("old_from_new says old {old}, but new_from_old says otherwise");
            return Err(Violation::new(format!("new vertex {new}"), what));
        }
        let leads_back = |old: usize, new: u32| self.old_from_new.get(new as usize) == Some(&(old as u32));
        let astray = |pair: &(usize, &Option<u32>)| pair.1.is_some_and(|new| !leads_back(pair.0, new));
        match self.new_from_old.iter().enumerate().find(astray) {
            Some((old, _)) => {
                let what = "old_from_new does not lead back from its new vertex";
                Err(Violation::new(format!("old vertex {old}"), what))
            }
            None => Ok(()),
        }
    }
}

/// Rising, and after one break the copies, which rise again (a vertex may have several).
fn check_order(old_from_new: &[u32]) -> Result<(), Violation> {
    let place = |new: usize| format!("new vertex {new}");
    let copies =
        old_from_new.windows(2).position(|pair| pair[0] >= pair[1]).map_or(old_from_new.len(), |i| i + 1);
    match old_from_new[copies..].windows(2).position(|pair| pair[0] > pair[1]) {
        Some(i) => Err(Violation::new(place(copies + i + 1), "the order of the vertices is mixed up")),
        None => Ok(()),
    }
}

fn check_range(place: &str, vertices: &[u32], vertex_count: usize) -> Result<(), Violation> {
    match vertices.iter().find(|&&vertex| vertex as usize >= vertex_count) {
        Some(vertex) => {
            Err(Violation::new(place, format!("names vertex {vertex} of a mesh that has {vertex_count}")))
        }
        None => Ok(()),
    }
}

fn check_rising(place: &str, vertices: &[u32], vertex_count: usize) -> Result<(), Violation> {
    if let Some(pair) = vertices.windows(2).find(|pair| pair[0] >= pair[1]) {
        return Err(Violation::new(place, format!("vertex {} follows {}; they must rise", pair[1], pair[0])));
    }
    check_range(place, vertices, vertex_count)
}
