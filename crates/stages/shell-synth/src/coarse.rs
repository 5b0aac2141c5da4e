//! A coarser shell over some of the mesh's vertices, where the descent starts.

use crate::blocks::ranks;
use crate::locator::{Place, nearest_of};
use crate::surface::{NONE, Surface};
use crate::{Error, Params};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::{Point3, Vector3};
use operators::{Keep, Proxy};
use rayon::prelude::*;

/// A mesh finer than this share of a coarse edge length has a level of that.
const FINE_SHARE: f64 = 2.0 / 3.0;
/// Each level's edges are so much shorter than those of the level before.
const REFINEMENT: f64 = 2.4;

/// A coarse level.
pub(crate) struct Coarse {
    /// Per coarse vertex the vertex of the mesh that it is; rising.
    pub(crate) vertices: Vec<u32>,
    pub(crate) surface: Surface,
    /// Aim of its edges' length, mm.
    pub(crate) edge_mm: f64,
    /// Per coarse vertex its place in an elimination order of all.
    pub(crate) ranks: Vec<u32>,
    /// Per vertex of the mesh that is a vertex of the next level its place here.
    places: Vec<Option<Place>>,
}

/// Some of the mesh's vertices (rising), and triangles over them.
struct Part {
    vertices: Vec<u32>,
    points: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
}

impl Part {
    fn new(surface: &Surface, vertices: &[u32]) -> Self {
        let mut local = vec![NONE; surface.rest.len()];
        (0u32..).zip(vertices).for_each(|(at, &vertex)| local[vertex as usize] = at);
        let renamed = surface.triangles.iter().map(|corners| corners.map(|vertex| local[vertex as usize]));
        Self {
            vertices: vertices.to_vec(),
            points: vertices.iter().map(|&vertex| surface.rest[vertex as usize]).collect(),
            triangles: renamed.filter(|corners| !corners.contains(&NONE)).collect(),
        }
    }

    /// Fewer of the vertices, as far apart as an edge length asks for.
    fn coarser(&self, edge_mm: f64) -> Self {
        let area: f64 = mesh::triangle_areas(&self.points, &self.triangles).iter().sum();
        let target = (2.0 * area / (3f64.sqrt() * edge_mm.powi(2))) as usize;
        let keep = Keep { vertices: &[], still: &[] };
        let spacing = vec![1.0; self.points.len()];
        let proxy = Proxy::of(&self.points, &self.triangles, target, &spacing, keep);
        Self {
            points: proxy.vertices.iter().map(|&at| self.points[at as usize]).collect(),
            vertices: proxy.vertices.iter().map(|&at| self.vertices[at as usize]).collect(),
            triangles: proxy.triangles,
        }
    }
}

impl Coarse {
    /// The levels over the vertices of a zone (rising), coarsest first, as far as the mesh is finer than they are.
    pub(crate) fn levels(surface: &Surface, zone: &[u32], params: &Params) -> Result<Vec<Self>, Error> {
        let mut part = Part::new(surface, zone);
        let edge = mesh::edge_length_median(&part.points, &part.triangles);
        let lengths: Vec<f64> =
            std::iter::successors(Some(params.coarse_edge_mm), |length| Some(length / REFINEMENT))
                .take_while(|length| !part.triangles.is_empty() && edge <= FINE_SHARE * length)
                .collect();
        let mut levels = Vec::new();
        for &edge_mm in lengths.iter().rev() {
            let finer = part.vertices.clone();
            part = part.coarser(edge_mm);
            let coarse = Surface::new(part.points.clone(), part.triangles.clone(), params)?;
            let places = places(&coarse, surface, &finer);
            let ranks = ranks(&coarse, &(0..coarse.rest.len() as u32).collect::<Vec<_>>());
            levels.push(Self { vertices: part.vertices.clone(), surface: coarse, edge_mm, ranks, places });
        }
        levels.reverse();
        Ok(levels)
    }

    /// Its vertices that are free, the mesh's free ones (rising) given.
    pub(crate) fn free(&self, of_mesh: &[u32]) -> Vec<u32> {
        (0..self.vertices.len() as u32)
            .filter(|&at| of_mesh.binary_search(&self.vertices[at as usize]).is_ok())
            .filter(|&at| !self.surface.boundary[at as usize])
            .collect()
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
