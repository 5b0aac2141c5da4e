//! Places on the rest mesh.

use crate::surface::Surface;
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::{Point3, Vector3};

/// A point of the surface: a triangle, and the shares of its corners.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pub(crate) triangle: u32,
    pub(crate) shares: [f64; 3],
}

impl Place {
    /// Where it is when the vertices are at `points`.
    pub(crate) fn on(&self, points: &[Point3<f64>], triangles: &[[u32; 3]]) -> Point3<f64> {
        let corners = triangles[self.triangle as usize];
        let sum: Vector3<f64> = corners
            .iter()
            .zip(self.shares)
            .map(|(&vertex, share)| points[vertex as usize].coords * share)
            .sum();
        Point3::from(sum)
    }
}

/// Finds the place of the surface that is nearest to a point.
pub(crate) struct Locator<'a> {
    surface: &'a Surface,
    tree: Option<ImmutableKdTree<f64, 3>>,
}

impl<'a> Locator<'a> {
    pub(crate) fn new(surface: &'a Surface) -> Self {
        let points: Vec<[f64; 3]> = surface.rest.iter().map(|&point| point.into()).collect();
        Self { surface, tree: ImmutableKdTree::new_from_slice(&points).ok() }
    }

    /// The nearest place on the triangles around the nearest vertex and its neighbours.
    pub(crate) fn nearest(&self, point: &Point3<f64>) -> Option<Place> {
        let query: [f64; 3] = (*point).into();
        let vertex = self.tree.as_ref()?.query(&query).nearest_one::<SquaredEuclidean<f64>>().execute().item;
        let mut near: Vec<u32> = self.surface.around(vertex).to_vec();
        self.surface.for_neighbors(vertex, |other| near.extend(self.surface.around(other)));
        near.sort_unstable();
        near.dedup();
        nearest_of(&near, &self.surface.triangles, &self.surface.rest, point).map(|found| found.0)
    }
}

/// The nearest place on some triangles, and its squared distance; the first of those equally near.
pub(crate) fn nearest_of(
    among: &[u32],
    triangles: &[[u32; 3]],
    points: &[Point3<f64>],
    point: &Point3<f64>,
) -> Option<(Place, f64)> {
    let mut best: Option<(Place, f64)> = None;
    for &triangle in among {
        let corners = triangles[triangle as usize].map(|vertex| points[vertex as usize]);
        let shares = mesh::nearest_in_triangle(point, &corners);
        let at: Vector3<f64> = corners.iter().zip(shares).map(|(corner, share)| corner.coords * share).sum();
        let distance = (point.coords - at).norm_squared();
        if best.is_none_or(|(_, least)| distance < least) {
            best = Some((Place { triangle, shares }, distance));
        }
    }
    best
}
