//! A part of the shell whose vertices are free, with everything else standing still: energy, gradient, Hessian.

use crate::energy::{self, Curvature};
use crate::slack::Slack;
use crate::sum::Sum;
use crate::surface::{NONE, Surface};
use nalgebra::{Point3, Vector3};
use operators::{CsMat, Ordering};

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

/// Free vertices, the elements that touch them, and the pattern of their Hessian.
pub(crate) struct Patch<'a> {
    surface: &'a Surface,
    /// The mesh's vertices: the free ones first, rising, then those that elements touch besides.
    pub(crate) vertices: Vec<u32>,
    pub(crate) free_count: usize,
    springs: Vec<Vec<Spring>>,
    /// Hinges and triangles of the mesh, with their vertices' places in `vertices`.
    hinges: Vec<(u32, [u32; 4])>,
    triangles: Vec<(u32, [u32; 3])>,
    /// Per hinge its edge's length and per triangle its area, at rest.
    lengths: Vec<Slack>,
    areas: Vec<Slack>,
    /// Per free vertex where the blocks of its columns start, in blocks.
    starts: Vec<usize>,
    /// Per block the free vertex of its rows; rising in every column.
    rows: Vec<u32>,
    matrix: CsMat<f64>,
}

impl<'a> Patch<'a> {
    /// `free`: rising; `springs`: per free vertex.
    pub(crate) fn new(surface: &'a Surface, free: Vec<u32>, springs: Vec<Vec<Spring>>) -> Self {
        let free_count = free.len();
        let mut places = Places::new(surface.rest.len(), free);
        let mut near: Vec<u32> =
            places.vertices.iter().flat_map(|&vertex| surface.around(vertex)).copied().collect();
        near.sort_unstable();
        near.dedup();
        let mut edges: Vec<u32> =
            near.iter().flat_map(|&triangle| surface.sides[triangle as usize]).collect();
        edges.sort_unstable();
        edges.dedup();
        let triangles: Vec<(u32, [u32; 3])> = near
            .iter()
            .map(|&at| (at, surface.triangles[at as usize].map(|vertex| places.of(vertex))))
            .collect();
        let hinges: Vec<(u32, [u32; 4])> = edges
            .iter()
            .map(|&at| (at, surface.hinges[at as usize].vertices.map(|vertex| places.of(vertex))))
            .filter(|(_, around)| around.iter().any(|&vertex| (vertex as usize) < free_count))
            .collect();
        let (starts, rows) = block_pattern(free_count, &hinges);
        let matrix = blank_matrix(&starts, &rows);
        let lengths = hinges
            .iter()
            .map(|&(at, _)| {
                let length = surface.hinges[at as usize].length;
                Slack::new(length, length, 1.0)
            })
            .collect();
        let areas = triangles
            .iter()
            .map(|&(at, _)| {
                let area = surface.rest_areas[at as usize];
                Slack::new(area, area, 1.0)
            })
            .collect();
        let vertices = places.vertices;
        Self {
            surface,
            vertices,
            free_count,
            springs,
            hinges,
            triangles,
            lengths,
            areas,
            starts,
            rows,
            matrix,
        }
    }

    /// Takes every edge and triangle for slack between its measure at rest and that in the motion without wrinkles
    /// ([`crate::slack`]). `large`: of `vertices`.
    pub(crate) fn slacken(&mut self, large: &[Point3<f64>], share: f64) {
        let at = |vertex: u32| large[vertex as usize];
        for (&(number, around), length) in self.hinges.iter().zip(&mut self.lengths) {
            let given = (at(around[1]) - at(around[0])).norm();
            *length = Slack::new(self.surface.hinges[number as usize].length, given, share);
        }
        for (&(number, corners), area) in self.triangles.iter().zip(&mut self.areas) {
            let [a, b, c] = corners.map(at);
            let given = 0.5 * (b - a).cross(&(c - a)).norm();
            *area = Slack::new(self.surface.rest_areas[number as usize], given, share);
        }
    }

    /// An elimination order of the unknowns (x, y, z of each free vertex): nested dissection of the vertices.
    pub(crate) fn order(&self) -> Vec<u32> {
        let count = self.free_count;
        let mut indices = Vec::with_capacity(self.rows.len());
        indices.extend(self.rows.iter().map(|&row| row as usize));
        let pattern =
            CsMat::new_csc((count, count), self.starts.clone(), indices, vec![1.0; self.rows.len()]);
        let points: Vec<Point3<f64>> =
            self.vertices[..count].iter().map(|&vertex| self.surface.rest[vertex as usize]).collect();
        let order = Ordering::nested_dissection(&pattern, &points);
        order.vertices().iter().flat_map(|&vertex| [3 * vertex, 3 * vertex + 1, 3 * vertex + 2]).collect()
    }

    /// The energy of everything that touches a free vertex. `points`: of `vertices`.
    pub(crate) fn energy(&self, points: &[Point3<f64>]) -> f64 {
        let at = |vertex: u32| points[vertex as usize];
        let mut sum = 0.0;
        for (&(number, around), length) in self.hinges.iter().zip(&self.lengths) {
            let hinge = &self.surface.hinges[number as usize];
            if self.stretches(&around) {
                sum += hinge.edge_weight * length.energy((at(around[1]) - at(around[0])).norm());
            }
            if hinge.bends() {
                let angle = energy::dihedral_angle(&around.map(at));
                let excess = energy::wrapped(angle - hinge.angle);
                sum += hinge.bend_weight * excess * excess;
            }
        }
        for (&(number, corners), area) in self.triangles.iter().zip(&self.areas) {
            let [a, b, c] = corners.map(at);
            sum += self.surface.area_weights[number as usize]
                * area.energy(0.5 * (b - a).cross(&(c - a)).norm());
        }
        sum + self.spring_energy(points)
    }

    fn spring_energy(&self, points: &[Point3<f64>]) -> f64 {
        let of = |(point, springs): (&Point3<f64>, &Vec<Spring>)| -> f64 {
            springs.iter().map(|spring| spring.stiffness * spring.stretch(point).norm_squared()).sum()
        };
        points.iter().zip(&self.springs).map(of).sum()
    }

    fn stretches(&self, around: &[u32; 4]) -> bool {
        around[..2].iter().any(|&vertex| (vertex as usize) < self.free_count)
    }

    /// Energy and gradient (x, y, z of each free vertex); the Hessian stands in [`Patch::matrix`] after.
    pub(crate) fn linearise(&mut self, points: &[Point3<f64>], curvature: Curvature) -> (f64, Vec<f64>) {
        let mut sum = Sum {
            free_count: self.free_count as u32,
            starts: &self.starts,
            rows: &self.rows,
            values: self.matrix.data_mut(),
            energy: 0.0,
            gradient: vec![0.0; 3 * self.free_count],
        };
        sum.values.fill(0.0);
        let at = |vertex: u32| points[vertex as usize];
        for (&(number, around), length) in self.hinges.iter().zip(&self.lengths) {
            let hinge = &self.surface.hinges[number as usize];
            let ends = [around[0], around[1]];
            if ends.iter().any(|&vertex| vertex < sum.free_count) {
                let points = ends.map(at);
                let measure = (points[1] - points[0]).norm();
                let (rest, share) = length.parabola(measure);
                let mut term = energy::edge(&points, rest, share * hinge.edge_weight, curvature);
                term.energy = hinge.edge_weight * length.energy(measure);
                sum.add(&ends, &term);
            }
            if hinge.bends() {
                let term = energy::hinge(&around.map(at), hinge.angle, hinge.bend_weight, curvature);
                sum.add(&around, &term);
            }
        }
        for (&(number, corners), area) in self.triangles.iter().zip(&self.areas) {
            let weight = self.surface.area_weights[number as usize];
            let points = corners.map(at);
            let measure = 0.5 * (points[1] - points[0]).cross(&(points[2] - points[0])).norm();
            let (rest, share) = area.parabola(measure);
            let mut term = energy::triangle(&points, rest, share * weight, curvature);
            term.energy = weight * area.energy(measure);
            sum.add(&corners, &term);
        }
        for (vertex, springs) in self.springs.iter().enumerate() {
            springs.iter().for_each(|spring| sum.add_spring(vertex as u32, at(vertex as u32), spring));
        }
        (sum.energy, sum.gradient)
    }

    pub(crate) fn matrix(&self) -> &CsMat<f64> {
        &self.matrix
    }

    /// Triangles that have turned over or lost nearly all their area, as (inverted, degenerate).
    pub(crate) fn damage(&self, points: &[Point3<f64>], normals: &[Vector3<f64>]) -> [usize; 2] {
        let mut counts = [0; 2];
        for &(number, corners) in &self.triangles {
            let [a, b, c] = corners.map(|vertex| points[vertex as usize]);
            let area = 0.5 * (b - a).cross(&(c - a));
            let outwards: Vector3<f64> = corners.iter().map(|&vertex| normals[vertex as usize]).sum();
            counts[0] += usize::from(area.dot(&outwards) < 0.0);
            counts[1] += usize::from(area.norm() < 0.05 * self.surface.rest_areas[number as usize]);
        }
        counts
    }
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

/// Per free vertex the free vertices that share a hinge with it, itself included.
fn block_pattern(free_count: usize, hinges: &[(u32, [u32; 4])]) -> (Vec<usize>, Vec<u32>) {
    let mut pairs: Vec<Vec<u32>> = vec![Vec::with_capacity(24); free_count];
    let free = |vertex: u32| (vertex as usize) < free_count;
    for (_, around) in hinges {
        for &column in around.iter().filter(|&&vertex| free(vertex)) {
            pairs[column as usize].extend(around.iter().copied().filter(|&vertex| free(vertex)));
        }
    }
    let mut starts = vec![0];
    let mut rows = Vec::new();
    for column in &mut pairs {
        column.sort_unstable();
        column.dedup();
        rows.extend_from_slice(column);
        starts.push(rows.len());
    }
    (starts, rows)
}

fn blank_matrix(starts: &[usize], rows: &[u32]) -> CsMat<f64> {
    let count = starts.len() - 1;
    let (mut column_starts, mut indices) = (vec![0], Vec::with_capacity(9 * rows.len()));
    for column in 0..count {
        for _ in 0..3 {
            let blocks = &rows[starts[column]..starts[column + 1]];
            indices.extend(blocks.iter().flat_map(|&row| (0..3).map(move |r| 3 * row as usize + r)));
            column_starts.push(indices.len());
        }
    }
    let values = vec![0.0; indices.len()];
    CsMat::new_csc((3 * count, 3 * count), column_starts, indices, values)
}
