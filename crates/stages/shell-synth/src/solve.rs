//! A region in a frame: solved on the coarse levels one after the other, then on the mesh.

use crate::coarse::Coarse;
use crate::descent::{Descent, Rule, minimise};
use crate::patch::{Freed, Patch, Spring};
use crate::region::Region;
use crate::stamp::Claim;
use crate::surface::Surface;
use crate::synthesis::Synthesis;
use crate::{Error, Params, Solver};
use nalgebra::{Point3, Vector3};

/// Stiffness of springs per mm² of skin, as a share of the stiffness of areas: of a valley's loosened rim …
const HOLD_SHARE: f64 = 1.0 / 150.0;
/// … and of the edge of its reach.
const ANCHOR_SHARE: f64 = 1.0 / 1500.0;
/// … and of the wall that opposite sides of a fold meet at.
const CONTACT_SHARE: f64 = 4.0;
/// Step at which a coarse level stops, as a share of its edge length.
const COARSE_STEP: f64 = 1.0 / 30.0;
/// A frame this near, mm, to its own coarse level is in the fold that the coarse level finds.
const SAME_FOLD_MM: f64 = 0.4;

/// What a frame leaves to the next: displacements from the surface without wrinkles, of the mesh and of its coarse levels.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Memory {
    pub(crate) moved: Vec<Vector3<f64>>,
    pub(crate) levels: Vec<Vec<Vector3<f64>>>,
}

/// What holds while a frame is made.
pub(crate) struct Scene<'a> {
    pub(crate) large: &'a [Point3<f64>],
    /// Positions at the start: valleys where they are held, all else as without wrinkles.
    pub(crate) start: Vec<Point3<f64>>,
    /// Per vertex its claim, or [`crate::surface::NONE`].
    pub(crate) claim_of: Vec<u32>,
    pub(crate) claims: Vec<Claim>,
    pub(crate) before: Option<&'a Memory>,
}

/// A region that was solved for.
pub(crate) struct Solved {
    /// Per free vertex.
    pub(crate) points: Vec<Point3<f64>>,
    /// Per coarse level the vertices that were free there, and their displacements.
    pub(crate) levels: Vec<Vec<(u32, Vector3<f64>)>>,
    pub(crate) level_descents: Vec<Descent>,
    pub(crate) descent: Descent,
    pub(crate) warm: bool,
    /// Triangles that turned over, and that lost nearly all their area.
    pub(crate) damage: [usize; 2],
}

/// A level that is descended on: a coarse one, or the mesh itself.
struct Level<'a> {
    surface: &'a Surface,
    ranks: &'a [u32],
    /// Per vertex that of the mesh; nothing on the mesh itself.
    vertices: Option<&'a [u32]>,
}

impl Level<'_> {
    fn of_mesh(&self, vertex: u32) -> u32 {
        self.vertices.map_or(vertex, |vertices| vertices[vertex as usize])
    }
}

/// What a coarse level found.
struct Guide<'a> {
    level: &'a Coarse,
    /// Displacements of all its vertices.
    moved: Vec<Vector3<f64>>,
    /// In a frame that starts from the one before: how they changed since.
    change: Option<Vec<Vector3<f64>>>,
}

impl Guide<'_> {
    /// Where a vertex of the mesh starts on the next level. `before`: where it was in the frame before.
    fn start(&self, vertex: u32, before: impl Fn() -> Vector3<f64>) -> Vector3<f64> {
        match &self.change {
            Some(change) => before() + self.level.prolong(vertex, change),
            None => self.level.prolong(vertex, &self.moved),
        }
    }
}

impl Scene<'_> {
    pub(crate) fn displacement(&self, vertex: u32) -> Vector3<f64> {
        self.start[vertex as usize] - self.large[vertex as usize]
    }

    fn springs(&self, vertex: u32, area: f64, params: &Params) -> [Option<Spring>; 3] {
        let claim = &self.claims[self.claim_of[vertex as usize] as usize];
        springs(claim, &self.large[vertex as usize], params.area_stiffness * area)
    }
}

/// What pulls a free vertex. `stiffness`: of its area.
fn springs(claim: &Claim, large: &Point3<f64>, stiffness: f64) -> [Option<Spring>; 3] {
    let hold = (claim.hold > 0.0).then_some(Spring {
        stiffness: HOLD_SHARE * stiffness * claim.hold / (1.0 - claim.hold),
        target: claim.target,
        plane: None,
    });
    let firm = 1.0 / claim.freedom.max(1e-3) - 1.0;
    let anchor = (claim.freedom < 1.0).then_some(Spring {
        stiffness: ANCHOR_SHARE * stiffness * firm * (1.0 - claim.hold),
        target: *large,
        plane: None,
    });
    let wall = claim.opposite.map(|wall| Spring {
        stiffness: CONTACT_SHARE * stiffness,
        target: wall.point,
        plane: Some(wall.normal),
    });
    [hold, anchor, wall]
}

impl Synthesis {
    /// From the coarsest level to the mesh: each starts at what the level before found. In a frame that starts from the one before,
    /// every level but the coarsest starts where it was then, and where the level before went since.
    pub(crate) fn solve(&self, scene: &Scene, region: &Region) -> Result<Solved, Error> {
        let (mut levels, mut level_descents) = (Vec::new(), Vec::new());
        let mut guide: Option<Guide> = None;
        for (number, coarse) in self.levels.iter().enumerate() {
            let free = coarse.free(&region.free);
            if free.is_empty() {
                break;
            }
            let found = self.descend_coarse(scene, number, &free, guide.as_ref())?;
            let warm = match &guide {
                Some(guide) => guide.change.is_some(),
                None => self.is_same_fold(scene, coarse, &free),
            };
            let before = scene.before.map(|before| &before.levels[number]).filter(|_| warm);
            let since = |before: &Vec<Vector3<f64>>| {
                found.0.iter().zip(before).map(|(now, then)| now - then).collect()
            };
            let change = before.map(since);
            levels.push(free.iter().map(|&at| (at, found.0[at as usize])).collect());
            level_descents.push(found.1);
            guide = Some(Guide { level: coarse, moved: found.0, change });
        }
        let level = Level { surface: &self.surface, ranks: &self.ranks, vertices: None };
        let start = |vertex: u32| {
            let before = || scene.before.map_or_else(Vector3::zeros, |before| before.moved[vertex as usize]);
            guide.as_ref().map_or_else(Vector3::zeros, |guide| guide.start(vertex, before))
        };
        let rule = match self.params.solver {
            Solver::CoarseToFine => Rule::Step(self.params.step_mm),
            Solver::Paper => Rule::Paper,
        };
        let (patch, mut points, descent) = self.descend(scene, &level, &region.free, start, rule)?;
        let normals: Vec<Vector3<f64>> =
            patch.vertices.iter().map(|&vertex| self.normal(scene.large, vertex)).collect();
        let damage = patch.damage(&points, &normals);
        points.truncate(region.free.len());
        let warm = guide.is_some_and(|guide| guide.change.is_some());
        Ok(Solved { points, levels, level_descents, descent, warm, damage })
    }

    /// Displacements of all vertices of a coarse level.
    fn descend_coarse(
        &self,
        scene: &Scene,
        number: usize,
        free: &[u32],
        guide: Option<&Guide>,
    ) -> Result<(Vec<Vector3<f64>>, Descent), Error> {
        let coarse = &self.levels[number];
        let level =
            Level { surface: &coarse.surface, ranks: &coarse.ranks, vertices: Some(&coarse.vertices) };
        let start = |at: u32| {
            let before =
                || scene.before.map_or_else(Vector3::zeros, |before| before.levels[number][at as usize]);
            guide.map_or_else(Vector3::zeros, |guide| guide.start(coarse.vertices[at as usize], before))
        };
        let rule = Rule::Guide(COARSE_STEP * coarse.edge_mm);
        let (_, points, descent) = self.descend(scene, &level, free, start, rule)?;
        let mut moved: Vec<Vector3<f64>> =
            coarse.vertices.iter().map(|&vertex| scene.displacement(vertex)).collect();
        for (&at, point) in free.iter().zip(&points) {
            moved[at as usize] = point - scene.large[coarse.vertices[at as usize] as usize];
        }
        Ok((moved, descent))
    }

    /// `free`: of the level; `start`: their displacements at the start.
    fn descend(
        &self,
        scene: &Scene,
        level: &Level,
        free: &[u32],
        start: impl Fn(u32) -> Vector3<f64>,
        rule: Rule,
    ) -> Result<(Patch, Vec<Point3<f64>>, Descent), Error> {
        let spring = |&at: &u32| {
            scene.springs(level.of_mesh(at), level.surface.vertex_areas[at as usize], &self.params)
        };
        let springs = free.iter().map(spring).collect();
        let freed = Freed { vertices: free.to_vec(), springs, ranks: level.ranks };
        let large = |at: u32| scene.large[level.of_mesh(at) as usize];
        let mut patch = Patch::new(level.surface, freed, large, self.params.resistance);
        let held = patch.vertices[free.len()..].iter().map(|&at| scene.start[level.of_mesh(at) as usize]);
        let mut points: Vec<Point3<f64>> = free.iter().map(|&at| large(at) + start(at)).chain(held).collect();
        let descent = minimise(&mut patch, &mut points, rule)?;
        Ok((patch, points, descent))
    }

    /// Whether the frame before was in the fold that its coarsest level found.
    fn is_same_fold(&self, scene: &Scene, coarse: &Coarse, free: &[u32]) -> bool {
        let Some(before) = scene.before.filter(|_| self.params.warm_start) else { return false };
        let apart = |&at: &u32| {
            let on_mesh = before.moved[coarse.vertices[at as usize] as usize];
            (on_mesh - before.levels[0][at as usize]).norm()
        };
        free.iter().map(apart).all(|apart| apart < SAME_FOLD_MM)
    }

    fn normal(&self, large: &[Point3<f64>], vertex: u32) -> Vector3<f64> {
        let of = |&triangle: &u32| {
            let [a, b, c] = self.surface.triangles[triangle as usize].map(|corner| large[corner as usize]);
            (b - a).cross(&(c - a))
        };
        self.surface.around(vertex).iter().map(of).sum()
    }
}
