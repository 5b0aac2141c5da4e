//! A part of the shell whose vertices are free, with everything else standing still: its elements and what they cost.

use crate::blocks::Blocks;
use crate::jet::{Jets, JointJet, TileJet};
use crate::slack::Slack;
use crate::surface::{NONE, Surface};
use nalgebra::{Point3, Vector3};
use operators::{CsMat, Factor, FactorError};

/// What pulls a free vertex to a place, `stiffness · ‖x − target‖²`, or keeps it from going behind a plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spring {
    pub(crate) stiffness: f64,
    pub(crate) target: Point3<f64>,
    /// Normal of a plane through the target: only what lies behind it is pulled, and only out of it.
    pub(crate) plane: Option<Vector3<f64>>,
}

impl Spring {
    /// How far a point is from where it may be.
    pub(crate) fn stretch(&self, point: &Point3<f64>) -> Vector3<f64> {
        let from = point - self.target;
        self.plane.map_or(from, |normal| normal * normal.dot(&from).min(0.0))
    }
}

/// An edge and the hinge at it, in a patch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Joint {
    /// Ends and apexes, as places in [`Patch::vertices`]; [`NONE`]: there is no second apex.
    pub(crate) vertices: [u32; 4],
    pub(crate) length: Slack,
    /// 0 where no end is free.
    pub(crate) edge_weight: f64,
    pub(crate) angle: f64,
    /// 0 where it does not bend.
    pub(crate) bend_weight: f64,
}

/// A triangle in a patch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tile {
    pub(crate) vertices: [u32; 3],
    pub(crate) area: Slack,
    pub(crate) weight: f64,
}

/// What a patch is made for: its free vertices and what pulls them.
pub(crate) struct Freed<'a> {
    /// The mesh's vertices, rising.
    pub(crate) vertices: Vec<u32>,
    /// Per vertex.
    pub(crate) springs: Vec<[Option<Spring>; 3]>,
    /// Per vertex of the mesh its place in an elimination order of all vertices that may become free ([`NONE`]: it was not
    /// among them).
    pub(crate) ranks: &'a [u32],
}

/// Free vertices, the elements that touch them, and the pattern of their Hessian.
pub(crate) struct Patch {
    /// The mesh's vertices: the free ones first, rising, then those that elements touch besides.
    pub(crate) vertices: Vec<u32>,
    pub(crate) free_count: usize,
    springs: Vec<[Option<Spring>; 3]>,
    joints: Vec<Joint>,
    tiles: Vec<Tile>,
    blocks: Blocks,
}

impl Patch {
    /// A patch whose edges and triangles are slack ([`crate::slack`]) between their measure at rest and that without wrinkles, down
    /// to a share of their stiffness. `large`: a vertex' place without wrinkles.
    pub(crate) fn new(
        surface: &Surface,
        freed: Freed,
        large: impl Fn(u32) -> Point3<f64>,
        share: f64,
    ) -> Self {
        let free_count = freed.vertices.len();
        let mut places = Places::new(surface.rest.len(), freed.vertices);
        let (triangles, edges) = touched(surface, &places.vertices[..free_count]);
        let tiles: Vec<Tile> = triangles
            .iter()
            .map(|&at| {
                let corners = surface.triangles[at as usize];
                let [a, b, c] = corners.map(&large);
                let given = 0.5 * (b - a).cross(&(c - a)).norm();
                let (rest, weight) = (surface.rest_areas[at as usize], surface.area_weights[at as usize]);
                let vertices = corners.map(|vertex| places.of(vertex));
                Tile { vertices, area: Slack::new(rest, given, share), weight }
            })
            .collect();
        let mut joints = Vec::with_capacity(edges.len());
        for at in edges {
            let hinge = &surface.hinges[at as usize];
            let vertices = hinge.vertices.map(|vertex| places.of(vertex));
            let free = vertices.map(|vertex| (vertex as usize) < free_count);
            if !free.contains(&true) {
                continue;
            }
            let given = (large(hinge.vertices[1]) - large(hinge.vertices[0])).norm();
            joints.push(Joint {
                vertices,
                length: Slack::new(hinge.length, given, share),
                edge_weight: if free[0] || free[1] { hinge.edge_weight } else { 0.0 },
                angle: hinge.angle,
                bend_weight: if hinge.bends() { hinge.bend_weight } else { 0.0 },
            });
        }
        let vertices = places.vertices;
        let blocks = Blocks::new(surface, &vertices[..free_count], &joints, &tiles, freed.ranks);
        Self { vertices, free_count, springs: freed.springs, joints, tiles, blocks }
    }

    /// Energy and gradient of everything that touches a free vertex. `points`: of `vertices`.
    pub(crate) fn evaluate(&self, points: &[Point3<f64>], into: &mut Jets) {
        into.fill(&self.joints, &self.tiles, points);
        let springs = |vertex: usize| self.springs[vertex].iter().flatten();
        let spring_energy: f64 = (0..self.free_count)
            .flat_map(|vertex| springs(vertex).map(move |spring| (vertex, spring)))
            .map(|(vertex, spring)| spring.stiffness * spring.stretch(&points[vertex]).norm_squared())
            .sum();
        into.energy += spring_energy;
        into.gradient.resize(self.free_count, Vector3::zeros());
        let pull = |vertex: usize| -> Vector3<f64> {
            let at = &points[vertex];
            springs(vertex).map(|spring| spring.stretch(at) * (2.0 * spring.stiffness)).sum()
        };
        let (joints, tiles) = (&into.joints, &into.tiles);
        self.blocks.gather(&mut into.gradient, |vertex, joint_corners, tile_corners| {
            let mut sum = pull(vertex);
            joint_corners.for_each(|(joint, corner): (u32, usize)| {
                sum += JointJet::pull(&joints[joint as usize], corner);
            });
            tile_corners
                .for_each(|(tile, corner): (u32, usize)| sum += TileJet::pull(&tiles[tile as usize], corner));
            sum
        });
    }

    /// Factors the Gauss–Newton matrix at `points`, where `jets` was evaluated.
    pub(crate) fn factor(
        &mut self,
        points: &[Point3<f64>],
        jets: &Jets,
        factor: Option<Factor>,
    ) -> Result<Factor, FactorError> {
        let springs = &self.springs;
        self.blocks.fill(jets, |vertex| {
            springs[vertex].iter().flatten().filter_map(move |spring| {
                let at = &points[vertex];
                let idle = spring.plane.is_some() && spring.stretch(at) == Vector3::zeros();
                (!idle).then_some((2.0 * spring.stiffness, spring.plane))
            })
        });
        match factor {
            Some(mut factor) => factor.renew(self.matrix()).map(|()| factor),
            None => self.blocks.factor(),
        }
    }

    fn matrix(&self) -> &CsMat<f64> {
        self.blocks.matrix()
    }

    /// Triangles that have turned over or lost nearly all their area, as (inverted, degenerate).
    pub(crate) fn damage(&self, points: &[Point3<f64>], normals: &[Vector3<f64>]) -> [usize; 2] {
        let mut counts = [0; 2];
        for tile in &self.tiles {
            let [a, b, c] = tile.vertices.map(|vertex| points[vertex as usize]);
            let area = 0.5 * (b - a).cross(&(c - a));
            let outwards: Vector3<f64> = tile.vertices.iter().map(|&vertex| normals[vertex as usize]).sum();
            counts[0] += usize::from(area.dot(&outwards) < 0.0);
            counts[1] += usize::from(area.norm() < 0.05 * tile.area.rest());
        }
        counts
    }
}

/// Triangles and edges of the triangles around some vertices, in the order in which they are met.
fn touched(surface: &Surface, vertices: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let mut seen_triangles = vec![false; surface.triangles.len()];
    let mut seen_edges = vec![false; surface.hinges.len()];
    let (mut triangles, mut edges) = (Vec::new(), Vec::new());
    for &triangle in vertices.iter().flat_map(|&vertex| surface.around(vertex)) {
        if std::mem::replace(&mut seen_triangles[triangle as usize], true) {
            continue;
        }
        triangles.push(triangle);
        for edge in surface.sides[triangle as usize] {
            if !std::mem::replace(&mut seen_edges[edge as usize], true) {
                edges.push(edge);
            }
        }
    }
    (triangles, edges)
}

/// Numbers of the mesh's vertices in a patch.
struct Places {
    of: Vec<u32>,
    vertices: Vec<u32>,
}

impl Places {
    fn new(vertex_count: usize, free: Vec<u32>) -> Self {
        let mut of = vec![NONE; vertex_count];
        free.iter().enumerate().for_each(|(place, &vertex)| of[vertex as usize] = place as u32);
        Self { of, vertices: free }
    }

    /// The place of a vertex; a new one if it has none yet.
    fn of(&mut self, vertex: u32) -> u32 {
        if vertex == NONE {
            return NONE;
        }
        let place = &mut self.of[vertex as usize];
        if *place == NONE {
            *place = self.vertices.len() as u32;
            self.vertices.push(vertex);
        }
        *place
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Params;

    /// A bumpy plate of 6 × 6 vertices, its inner ones free, one with a spring.
    fn plate() -> (Surface, Vec<u32>) {
        let at = |i: u32| {
            let (x, y) = (f64::from(i % 6), f64::from(i / 6));
            Point3::new(0.3 * x + 0.05 * (y * 1.7).sin(), 0.3 * y, 0.08 * (x * 1.3 + y).sin())
        };
        let cell = |i: u32| [[i, i + 1, i + 7], [i, i + 7, i + 6]];
        let triangles = (0..30).filter(|i| i % 6 < 5).flat_map(cell).collect();
        let surface = Surface::new((0..36).map(at).collect(), triangles, &Params::default()).unwrap();
        let free = (0..36).filter(|i| (1..5).contains(&(i % 6)) && (1..5).contains(&(i / 6))).collect();
        (surface, free)
    }

    fn patch(surface: &Surface, free: &[u32], large: impl Fn(u32) -> Point3<f64>, share: f64) -> Patch {
        let spring = |at: usize| {
            let target = surface.rest[free[at] as usize];
            [(at == 3).then_some(Spring { stiffness: 7.0, target, plane: None }), None, None]
        };
        let springs = (0..free.len()).map(spring).collect();
        let ranks = vec![NONE; surface.rest.len()];
        Patch::new(surface, Freed { vertices: free.to_vec(), springs, ranks: &ranks }, large, share)
    }

    fn evaluated(patch: &Patch, points: &[Point3<f64>]) -> Jets {
        let mut jets = Jets::default();
        patch.evaluate(points, &mut jets);
        jets
    }

    /// Points moved by ± a step along one axis.
    fn beside(points: &[Point3<f64>], vertex: usize, axis: usize, step: f64) -> [Vec<Point3<f64>>; 2] {
        [step, -step].map(|step| {
            let mut moved = points.to_vec();
            moved[vertex][axis] += step;
            moved
        })
    }

    #[test]
    fn the_gradient_agrees_with_differences() {
        let (surface, free) = plate();
        let pushed = |vertex: u32| {
            surface.rest[vertex as usize] + Vector3::new(0.0, 0.02 * f64::from(vertex / 6), 0.0)
        };
        let patch = patch(&surface, &free, pushed, 0.01);
        let points: Vec<Point3<f64>> = patch
            .vertices
            .iter()
            .map(|&v| pushed(v) + Vector3::new(0.0, 0.0, 0.03 * f64::from(v % 5)))
            .collect();
        let jets = evaluated(&patch, &points);
        let largest = jets.gradient.iter().map(Vector3::amax).fold(0.0, f64::max);
        for vertex in 0..free.len() {
            for axis in 0..3 {
                let [up, down] = beside(&points, vertex, axis, 1e-6).map(|at| evaluated(&patch, &at).energy);
                let slope = (up - down) / 2e-6;
                assert!((slope - jets.gradient[vertex][axis]).abs() < 1e-6 * largest, "{vertex} {axis}");
            }
        }
    }

    /// At rest nothing pulls, so that the Gauss–Newton matrix is the Hessian.
    #[test]
    fn the_matrix_agrees_with_differences_at_rest() {
        let (surface, free) = plate();
        let rest = |vertex: u32| surface.rest[vertex as usize];
        let mut patch = patch(&surface, &free, rest, 1.0);
        let points: Vec<Point3<f64>> = patch.vertices.iter().map(|&vertex| rest(vertex)).collect();
        let jets = evaluated(&patch, &points);
        assert!(jets.energy < 1e-20);
        patch.factor(&points, &jets, None).unwrap();
        let matrix = patch.matrix();
        let largest = matrix.data().iter().fold(0.0f64, |most, value| most.max(value.abs()));
        let stored = |row: usize, column: usize| matrix.get(row, column).or(matrix.get(column, row));
        for column in 0..3 * free.len() {
            let [up, down] = beside(&points, column / 3, column % 3, 1e-6).map(|at| evaluated(&patch, &at));
            for row in 0..3 * free.len() {
                let slope = (up.gradient[row / 3][row % 3] - down.gradient[row / 3][row % 3]) / 2e-6;
                let found = stored(row, column).copied().unwrap_or(0.0);
                assert!((slope - found).abs() < 1e-6 * largest, "{row} {column}: {slope} {found}");
            }
        }
    }
}
