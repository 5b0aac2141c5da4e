//! The mesh that is baked onto, as a renderer sees it.

use crate::Error;
use crate::tangent::{Tangent, tangents};
use mesh::{LabelKind, Mesh, NO_UV};
use nalgebra::{Point3, Vector2, Vector3};
use std::collections::HashMap;

/// A triangle mesh with texture coordinates, normals and tangents per corner.
pub struct Low {
    /// Per triangle its corners.
    pub triangles: Vec<[Corner; 3]>,
    /// Per triangle its tile.
    pub tiles: Vec<u32>,
}

/// A corner of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Its place, mm.
    pub point: Point3<f64>,
    /// Its texture coordinates, v up.
    pub uv: Vector2<f64>,
    /// The unit normal.
    pub normal: Vector3<f64>,
    /// The tangent of MikkTSpace.
    pub tangent: Tangent,
}

impl Low {
    /// Polygons are split as fans from their first corner, as everywhere here: triangulate the mesh first where the renderer splits it
    /// otherwise. Normals are smooth, weighted by the angle, but for polygons of different smoothing groups; vertices at the same place
    /// share them, so that seams of the texture stay unseen. Tangents are those of MikkTSpace [Mikkelsen2008].
    ///
    /// # Errors
    /// If there are no triangles, or one has no texture coordinates, or lies on two tiles.
    pub fn of(mesh: &Mesh) -> Result<Self, Error> {
        let corners = corners(mesh)?;
        if corners.is_empty() {
            return Err(Error::Empty { which: "low-resolution" });
        }
        let normals = smooth_normals(mesh, &corners);
        let bare: Vec<[Corner; 3]> = corners
            .iter()
            .zip(&normals)
            .map(|(fan, normals)| {
                [0, 1, 2].map(|k| Corner {
                    point: mesh.positions[fan.vertices[k] as usize],
                    uv: fan.uvs[k],
                    normal: normals[k],
                    tangent: Tangent::default(),
                })
            })
            .collect();
        let tiles = corners.iter().map(|fan| tile(fan.face, &fan.uvs)).collect::<Result<_, _>>()?;
        let tangents = tangents(&bare)?;
        let mut triangles = bare;
        for (triangle, tangents) in triangles.iter_mut().zip(tangents) {
            for (corner, tangent) in triangle.iter_mut().zip(tangents) {
                corner.tangent = tangent;
            }
        }
        Ok(Self { triangles, tiles })
    }

    /// The tiles that there are, rising.
    pub(crate) fn tile_numbers(&self) -> Vec<u32> {
        let mut numbers = self.tiles.clone();
        numbers.sort_unstable();
        numbers.dedup();
        numbers
    }
}

/// A triangle of a polygon's fan.
struct Fan {
    face: usize,
    vertices: [u32; 3],
    uvs: [Vector2<f64>; 3],
}

fn corners(mesh: &Mesh) -> Result<Vec<Fan>, Error> {
    let mut all = Vec::new();
    for face in 0..mesh.polygons.len() {
        let range = mesh.polygons.corner_range(face);
        let vertices = mesh.polygons.face(face);
        let uv_ids = mesh.corner_uvs.get(range).ok_or(Error::NoTextureCoordinates { face: face + 1 })?;
        if uv_ids.contains(&NO_UV) {
            return Err(Error::NoTextureCoordinates { face: face + 1 });
        }
        for k in 1..vertices.len().saturating_sub(1) {
            let fan = [0, k, k + 1];
            let [a, b, c] = fan.map(|k| vertices[k]);
            // As `Mesh::triangles`: what names a vertex twice has no area.
            if a != b && b != c && c != a {
                let uvs = fan.map(|k| mesh.uvs[uv_ids[k] as usize]);
                all.push(Fan { face, vertices: [a, b, c], uvs });
            }
        }
    }
    Ok(all)
}

/// Normals per corner: those of vertices that places and smoothing groups tell apart.
fn smooth_normals(mesh: &Mesh, corners: &[Fan]) -> Vec<[Vector3<f64>; 3]> {
    let groups = smoothing_groups(mesh);
    let mut number: HashMap<([u64; 3], u64), u32> = HashMap::new();
    let mut points: Vec<Point3<f64>> = Vec::new();
    let mut vertex = |at: Point3<f64>, group: u64| {
        // Adding zero makes −0 and 0 one place.
        let key = [at.x, at.y, at.z].map(|x| (x + 0.0).to_bits());
        *number.entry((key, group)).or_insert_with(|| {
            points.push(at);
            points.len() as u32 - 1
        })
    };
    let triangles: Vec<[u32; 3]> = corners
        .iter()
        .map(|fan| fan.vertices.map(|v| vertex(mesh.positions[v as usize], groups[fan.face])))
        .collect();
    let normals = mesh::vertex_normals(&points, &triangles);
    triangles.iter().map(|triangle| triangle.map(|vertex| normals[vertex as usize])).collect()
}

/// Per polygon its smoothing group: 0 where the mesh names none, one of its own where smoothing is off.
fn smoothing_groups(mesh: &Mesh) -> Vec<u64> {
    let labels: Vec<_> = mesh.labels.iter().filter(|label| label.kind == LabelKind::Smoothing).collect();
    let mut next = 0;
    let mut names: HashMap<&str, u64> = HashMap::new();
    (0..mesh.polygons.len())
        .map(|face| {
            while labels.get(next).is_some_and(|label| label.first_face <= face) {
                next += 1;
            }
            match next.checked_sub(1).map(|at| labels[at].name.trim()) {
                None => 0,
                Some("off" | "0") => (1 << 32) + face as u64,
                Some(name) => {
                    let count = names.len() as u64;
                    1 + *names.entry(name).or_insert(count)
                }
            }
        })
        .collect()
}

/// The tile that a triangle lies on: a corner on the border belongs to either side.
fn tile(face: usize, uvs: &[Vector2<f64>; 3]) -> Result<u32, Error> {
    let middle = (uvs[0] + uvs[1] + uvs[2]) / 3.0;
    let [column, row] = [middle.x.floor(), middle.y.floor()];
    let face = face + 1;
    if !((0.0..10.0).contains(&column) && (0.0..800.0).contains(&row)) {
        return Err(Error::NoTile { face, u: middle.x, v: middle.y });
    }
    let number = |column: f64, row: f64| 1001 + column as u32 + 10 * row as u32;
    let first = number(column, row);
    let outside = |uv: &&Vector2<f64>| {
        let beyond = |x: f64, low: f64| x < low - BORDER || x > low + 1.0 + BORDER;
        beyond(uv.x, column) || beyond(uv.y, row)
    };
    match uvs.iter().find(outside) {
        Some(uv) => {
            let second = number(uv.x.floor().max(0.0), uv.y.floor().max(0.0));
            Err(Error::AcrossTiles { face, first, second })
        }
        None => Ok(first),
    }
}

/// How far beyond a tile a corner may lie by rounding.
const BORDER: f64 = 1e-5;
