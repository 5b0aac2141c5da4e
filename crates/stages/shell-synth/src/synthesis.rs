//! A frame: valleys stamped in, bulges raised by the shell, everything else left as it is.

use crate::blocks::ranks;
use crate::coarse::Coarse;
use crate::crease::{Crease, Creases};
use crate::curve::Curve;
use crate::locator::Locator;
use crate::moment::Moment;
use crate::reach::{Beside, reach};
use crate::region::{FIXED, Region, regions};
use crate::report::{CreaseReport, RegionReport, crease_report};
use crate::solve::{Memory, Scene, Solved};
use crate::stamp::{Open, claims, reach_mm};
use crate::surface::{NONE, Surface};
use crate::{Error, Params, Solver};
use artifact::ValleysFrame;
use mesh::Mesh;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Wrinkles of a take, ready to be put on its frames.
pub struct Synthesis {
    pub(crate) surface: Surface,
    normals: Vec<Vector3<f64>>,
    creases: Creases,
    reaches: Vec<Vec<Beside>>,
    /// Coarsest first.
    pub(crate) levels: Vec<Coarse>,
    /// Per vertex its place in an elimination order of all that wrinkles reach.
    pub(crate) ranks: Vec<u32>,
    pub(crate) params: Params,
}

/// A frame with its wrinkles.
#[derive(Debug, Clone, PartialEq)]
pub struct Wrinkling {
    /// #V positions, mm.
    pub positions: Vec<Point3<f64>>,
    /// What happened in each region that was solved for.
    pub regions: Vec<RegionReport>,
    /// Where the next frame may start.
    pub memory: Memory,
}

impl Synthesis {
    /// Prepares: edges and hinges, the creases' lines on the skin and what they reach, the coarse level.
    ///
    /// `mesh`: the rest pose, mm; `wrinkles`: ids; `valleys`: rising frames, all that there are, so that a frame does not depend
    /// on which others are made.
    ///
    /// # Errors
    /// [`Error`]: parameters out of range, valleys of another mesh, a mesh that is no surface.
    pub fn new(
        mesh: &Mesh,
        wrinkles: &[String],
        valleys: &[ValleysFrame],
        params: &Params,
    ) -> Result<Self, Error> {
        params.check()?;
        let surface = Surface::new(mesh.positions.clone(), mesh.triangles(), params)?;
        let normals = mesh::vertex_normals(&surface.rest, &surface.triangles);
        let creases = Creases::new(&surface, &normals, wrinkles, valleys, params)?;
        let walk = |crease: &Crease| reach(&surface, &crease.curve, reach_mm(crease.widest_mm, params));
        let reaches: Vec<Vec<Beside>> = creases.all.par_iter().map(walk).collect();
        let mut zone: Vec<u32> = reaches.iter().flatten().map(|beside| beside.vertex).collect();
        zone.sort_unstable();
        zone.dedup();
        surface.check_areas(&zone)?;
        let levels = match params.solver {
            Solver::CoarseToFine => Coarse::levels(&surface, &zone, params)?,
            Solver::Paper => Vec::new(),
        };
        let ranks = ranks(&surface, &zone);
        Ok(Self { surface, normals, creases, reaches, levels, ranks, params: params.clone() })
    }

    /// Puts a frame's wrinkles on it.
    ///
    /// `large`: #V positions without wrinkles, mm; `before`: what the frame before left. It only shortens the way: where the fold could
    /// be another one, the frame starts anew.
    ///
    /// A frame without an open valley comes back as it is; so do all vertices that no valley reaches.
    ///
    /// # Errors
    /// [`Error::VertexCount`], or [`Error::Solve`] where the mesh is degenerate.
    pub fn frame(
        &self,
        frame: i64,
        large: &[Point3<f64>],
        before: Option<&Memory>,
    ) -> Result<Wrinkling, Error> {
        let (found, expected) = (large.len(), self.surface.rest.len());
        if found != expected {
            return Err(Error::VertexCount { found, expected });
        }
        let still = || self.levels.iter().map(|level| vec![Vector3::zeros(); level.vertices.len()]).collect();
        let Some(moment) = self.creases.moment(frame, &self.params) else {
            let memory = Memory { moved: vec![Vector3::zeros(); found], levels: still() };
            return Ok(Wrinkling { positions: large.to_vec(), regions: Vec::new(), memory });
        };
        let scene = self.scene(large, before, &moment);
        let mut regions = regions(&self.surface, &scene.claims, &scene.claim_of);
        // The largest first, so that no thread is left alone with it at the end.
        regions.sort_by_key(|region| std::cmp::Reverse(region.free.len()));
        let solved: Vec<Solved> = regions
            .par_iter()
            .with_max_len(1)
            .map(|region| self.solve(&scene, region))
            .collect::<Result<_, Error>>()?;
        let mut levels: Vec<Vec<Vector3<f64>>> = self
            .levels
            .iter()
            .map(|level| level.vertices.iter().map(|&vertex| scene.displacement(vertex)).collect())
            .collect();
        let mut positions = scene.start;
        let mut reports = Vec::new();
        for (region, solved) in regions.iter().zip(solved) {
            region
                .free
                .iter()
                .zip(&solved.points)
                .for_each(|(&vertex, &point)| positions[vertex as usize] = point);
            for (level, found) in levels.iter_mut().zip(&solved.levels) {
                found.iter().for_each(|&(at, moved)| level[at as usize] = moved);
            }
            reports.push(self.report(region, &solved));
        }
        let moved = positions.iter().zip(large).map(|(wrinkled, large)| wrinkled - large).collect();
        Ok(Wrinkling { positions, regions: reports, memory: Memory { moved, levels } })
    }

    fn report(&self, region: &Region, solved: &Solved) -> RegionReport {
        let [inverted_triangles, degenerate_triangles] = solved.damage;
        RegionReport {
            wrinkles: region.creases.iter().map(|&at| self.creases.all[at as usize].id.clone()).collect(),
            free_vertices: region.free.len(),
            warm: solved.warm,
            levels: solved.level_descents.clone(),
            descent: solved.descent,
            inverted_triangles,
            degenerate_triangles,
        }
    }

    fn scene<'a>(&self, large: &'a [Point3<f64>], before: Option<&'a Memory>, moment: &Moment) -> Scene<'a> {
        let moved = self.moved_creases(moment);
        let open: Vec<Open> = (0..self.creases.all.len())
            .filter_map(|at| {
                let (curve, reach) = match &moved[at] {
                    Some((curve, reach)) => (curve, reach),
                    None => (&self.creases.all[at].curve, &self.reaches[at]),
                };
                Open::at(&self.creases, at, moment, curve, reach)
            })
            .collect();
        let claims = claims(&self.surface, large, &open, &self.params);
        let mut claim_of = vec![NONE; large.len()];
        let mut start = large.to_vec();
        for (at, claim) in claims.iter().enumerate() {
            claim_of[claim.vertex as usize] = at as u32;
            if claim.hold >= FIXED && !self.surface.boundary[claim.vertex as usize] {
                start[claim.vertex as usize] = claim.target;
            }
        }
        Scene { large, start, claim_of, claims, before }
    }

    /// Lines and reaches of creases that wander.
    fn moved_creases(&self, moment: &Moment) -> Vec<Option<(Curve, Vec<Beside>)>> {
        if self.params.track == crate::Track::Steady {
            return self.creases.all.iter().map(|_| None).collect();
        }
        let locator = Locator::new(&self.surface);
        let moved = |crease: &Crease| {
            let curve = crease.curve_at(&self.surface, &self.normals, &locator, moment)?;
            let reach = reach(&self.surface, &curve, reach_mm(crease.widest_mm, &self.params));
            Some((curve, reach))
        };
        self.creases.all.par_iter().map(moved).collect()
    }

    /// What is known of the creases.
    #[must_use]
    pub fn creases(&self) -> Vec<CreaseReport> {
        self.creases
            .all
            .iter()
            .zip(&self.reaches)
            .map(|(crease, reach)| crease_report(&self.surface, crease, reach))
            .collect()
    }
}
