//! Refinement of a triangle mesh by bisecting edges.
//!
//! After Rivara's longest-edge refinement: edges longer than wanted are marked; a triangle with a marked edge gets its
//! longest edge marked; a triangle is split at its longest edge first, then at its other marked ones. No angle falls
//! below half of the smallest one at the start (on a flat mesh), and no vertex comes to lie inside a neighbour's edge.

use mesh::{Label, Mesh, NO_UV, Polygons};
use nalgebra::Point3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Marks a side without a neighbour.
const NONE: u32 = u32::MAX;

/// A triangle mesh that is being refined. Old vertices keep their numbers; new ones follow in the order of
/// [`Self::parents`], so that any attribute of vertices can be carried along.
#[derive(Debug, Clone)]
pub struct Refinement {
    vertex_count: usize,
    uv_count: usize,
    parents: Vec<[u32; 2]>,
    uv_parents: Vec<[u32; 2]>,
    triangles: Vec<[u32; 3]>,
    /// Per corner its texture coordinate, or `NO_UV`.
    corner_uvs: Vec<[u32; 3]>,
    /// Per side (triangle × 3 + corner that it starts at) the side across, or `NONE`.
    twins: Vec<u32>,
    /// Per triangle the one of the start that it lies in.
    origins: Vec<u32>,
}

impl Refinement {
    /// Starts from a mesh of triangles in which no edge has more than two.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let triangles = mesh.triangles();
        let uv = |corner: usize| mesh.corner_uvs.get(corner).copied().unwrap_or(NO_UV);
        let corner_uvs = (0..triangles.len()).map(|t| [0, 1, 2].map(|corner| uv(3 * t + corner))).collect();
        Self {
            vertex_count: mesh.positions.len(),
            uv_count: mesh.uvs.len(),
            parents: Vec::new(),
            uv_parents: Vec::new(),
            twins: twins(&triangles),
            origins: (0..triangles.len() as u32).collect(),
            triangles,
            corner_uvs,
        }
    }

    /// Per new vertex the two that it lies between, in order.
    #[must_use]
    pub fn parents(&self) -> &[[u32; 2]] {
        &self.parents
    }

    /// The triangles now, those of one old triangle together and in the order of the old ones.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Splits once every edge that is longer than the mean spacing wanted at its ends (both one per vertex so far,
    /// mm), and those around it that must go along. Returns the number of new vertices; 0 when all edges are short.
    pub fn split_longer(&mut self, positions: &[Point3<f64>], spacing: &[f64]) -> usize {
        let marked = self.close(self.longer(positions, spacing), positions);
        if marked.is_empty() {
            return 0;
        }
        let before = self.parents.len();
        let middles = self.middles(&marked);
        self.split(&middles, positions);
        self.parents.len() - before
    }

    /// The refined mesh at `positions` (one per vertex, old and new); groups and texture seams are kept.
    #[must_use]
    pub fn mesh(&self, start: &Mesh, positions: Vec<Point3<f64>>) -> Mesh {
        let mut polygons = Polygons::default();
        self.triangles.iter().for_each(|triangle| polygons.push(triangle));
        let mut uvs = start.uvs.clone();
        for &[a, b] in &self.uv_parents {
            uvs.push(0.5 * (uvs[a as usize] + uvs[b as usize]));
        }
        let mut colors = start.colors.clone();
        if !colors.is_empty() {
            for &[a, b] in &self.parents {
                let (a, b) = (colors[a as usize], colors[b as usize]);
                colors.push(std::array::from_fn(|channel| 0.5 * (a[channel] + b[channel])));
            }
        }
        let first = |face: usize| self.origins.partition_point(|&origin| (origin as usize) < face);
        let labels = start
            .labels
            .iter()
            .map(|label| Label { first_face: first(label.first_face), ..label.clone() })
            .collect();
        let corner_uvs =
            if start.corner_uvs.is_empty() { Vec::new() } else { self.corner_uvs.as_flattened().to_vec() };
        Mesh { positions, polygons, uvs, corner_uvs, colors, labels }
    }

    fn ends(&self, side: u32) -> [u32; 2] {
        ends(&self.triangles, side)
    }

    /// Sides that are longer than wanted.
    fn longer(&self, positions: &[Point3<f64>], spacing: &[f64]) -> Vec<u32> {
        let is_long = |side: &u32| {
            let [a, b] = self.ends(*side).map(|vertex| vertex as usize);
            (positions[a] - positions[b]).norm() > 0.5 * (spacing[a] + spacing[b])
        };
        (0..3 * self.triangles.len() as u32).into_par_iter().filter(is_long).collect()
    }

    /// Adds the longest edge of every triangle with a marked one, until nothing is left to add. Rising.
    fn close(&self, mut open: Vec<u32>, positions: &[Point3<f64>]) -> Vec<u32> {
        let mut is_marked = vec![false; 3 * self.triangles.len()];
        let mut marked = Vec::new();
        while let Some(side) = open.pop() {
            for side in [side, self.twins[side as usize]] {
                if side == NONE || is_marked[side as usize] {
                    continue;
                }
                is_marked[side as usize] = true;
                marked.push(side);
                open.push(3 * (side / 3) + longest_side(self.triangles[side as usize / 3], positions));
            }
        }
        marked.sort_unstable();
        marked
    }

    /// A new vertex and new texture coordinates for every marked edge; per side the vertex or `NONE`, and the
    /// coordinate.
    fn middles(&mut self, marked: &[u32]) -> Vec<[u32; 2]> {
        let mut middles = vec![[NONE; 2]; 3 * self.triangles.len()];
        for &side in marked {
            let twin = self.twins[side as usize];
            let uv = self.uv_ends(side);
            let known = if twin == NONE { [NONE; 2] } else { middles[twin as usize] };
            let vertex = if known[0] == NONE { self.new_vertex(self.ends(side)) } else { known[0] };
            let is_seam = known[0] == NONE || self.uv_ends(twin) != [uv[1], uv[0]];
            middles[side as usize] = [vertex, if is_seam { self.new_uv(uv) } else { known[1] }];
        }
        middles
    }

    fn uv_ends(&self, side: u32) -> [u32; 2] {
        ends(&self.corner_uvs, side)
    }

    fn new_vertex(&mut self, parents: [u32; 2]) -> u32 {
        self.parents.push(parents);
        (self.vertex_count + self.parents.len() - 1) as u32
    }

    fn new_uv(&mut self, parents: [u32; 2]) -> u32 {
        if parents.contains(&NO_UV) {
            return NO_UV;
        }
        self.uv_parents.push(parents);
        (self.uv_count + self.uv_parents.len() - 1) as u32
    }

    fn split(&mut self, middles: &[[u32; 2]], positions: &[Point3<f64>]) {
        let mut parts = Parts::with_capacity(self.triangles.len() * 2);
        // Per old side its one or two parts, in its direction.
        let mut halves = vec![[NONE; 2]; middles.len()];
        for triangle in 0..self.triangles.len() {
            let turn = longest_side(self.triangles[triangle], positions) as usize;
            let side = |i: usize| 3 * triangle + (turn + i) % 3;
            let corner = |i: usize| {
                let at = (turn + i) % 3;
                [self.triangles[triangle][at], self.corner_uvs[triangle][at]]
            };
            let outer = parts.split(
                [0, 1, 2].map(corner),
                [0, 1, 2].map(|i| middles[side(i)]),
                self.origins[triangle],
            );
            (0..3).for_each(|i| halves[side(i)] = outer[i]);
        }
        for (side, [first, second]) in halves.iter().enumerate() {
            if self.twins[side] != NONE {
                let across = halves[self.twins[side] as usize];
                let across = if across[1] == NONE { [across[0], NONE] } else { [across[1], across[0]] };
                parts.twins[*first as usize] = across[0];
                if *second != NONE {
                    parts.twins[*second as usize] = across[1];
                }
            }
        }
        (self.triangles, self.corner_uvs) = (parts.triangles, parts.corner_uvs);
        (self.twins, self.origins) = (parts.twins, parts.origins);
    }
}

/// A corner: its vertex and its texture coordinate.
type Corner = [u32; 2];

/// The triangles after a split.
struct Parts {
    triangles: Vec<[u32; 3]>,
    corner_uvs: Vec<[u32; 3]>,
    twins: Vec<u32>,
    origins: Vec<u32>,
}

impl Parts {
    fn with_capacity(count: usize) -> Self {
        Self {
            triangles: Vec::with_capacity(count),
            corner_uvs: Vec::with_capacity(count),
            twins: Vec::with_capacity(3 * count),
            origins: Vec::with_capacity(count),
        }
    }

    /// Splits a triangle whose first side is the longest. Returns the parts of its three sides.
    fn split(&mut self, corners: [Corner; 3], middles: [Corner; 3], origin: u32) -> [[u32; 2]; 3] {
        let ([a, b, c], [ab, bc, ca]) = (corners, middles);
        if ab[0] == NONE {
            let [one, two, three] = self.push([a, b, c], origin);
            return [[one, NONE], [two, NONE], [three, NONE]];
        }
        let (left_base, left_inner, left) = if ca[0] == NONE {
            let [base, inner, side] = self.push([a, ab, c], origin);
            (base, inner, [side, NONE])
        } else {
            let [base, cut, end] = self.push([a, ab, ca], origin);
            let [inner, start, back] = self.push([ab, c, ca], origin);
            self.join(cut, back);
            (base, inner, [start, end])
        };
        let (right_base, right_inner, right) = if bc[0] == NONE {
            let [base, side, inner] = self.push([ab, b, c], origin);
            (base, inner, [side, NONE])
        } else {
            let [base, start, cut] = self.push([ab, b, bc], origin);
            let [back, end, inner] = self.push([ab, bc, c], origin);
            self.join(cut, back);
            (base, inner, [start, end])
        };
        self.join(left_inner, right_inner);
        [[left_base, right_base], right, left]
    }

    fn push(&mut self, corners: [Corner; 3], origin: u32) -> [u32; 3] {
        let first = 3 * self.triangles.len() as u32;
        self.triangles.push(corners.map(|corner| corner[0]));
        self.corner_uvs.push(corners.map(|corner| corner[1]));
        self.origins.push(origin);
        self.twins.extend([NONE; 3]);
        [first, first + 1, first + 2]
    }

    fn join(&mut self, one: u32, other: u32) {
        self.twins[one as usize] = other;
        self.twins[other as usize] = one;
    }
}

/// What stands at the two ends of a side.
fn ends(corners: &[[u32; 3]], side: u32) -> [u32; 2] {
    let triangle = corners[side as usize / 3];
    [triangle[side as usize % 3], triangle[(side as usize + 1) % 3]]
}

/// The corner that the longest side starts at, the first among equals.
fn longest_side(triangle: [u32; 3], positions: &[Point3<f64>]) -> u32 {
    let p = triangle.map(|vertex| positions[vertex as usize]);
    let length = |i: usize| (p[(i + 1) % 3] - p[i]).norm_squared();
    (1..3).fold(0, |best, i| if length(i) > length(best) { i } else { best }) as u32
}

/// Pairs the sides; where an edge has more than two, the rest stay alone.
fn twins(triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut twins = vec![NONE; 3 * triangles.len()];
    let mut waiting: HashMap<[u32; 2], u32> = HashMap::new();
    for side in 0..twins.len() as u32 {
        let [a, b] = ends(triangles, side);
        if let Some(twin) = waiting.remove(&[b, a]) {
            (twins[side as usize], twins[twin as usize]) = (twin, side);
        } else {
            waiting.insert([a, b], side);
        }
    }
    twins
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh::{Connectivity, LabelKind};
    use nalgebra::Vector2;

    /// A bumpy grid of two groups; its texture has a seam between them.
    fn grid(size: u32) -> Mesh {
        let place = |k: u32| {
            let (x, y) = (f64::from(k % (size + 1)), f64::from(k / (size + 1)));
            Point3::new(x + 0.3 * (3.1 * y).sin(), y + 0.3 * (2.3 * x).cos(), 0.0)
        };
        let count = (size + 1) * (size + 1);
        let mut mesh = Mesh { positions: (0..count).map(place).collect(), ..Mesh::default() };
        mesh.uvs = [0.0, 10.0]
            .iter()
            .flat_map(|shift| mesh.positions.iter().map(move |p| Vector2::new(p.x + shift, p.y)))
            .collect();
        let mut half = 0;
        for (j, i) in (0..size).flat_map(|j| (0..size).map(move |i| (j, i))) {
            half = if 2 * j < size { 0 } else { count };
            let at = j * (size + 1) + i;
            for triangle in [[at, at + 1, at + size + 2], [at, at + size + 2, at + size + 1]] {
                mesh.polygons.push(&triangle);
                mesh.corner_uvs.extend(triangle.map(|vertex| vertex + half));
            }
        }
        assert_eq!(half, count);
        let label = |first_face: u32, name: &str| Label {
            first_face: first_face as usize,
            kind: LabelKind::Group,
            name: name.to_string(),
        };
        mesh.labels = vec![label(0, "low"), label(2 * size * (size / 2), "high")];
        mesh
    }

    /// Spacing 0.6 on the left, 0.05 on the right.
    fn refined(start: &Mesh) -> Mesh {
        let mut refinement = Refinement::of(start);
        let mut positions = start.positions.clone();
        loop {
            let wanted: Vec<f64> = positions.iter().map(|p| (0.6 - 0.1 * p.x).clamp(0.05, 0.6)).collect();
            let first = refinement.parents().len();
            if refinement.split_longer(&positions, &wanted) == 0 {
                break;
            }
            for &[a, b] in &refinement.parents()[first..] {
                positions.push(nalgebra::center(&positions[a as usize], &positions[b as usize]));
            }
        }
        refinement.mesh(start, positions)
    }

    fn smallest_angle(mesh: &Mesh) -> f64 {
        let angles = mesh.triangles().into_iter().flat_map(|triangle| {
            let p = triangle.map(|vertex| mesh.positions[vertex as usize]);
            [0, 1, 2].map(|i| (p[(i + 1) % 3] - p[i]).angle(&(p[(i + 2) % 3] - p[i])))
        });
        angles.fold(f64::INFINITY, f64::min)
    }

    fn area(mesh: &Mesh, faces: std::ops::Range<usize>) -> f64 {
        mesh::triangle_areas(&mesh.positions, &mesh.triangles()[faces]).iter().sum()
    }

    #[test]
    fn edges_become_short_and_angles_stay_wide() {
        let start = grid(8);
        let fine = refined(&start);
        for triangle in fine.triangles() {
            for i in 0..3 {
                let [a, b] = [i, (i + 1) % 3].map(|k| fine.positions[triangle[k] as usize]);
                let wanted = |p: Point3<f64>| (0.6 - 0.1 * p.x).clamp(0.05, 0.6);
                assert!((a - b).norm() <= 0.5 * (wanted(a) + wanted(b)) + 1e-12);
            }
        }
        assert!(fine.positions.len() > 3_000);
        let (before, after) = (smallest_angle(&start), smallest_angle(&fine));
        assert!(after >= 0.5 * before - 1e-9, "{after} from {before}");
    }

    #[test]
    fn the_surface_stays_whole() {
        let start = grid(8);
        let fine = refined(&start);
        let around = Connectivity::of(fine.positions.len(), &fine.triangles());
        assert!(around.non_manifold_edges().is_empty() && around.flipped_edges().is_empty());
        assert!(around.bow_ties().is_empty() && around.unreferenced().is_empty());
        // A vertex inside a neighbour's edge would be a hole without width.
        let loops = around.boundary_loops();
        assert_eq!(loops.len(), 1);
        let old = Connectivity::of(start.positions.len(), &start.triangles()).boundary_loops();
        let length = mesh::loop_length(&fine.positions, &loops[0]);
        assert!((length - mesh::loop_length(&start.positions, &old[0])).abs() < 1e-9);
        assert_eq!(fine.positions[..start.positions.len()], start.positions[..]);
    }

    #[test]
    fn groups_and_texture_seams_stay_where_they_were() {
        let start = grid(8);
        let fine = refined(&start);
        let (cut, fine_cut) = (start.labels[1].first_face, fine.labels[1].first_face);
        assert_eq!((&*fine.labels[0].name, &*fine.labels[1].name), ("low", "high"));
        assert!((area(&start, 0..cut) - area(&fine, 0..fine_cut)).abs() < 1e-9);
        for (face, triangle) in fine.triangles().iter().enumerate() {
            let shift = if face < fine_cut { 0.0 } else { 10.0 };
            for (i, vertex) in triangle.iter().enumerate() {
                let uv = fine.uvs[fine.corner_uvs[3 * face + i] as usize];
                let p = fine.positions[*vertex as usize];
                assert!((uv - Vector2::new(p.x + shift, p.y)).norm() < 1e-9, "face {face}");
            }
        }
        // A coordinate per vertex, and one more per vertex on the seam.
        assert!(fine.uvs.len() < start.uvs.len() + (fine.positions.len() - start.positions.len()) + 300);
    }

    #[test]
    fn short_edges_change_nothing() {
        let start = grid(4);
        let mut refinement = Refinement::of(&start);
        assert_eq!(refinement.split_longer(&start.positions, &[10.0; 25]), 0);
        assert!(refinement.mesh(&start, start.positions.clone()) == start);
    }
}
