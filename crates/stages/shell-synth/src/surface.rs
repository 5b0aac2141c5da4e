//! The rest mesh as a shell: edges, hinges, triangles and their measures at rest.

use crate::energy::dihedral;
use crate::{Error, Params, Solver};
use mesh::Around;
use nalgebra::Point3;

/// No vertex, no triangle.
pub(crate) const NONE: u32 = u32::MAX;
/// Edge length, mm, that the stiffness of edges is stated for.
const STATED_EDGE_MM: f64 = 0.3;

/// An edge with the triangles beside it, and what they are at rest.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hinge {
    /// Ends, in the direction of the first triangle, and the apexes of both triangles ([`NONE`]: there is none).
    pub(crate) vertices: [u32; 4],
    pub(crate) length: f64,
    pub(crate) edge_weight: f64,
    pub(crate) angle: f64,
    pub(crate) bend_weight: f64,
}

impl Hinge {
    pub(crate) fn bends(&self) -> bool {
        self.vertices[3] != NONE && self.bend_weight > 0.0
    }
}

/// A mesh in its rest pose, with all that the energy asks for.
#[derive(Debug)]
pub(crate) struct Surface {
    pub(crate) rest: Vec<Point3<f64>>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) rest_areas: Vec<f64>,
    pub(crate) area_weights: Vec<f64>,
    pub(crate) hinges: Vec<Hinge>,
    /// Per triangle its three edges.
    pub(crate) sides: Vec<[u32; 3]>,
    around: Around,
    pub(crate) boundary: Vec<bool>,
    /// A third of the area of the triangles around each vertex, mm².
    pub(crate) vertex_areas: Vec<f64>,
}

impl Surface {
    pub(crate) fn new(
        rest: Vec<Point3<f64>>,
        triangles: Vec<[u32; 3]>,
        params: &Params,
    ) -> Result<Self, Error> {
        let rest_areas = mesh::triangle_areas(&rest, &triangles);
        let around = Around::of(rest.len(), &triangles);
        let mut surface = Self {
            vertex_areas: vec![0.0; rest.len()],
            boundary: vec![false; rest.len()],
            area_weights: rest_areas
                .iter()
                .map(|&area| params.area_stiffness / area.max(f64::MIN_POSITIVE))
                .collect(),
            sides: vec![[NONE; 3]; triangles.len()],
            hinges: Vec::new(),
            rest,
            triangles,
            rest_areas,
            around,
        };
        surface.join_edges(params)?;
        for (triangle, area) in surface.triangles.iter().zip(&surface.rest_areas) {
            triangle.iter().for_each(|&vertex| surface.vertex_areas[vertex as usize] += area / 3.0);
        }
        Ok(surface)
    }

    /// Triangles around a vertex, rising.
    pub(crate) fn around(&self, vertex: u32) -> &[u32] {
        self.around.at(vertex)
    }

    /// Calls `with` for every corner of the triangles around a vertex but itself: inner neighbours come twice.
    pub(crate) fn for_neighbors(&self, vertex: u32, mut with: impl FnMut(u32)) {
        for &triangle in self.around(vertex) {
            self.triangles[triangle as usize]
                .iter()
                .filter(|&&other| other != vertex)
                .for_each(|&other| with(other));
        }
    }

    /// Refuses triangles without area around some vertices: their energy has no rest.
    pub(crate) fn check_areas(&self, vertices: &[u32]) -> Result<(), Error> {
        for &vertex in vertices {
            if let Some(&triangle) =
                self.around(vertex).iter().find(|&&at| self.rest_areas[at as usize] <= 1e-12)
            {
                return Err(Error::Degenerate { triangle, vertex });
            }
        }
        Ok(())
    }

    fn join_edges(&mut self, params: &Params) -> Result<(), Error> {
        let count = self.triangles.len() as u32 * 3;
        let mut sides: Vec<(u64, u32)> = (0..count).map(|side| (self.key(side), side)).collect();
        rayon::slice::ParallelSliceMut::par_sort_unstable(&mut sides[..]);
        let mut at = 0;
        while at < sides.len() {
            let end = at + sides[at..].iter().take_while(|side| side.0 == sides[at].0).count();
            let edge = self.hinges.len() as u32;
            let [start, stop] = self.ends(sides[at].1);
            match end - at {
                1 => [start, stop].iter().for_each(|&vertex| self.boundary[vertex as usize] = true),
                2 => {}
                _ => return Err(Error::NonManifold(start.min(stop), start.max(stop))),
            }
            for &(_, side) in &sides[at..end] {
                self.sides[side as usize / 3][side as usize % 3] = edge;
            }
            let second = (end - at == 2).then(|| sides[at + 1].1);
            let hinge = self.hinge(sides[at].1, second, params);
            self.hinges.push(hinge);
            at = end;
        }
        Ok(())
    }

    fn ends(&self, side: u32) -> [u32; 2] {
        let corners = self.triangles[side as usize / 3];
        [corners[side as usize % 3], corners[(side as usize + 1) % 3]]
    }

    fn apex(&self, side: u32) -> u32 {
        self.triangles[side as usize / 3][(side as usize + 2) % 3]
    }

    fn key(&self, side: u32) -> u64 {
        let [a, b] = self.ends(side);
        u64::from(a.min(b)) << 32 | u64::from(a.max(b))
    }

    fn hinge(&self, first: u32, second: Option<u32>, params: &Params) -> Hinge {
        let [start, stop] = self.ends(first);
        let length = (self.rest[stop as usize] - self.rest[start as usize]).norm().max(f64::MIN_POSITIVE);
        let areas: f64 =
            [Some(first), second].iter().flatten().map(|side| self.rest_areas[*side as usize / 3]).sum();
        let mean_area = areas / if second.is_some() { 2.0 } else { 1.0 };
        // The side of an equilateral triangle of that area.
        let local = (4.0 * mean_area / 3f64.sqrt()).sqrt();
        let scale = if params.solver == Solver::Paper { 1.0 } else { local / STATED_EDGE_MM };
        let mut hinge = Hinge {
            vertices: [start, stop, self.apex(first), NONE],
            length,
            edge_weight: params.edge_stiffness * scale / length,
            angle: 0.0,
            bend_weight: 0.0,
        };
        // A second triangle that runs the same way is turned over: there is no angle to speak of.
        if let Some(second) = second.filter(|&second| self.ends(second) == [stop, start]) {
            hinge.vertices[3] = self.apex(second);
            hinge.angle = dihedral(&hinge.vertices.map(|vertex| self.rest[vertex as usize])).0;
            // A third of the mean height of both triangles [Grinspun2003].
            let height = 2.0 * mean_area / length / 3.0;
            hinge.bend_weight = params.bending_stiffness * length / height.max(f64::MIN_POSITIVE);
        }
        hinge
    }
}
