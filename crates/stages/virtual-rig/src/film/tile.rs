//! Which triangle each sample of a tile sees.

use super::bins::{Bins, Chunk, TILE};
use super::lanes::{LANES, Lanes, highest, lowest, map};
use super::pattern::Pattern;
use super::projection::{Corner, Corners};

/// No triangle.
pub(super) const NOTHING: u32 = u32::MAX;
/// Pixel positions are relative to the tile's middle, so that single precision places edges within 1e-4 px.
const MIDDLE: f32 = (TILE / 2) as f32;

/// A triangle in a tile, at the four times: what its samples are shaded from. Everything is relative to its first corner,
/// so that weights stay exact in triangles much smaller than a pixel.
#[derive(Debug, Clone, Copy)]
pub(super) struct Facet {
    pub(super) vertices: [u32; 3],
    /// Its number if it is the face's, else [`NOTHING`].
    pub(super) of_face: u32,
    /// First corner, px from the tile's middle.
    pub(super) x: Lanes,
    pub(super) y: Lanes,
    /// Change of the weights of the second and third corner per pixel, [corner][axis].
    pub(super) slopes: [[Lanes; 2]; 2],
    /// 1 / depth per corner, 1/mm.
    pub(super) nearness: [Lanes; 3],
    /// Whether it faces the camera.
    pub(super) front: [bool; LANES],
}

/// The edges of a triangle as functions A x + B y + C of the position, not negative inside. Two triangles that share an
/// edge get numbers that differ in the sign only, so that no sample falls between them.
struct Edges {
    a: [Lanes; 3],
    b: [Lanes; 3],
    c: [Lanes; 3],
}

/// Columns and rows of pixels, both ends included.
struct Box2 {
    columns: [usize; 2],
    rows: [usize; 2],
}

/// What the samples of one tile see.
pub(super) struct Tile<const BLOCKS: usize> {
    pattern: Pattern<BLOCKS>,
    /// 1 / depth of the nearest triangle per sample, pixel by pixel.
    pub(super) nearness: Vec<[Lanes; BLOCKS]>,
    /// Its number in `facets`.
    pub(super) seen: Vec<[[u32; LANES]; BLOCKS]>,
    pub(super) facets: Vec<Facet>,
}

impl<const BLOCKS: usize> Tile<BLOCKS> {
    pub(super) fn new(moving: bool) -> Self {
        Self {
            pattern: Pattern::new(moving),
            nearness: vec![[[0.0; LANES]; BLOCKS]; TILE * TILE],
            seen: vec![[[NOTHING; LANES]; BLOCKS]; TILE * TILE],
            facets: Vec::new(),
        }
    }

    pub(super) fn pattern(&self) -> &Pattern<BLOCKS> {
        &self.pattern
    }

    /// The position of a pixel's centre, px from the tile's middle.
    pub(super) fn position(column: usize, row: usize) -> [f32; 2] {
        [column as f32 - MIDDLE, row as f32 - MIDDLE]
    }

    /// Draws the triangles of a tile whose first pixel is `first` and that has `size` columns and rows.
    pub(super) fn draw(
        &mut self,
        tile: usize,
        (first, size): ([usize; 2], [usize; 2]),
        chunks: &[Chunk<'_>],
        bins: &[Bins],
        corners: &impl Corners,
    ) {
        self.nearness.fill([[0.0; LANES]; BLOCKS]);
        self.seen.fill([[NOTHING; LANES]; BLOCKS]);
        self.facets.clear();
        let middle = first.map(|pixel| pixel as f32 + MIDDLE);
        for (chunk, bins) in chunks.iter().zip(bins) {
            for &index in bins.tile(tile) {
                let vertices = chunk.vertices(usize::from(index));
                let places = vertices.map(|vertex| shifted(corners.corner(vertex), middle));
                let Some(pixels) = Box2::of(&places, size) else { continue };
                let of_face = chunk.first_of_face.map_or(NOTHING, |face| face + u32::from(index));
                self.add(vertices, of_face, &places, &pixels);
            }
        }
    }

    #[inline(always)]
    fn add(&mut self, vertices: [u32; 3], of_face: u32, places: &[Corner; 3], pixels: &Box2) {
        let [p, q, r] = places;
        let area = map(|t| (q.x[t] - p.x[t]) * (r.y[t] - p.y[t]) - (q.y[t] - p.y[t]) * (r.x[t] - p.x[t]));
        let edges = Edges::of(places, &area);
        // An area of zero has no inside: its slopes are never asked for.
        let slopes = [
            [map(|t| (r.y[t] - p.y[t]) / area[t]), map(|t| -(r.x[t] - p.x[t]) / area[t])],
            [map(|t| -(q.y[t] - p.y[t]) / area[t]), map(|t| (q.x[t] - p.x[t]) / area[t])],
        ];
        let facet = Facet {
            vertices,
            of_face,
            x: p.x,
            y: p.y,
            slopes,
            nearness: [p.nearness, q.nearness, r.nearness],
            // y runs down in the image.
            front: area.map(|area| area < 0.0),
        };
        let number = self.facets.len() as u32;
        self.cover(&edges, &facet, number, pixels);
        self.facets.push(facet);
    }

    /// Gives a triangle the samples that it covers and that see nothing nearer.
    #[inline(always)]
    fn cover(&mut self, edges: &Edges, facet: &Facet, number: u32, pixels: &Box2) {
        let pattern = &self.pattern;
        let in_pixel = |x: &Lanes, y: &Lanes| -> [Lanes; BLOCKS] {
            std::array::from_fn(|block| map(|t| x[t] * pattern.x[block][t] + y[t] * pattern.y[block][t]))
        };
        let edge_steps: [[Lanes; BLOCKS]; 3] = std::array::from_fn(|k| in_pixel(&edges.a[k], &edges.b[k]));
        let reach: [f32; 3] =
            std::array::from_fn(|k| highest(map(|t| 0.5 * (edges.a[k][t].abs() + edges.b[k][t].abs()))));
        let slope = facet.nearness_slope();
        let nearness_steps = in_pixel(&slope[0], &slope[1]);
        for row in pixels.rows[0]..=pixels.rows[1] {
            for column in pixels.columns[0]..=pixels.columns[1] {
                let [x, y] = Self::position(column, row);
                let at: [Lanes; 3] =
                    std::array::from_fn(|k| map(|t| edges.a[k][t] * x + edges.b[k][t] * y + edges.c[k][t]));
                if (0..3).any(|k| highest(at[k]) + reach[k] < 0.0) {
                    continue;
                }
                let here = map(|t| {
                    facet.nearness[0][t] + slope[0][t] * (x - facet.x[t]) + slope[1][t] * (y - facet.y[t])
                });
                let pixel = row * TILE + column;
                let (nearness, seen) = (&mut self.nearness[pixel], &mut self.seen[pixel]);
                for block in 0..BLOCKS {
                    for t in 0..LANES {
                        let [e0, e1, e2]: [f32; 3] =
                            std::array::from_fn(|k| at[k][t] + edge_steps[k][block][t]);
                        let depth = here[t] + nearness_steps[block][t];
                        let wins = (e0 >= 0.0) & (e1 >= 0.0) & (e2 >= 0.0) & (depth > nearness[block][t]);
                        nearness[block][t] = if wins { depth } else { nearness[block][t] };
                        seen[block][t] = if wins { number } else { seen[block][t] };
                    }
                }
            }
        }
    }
}

impl Facet {
    /// Change of 1 / depth per pixel along each axis.
    #[inline(always)]
    fn nearness_slope(&self) -> [Lanes; 2] {
        let [near_p, near_q, near_r] = &self.nearness;
        [0, 1].map(|axis| {
            map(|t| {
                self.slopes[0][axis][t] * (near_q[t] - near_p[t])
                    + self.slopes[1][axis][t] * (near_r[t] - near_p[t])
            })
        })
    }
}

impl Edges {
    #[inline(always)]
    fn of(places: &[Corner; 3], area: &Lanes) -> Self {
        let sign = map(|t| if area[t] < 0.0 { -1.0 } else { 1.0 });
        let ends = |k: usize| (&places[(k + 1) % 3], &places[(k + 2) % 3]);
        let side = |f: &dyn Fn(&Corner, &Corner, usize) -> f32| -> [Lanes; 3] {
            std::array::from_fn(|k| map(|t| sign[t] * f(ends(k).0, ends(k).1, t)))
        };
        let mut edges = Self {
            a: side(&|from, to, t| from.y[t] - to.y[t]),
            b: side(&|from, to, t| to.x[t] - from.x[t]),
            c: side(&|from, to, t| from.x[t] * to.y[t] - to.x[t] * from.y[t]),
        };
        for t in 0..LANES {
            if area[t] == 0.0 {
                (edges.a[0][t], edges.b[0][t], edges.c[0][t]) = (0.0, 0.0, -1.0);
            }
        }
        edges
    }
}

impl Box2 {
    /// The pixels that a triangle may touch, in a tile of `size`; none if it touches none.
    #[inline(always)]
    fn of(places: &[Corner; 3], size: [usize; 2]) -> Option<Self> {
        let [p, q, r] = places;
        let low = |p: Lanes, q: Lanes, r: Lanes| lowest(map(|t| p[t].min(q[t]).min(r[t])));
        let high = |p: Lanes, q: Lanes, r: Lanes| highest(map(|t| p[t].max(q[t]).max(r[t])));
        // Negative numbers become 0.
        let span = |low: f32, high: f32, size: usize| {
            let to = high + MIDDLE + 0.5;
            let ends = [(low + MIDDLE + 0.5) as usize, (to as usize).min(size - 1)];
            (to >= 0.0 && ends[0] <= ends[1]).then_some(ends)
        };
        Some(Self {
            columns: span(low(p.x, q.x, r.x), high(p.x, q.x, r.x), size[0])?,
            rows: span(low(p.y, q.y, r.y), high(p.y, q.y, r.y), size[1])?,
        })
    }
}

#[inline(always)]
fn shifted(corner: Corner, middle: [f32; 2]) -> Corner {
    Corner {
        x: corner.x.map(|x| x - middle[0]),
        y: corner.y.map(|y| y - middle[1]),
        nearness: corner.nearness,
    }
}
