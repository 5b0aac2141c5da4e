//! Triangles around vertices.

/// Which triangles meet at each vertex.
#[derive(Debug, Clone)]
pub struct Around {
    /// `triangles[starts[v]..starts[v + 1]]` meet at vertex v.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Around {
    /// Of #F triangles over `vertex_count` vertices.
    ///
    /// # Panics
    /// If a triangle names a vertex beyond them.
    #[must_use]
    pub fn of(vertex_count: usize, triangles: &[[u32; 3]]) -> Self {
        let mut starts = vec![0u32; vertex_count + 1];
        triangles.iter().flatten().for_each(|&vertex| starts[vertex as usize + 1] += 1);
        (0..vertex_count).for_each(|vertex| starts[vertex + 1] += starts[vertex]);
        let mut fill = starts.clone();
        let mut around = vec![0; 3 * triangles.len()];
        for (number, triangle) in triangles.iter().enumerate() {
            for &vertex in triangle {
                around[fill[vertex as usize] as usize] = number as u32;
                fill[vertex as usize] += 1;
            }
        }
        Self { starts, triangles: around }
    }

    /// The triangles at a vertex, rising.
    ///
    /// # Panics
    /// If there is no such vertex.
    #[must_use]
    pub fn at(&self, vertex: u32) -> &[u32] {
        let vertex = vertex as usize;
        &self.triangles[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// How many vertices there are.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.starts.len() - 1
    }
}

#[cfg(test)]
mod tests {
    use super::Around;

    #[test]
    fn every_triangle_stands_at_its_corners_and_nowhere_else() {
        let triangles = [[0, 1, 2], [2, 1, 3], [3, 5, 2]];
        let around = Around::of(6, &triangles);
        let found: Vec<&[u32]> = (0..6).map(|vertex| around.at(vertex)).collect();
        assert_eq!(found, [&[0u32][..], &[0, 1], &[0, 1, 2], &[1, 2], &[], &[2]]);
        assert_eq!(around.vertex_count(), 6);
    }
}
