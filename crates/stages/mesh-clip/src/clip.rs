//! The order of the work: slit, select, make sound, map.

use crate::path::{Edges, check_range};
use crate::slit::slit;
use crate::soundness::{Dropped, drop_non_manifold};
use crate::{Error, Params};
use mesh::{Connectivity, Mesh, NO_UV, triangle_areas};
use nalgebra::{Point3, Vector2, Vector3};

/// What was picked on the mesh, by vertex index (0-based).
#[derive(Debug, Clone, Default)]
pub struct Picks<'a> {
    /// Only faces all of whose vertices are in every one of these sets stay.
    pub keep: Vec<&'a [u32]>,
    /// Faces all (with `touching`: any) of whose vertices are in one of these sets go.
    pub remove: Vec<&'a [u32]>,
    /// Lines to slit the mesh along; the shortest way along edges is taken from each vertex to the next.
    pub cuts: Vec<&'a [u32]>,
    /// A picture over the texture coordinates; its dark texels are cut away.
    pub mask: Option<Mask>,
}

/// A grey picture; row 0 is the top, where v = 1. Coordinates beyond the unit square repeat it.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    /// Texels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Brightness 0–1, row after row.
    pub texels: Vec<f64>,
}

impl Mask {
    fn at(&self, uv: Vector2<f64>) -> f64 {
        let texel = |x: f64, count: usize| ((x.rem_euclid(1.0) * count as f64) as usize).min(count - 1);
        self.texels[texel(1.0 - uv.y, self.height) * self.width + texel(uv.x, self.width)]
    }
}

/// What is left of a mesh, with the way back.
#[derive(Debug, Clone)]
pub struct Clipped {
    /// What is left. Positions, texture coordinates, colours and labels are those of the old mesh, bit for bit.
    pub mesh: Mesh,
    /// Per old vertex its new index, of its first copy where a slit doubled it; `None` where it is gone.
    pub new_from_old: Vec<Option<u32>>,
    /// Per new vertex its old index: rising, and after that the copies that slits made.
    pub old_from_new: Vec<u32>,
    /// Vertices on cuts that were doubled.
    pub slit_vertices: usize,
    /// What was dropped to make the surface a manifold.
    pub dropped: Dropped,
    /// Components left out because they were not the largest.
    pub dropped_components: usize,
}

/// Cuts faces out of a mesh [BickelBotsch2007, Sec. 6.2: eyes and all above the hair line are cut out].
///
/// First the mesh is slit along the cuts, then faces go by region, set and mask, then faces go until the surface is a
/// manifold, then all components but the largest go. Vertices without a face go; all others keep their order.
///
/// # Errors
/// [`Error`]: a pick out of range, no way between two picks of a cut, a mask without texture coordinates, nothing left.
pub fn clip(mesh: &Mesh, picks: &Picks, params: &Params) -> Result<Clipped, Error> {
    params.check()?;
    let edges = Edges::of(mesh);
    let lines: Vec<Vec<u32>> = picks.cuts.iter().map(|cut| edges.line(cut)).collect::<Result<_, _>>()?;
    let slit = slit(mesh, &lines);
    let mut keep = selected(mesh, picks, params)?;
    narrow_cuts(mesh, &lines, params.slit_width_mm, &mut keep);
    check_left(&keep, "what was selected leaves nothing")?;
    let dropped = match params.drop_non_manifold {
        true => drop_non_manifold(&slit.mesh, &mut keep),
        false => Dropped::default(),
    };
    check_left(&keep, "every face was on a non-manifold edge or at a bow tie")?;
    let dropped_components = match params.keep_largest_component {
        true => keep_largest(&slit.mesh, &mut keep),
        false => 0,
    };
    let (left, map) = slit.mesh.keep_faces(&keep);
    let old_from_new: Vec<u32> =
        map.old_from_new.iter().map(|&slit_vertex| slit.whole_from_slit[slit_vertex as usize]).collect();
    let mut new_from_old = vec![None; mesh.positions.len()];
    for (new, &old) in old_from_new.iter().enumerate().rev() {
        new_from_old[old as usize] = Some(new as u32);
    }
    let slit_vertices = slit.whole_from_slit.len() - mesh.positions.len();
    Ok(Clipped { mesh: left, new_from_old, old_from_new, slit_vertices, dropped, dropped_components })
}

fn check_left(keep: &[bool], why: &'static str) -> Result<(), Error> {
    match keep.iter().any(|&kept| kept) {
        true => Ok(()),
        false => Err(Error::NothingLeft { face_count: keep.len(), why }),
    }
}

/// Per face whether regions, sets and mask leave it.
fn selected(mesh: &Mesh, picks: &Picks, params: &Params) -> Result<Vec<bool>, Error> {
    let mut keep = vec![true; mesh.polygons.len()];
    let mut restrict = |inside: &dyn Fn(u32) -> bool| {
        for (face, polygon) in mesh.polygons.iter().enumerate() {
            keep[face] &= polygon.iter().all(|&vertex| inside(vertex));
        }
    };
    for set in &picks.keep {
        let flags = flags(mesh, set)?;
        restrict(&|vertex| flags[vertex as usize]);
    }
    for region in &params.keep_regions {
        restrict(&|vertex| region.contains(&mesh.positions[vertex as usize]));
    }
    let mut remove = |inside: &dyn Fn(u32) -> bool| {
        for (face, polygon) in mesh.polygons.iter().enumerate() {
            let goes = match params.touching {
                true => polygon.iter().any(|&vertex| inside(vertex)),
                false => polygon.iter().all(|&vertex| inside(vertex)),
            };
            keep[face] &= !goes;
        }
    };
    for set in &picks.remove {
        let flags = flags(mesh, set)?;
        remove(&|vertex| flags[vertex as usize]);
    }
    for region in &params.remove_regions {
        remove(&|vertex| region.contains(&mesh.positions[vertex as usize]));
    }
    if let Some(mask) = &picks.mask {
        apply_mask(mesh, mask, params.mask_level, &mut keep)?;
    }
    Ok(keep)
}

fn flags(mesh: &Mesh, set: &[u32]) -> Result<Vec<bool>, Error> {
    check_range(mesh, set)?;
    let mut flags = vec![false; mesh.positions.len()];
    set.iter().for_each(|&vertex| flags[vertex as usize] = true);
    Ok(flags)
}

/// Faces go where the mask is dark at their centre; faces without texture coordinates stay.
fn apply_mask(mesh: &Mesh, mask: &Mask, level: f64, keep: &mut [bool]) -> Result<(), Error> {
    if mesh.corner_uvs.is_empty() {
        return Err(Error::NoTextureCoordinates);
    }
    for (face, keep) in keep.iter_mut().enumerate() {
        let corners = &mesh.corner_uvs[mesh.polygons.corner_range(face)];
        if corners.contains(&NO_UV) {
            continue;
        }
        let sum = corners.iter().fold(Vector2::zeros(), |sum, &uv| sum + mesh.uvs[uv as usize]);
        *keep &= mask.at(sum / corners.len() as f64) >= level;
    }
    Ok(())
}

/// Faces whose centre lies within half of `width` of a line go.
fn narrow_cuts(mesh: &Mesh, lines: &[Vec<u32>], width: f64, keep: &mut [bool]) {
    if width == 0.0 {
        return;
    }
    let at = |vertex: u32| mesh.positions[vertex as usize];
    let segments: Vec<[Point3<f64>; 2]> =
        lines.iter().flat_map(|line| line.windows(2).map(|pair| [at(pair[0]), at(pair[1])])).collect();
    for (face, polygon) in mesh.polygons.iter().enumerate() {
        let sum = polygon.iter().fold(Vector3::zeros(), |sum, &vertex| sum + at(vertex).coords);
        let center = Point3::from(sum / polygon.len() as f64);
        keep[face] &= segments.iter().all(|segment| distance(center, segment) >= 0.5 * width);
    }
}

fn distance(point: Point3<f64>, [from, to]: &[Point3<f64>; 2]) -> f64 {
    let along = to - from;
    let share = (point - from).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
    (point - (from + along * share.clamp(0.0, 1.0))).norm()
}

/// Drops all components but the one of the largest area; of equals the one with the lowest vertex stays.
fn keep_largest(mesh: &Mesh, keep: &mut [bool]) -> usize {
    let mut triangles = Vec::new();
    let mut areas = vec![0.0; mesh.polygons.len()];
    for (face, polygon) in mesh.polygons.iter().enumerate().filter(|(face, _)| keep[*face]) {
        let fan: Vec<[u32; 3]> = polygon[1..].windows(2).map(|pair| [polygon[0], pair[0], pair[1]]).collect();
        areas[face] = triangle_areas(&mesh.positions, &fan).iter().sum();
        triangles.extend(fan);
    }
    let (component_of, count) = Connectivity::of(mesh.positions.len(), &triangles).components();
    let component = |face: usize| component_of[mesh.polygons.face(face)[0] as usize] as usize;
    let mut totals: Vec<Option<f64>> = vec![None; count];
    for face in (0..keep.len()).filter(|&face| keep[face]) {
        *totals[component(face)].get_or_insert(0.0) += areas[face];
    }
    let area = |component: usize| totals[component].unwrap_or(f64::NEG_INFINITY);
    let largest = (0..count).rev().max_by(|&a, &b| area(a).total_cmp(&area(b))).unwrap_or(0);
    for (face, keep) in keep.iter_mut().enumerate() {
        *keep &= component(face) == largest;
    }
    totals.iter().flatten().count() - 1
}
