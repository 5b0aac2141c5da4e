//! Which triangle each sample of a tile sees.

use super::bins::{Bins, Chunk, TILE};
use super::lanes::{LANES, Lanes, WIDE, Wide, higher, highest, lower, lowest, map, map_wide, spread};
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
pub(super) struct Tile<const PARTS: usize> {
    pattern: Pattern<PARTS>,
    /// 1 / depth of the nearest triangle per sample, pixel by pixel.
    pub(super) nearness: Vec<[Wide; PARTS]>,
    /// Its number in `facets`.
    pub(super) seen: Vec<[[u32; WIDE]; PARTS]>,
    pub(super) facets: Vec<Facet>,
}

impl<const PARTS: usize> Tile<PARTS> {
    pub(super) fn new(moving: bool) -> Self {
        Self {
            pattern: Pattern::new(moving),
            nearness: vec![[[0.0; WIDE]; PARTS]; TILE * TILE],
            seen: vec![[[NOTHING; WIDE]; PARTS]; TILE * TILE],
            facets: Vec::new(),
        }
    }

    pub(super) fn pattern(&self) -> &Pattern<PARTS> {
        &self.pattern
    }

    /// The position of a pixel's centre, px from the tile's middle.
    pub(super) fn position(column: usize, row: usize) -> [f32; 2] {
        [column as f32 - MIDDLE, row as f32 - MIDDLE]
    }

    /// Draws the triangles of a tile whose first pixel is `first` and that has `size` columns and rows.
    #[inline(always)]
    pub(super) fn draw(
        &mut self,
        tile: usize,
        (first, size): ([usize; 2], [usize; 2]),
        chunks: &[Chunk<'_>],
        bins: &[Bins],
        corners: &impl Corners,
    ) {
        self.nearness.fill([[0.0; WIDE]; PARTS]);
        self.seen.fill([[NOTHING; WIDE]; PARTS]);
        self.facets.clear();
        let middle = first.map(|pixel| pixel as f32 + MIDDLE);
        let places_of = |chunk: &Chunk<'_>, index: u16| {
            chunk.vertices(usize::from(index)).map(|vertex| shifted(corners.corner(vertex), middle))
        };
        for (chunk, bins) in chunks.iter().zip(bins) {
            for &index in bins.tile(tile) {
                let places = places_of(chunk, index);
                if let Some(pixels) = Box2::of(&places, size) {
                    self.add(chunk, index, &places, &pixels);
                }
            }
        }
    }

    #[inline(always)]
    fn add(&mut self, chunk: &Chunk<'_>, index: u16, places: &[Corner; 3], pixels: &Box2) {
        let [p, q, r] = places;
        let area = area(places);
        let edges = Edges::of(places, &area);
        // An area of zero has no inside: its slopes are never asked for.
        let slopes = [
            [map(|t| (r.y[t] - p.y[t]) / area[t]), map(|t| -(r.x[t] - p.x[t]) / area[t])],
            [map(|t| -(q.y[t] - p.y[t]) / area[t]), map(|t| (q.x[t] - p.x[t]) / area[t])],
        ];
        let facet = Facet {
            vertices: chunk.vertices(usize::from(index)),
            of_face: chunk.first_of_face.map_or(NOTHING, |face| face + u32::from(index)),
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

    /// Gives a triangle the samples that it covers and that see nothing nearer. Bits are chosen by masks: a branch per
    /// sample would be slower than the rest together.
    #[inline(always)]
    fn cover(&mut self, edges: &Edges, facet: &Facet, number: u32, pixels: &Box2) {
        let (a, b) = (edges.a.each_ref().map(spread), edges.b.each_ref().map(spread));
        let slope = facet.nearness_slope();
        let at_middle = map(|t| facet.nearness[0][t] - slope[0][t] * facet.x[t] - slope[1][t] * facet.y[t]);
        let [slope_x, slope_y] = slope.each_ref().map(spread);
        for part in 0..PARTS {
            let (x, y) = (&self.pattern.x[part], &self.pattern.y[part]);
            // Values at a part's samples if its pixel lay in the tile's middle.
            let in_middle: [Wide; 3] = std::array::from_fn(|k| {
                map_wide(|i| x[i] * a[k][i] + y[i] * b[k][i] + edges.c[k][i % LANES])
            });
            let near = map_wide(|i| x[i] * slope_x[i] + y[i] * slope_y[i] + at_middle[i % LANES]);
            for row in pixels.rows[0]..=pixels.rows[1] {
                let [_, y] = Self::position(0, row);
                let in_row: [Wide; 3] = std::array::from_fn(|k| map_wide(|i| in_middle[k][i] + b[k][i] * y));
                let near = map_wide(|i| near[i] + slope_y[i] * y);
                for column in pixels.columns[0]..=pixels.columns[1] {
                    let [x, _] = Self::position(column, row);
                    let pixel = row * TILE + column;
                    let (nearness, seen) = (&mut self.nearness[pixel][part], &mut self.seen[pixel][part]);
                    for i in 0..WIDE {
                        let edge = |k: usize| in_row[k][i] + a[k][i] * x;
                        let depth = near[i] + slope_x[i] * x;
                        let inside = lower(lower(edge(0), edge(1)), edge(2)) >= 0.0;
                        let mask = u32::from(inside & (depth > nearness[i])).wrapping_neg();
                        nearness[i] = f32::from_bits(depth.to_bits() & mask | nearness[i].to_bits() & !mask);
                        seen[i] = number & mask | seen[i] & !mask;
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
        let low = |p: Lanes, q: Lanes, r: Lanes| lowest(map(|t| lower(lower(p[t], q[t]), r[t])));
        let high = |p: Lanes, q: Lanes, r: Lanes| highest(map(|t| higher(higher(p[t], q[t]), r[t])));
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

/// Twice the signed area in the image; not negative for backs, since y runs down.
#[inline(always)]
fn area([p, q, r]: &[Corner; 3]) -> Lanes {
    map(|t| (q.x[t] - p.x[t]) * (r.y[t] - p.y[t]) - (q.y[t] - p.y[t]) * (r.x[t] - p.x[t]))
}

#[inline(always)]
fn shifted(corner: Corner, middle: [f32; 2]) -> Corner {
    Corner {
        x: corner.x.map(|x| x - middle[0]),
        y: corner.y.map(|y| y - middle[1]),
        nearness: corner.nearness,
    }
}
