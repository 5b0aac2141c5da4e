//! What is said of creases and regions.

use crate::at_rest;
use crate::crease::{Crease, Drift};
use crate::descent::Descent;
use crate::reach::Beside;
use crate::surface::Surface;
use serde::Serialize;

/// What happened in a region.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegionReport {
    /// Ids of the wrinkles that reach it.
    pub wrinkles: Vec<String>,
    /// Free vertices.
    pub free_vertices: usize,
    /// Whether it started from the frame before.
    pub warm: bool,
    /// On the coarse levels, coarsest first.
    pub levels: Vec<Descent>,
    /// On the mesh.
    pub descent: Descent,
    /// Triangles that turned over.
    pub inverted_triangles: usize,
    /// Triangles that lost 95 % of their area.
    pub degenerate_triangles: usize,
}

/// What is known of a crease before any frame is made.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CreaseReport {
    /// Wrinkle id.
    pub wrinkle: String,
    /// Greatest depth, mm.
    pub deepest_mm: f64,
    /// Least width, mm, where it is open.
    pub narrowest_mm: f64,
    /// Median edge length of the mesh in the valley, mm.
    pub edge_mm: f64,
    /// Depth of a valley that the scan has there at rest, mm.
    pub at_rest_mm: f64,
    /// How far it wanders over the skin.
    pub drift: Drift,
    /// Vertices of the mesh's boundary that it reaches; they are held.
    pub boundary_vertices: usize,
}

/// Looks at a crease and at what it reaches.
pub(crate) fn crease_report(surface: &Surface, crease: &Crease, reach: &[Beside]) -> CreaseReport {
    let inside =
        || reach.iter().filter(|beside| beside.foot.distance < crease.narrowest_mm.min(crease.widest_mm));
    let mut areas: Vec<f64> = inside().map(|beside| surface.vertex_areas[beside.vertex as usize]).collect();
    areas.sort_by(f64::total_cmp);
    let area = areas.get(areas.len() / 2).copied().unwrap_or(0.0);
    CreaseReport {
        wrinkle: crease.id.clone(),
        deepest_mm: crease.deepest_mm,
        narrowest_mm: crease.narrowest_mm,
        // A vertex has two equilateral triangles of this side.
        edge_mm: (2.0 * area / 3f64.sqrt()).sqrt(),
        at_rest_mm: at_rest::depth(surface, &crease.curve, reach, crease.widest_mm),
        drift: crease.drift,
        boundary_vertices: reach.iter().filter(|beside| surface.boundary[beside.vertex as usize]).count(),
    }
}
