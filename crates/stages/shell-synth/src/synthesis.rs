//! A frame: valleys stamped in, bulges raised by the shell, everything else left as it is.

use crate::coarse::Coarse;
use crate::crease::{Crease, Creases};
use crate::curve::Curve;
use crate::descent::{Descent, Rule, minimise};
use crate::locator::Locator;
use crate::moment::Moment;
use crate::patch::{Patch, Spring};
use crate::reach::{Beside, reach};
use crate::region::{FIXED, Region, regions};
use crate::report::{CreaseReport, RegionReport, crease_report};
use crate::stamp::{Claim, Open, claims, reach_mm};
use crate::surface::{NONE, Surface};
use crate::{Error, Params, Solver};
use artifact::ValleysFrame;
use mesh::Mesh;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Stiffness of springs per mm² of skin, as a share of the stiffness of areas: of a valley's loosened rim …
const HOLD_SHARE: f64 = 1.0 / 150.0;
/// … and of the edge of its reach.
const ANCHOR_SHARE: f64 = 1.0 / 1500.0;
/// … and of the wall that opposite sides of a fold meet at.
const CONTACT_SHARE: f64 = 4.0;
/// Step, mm, at which the coarse level stops.
const COARSE_STEP_MM: f64 = 0.02;
/// A start this near, mm, to the coarse level's own result is in the same fold.
const SAME_FOLD_MM: f64 = 0.4;

/// Wrinkles of a take, ready to be put on its frames.
pub struct Synthesis {
    surface: Surface,
    normals: Vec<Vector3<f64>>,
    creases: Creases,
    reaches: Vec<Vec<Beside>>,
    coarse: Option<Coarse>,
    params: Params,
}

/// A frame with its wrinkles.
#[derive(Debug, Clone, PartialEq)]
pub struct Wrinkling {
    /// #V positions, mm.
    pub positions: Vec<Point3<f64>>,
    /// What happened in each region that was solved for.
    pub regions: Vec<RegionReport>,
}

/// A region on the coarse level: displacements of all coarse vertices, and how the descent went.
struct Guide<'a> {
    level: &'a Coarse,
    moved: Vec<Vector3<f64>>,
    descent: Descent,
}

/// What holds while a frame is made.
struct Scene<'a> {
    large: &'a [Point3<f64>],
    /// Positions at the start: valleys where they are held, all else as without wrinkles.
    start: Vec<Point3<f64>>,
    /// Per vertex its claim, or [`NONE`].
    claim_of: Vec<u32>,
    claims: Vec<Claim>,
    before: Option<&'a [Vector3<f64>]>,
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
        let coarse = match params.solver {
            Solver::CoarseToFine => Coarse::of(&surface, &zone, params)?,
            Solver::Paper => None,
        };
        Ok(Self { surface, normals, creases, reaches, coarse, params: params.clone() })
    }

    /// Puts a frame's wrinkles on it.
    ///
    /// `large`: #V positions without wrinkles, mm; `before`: the displacements that the frame before got (its positions less those
    /// without wrinkles). They only shorten the way: where the fold could be another one, the frame starts anew.
    ///
    /// A frame without an open valley comes back as it is; so do all vertices that no valley reaches.
    ///
    /// # Errors
    /// [`Error::VertexCount`], or [`Error::Solve`] where the mesh is degenerate.
    pub fn frame(
        &self,
        frame: i64,
        large: &[Point3<f64>],
        before: Option<&[Vector3<f64>]>,
    ) -> Result<Wrinkling, Error> {
        let (found, expected) = (large.len(), self.surface.rest.len());
        if found != expected {
            return Err(Error::VertexCount { found, expected });
        }
        let Some(moment) = self.creases.moment(frame, &self.params) else {
            return Ok(Wrinkling { positions: large.to_vec(), regions: Vec::new() });
        };
        let scene = self.scene(large, before, &moment);
        let regions = regions(&self.surface, &scene.claims, &scene.claim_of);
        let solved: Vec<(Vec<Point3<f64>>, RegionReport)> =
            regions.par_iter().map(|region| self.solve(&scene, region)).collect::<Result<_, Error>>()?;
        let mut positions = scene.start;
        let mut reports = Vec::new();
        for (region, (points, report)) in regions.iter().zip(solved) {
            region.free.iter().zip(points).for_each(|(&vertex, point)| positions[vertex as usize] = point);
            reports.push(report);
        }
        Ok(Wrinkling { positions, regions: reports })
    }

    fn scene<'a>(
        &self,
        large: &'a [Point3<f64>],
        before: Option<&'a [Vector3<f64>]>,
        moment: &Moment,
    ) -> Scene<'a> {
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

    /// What pulls a free vertex, per mm² of its skin.
    fn springs(&self, claim: &Claim, large: &Point3<f64>, area: f64) -> Vec<Spring> {
        let stiffness = self.params.area_stiffness * area;
        let mut springs = Vec::new();
        if claim.hold > 0.0 {
            let firm = claim.hold / (1.0 - claim.hold);
            springs.push(Spring {
                stiffness: HOLD_SHARE * stiffness * firm,
                target: claim.target,
                plane: None,
            });
        }
        if claim.freedom < 1.0 {
            let firm = 1.0 / claim.freedom.max(1e-3) - 1.0;
            springs.push(Spring {
                stiffness: ANCHOR_SHARE * stiffness * firm * (1.0 - claim.hold),
                target: *large,
                plane: None,
            });
        }
        if let Some(wall) = claim.opposite {
            springs.push(Spring {
                stiffness: CONTACT_SHARE * stiffness,
                target: wall.point,
                plane: Some(wall.normal),
            });
        }
        springs
    }

    fn solve(&self, scene: &Scene, region: &Region) -> Result<(Vec<Point3<f64>>, RegionReport), Error> {
        let coarse = match &self.coarse {
            Some(coarse) => self.solve_coarse(coarse, scene, region)?,
            None => None,
        };
        let spring = |&vertex: &u32| {
            let claim = &scene.claims[scene.claim_of[vertex as usize] as usize];
            self.springs(claim, &scene.large[vertex as usize], self.surface.vertex_areas[vertex as usize])
        };
        let springs = region.free.iter().map(spring).collect();
        let mut patch = Patch::new(&self.surface, region.free.clone(), springs);
        if self.params.resistance < 1.0 {
            let large: Vec<Point3<f64>> =
                patch.vertices.iter().map(|&vertex| scene.large[vertex as usize]).collect();
            patch.slacken(&large, self.params.resistance);
        }
        let mut points: Vec<Point3<f64>> =
            patch.vertices.iter().map(|&vertex| scene.start[vertex as usize]).collect();
        let warm = self.is_same_fold(scene, region, coarse.as_ref());
        let moved: Vec<Vector3<f64>> = match (&coarse, scene.before) {
            (_, Some(before)) if warm => region.free.iter().map(|&vertex| before[vertex as usize]).collect(),
            (Some(guide), _) => {
                region.free.iter().map(|&vertex| guide.level.prolong(vertex, &guide.moved)).collect()
            }
            _ => Vec::new(),
        };
        points.iter_mut().zip(moved).for_each(|(point, moved)| *point += moved);
        let rule = match self.params.solver {
            Solver::CoarseToFine => Rule::Step(self.params.step_mm),
            Solver::Paper => Rule::Paper,
        };
        let descent = minimise(&mut patch, &mut points, rule)?;
        let normals: Vec<Vector3<f64>> =
            patch.vertices.iter().map(|&vertex| self.normal(scene.large, vertex)).collect();
        let [inverted_triangles, degenerate_triangles] = patch.damage(&points, &normals);
        points.truncate(region.free.len());
        let report = RegionReport {
            wrinkles: region.creases.iter().map(|&at| self.creases.all[at as usize].id.clone()).collect(),
            free_vertices: region.free.len(),
            warm,
            coarse: coarse.map(|guide| guide.descent),
            descent,
            inverted_triangles,
            degenerate_triangles,
        };
        Ok((points, report))
    }

    fn normal(&self, large: &[Point3<f64>], vertex: u32) -> Vector3<f64> {
        let of = |&triangle: &u32| {
            let [a, b, c] = self.surface.triangles[triangle as usize].map(|corner| large[corner as usize]);
            (b - a).cross(&(c - a))
        };
        self.surface.around(vertex).iter().map(of).sum()
    }

    /// The coarse level of a region, if it has free vertices there.
    fn solve_coarse<'a>(
        &self,
        coarse: &'a Coarse,
        scene: &Scene,
        region: &Region,
    ) -> Result<Option<Guide<'a>>, Error> {
        let inside = |&at: &u32| region.free.binary_search(&coarse.vertices[at as usize]).is_ok();
        let free: Vec<u32> = (0..coarse.vertices.len() as u32)
            .filter(inside)
            .filter(|&at| !coarse.surface.boundary[at as usize])
            .collect();
        if free.is_empty() {
            return Ok(None);
        }
        let spring = |&at: &u32| {
            let vertex = coarse.vertices[at as usize] as usize;
            let claim = &scene.claims[scene.claim_of[vertex] as usize];
            self.springs(claim, &scene.large[vertex], coarse.surface.vertex_areas[at as usize])
        };
        let springs = free.iter().map(spring).collect();
        let mut patch = Patch::new(&coarse.surface, free, springs);
        if self.params.resistance < 1.0 {
            let of = |&at: &u32| scene.large[coarse.vertices[at as usize] as usize];
            let large: Vec<Point3<f64>> = patch.vertices.iter().map(of).collect();
            patch.slacken(&large, self.params.resistance);
        }
        let start = |&at: &u32| scene.start[coarse.vertices[at as usize] as usize];
        let mut points: Vec<Point3<f64>> = patch.vertices.iter().map(start).collect();
        let descent = minimise(&mut patch, &mut points, Rule::Step(COARSE_STEP_MM))?;
        let displacement = |&vertex: &u32| scene.start[vertex as usize] - scene.large[vertex as usize];
        let mut moved: Vec<Vector3<f64>> = coarse.vertices.iter().map(displacement).collect();
        for (&at, point) in patch.vertices.iter().zip(&points) {
            moved[at as usize] = point - scene.large[coarse.vertices[at as usize] as usize];
        }
        Ok(Some(Guide { level: coarse, moved, descent }))
    }

    /// Whether the frame before shows the fold that the coarse level found.
    fn is_same_fold(&self, scene: &Scene, region: &Region, coarse: Option<&Guide>) -> bool {
        let (Some(before), Some(Guide { level, moved, .. })) = (scene.before, coarse) else { return false };
        let apart = |(at, &vertex): (usize, &u32)| {
            let free = region.free.binary_search(&vertex).is_ok();
            if free { (before[vertex as usize] - moved[at]).norm() } else { 0.0 }
        };
        self.params.warm_start
            && level.vertices.iter().enumerate().map(apart).all(|apart| apart < SAME_FOLD_MM)
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
