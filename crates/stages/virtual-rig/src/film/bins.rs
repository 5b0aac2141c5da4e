//! Which triangles may touch which tile of the image.

use super::lanes::{Lanes, higher, highest, lower, lowest, map};
use super::projection::Corners;
use super::scene::Scene;
use rayon::prelude::*;

/// Side of a tile, px: its samples fit into a processor's nearer caches.
pub(super) const TILE: usize = 32;
/// Triangles per chunk. Chunks are fixed, so that the order of triangles in a tile is too.
const CHUNK: usize = 8192;

/// The image's tiles, row by row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tiling {
    pub(super) size: [usize; 2],
    pub(super) columns: usize,
    pub(super) rows: usize,
}

impl Tiling {
    pub(super) fn of(image_size: [u32; 2]) -> Self {
        let size = image_size.map(|side| side as usize);
        Self { size, columns: size[0].div_ceil(TILE), rows: size[1].div_ceil(TILE) }
    }

    pub(super) fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// The first pixel of a tile, and how many columns and rows of pixels it has.
    pub(super) fn pixels(&self, tile: usize) -> ([usize; 2], [usize; 2]) {
        let first = [tile % self.columns * TILE, tile / self.columns * TILE];
        (first, std::array::from_fn(|axis| TILE.min(self.size[axis] - first[axis])))
    }
}

/// A run of triangles of one solid.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chunk<'a> {
    pub(super) triangles: &'a [[u32; 3]],
    /// Vertices before the solid's own.
    pub(super) first_vertex: u32,
    /// Number of the first triangle if it is the face's.
    pub(super) first_of_face: Option<u32>,
}

impl Chunk<'_> {
    #[inline(always)]
    pub(super) fn vertices(&self, triangle: usize) -> [u32; 3] {
        self.triangles[triangle].map(|vertex| vertex + self.first_vertex)
    }
}

/// The chunks of all solids, in order.
pub(super) fn chunks<'a>(scene: &Scene<'a>) -> Vec<Chunk<'a>> {
    let mut all = Vec::new();
    let mut first_vertex = 0;
    for (index, solid) in scene.solids().enumerate() {
        for (part, triangles) in solid.skin.triangles.chunks(CHUNK).enumerate() {
            let first_of_face = (index == 0).then_some((part * CHUNK) as u32);
            all.push(Chunk { triangles, first_vertex, first_of_face });
        }
        first_vertex += solid.moment.open.len() as u32;
    }
    all
}

/// The triangles of a chunk by tile.
pub(super) struct Bins {
    starts: Vec<u32>,
    triangles: Vec<u16>,
}

impl Bins {
    /// Those of each chunk.
    pub(super) fn of(chunks: &[Chunk<'_>], corners: &impl Corners, tiling: &Tiling) -> Vec<Self> {
        chunks.par_iter().map(|chunk| Self::of_chunk(chunk, corners, tiling)).collect()
    }

    /// The triangles that may touch a tile, in order.
    pub(super) fn tile(&self, tile: usize) -> &[u16] {
        &self.triangles[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }

    fn of_chunk(chunk: &Chunk<'_>, corners: &impl Corners, tiling: &Tiling) -> Self {
        let spans: Vec<Span> = (0..chunk.triangles.len())
            .map(|index| Span::of(chunk.vertices(index), corners, tiling))
            .collect();
        let mut starts = vec![0; tiling.count() + 1];
        for span in &spans {
            span.tiles(tiling).for_each(|tile| starts[tile + 1] += 1);
        }
        for tile in 0..tiling.count() {
            starts[tile + 1] += starts[tile];
        }
        let mut next = starts.clone();
        let mut triangles = vec![0; starts[tiling.count()] as usize];
        for (index, span) in spans.iter().enumerate() {
            for tile in span.tiles(tiling) {
                triangles[next[tile] as usize] = index as u16;
                next[tile] += 1;
            }
        }
        Self { starts, triangles }
    }
}

/// Columns and rows of tiles, from (included) and to (excluded).
#[derive(Clone, Copy)]
struct Span {
    columns: [u16; 2],
    rows: [u16; 2],
}

impl Span {
    const NONE: Self = Self { columns: [0; 2], rows: [0; 2] };

    fn of(vertices: [u32; 3], corners: &impl Corners, tiling: &Tiling) -> Self {
        let [a, b, c] = vertices.map(|vertex| corners.corner(vertex));
        let least = |a: &Lanes, b: &Lanes, c: &Lanes| lowest(map(|t| lower(lower(a[t], b[t]), c[t])));
        let most = |a: &Lanes, b: &Lanes, c: &Lanes| highest(map(|t| higher(higher(a[t], b[t]), c[t])));
        let drawn = least(&a.nearness, &b.nearness, &c.nearness) > 0.0;
        let low = [least(&a.x, &b.x, &c.x), least(&a.y, &b.y, &c.y)];
        let high = [most(&a.x, &b.x, &c.x), most(&a.y, &b.y, &c.y)];
        let [width, height] = tiling.size.map(|side| side as f32 - 0.5);
        let seen = low[0] < width && low[1] < height && high[0] > -0.5 && high[1] > -0.5;
        if !(drawn && seen) {
            return Self::NONE;
        }
        // Negative numbers become 0.
        let tile = |pixel: f32| ((pixel + 0.5) / TILE as f32) as u16;
        Self {
            columns: [tile(low[0]), tile(high[0]).saturating_add(1).min(tiling.columns as u16)],
            rows: [tile(low[1]), tile(high[1]).saturating_add(1).min(tiling.rows as u16)],
        }
    }

    fn tiles(self, tiling: &Tiling) -> impl Iterator<Item = usize> {
        let columns = tiling.columns;
        (self.rows[0]..self.rows[1]).flat_map(move |row| {
            (self.columns[0]..self.columns[1]).map(move |column| row as usize * columns + column as usize)
        })
    }
}
