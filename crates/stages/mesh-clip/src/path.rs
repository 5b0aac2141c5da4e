//! Shortest ways along the edges of a mesh.

use crate::Error;
use mesh::{Mesh, shortest_way};

/// The edges of all polygons: per vertex its neighbours, rising.
pub(crate) struct Edges<'a> {
    mesh: &'a Mesh,
    neighbors: Vec<Vec<u32>>,
}

impl<'a> Edges<'a> {
    pub(crate) fn of(mesh: &'a Mesh) -> Self {
        let mut neighbors = vec![Vec::new(); mesh.positions.len()];
        for polygon in mesh.polygons.iter() {
            for (i, &from) in polygon.iter().enumerate() {
                let to = polygon[(i + 1) % polygon.len()];
                neighbors[from as usize].push(to);
                neighbors[to as usize].push(from);
            }
        }
        for around in &mut neighbors {
            around.sort_unstable();
            around.dedup();
        }
        Self { mesh, neighbors }
    }

    /// The line through `picks`, the shortest way along edges between each two.
    ///
    /// # Errors
    /// [`Error::VertexOutOfRange`], [`Error::NoWay`].
    pub(crate) fn line(&self, picks: &[u32]) -> Result<Vec<u32>, Error> {
        check_range(self.mesh, picks)?;
        let mut line: Vec<u32> = picks.first().copied().into_iter().collect();
        for pair in picks.windows(2) {
            line.extend(self.way(pair[0], pair[1])?.into_iter().skip(1));
        }
        Ok(line)
    }

    fn way(&self, from: u32, to: u32) -> Result<Vec<u32>, Error> {
        let neighbors = |vertex: u32| self.neighbors[vertex as usize].as_slice();
        shortest_way(&self.mesh.positions, neighbors, from, to, f64::INFINITY)
            .ok_or(Error::NoWay { from, to })
    }
}

pub(crate) fn check_range(mesh: &Mesh, vertices: &[u32]) -> Result<(), Error> {
    let vertex_count = mesh.positions.len();
    match vertices.iter().find(|&&vertex| vertex as usize >= vertex_count) {
        Some(&vertex) => Err(Error::VertexOutOfRange { vertex, vertex_count }),
        None => Ok(()),
    }
}
