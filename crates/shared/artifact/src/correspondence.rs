//! `correspondence/1`: which vertex of the scan each marker sits on [BickelBotsch2007, Sec. 4.1].

use crate::{Document, Kind, MeshRef, Violation, finite};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Marker → vertex of a mesh in its rest pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Correspondence {
    /// The mesh that was picked on.
    pub mesh: MeshRef,
    /// The pairs; no marker and no vertex twice.
    pub pairs: Vec<Pair>,
}

/// One picked pair.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pair {
    /// Marker id.
    pub marker: String,
    /// Vertex index, 0-based.
    pub vertex: u32,
    /// The vertex's rest position, mm.
    pub position_mm: [f64; 3],
}

impl Kind for Correspondence {
    const NAME: &'static str = "correspondence";
    const VERSION: u32 = 1;
}

impl Document for Correspondence {
    fn check(&self) -> Result<(), Violation> {
        let mut markers = HashMap::new();
        let mut vertices = HashMap::new();
        for pair in &self.pairs {
            let place = format!("marker {}", pair.marker);
            finite(&place, &pair.position_mm)?;
            if pair.vertex as usize >= self.mesh.vertex_count {
                let what =
                    format!("names vertex {} of a mesh that has {}", pair.vertex, self.mesh.vertex_count);
                return Err(Violation::new(place, what));
            }
            if markers.insert(&pair.marker, ()).is_some() {
                return Err(Violation::new(place, "is picked twice"));
            }
            if let Some(other) = vertices.insert(pair.vertex, &pair.marker) {
                let what = format!("sits on vertex {}, as marker {other} does", pair.vertex);
                return Err(Violation::new(place, what));
            }
        }
        Ok(())
    }
}
