//! Elimination orders with little fill.

use crate::bisection::{OUTSIDE, bisect};
use nalgebra::Point3;
use sprs::CsMat;

/// Parts of at most this many vertices are not cut further.
const LEAF: usize = 32;

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
    /// separator last, and so on within the parts. Cuts follow the coordinates, so `pattern` must join only vertices
    /// that are near each other; it is the graph of the matrix that will be factored, not the mesh's.
    ///
    /// `pattern`: #V × #V, symmetric; `points`: #V.
    #[must_use]
    pub fn nested_dissection(pattern: &CsMat<f64>, points: &[Point3<f64>]) -> Self {
        let mut side = vec![OUTSIDE; points.len()];
        let mut vertices = Vec::with_capacity(points.len());
        let mut work = vec![Step::Cut((0..points.len() as u32).collect())];
        while let Some(step) = work.pop() {
            match step {
                Step::Place(block) => vertices.extend(block),
                Step::Cut(part) if part.len() <= LEAF => vertices.extend(part),
                Step::Cut(part) => {
                    let cut = bisect(pattern, points, &part, &mut side);
                    work.push(Step::Place(cut.separator));
                    work.extend(cut.parts.into_iter().map(Step::Cut));
                }
            }
        }
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

enum Step {
    Cut(Vec<u32>),
    Place(Vec<u32>),
}
