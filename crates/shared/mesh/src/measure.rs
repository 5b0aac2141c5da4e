//! Lengths, areas and normals.

use nalgebra::{Point3, Vector3};

type Points = [Point3<f64>];

/// The corners of the axis-aligned box around all points: (lowest, highest). Zero points give a box at the origin.
#[must_use]
pub fn bounding_box(points: &Points) -> (Point3<f64>, Point3<f64>) {
    let Some(&first) = points.first() else {
        return (Point3::origin(), Point3::origin());
    };
    points.iter().fold((first, first), |(low, high), point| (low.inf(point), high.sup(point)))
}

fn corners(points: &Points, triangle: [u32; 3]) -> [Point3<f64>; 3] {
    triangle.map(|vertex| points[vertex as usize])
}

/// Twice the area vector of a triangle.
fn cross(points: &Points, triangle: [u32; 3]) -> Vector3<f64> {
    let [a, b, c] = corners(points, triangle);
    (b - a).cross(&(c - a))
}

/// Area per triangle, in the square of the positions' unit.
#[must_use]
pub fn triangle_areas(points: &Points, triangles: &[[u32; 3]]) -> Vec<f64> {
    triangles.iter().map(|&triangle| 0.5 * cross(points, triangle).norm()).collect()
}

/// Mixed Voronoi area per vertex [Meyer2003, Sec. 3.3]: the Voronoi cell inside non-obtuse triangles; half of an
/// obtuse triangle to its obtuse corner, a quarter to each other. The areas add up to the surface's.
#[must_use]
pub fn mixed_voronoi_areas(points: &Points, triangles: &[[u32; 3]]) -> Vec<f64> {
    let mut areas = vec![0.0; points.len()];
    for &triangle in triangles {
        for (corner, share) in mixed_shares(corners(points, triangle)).into_iter().enumerate() {
            areas[triangle[corner] as usize] += share;
        }
    }
    areas
}

fn mixed_shares(p: [Point3<f64>; 3]) -> [f64; 3] {
    let area = 0.5 * (p[1] - p[0]).cross(&(p[2] - p[0])).norm();
    let spokes = |i: usize| (p[(i + 1) % 3] - p[i], p[(i + 2) % 3] - p[i]);
    let dots: [f64; 3] = std::array::from_fn(|i| spokes(i).0.dot(&spokes(i).1));
    if let Some(obtuse) = (0..3).find(|&i| dots[i] < 0.0) {
        return std::array::from_fn(|i| if i == obtuse { area / 2.0 } else { area / 4.0 });
    }
    if area == 0.0 {
        return [0.0; 3];
    }
    let cot = dots.map(|dot| dot / (2.0 * area));
    std::array::from_fn(|i| {
        let (next, previous) = spokes(i);
        (next.norm_squared() * cot[(i + 2) % 3] + previous.norm_squared() * cot[(i + 1) % 3]) / 8.0
    })
}

/// Unit normal per vertex, triangles weighted by their angle at the vertex, so that the result does not depend on
/// how a flat polygon was split. Vertices without a triangle of positive area get zero.
#[must_use]
pub fn vertex_normals(points: &Points, triangles: &[[u32; 3]]) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); points.len()];
    for &triangle in triangles {
        let Some(normal) = cross(points, triangle).try_normalize(0.0) else { continue };
        let p = corners(points, triangle);
        for i in 0..3 {
            let angle = (p[(i + 1) % 3] - p[i]).angle(&(p[(i + 2) % 3] - p[i]));
            normals[triangle[i] as usize] += angle * normal;
        }
    }
    normals.into_iter().map(|normal| normal.try_normalize(0.0).unwrap_or_else(Vector3::zeros)).collect()
}

/// The median length over the sides of all triangles; 0 without triangles.
#[must_use]
pub fn edge_length_median(points: &Points, triangles: &[[u32; 3]]) -> f64 {
    let mut lengths: Vec<f64> = triangles
        .iter()
        .flat_map(|&triangle| {
            let p = corners(points, triangle);
            [0, 1, 2].map(|i| (p[(i + 1) % 3] - p[i]).norm())
        })
        .collect();
    let middle = lengths.len() / 2;
    match lengths.is_empty() {
        true => 0.0,
        false => *lengths.select_nth_unstable_by(middle, f64::total_cmp).1,
    }
}

/// The length of a closed polyline through vertices.
#[must_use]
pub fn loop_length(points: &Points, vertices: &[u32]) -> f64 {
    let at = |i: usize| points[vertices[i % vertices.len()] as usize];
    (0..vertices.len()).map(|i| (at(i + 1) - at(i)).norm()).sum()
}
