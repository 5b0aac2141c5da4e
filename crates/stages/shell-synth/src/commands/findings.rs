//! What the frames showed: for the summary, and as a table.

use serde_json::json;
use shell_synth::{CreaseReport, RegionReport};
use stage::Run;
use std::fmt::Write;

/// Fewest edges across a valley (2 w) that carry its section.
const LEAST_EDGES: f64 = 4.0;
/// A valley at rest of this share of the measured depth is a wrinkle of the scan.
const REST_SHARE: f64 = 0.3;
/// A crease that wanders farther than this is worth a word, mm.
const LARGE_DRIFT_MM: f64 = 1.0;

#[derive(Default)]
pub(crate) struct Findings {
    table: String,
    frames: usize,
    without: usize,
    regions: usize,
    warm: usize,
    steps: usize,
    largest_region: usize,
    inverted: usize,
    degenerate: usize,
    unfinished: Vec<i64>,
    worst_frame: Option<i64>,
}

impl Findings {
    pub(crate) fn add(&mut self, frame: i64, regions: &[RegionReport]) {
        self.frames += 1;
        self.without += usize::from(regions.is_empty());
        for region in regions {
            self.regions += 1;
            self.warm += usize::from(region.warm);
            self.steps += region.descent.steps;
            self.largest_region = self.largest_region.max(region.free_vertices);
            if region.inverted_triangles > 0 && self.worst_frame.is_none() {
                self.worst_frame = Some(frame);
            }
            self.inverted += region.inverted_triangles;
            self.degenerate += region.degenerate_triangles;
            if !region.descent.converged {
                self.unfinished.push(frame);
            }
            self.row(frame, region);
        }
    }

    fn row(&mut self, frame: i64, region: &RegionReport) {
        let way = &region.descent;
        let coarse: usize = region.levels.iter().map(|level| level.steps).sum();
        // Writing to a string cannot fail.
        let _ = writeln!(
            self.table,
            "{frame},{},{},{},{coarse},{},{},{:e},{:e},{:e},{:e},{},{},{}",
            region.wrinkles.join(" "),
            region.free_vertices,
            region.warm,
            way.steps,
            way.evaluations,
            way.first_energy,
            way.energy,
            way.first_step_mm,
            way.last_step_mm,
            way.converged,
            region.inverted_triangles,
            region.degenerate_triangles,
        );
    }

    /// The table, one row per frame and region.
    pub(crate) fn table(&self) -> String {
        let head = "frame,wrinkles,free_vertices,warm,coarse_steps,steps,evaluations,first_energy,energy,first_step_mm,last_step_mm,\
                    converged,inverted_triangles,degenerate_triangles\n";
        format!("{head}{}", self.table)
    }

    pub(crate) fn report(&self, run: &mut Run) {
        run.result("frames", self.frames);
        run.result("frames_without_valleys", self.without);
        run.result("regions", self.regions);
        run.result("warm_regions", self.warm);
        run.result("largest_region", self.largest_region);
        run.result("steps", self.steps);
        run.result("inverted_triangles", self.inverted);
        run.result("degenerate_triangles", self.degenerate);
        run.result("unfinished_regions", self.unfinished.len());
        if let Some(frame) = self.worst_frame {
            run.warn(format!(
                "{} triangles turned over, the first in frame {frame}: valleys cross there, or are deeper than they are wide",
                self.inverted
            ));
        }
        if let Some(frame) = self.unfinished.first() {
            run.warn(format!(
                "{} regions did not settle, the first in frame {frame}; a greater --bending-stiffness helps",
                self.unfinished.len()
            ));
        }
    }
}

/// Says what the creases are like.
pub(crate) fn report_creases(run: &mut Run, creases: &[CreaseReport]) {
    run.result("creases", creases);
    let worst = creases.iter().map(|crease| crease.drift.found_mm).fold(0.0, f64::max);
    run.result("drift_found_mm", worst);
    run.result("drift_used_mm", creases.iter().map(|crease| crease.drift.used_mm).fold(0.0, f64::max));
    for crease in creases {
        let edges = 2.0 * crease.narrowest_mm / crease.edge_mm;
        if edges < LEAST_EDGES {
            run.warn(format!(
                "wrinkle {}: it is down to w = {:.2} mm wide, but the mesh has edges of {:.2} mm there: {edges:.1} across the valley \
                 instead of {LEAST_EDGES}; its depth will be lost between vertices. Use a finer mesh, or --refine",
                crease.wrinkle, crease.narrowest_mm, crease.edge_mm
            ));
        }
        if crease.at_rest_mm > REST_SHARE * crease.deepest_mm {
            run.warn(format!(
                "wrinkle {}: the scan has a valley of {:.2} mm there already, against {:.2} mm measured: it would be there twice; \
                 `wrinkle-removal` takes it off the scan",
                crease.wrinkle, crease.at_rest_mm, crease.deepest_mm
            ));
        }
        if crease.drift.found_mm > LARGE_DRIFT_MM {
            run.warn(format!(
                "wrinkle {}: it wanders by {:.2} mm over the skin (95 %); check --labels, warp and large-scale motion",
                crease.wrinkle, crease.drift.found_mm
            ));
        }
        if crease.boundary_vertices > 0 {
            run.detail(&format!(
                "wrinkle {} reaches {} vertices of the mesh's boundary; they are held",
                crease.wrinkle, crease.boundary_vertices
            ));
        }
    }
    run.result(
        "boundary_vertices",
        json!(creases.iter().map(|crease| crease.boundary_vertices).sum::<usize>()),
    );
}
