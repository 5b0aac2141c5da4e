//! Elimination orders with little fill.

use crate::bisection::Part;
use nalgebra::Point3;
use sprs::CsMat;

/// Parts of at most this many vertices are not cut further.
const LEAF: usize = 32;
/// Parts of at most this many vertices are ordered by one thread.
const TASK: usize = 4096;

/// An order in which to eliminate the vertices of a mesh. It depends on the mesh alone, not on which vertices are
/// handles, so that one order serves every set of handles ([`crate::Dirichlet`] restricts it).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ordering {
    vertices: Vec<u32>,
}

/// A saved order that does not list every vertex once.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("the order does not list each of {vertex_count} vertices once")]
pub struct NotAPermutation {
    /// How many vertices there are.
    pub vertex_count: usize,
}

impl Ordering {
    /// Nested dissection [George1973]: cut the graph in two by a small separator, order both parts first and the
    /// separator last, and so on within the parts, on all threads; the same order for any number of them.
    ///
    /// Of the planes across a part, along four directions, the one is taken that fewest edges cross near the middle; the
    /// separator is a smallest set of vertices that touches these edges. Where coordinates do not help (points in one place,
    /// on top of each other, not finite), cuts follow distances in the graph.
    ///
    /// `pattern`: #V × #V, symmetric: the graph of the matrix that will be factored, not the mesh's; `points`: #V.
    ///
    /// # Panics
    /// If there is not one point per vertex.
    #[must_use]
    pub fn nested_dissection(pattern: &CsMat<f64>, points: &[Point3<f64>]) -> Self {
        assert_eq!(points.len(), pattern.rows(), "one point per vertex");
        let finite = points.iter().all(|point| point.iter().all(|x| x.abs() < f64::from(f32::MAX)));
        Self::of(pattern, if finite { smoothed(pattern, points) } else { Vec::new() })
    }

    /// Nested dissection by the graph alone. `pattern`: #V × #V, symmetric.
    #[must_use]
    pub fn of_graph(pattern: &CsMat<f64>) -> Self {
        Self::of(pattern, Vec::new())
    }

    fn of(pattern: &CsMat<f64>, places: Vec<[f32; 3]>) -> Self {
        let count = pattern.rows() as u32;
        let mut starts = vec![0];
        let mut neighbors = Vec::with_capacity(pattern.nnz());
        for (vertex, row) in pattern.outer_iterator().enumerate() {
            neighbors
                .extend(row.indices().iter().filter(|&&other| other != vertex).map(|&other| other as u32));
            starts.push(neighbors.len() as u32);
        }
        let mut vertices = vec![0; pattern.rows()];
        order(Part::new((0..count).collect(), places, starts, neighbors), &mut vertices);
        Self { vertices }
    }

    /// An order that was saved.
    ///
    /// # Errors
    /// If it does not list each vertex below `vertex_count` once.
    pub fn from_saved(vertices: Vec<u32>, vertex_count: usize) -> Result<Self, NotAPermutation> {
        let mut seen = vec![false; vertex_count];
        let fresh =
            |&vertex: &u32| seen.get_mut(vertex as usize).is_some_and(|seen| !std::mem::replace(seen, true));
        match vertices.len() == vertex_count && vertices.iter().all(fresh) {
            true => Ok(Self { vertices }),
            false => Err(NotAPermutation { vertex_count }),
        }
    }

    /// The vertices, first eliminated first.
    #[must_use]
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }
}

/// Every point moved to the middle of its neighbours: cuts follow the graph, not the scatter of its points.
fn smoothed(pattern: &CsMat<f64>, points: &[Point3<f64>]) -> Vec<[f32; 3]> {
    let middle = |row: sprs::CsVecView<f64>| {
        let sum =
            row.indices().iter().fold(nalgebra::Vector3::zeros(), |sum, &other| sum + points[other].coords);
        let mean = sum / row.nnz().max(1) as f64;
        [mean.x as f32, mean.y as f32, mean.z as f32]
    };
    pattern.outer_iterator().map(middle).collect()
}

/// Writes the vertices of a part in their order.
fn order(part: Part, out: &mut [u32]) {
    let cut = if part.len() > LEAF { part.bisect() } else { None };
    let Some(([left, right], separator)) = cut else { return order_leaf(&part, out) };
    let tasks = part.len() > TASK;
    drop(part);
    let (parts, last) = out.split_at_mut(left.len() + right.len());
    last.copy_from_slice(&separator);
    let (first, second) = parts.split_at_mut(left.len());
    match tasks {
        true => {
            rayon::join(|| order(left, first), || order(right, second));
        }
        false => {
            order(left, first);
            order(right, second);
        }
    }
}

/// Vertices with few neighbours first: the centre of a star comes last.
fn order_leaf(part: &Part, out: &mut [u32]) {
    let mut order: Vec<u32> = (0..part.len() as u32).collect();
    order.sort_by_key(|&vertex| part.neighbors(vertex as usize).len());
    out.iter_mut().zip(order).for_each(|(out, vertex)| *out = part.vertices[vertex as usize]);
}
