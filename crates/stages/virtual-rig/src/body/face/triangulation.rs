//! Triangles between the points: constrained Delaunay in the domain, then flips until it is Delaunay in space.

use crate::body::face::sampling::{Samples, contains};
use nalgebra::{Point2, Point3};
use spade::{ConstrainedDelaunayTriangulation, Point2 as Site, Triangulation};
use std::collections::BTreeMap;

/// The triangles of the face, counter-clockwise seen from outside; edges of the contours are kept.
pub(crate) fn triangulate(samples: &Samples) -> Vec<[u32; 3]> {
    let sites = samples.domain.iter().map(|at| Site::new(at.x, at.y)).collect();
    let edges = samples
        .loops
        .iter()
        .flat_map(|ring| (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]).collect::<Vec<_>>());
    // The contours never cross, so that this cannot fail; without triangles every test of the mesh would.
    let Ok(delaunay) = ConstrainedDelaunayTriangulation::<Site<f64>>::bulk_load_cdt(sites, edges.collect())
    else {
        return Vec::new();
    };
    let polygons: Vec<Vec<Point2<f64>>> =
        samples.loops.iter().map(|ring| ring.iter().map(|&i| samples.domain[i]).collect()).collect();
    let keep = |triangle: &[u32; 3]| {
        let middle =
            triangle.iter().fold(Point2::origin(), |sum, &i| sum + samples.domain[i as usize].coords / 3.0);
        contains(&polygons[0], middle) && !polygons[1..].iter().any(|hole| contains(hole, middle))
    };
    let mut triangles: Vec<[u32; 3]> = delaunay
        .inner_faces()
        .map(|face| face.vertices().map(|vertex| vertex.fix().index() as u32))
        .filter(keep)
        .collect();
    triangles.iter_mut().for_each(start_at_lowest);
    triangles.sort_unstable();
    for _ in 0..MAX_PASSES {
        if flip_pass(samples, &mut triangles) == 0 {
            break;
        }
    }
    triangles
}

const MAX_PASSES: usize = 60;

fn start_at_lowest(triangle: &mut [u32; 3]) {
    let lowest = (0..3).min_by_key(|&i| triangle[i]).unwrap_or(0);
    triangle.rotate_left(lowest);
}

/// Flips every edge whose opposite angles in space add up to more than π, at most one per triangle.
fn flip_pass(samples: &Samples, triangles: &mut [[u32; 3]]) -> usize {
    let mut beside: BTreeMap<[u32; 2], Vec<(usize, usize)>> = BTreeMap::new();
    for (t, triangle) in triangles.iter().enumerate() {
        for corner in 0..3 {
            let (a, b) = (triangle[(corner + 1) % 3], triangle[(corner + 2) % 3]);
            beside.entry([a.min(b), a.max(b)]).or_default().push((t, corner));
        }
    }
    let mut touched = vec![false; triangles.len()];
    let mut flips = 0;
    for sides in beside.values() {
        let &[(one, corner), (other, opposite)] = sides.as_slice() else { continue };
        if touched[one] || touched[other] {
            continue;
        }
        let apex = triangles[one][corner];
        let (a, b) = (triangles[one][(corner + 1) % 3], triangles[one][(corner + 2) % 3]);
        let across = triangles[other][opposite];
        if wants_flip(&samples.space, a, b, apex, across) && is_convex(&samples.domain, a, b, apex, across) {
            triangles[one] = [apex, a, across];
            triangles[other] = [apex, across, b];
            (touched[one], touched[other]) = (true, true);
            flips += 1;
        }
    }
    flips
}

fn wants_flip(points: &[Point3<f64>], a: u32, b: u32, apex: u32, across: u32) -> bool {
    let angle = |at: u32| {
        let at = points[at as usize];
        (points[a as usize] - at).angle(&(points[b as usize] - at))
    };
    angle(apex) + angle(across) > std::f64::consts::PI + 1e-9
}

/// Whether both triangles after the flip are well turned in the domain.
fn is_convex(points: &[Point2<f64>], a: u32, b: u32, apex: u32, across: u32) -> bool {
    let area = |i: u32, j: u32, k: u32| {
        let [p, q, r] = [i, j, k].map(|index| points[index as usize]);
        (q - p).perp(&(r - p))
    };
    area(apex, a, across) > 1e-6 && area(apex, across, b) > 1e-6
}
