//! A finer mesh where valleys are too narrow for the scan's own.
//!
//! Triangles near a crease are halved at their longest edge until a valley has edges enough across it [Rivara1984]: angles stay
//! above half of the least that the scan has, neighbours always fit, and far from valleys nothing changes. New vertices are the
//! middles of edges, so that the surface stays the same and every sequence of the scan can be carried over.

use crate::crease::Creases;
use crate::curve::{Curve, nearest_from};
use crate::reach::reach;
use crate::surface::Surface;
use crate::{Error, Params};
use artifact::ValleysFrame;
use mesh::{Label, Mesh, NO_UV, Polygons};
use nalgebra::{Point3, Vector2};
use std::collections::BTreeMap;

/// Edges may grow by so many mm per mm of distance from a valley's rim.
const GROWTH: f64 = 0.2;
/// A valley's rim and the foot of its bulge lie within so many of its widths: edges stay short up to here.
const FINE_WIDTHS: f64 = 1.5;
/// Edges are not made shorter than this, mm, however narrow a valley is.
const SHORTEST_MM: f64 = 0.05;
/// Halvings of a triangle, at most.
const MOST_ROUNDS: usize = 24;

/// A mesh with more vertices than the scan where valleys need them.
pub struct Refinement {
    /// The finer mesh; its first vertices are the scan's.
    pub mesh: Mesh,
    /// Per vertex that was added the two that it lies in the middle of; these may have been added, too, but before it.
    pub parents: Vec<[u32; 2]>,
    /// Per triangle the scan's triangle that it is a part of.
    origins: Vec<u32>,
}

/// A corner of a triangle.
#[derive(Clone, Copy)]
struct Corner {
    vertex: u32,
    uv: u32,
}

/// A triangle, or a part of one.
#[derive(Clone, Copy)]
struct Piece {
    corners: [Corner; 3],
    /// The scan's triangle, and its polygon.
    origin: u32,
    polygon: u32,
    split: bool,
}

/// How long edges may be near a crease.
struct Need {
    curve: Curve,
    width_mm: f64,
    edge_mm: f64,
}

impl Refinement {
    /// Halves edges of `mesh` (mm) until every valley that opens has at least `edges` of them across (2 w).
    ///
    /// `wrinkles`, `valleys`: as for [`crate::Synthesis::new`], on the triangles of `mesh`; [`Refinement::valleys`] carries them over.
    ///
    /// # Errors
    /// [`Error`]: as [`crate::Synthesis::new`].
    pub fn new(
        mesh: &Mesh,
        wrinkles: &[String],
        valleys: &[ValleysFrame],
        edges: f64,
        params: &Params,
    ) -> Result<Self, Error> {
        params.check()?;
        let surface = Surface::new(mesh.positions.clone(), mesh.triangles(), params)?;
        let normals = mesh::vertex_normals(&surface.rest, &surface.triangles);
        let creases = Creases::new(&surface, &normals, wrinkles, valleys, params)?;
        let mut splitter = Splitter::new(mesh);
        for crease in creases.all.into_iter().filter(|crease| crease.narrowest_mm.is_finite()) {
            let edge_mm = (2.0 * crease.narrowest_mm / edges).max(SHORTEST_MM);
            let need = Need { width_mm: crease.widest_mm, edge_mm, curve: crease.curve };
            splitter.refine(&surface, &need);
        }
        Ok(splitter.finish(mesh))
    }

    /// A frame of the scan as a frame of the finer mesh.
    ///
    /// # Panics
    /// If it is not of the scan.
    #[must_use]
    pub fn carry(&self, positions: &[Point3<f64>]) -> Vec<Point3<f64>> {
        assert_eq!(positions.len() + self.parents.len(), self.mesh.positions.len(), "a frame of the scan");
        let mut all = Vec::with_capacity(self.mesh.positions.len());
        all.extend_from_slice(positions);
        for &[a, b] in &self.parents {
            all.push(nalgebra::center(&all[a as usize], &all[b as usize]));
        }
        all
    }

    /// Valleys on the finer mesh: each point on the part of its triangle that it lies in.
    #[must_use]
    pub fn valleys(&self, scan: &Mesh, frames: &[ValleysFrame]) -> Vec<ValleysFrame> {
        let (old, new) = (scan.triangles(), self.mesh.triangles());
        let mut parts: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (part, &origin) in self.origins.iter().enumerate() {
            parts.entry(origin).or_default().push(part as u32);
        }
        let mut frames = frames.to_vec();
        for point in frames.iter_mut().flat_map(|frame| frame.valleys.values_mut().flatten()) {
            let (Some(corners), Some(parts)) = (old.get(point.face as usize), parts.get(&point.face)) else {
                continue;
            };
            let at: nalgebra::Vector3<f64> =
                (0..3).map(|i| scan.positions[corners[i] as usize].coords * point.barycentric[i]).sum();
            let place = crate::locator::nearest_of(parts, &new, &self.mesh.positions, &Point3::from(at));
            if let Some((place, _)) = place {
                (point.face, point.barycentric) = (place.triangle, place.shares);
            }
        }
        frames
    }
}

/// Triangles while they are halved.
struct Splitter {
    positions: Vec<Point3<f64>>,
    parents: Vec<[u32; 2]>,
    uvs: Vec<Vector2<f64>>,
    /// Pieces of each of the scan's triangles.
    pieces: Vec<Vec<Piece>>,
    middles: BTreeMap<[u32; 2], u32>,
    middle_uvs: BTreeMap<[u32; 2], u32>,
}

impl Splitter {
    fn new(mesh: &Mesh) -> Self {
        let mut pieces = Vec::new();
        for polygon in 0..mesh.polygons.len() {
            let range = mesh.polygons.corner_range(polygon);
            let corner = |at: usize| Corner {
                vertex: mesh.polygons.corners()[at],
                uv: mesh.corner_uvs.get(at).copied().unwrap_or(NO_UV),
            };
            for at in range.start + 1..range.end.max(1) - 1 {
                let corners = [range.start, at, at + 1].map(corner);
                let [a, b, c] = corners.map(|corner| corner.vertex);
                if a != b && b != c && c != a {
                    let (origin, polygon) = (pieces.len() as u32, polygon as u32);
                    pieces.push(vec![Piece { corners, origin, polygon, split: false }]);
                }
            }
        }
        Self {
            positions: mesh.positions.clone(),
            parents: Vec::new(),
            uvs: mesh.uvs.clone(),
            pieces,
            middles: BTreeMap::new(),
            middle_uvs: BTreeMap::new(),
        }
    }

    /// Halves what is too long near a crease, and what must be so that triangles fit.
    fn refine(&mut self, surface: &Surface, need: &Need) {
        let longest = need.curve.places.iter().flat_map(|place| self.pieces[place.triangle as usize].iter());
        let reach_mm = 3.0 * FINE_WIDTHS * need.width_mm
            + longest.map(|piece| self.longest(piece).0).fold(0.0, f64::max);
        let near = reach(surface, &need.curve, reach_mm);
        let mut origins: Vec<u32> =
            near.iter().flat_map(|beside| surface.around(beside.vertex)).copied().collect();
        origins.sort_unstable();
        origins.dedup();
        for _ in 0..MOST_ROUNDS {
            let pieces = || origins.iter().flat_map(|&origin| &self.pieces[origin as usize]);
            let edges: Vec<[u32; 2]> = pieces()
                .filter(|piece| self.is_too_long(piece, need))
                .map(|piece| self.longest(piece).1)
                .collect();
            if edges.is_empty() {
                return;
            }
            edges.into_iter().for_each(|edge| self.halve(edge));
            self.fit();
        }
    }

    fn is_too_long(&self, piece: &Piece, need: &Need) -> bool {
        let (length, _) = self.longest(piece);
        if length <= need.edge_mm || need.curve.points.len() < 2 {
            return false;
        }
        let [a, b, c] = piece.corners.map(|corner| self.positions[corner.vertex as usize].coords);
        let middle = Point3::from((a + b + c) / 3.0);
        // The nearest corner of the polyline first, since the way downhill along it could end before.
        let distance = |at: &Point3<f64>| (at - middle).norm_squared();
        let points = &need.curve.points;
        let start = (0..points.len()).min_by(|&i, &j| distance(&points[i]).total_cmp(&distance(&points[j])));
        let away = nearest_from(points, start.unwrap_or(0) as u32, &middle).distance - 0.5 * length;
        length > need.edge_mm + GROWTH * (away - FINE_WIDTHS * need.width_mm).max(0.0)
    }

    /// A triangle's longest edge; of two equally long the same one for both of its triangles.
    fn longest(&self, piece: &Piece) -> (f64, [u32; 2]) {
        let side = |i: usize| {
            let [a, b] = [piece.corners[i].vertex, piece.corners[(i + 1) % 3].vertex];
            let ends = [a.min(b), a.max(b)];
            ((self.positions[ends[0] as usize] - self.positions[ends[1] as usize]).norm(), ends)
        };
        let longer = |a: (f64, [u32; 2]), b: (f64, [u32; 2])| if (b.0, b.1) > (a.0, a.1) { b } else { a };
        longer(longer(side(0), side(1)), side(2))
    }

    /// Puts a vertex into the middle of an edge, if there is none yet.
    fn halve(&mut self, edge: [u32; 2]) {
        if !self.middles.contains_key(&edge) {
            let [a, b] = edge.map(|vertex| self.positions[vertex as usize]);
            self.middles.insert(edge, self.positions.len() as u32);
            self.positions.push(nalgebra::center(&a, &b));
            self.parents.push(edge);
        }
    }

    /// Splits every triangle with a vertex in one of its edges, at its longest edge, until there is none.
    fn fit(&mut self) {
        loop {
            let open = |(origin, pieces): (usize, &Vec<Piece>)| {
                pieces.iter().any(|piece| self.is_open(piece)).then_some(origin)
            };
            let open: Vec<usize> = self.pieces.iter().enumerate().filter_map(open).collect();
            if open.is_empty() {
                return;
            }
            for origin in open {
                let pieces = std::mem::take(&mut self.pieces[origin]);
                let parts = pieces.into_iter().flat_map(|piece| self.parts(piece)).collect();
                self.pieces[origin] = parts;
            }
        }
    }

    fn is_open(&self, piece: &Piece) -> bool {
        (0..3).any(|i| {
            let [a, b] = [piece.corners[i].vertex, piece.corners[(i + 1) % 3].vertex];
            self.middles.contains_key(&[a.min(b), a.max(b)])
        })
    }

    fn parts(&mut self, piece: Piece) -> Vec<Piece> {
        if !self.is_open(&piece) {
            return vec![piece];
        }
        let (_, edge) = self.longest(&piece);
        self.halve(edge);
        let first = (0..3).find(|&i| !edge.contains(&piece.corners[(i + 2) % 3].vertex)).unwrap_or(0);
        let [a, b, c] = [0, 1, 2].map(|i| piece.corners[(first + i) % 3]);
        let middle = Corner { vertex: self.middles[&edge], uv: self.middle_uv([a.uv, b.uv]) };
        [[a, middle, c], [middle, b, c]].map(|corners| Piece { corners, split: true, ..piece }).into()
    }

    fn middle_uv(&mut self, ends: [u32; 2]) -> u32 {
        if ends.contains(&NO_UV) {
            return NO_UV;
        }
        let key = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let uvs = &mut self.uvs;
        *self.middle_uvs.entry(key).or_insert_with(|| {
            uvs.push((uvs[key[0] as usize] + uvs[key[1] as usize]) * 0.5);
            uvs.len() as u32 - 1
        })
    }

    /// Polygons that were not touched stay as they are; of the others, every part is a triangle.
    fn finish(self, scan: &Mesh) -> Refinement {
        let mut touched = vec![false; scan.polygons.len()];
        for piece in self.pieces.iter().flatten().filter(|piece| piece.split) {
            touched[piece.polygon as usize] = true;
        }
        let (mut polygons, mut corner_uvs, mut first_faces) = (Polygons::default(), Vec::new(), Vec::new());
        let mut rest = self.pieces.iter().flatten().peekable();
        for (polygon, &touched) in touched.iter().enumerate() {
            first_faces.push(polygons.len());
            if !touched {
                polygons.push(scan.polygons.face(polygon));
                corner_uvs.extend_from_slice(
                    scan.corner_uvs.get(scan.polygons.corner_range(polygon)).unwrap_or(&[]),
                );
            }
            while let Some(piece) = rest.next_if(|piece| piece.polygon as usize == polygon) {
                if touched {
                    polygons.push(&piece.corners.map(|corner| corner.vertex));
                    if !scan.corner_uvs.is_empty() {
                        corner_uvs.extend(piece.corners.map(|corner| corner.uv));
                    }
                }
            }
        }
        let move_label = |label: &Label| Label {
            first_face: first_faces.get(label.first_face).copied().unwrap_or(polygons.len()),
            ..label.clone()
        };
        let mut colors = scan.colors.clone();
        if !colors.is_empty() {
            for &[a, b] in &self.parents {
                let [a, b] = [colors[a as usize], colors[b as usize]];
                colors.push([0, 1, 2].map(|i| 0.5 * (a[i] + b[i])));
            }
        }
        let origins = self.pieces.iter().flatten().map(|piece| piece.origin).collect();
        let labels = scan.labels.iter().map(move_label).collect();
        let mesh = Mesh { positions: self.positions, polygons, uvs: self.uvs, corner_uvs, colors, labels };
        Refinement { mesh, parents: self.parents, origins }
    }
}
