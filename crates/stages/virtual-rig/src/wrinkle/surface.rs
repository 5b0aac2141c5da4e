//! The rest surface near the lines: finding places of the domain on it, and walking across it.

use nalgebra::{Point2, Point3, Vector3};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};

/// A material point of the skin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spot {
    pub(super) triangle: u32,
    pub(super) corners: [u32; 3],
    pub(super) barycentric: [f64; 3],
}

impl Spot {
    pub(super) fn at(&self, points: &[Point3<f64>]) -> Point3<f64> {
        let weighted = |i: usize| points[self.corners[i] as usize].coords * self.barycentric[i];
        Point3::from(weighted(0) + weighted(1) + weighted(2))
    }

    /// The unit normal of its triangle; zero where that has no area.
    pub(super) fn normal(&self, points: &[Point3<f64>]) -> Vector3<f64> {
        let [a, b, c] = self.corners.map(|corner| points[corner as usize]);
        (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vector3::zeros)
    }
}

/// Size of the cells that hold triangles of the domain, mm.
const CELL: f64 = 2.0;

/// Triangles of the domain near some polylines.
pub(super) struct Atlas<'a> {
    domain: &'a [Point2<f64>],
    triangles: &'a [[u32; 3]],
    cells: HashMap<[i32; 2], Vec<u32>>,
}

fn cell(at: Point2<f64>) -> [i32; 2] {
    [(at.x / CELL).floor() as i32, (at.y / CELL).floor() as i32]
}

impl<'a> Atlas<'a> {
    /// `near`: points no further apart than a cell.
    pub(super) fn new(
        domain: &'a [Point2<f64>],
        triangles: &'a [[u32; 3]],
        near: impl Iterator<Item = Point2<f64>>,
    ) -> Self {
        let wanted: HashSet<[i32; 2]> = near.map(cell).collect();
        let covers = |number: usize| -> Vec<([i32; 2], u32)> {
            let corners = triangles[number].map(|vertex| domain[vertex as usize]);
            if corners.iter().any(|corner| !(corner.x.is_finite() && corner.y.is_finite())) {
                return Vec::new();
            }
            let low = cell(corners[0].inf(&corners[1]).inf(&corners[2]));
            let high = cell(corners[0].sup(&corners[1]).sup(&corners[2]));
            // A triangle of many cells bridges two ends of an unrolled map.
            if high[0] - low[0] > 50 || high[1] - low[1] > 50 {
                return Vec::new();
            }
            let all = (low[0]..=high[0]).flat_map(|i| (low[1]..=high[1]).map(move |j| [i, j]));
            all.filter(|cell| wanted.contains(cell)).map(|cell| (cell, number as u32)).collect()
        };
        let found: Vec<([i32; 2], u32)> =
            (0..triangles.len()).into_par_iter().flat_map_iter(covers).collect();
        let mut cells: HashMap<[i32; 2], Vec<u32>> = HashMap::new();
        found.into_iter().for_each(|(cell, number)| cells.entry(cell).or_default().push(number));
        Self { domain, triangles, cells }
    }

    /// The material point over a point of the domain; `None` outside. Where sheets lie over each other (a scan's mouth
    /// goes on inside) it is on the outermost: of those that face outwards, the one farthest along their normals.
    pub(super) fn find(&self, at: Point2<f64>, points: &[Point3<f64>]) -> Option<Spot> {
        let candidates = self.cells.get(&cell(at))?;
        let sheets: Vec<Spot> = candidates.iter().filter_map(|&number| self.within(number, at)).collect();
        let faces_out = |spot: &Spot| {
            let [a, b, c] = spot.corners.map(|vertex| self.domain[vertex as usize]);
            (b - a).perp(&(c - a)) > 0.0
        };
        let out: Vec<Spot> = sheets.iter().copied().filter(faces_out).collect();
        let sheets = if out.is_empty() { sheets } else { out };
        let outwards: Vector3<f64> = sheets.iter().map(|spot| spot.normal(points)).sum();
        let height = |spot: &Spot| spot.at(points).coords.dot(&outwards);
        // The first of equally high ones.
        sheets.into_iter().reduce(|best, spot| if height(&spot) > height(&best) { spot } else { best })
    }

    fn within(&self, number: u32, at: Point2<f64>) -> Option<Spot> {
        let corners = self.triangles[number as usize];
        let [a, b, c] = corners.map(|vertex| self.domain[vertex as usize]);
        let area = (b - a).perp(&(c - a));
        if area == 0.0 {
            return None;
        }
        let (v, w) = ((at - a).perp(&(c - a)) / area, (b - a).perp(&(at - a)) / area);
        let barycentric = [1.0 - v - w, v, w];
        // Rounding must not lose a point between two triangles.
        barycentric.iter().all(|&share| share >= -1e-12).then_some(Spot {
            triangle: number,
            corners,
            barycentric,
        })
    }
}

/// The triangles beside each side of the triangles near the lines.
pub(super) struct Neighbors(HashMap<u32, [u32; 3]>);

const NONE: u32 = u32::MAX;

impl Neighbors {
    /// Of those triangles of which `is_near` a corner.
    pub(super) fn new(triangles: &[[u32; 3]], is_near: impl Fn(u32) -> bool + Sync) -> Self {
        let side = |number: usize| {
            let triangle = triangles[number];
            (0..3u32).map(move |i| {
                let (a, b) = (triangle[i as usize], triangle[(i as usize + 1) % 3]);
                ((u64::from(a.min(b)) << 32) | u64::from(a.max(b)), number as u32, i)
            })
        };
        let near = |number: &usize| triangles[*number].iter().any(|&vertex| is_near(vertex));
        let mut sides: Vec<(u64, u32, u32)> =
            (0..triangles.len()).into_par_iter().filter(near).flat_map_iter(side).collect();
        sides.par_sort_unstable();
        let mut beside: HashMap<u32, [u32; 3]> = HashMap::new();
        sides.iter().for_each(|side| {
            beside.entry(side.1).or_insert([NONE; 3]);
        });
        // An edge of more than two triangles ends a walk, as a boundary does.
        for edge in sides.chunk_by(|a, b| a.0 == b.0).filter(|edge| edge.len() == 2) {
            for (own, other) in [(edge[0], edge[1]), (edge[1], edge[0])] {
                if let Some(sides) = beside.get_mut(&own.1) {
                    sides[own.2 as usize] = other.1;
                }
            }
        }
        Self(beside)
    }

    /// The triangle across the side that starts at corner `side`; `None` at a boundary.
    fn across(&self, triangle: u32, side: usize) -> Option<u32> {
        self.0.get(&triangle).map(|sides| sides[side]).filter(|&other| other != NONE)
    }
}

/// A straight piece of a section, within one triangle.
struct Piece {
    from: Spot,
    to: Spot,
    length: f64,
}

/// A plane that cuts the surface: through `origin`, with normal `along`; sections run towards `across`.
pub(super) struct Cut {
    pub(super) origin: Point3<f64>,
    pub(super) along: Vector3<f64>,
    pub(super) across: Vector3<f64>,
}

/// A rest surface that can be walked on.
pub(super) struct Ground<'a> {
    pub(super) points: &'a [Point3<f64>],
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) neighbors: Neighbors,
}

impl Ground<'_> {
    /// Material points every `step` mm along the cut from `start` (excluded), up to `length` mm, to a boundary, or to
    /// where the surface turns back.
    pub(super) fn walk(&self, start: &Spot, cut: &Cut, step: f64, length: f64) -> Vec<Spot> {
        let (mut spots, mut walked) = (Vec::new(), 0.0);
        for piece in self.pieces(start, cut, length) {
            while step * (spots.len() + 1) as f64 <= walked + piece.length {
                let share = (step * (spots.len() + 1) as f64 - walked) / piece.length;
                let mix =
                    |i: usize| piece.from.barycentric[i] * (1.0 - share) + piece.to.barycentric[i] * share;
                spots.push(Spot { barycentric: [mix(0), mix(1), mix(2)], ..piece.from });
            }
            walked += piece.length;
        }
        spots
    }

    fn pieces(&self, start: &Spot, cut: &Cut, length: f64) -> Vec<Piece> {
        // Strictly inside its triangle, so that the plane crosses two of its sides.
        let raised = start.barycentric.map(|share| share.max(0.0) + INSIDE);
        let inner = Spot { barycentric: raised.map(|share| share / raised.iter().sum::<f64>()), ..*start };
        let level = (inner.at(self.points) - cut.origin).dot(&cut.along);
        let is_ahead = |vertex: u32| (self.points[vertex as usize] - cut.origin).dot(&cut.along) >= level;
        let (mut pieces, mut walked, mut furthest) = (Vec::new(), 0.0, 0.0f64);
        let (mut from, mut entry) = (*start, None);
        while walked < length && pieces.len() < 20_000 {
            let exits = (0..3).filter(|&i| {
                is_ahead(from.corners[i]) != is_ahead(from.corners[(i + 1) % 3]) && Some(i) != entry
            });
            let reached = |i: usize| {
                (self.crossing(&from, i, cut, level).at(self.points) - cut.origin).dot(&cut.across)
            };
            let Some(exit) = exits.max_by(|&a, &b| reached(a).total_cmp(&reached(b))) else { break };
            let to = self.crossing(&from, exit, cut, level);
            if reached(exit) < furthest - TURN_BACK {
                break;
            }
            furthest = furthest.max(reached(exit));
            let piece = Piece { from, to, length: (to.at(self.points) - from.at(self.points)).norm() };
            walked += piece.length;
            pieces.push(piece);
            let Some(next) = self.neighbors.across(from.triangle, exit) else { break };
            let Some((spot, side)) = self.enter(&to, exit, next) else { break };
            (from, entry) = (spot, Some(side));
        }
        pieces
    }

    /// Where the cut crosses the side that starts at corner `i`.
    fn crossing(&self, of: &Spot, i: usize, cut: &Cut, level: f64) -> Spot {
        let j = (i + 1) % 3;
        let height =
            |corner: usize| (self.points[of.corners[corner] as usize] - cut.origin).dot(&cut.along) - level;
        let share = (height(i) / (height(i) - height(j))).clamp(0.0, 1.0);
        let mut barycentric = [0.0; 3];
        (barycentric[i], barycentric[j]) = (1.0 - share, share);
        Spot { barycentric, ..*of }
    }

    /// A point on side `i` of one triangle as a point of the next one, with that one's side.
    fn enter(&self, spot: &Spot, i: usize, next: u32) -> Option<(Spot, usize)> {
        let corners = self.triangles[next as usize];
        let place = |vertex: u32| corners.iter().position(|&corner| corner == vertex);
        let (here, there) = (place(spot.corners[i])?, place(spot.corners[(i + 1) % 3])?);
        let mut barycentric = [0.0; 3];
        (barycentric[here], barycentric[there]) = (spot.barycentric[i], spot.barycentric[(i + 1) % 3]);
        let side = if (here + 1) % 3 == there { here } else { there };
        Some((Spot { triangle: next, corners, barycentric }, side))
    }
}

/// A section that goes back by this much has gone around a fold of the rest surface, mm.
const TURN_BACK: f64 = 0.3;
/// Share of every corner in a point that counts as strictly inside its triangle.
const INSIDE: f64 = 1e-7;
