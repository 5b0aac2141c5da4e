//! A coarser shell over some of the mesh's vertices, where the descent starts.

use crate::locator::{Place, nearest_of};
use crate::surface::{NONE, Surface};
use crate::{Error, Params};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::{Point3, Vector3};
use operators::{Keep, Proxy};
use rayon::prelude::*;

/// A mesh finer than this share of the coarse edge length has a coarse level.
const FINE_SHARE: f64 = 2.0 / 3.0;

/// The coarse level.
pub(crate) struct Coarse {
    /// Per coarse vertex the vertex of the mesh that it is; rising.
    pub(crate) vertices: Vec<u32>,
    pub(crate) surface: Surface,
    /// Per vertex of the mesh its place on the coarse mesh, where it has one.
    places: Vec<Option<Place>>,
}

impl Coarse {
    /// Over the vertices of a zone (rising), if the mesh is fine enough there to gain from it.
    pub(crate) fn of(surface: &Surface, zone: &[u32], params: &Params) -> Result<Option<Self>, Error> {
        let mut local = vec![NONE; surface.rest.len()];
        zone.iter().enumerate().for_each(|(at, &vertex)| local[vertex as usize] = at as u32);
        let inside = |corners: &&[u32; 3]| corners.iter().all(|&vertex| local[vertex as usize] != NONE);
        let triangles: Vec<[u32; 3]> = surface
            .triangles
            .iter()
            .filter(inside)
            .map(|corners| corners.map(|vertex| local[vertex as usize]))
            .collect();
        let points: Vec<Point3<f64>> = zone.iter().map(|&vertex| surface.rest[vertex as usize]).collect();
        let edge = mesh::edge_length_median(&points, &triangles);
        if triangles.is_empty() || edge > FINE_SHARE * params.coarse_edge_mm {
            return Ok(None);
        }
        let area: f64 = mesh::triangle_areas(&points, &triangles).iter().sum();
        let target = (2.0 * area / (3f64.sqrt() * params.coarse_edge_mm.powi(2))) as usize;
        let keep = Keep { vertices: &[], still: &[] };
        let proxy = Proxy::of(&points, &triangles, target, &vec![1.0; points.len()], keep);
        let rest: Vec<Point3<f64>> = proxy.vertices.iter().map(|&vertex| points[vertex as usize]).collect();
        let coarse = Surface::new(rest, proxy.triangles, params)?;
        let places = places(&coarse, surface, zone);
        let vertices = proxy.vertices.iter().map(|&vertex| zone[vertex as usize]).collect();
        Ok(Some(Self { vertices, surface: coarse, places }))
    }

    /// A vertex's displacement from those of the coarse vertices.
    pub(crate) fn prolong(&self, vertex: u32, coarse: &[Vector3<f64>]) -> Vector3<f64> {
        let Some(place) = self.places[vertex as usize] else { return Vector3::zeros() };
        let corners = self.surface.triangles[place.triangle as usize];
        corners.iter().zip(place.shares).map(|(&corner, share)| coarse[corner as usize] * share).sum()
    }
}

/// The nearest place on the coarse mesh of every vertex of the zone.
fn places(coarse: &Surface, surface: &Surface, zone: &[u32]) -> Vec<Option<Place>> {
    let mut places = vec![None; surface.rest.len()];
    let points: Vec<[f64; 3]> = coarse.rest.iter().map(|&point| point.into()).collect();
    let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&points) else { return places };
    let find = |&vertex: &u32| {
        let point = surface.rest[vertex as usize];
        let query: [f64; 3] = point.into();
        let nearest = tree.query(&query).nearest_one::<SquaredEuclidean<f64>>().execute().item;
        let mut near = coarse.around(nearest).to_vec();
        coarse.for_neighbors(nearest, |other| near.extend(coarse.around(other)));
        near.sort_unstable();
        near.dedup();
        nearest_of(&near, &coarse.triangles, &coarse.rest, &point).map(|found| found.0)
    };
    let found: Vec<Option<Place>> = zone.par_iter().map(find).collect();
    zone.iter().zip(found).for_each(|(&vertex, place)| places[vertex as usize] = place);
    places
}
