//! A face that is given: a scan, or an expression set.

use crate::body::Body;
use crate::body::expressions::ExpressionSet;
use crate::body::face::{BISECTED, Fineness, Near};
use crate::body::place::TURN;
use crate::body::refine::Refinement;
use crate::body::scan::Scan;
use mesh::{Mesh, triangle_areas};
use nalgebra::{Point2, Vector3};

/// A face that is given.
pub enum Base {
    /// A scan, moved by the muscles of the average face.
    Scan(Scan),
    /// An expression set, moved by its own shapes.
    Expressions(ExpressionSet),
}

impl Base {
    /// The face with about `vertex_count` vertices, finer along the polylines `near` (domain, mm). What has more vertices
    /// already keeps them all.
    #[must_use]
    pub fn body(self, vertex_count: usize, near: &[Vec<Point2<f64>>], fineness: impl Into<Fineness>) -> Body {
        let fineness = fineness.into();
        match self {
            Self::Scan(Scan { mesh, domain, albedo, face_from_canonical, eyes_are_open, .. }) => {
                let finer = Finer::of(
                    Points { mesh, domain, albedo, offsets: Vec::new() },
                    vertex_count,
                    near,
                    fineness,
                );
                let Points { mesh, domain, albedo, .. } = finer;
                let body = Body::from_muscles(mesh, domain, albedo, face_from_canonical);
                if eyes_are_open { body.with_eyeballs() } else { body }
            }
            Self::Expressions(ExpressionSet { scan, names, offsets }) => {
                let Scan { mesh, domain, albedo, face_from_canonical, eyes_are_open, .. } = scan;
                let Points { mesh, domain, albedo, offsets } =
                    Finer::of(Points { mesh, domain, albedo, offsets }, vertex_count, near, fineness);
                let body = Body::from_shapes(mesh, domain, albedo, names, offsets);
                let body = Body { face_from_canonical, ..body };
                if eyes_are_open { body.with_eyeballs() } else { body }
            }
        }
    }
}

/// Places farther apart than this along s lie on either side of the cut at the back of the head, mm.
const ACROSS_CUT: f64 = 100.0;

/// The middle between two places of the unrolled face; of neighbours across the cut it is at the cut, not on the face.
fn place_between(a: Point2<f64>, b: Point2<f64>) -> Point2<f64> {
    let way = b.x - a.x;
    match way.abs() > ACROSS_CUT {
        true => nalgebra::center(&a, &Point2::new(b.x - TURN.copysign(way), b.y)),
        false => nalgebra::center(&a, &b),
    }
}

/// What is known at the vertices of a mesh.
struct Points {
    mesh: Mesh,
    domain: Vec<Point2<f64>>,
    albedo: Vec<[f32; 3]>,
    offsets: Vec<Vec<Vector3<f64>>>,
}

/// Bisection of edges; what is known at their ends is averaged.
struct Finer;

impl Finer {
    fn of(start: Points, vertex_count: usize, lines: &[Vec<Point2<f64>>], fineness: Fineness) -> Points {
        let near = Near { lines, fineness };
        let triangles = start.mesh.triangles();
        let areas = triangle_areas(&start.mesh.positions, &triangles);
        let demand: f64 = areas
            .iter()
            .zip(&triangles)
            .map(|(area, corners)| area * near.factor(start.domain[corners[0] as usize]).powi(-2))
            .sum();
        let spacing = BISECTED * (demand / vertex_count.max(1) as f64).sqrt();
        let Points { mesh, mut domain, mut albedo, mut offsets } = start;
        let mut refinement = Refinement::of(&mesh);
        let mut positions = mesh.positions.clone();
        loop {
            let spacings: Vec<f64> = domain.iter().map(|at| near.spacing(*at, spacing)).collect();
            let first = positions.len();
            if refinement.split_longer(&positions, &spacings) == 0 {
                break;
            }
            for &[a, b] in &refinement.parents()[first - mesh.positions.len()..] {
                let (a, b) = (a as usize, b as usize);
                positions.push(nalgebra::center(&positions[a], &positions[b]));
                domain.push(place_between(domain[a], domain[b]));
                albedo.push(std::array::from_fn(|channel| 0.5 * (albedo[a][channel] + albedo[b][channel])));
                for field in &mut offsets {
                    field.push(0.5 * (field[a] + field[b]));
                }
            }
        }
        Points { mesh: refinement.mesh(&mesh, positions), domain, albedo, offsets }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_across_the_cut_is_at_the_cut() {
        let middle = place_between(Point2::new(220.0, 80.0), Point2::new(-222.0, 82.0));
        assert!((middle.x.abs() - 0.5 * TURN).abs() < 2.0 && middle.y == 81.0, "{middle}");
        assert_eq!(place_between(Point2::new(-3.0, 1.0), Point2::new(5.0, 2.0)), Point2::new(1.0, 1.5));
    }
}
