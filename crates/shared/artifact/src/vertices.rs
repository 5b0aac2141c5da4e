//! `vertex-set/1` (a region of a mesh) and `vertex-map/1` (which vertex became which).

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

/// Which vertex became which when faces were cut out of a mesh: the map and its inverse.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VertexMapping {
    /// The mesh before.
    pub old: MeshRef,
    /// The mesh after.
    pub new: MeshRef,
    /// Per old vertex its new index; null where it is gone.
    pub new_from_old: Vec<Option<u32>>,
    /// Per new vertex its old index, rising.
    pub old_from_new: Vec<u32>,
}

impl Kind for VertexMapping {
    const NAME: &'static str = "vertex-map";
    const VERSION: u32 = 1;
}

impl Document for VertexMapping {
    fn check(&self) -> Result<(), Violation> {
        check_rising("old_from_new", &self.old_from_new, self.old.vertex_count)?;
        if self.new_from_old.len() != self.old.vertex_count
            || self.old_from_new.len() != self.new.vertex_count
        {
            return Err(Violation::new("new_from_old", "the map's length is not the mesh's vertex count"));
        }
        let kept = self.new_from_old.iter().flatten().count();
        if kept != self.old_from_new.len() {
            let what = format!("keeps {kept} vertices, but old_from_new has {}", self.old_from_new.len());
            return Err(Violation::new("new_from_old", what));
        }
        let inverse = |(new, &old): (usize, &u32)| self.new_from_old[old as usize] == Some(new as u32);
        match self.old_from_new.iter().enumerate().find(|&pair| !inverse(pair)) {
            Some((new, old)) => {
                let what = format!("old_from_new says old {old}, but new_from_old says otherwise");
                Err(Violation::new(format!("new vertex {new}"), what))
            }
            None => Ok(()),
        }
    }
}

fn check_rising(place: &str, vertices: &[u32], vertex_count: usize) -> Result<(), Violation> {
    if let Some(pair) = vertices.windows(2).find(|pair| pair[0] >= pair[1]) {
        return Err(Violation::new(place, format!("vertex {} follows {}; they must rise", pair[1], pair[0])));
    }
    match vertices.last().filter(|&&last| last as usize >= vertex_count) {
        Some(last) => {
            Err(Violation::new(place, format!("names vertex {last} of a mesh that has {vertex_count}")))
        }
        None => Ok(()),
    }
}
