//! Cutting a graph in two by a small separator: the step of nested dissection.

use crate::matching::{Crossing, minimum_cover};
use nalgebra::{Matrix3, Vector3};

/// A piece of a graph, with vertices of its own numbering: what lies in a part stays together in memory.
pub(crate) struct Part {
    /// Names in the whole graph.
    pub(crate) vertices: Vec<u32>,
    /// Places, if there are any to go by.
    places: Vec<[f32; 3]>,
    starts: Vec<u32>,
    neighbors: Vec<u32>,
}

/// Directions that are looked along.
const DIRECTIONS: usize = 4;
/// Steps of a direction in which the plane may stand.
const BINS: usize = 256;
/// Least share of a part on either side of the cut, where there is a choice, and where there is none.
const BALANCE: f32 = 0.38;
const LEAST_BALANCE: f32 = 0.1;

/// Per vertex how high it stands along every direction.
type Heights = [f32; DIRECTIONS];

/// A plane: a direction and a height. Vertices below it are on one side.
struct Plane {
    direction: usize,
    height: f32,
    cost: f32,
}

impl Part {
    pub(crate) fn new(
        vertices: Vec<u32>,
        places: Vec<[f32; 3]>,
        starts: Vec<u32>,
        neighbors: Vec<u32>,
    ) -> Self {
        Self { vertices, places, starts, neighbors }
    }

    pub(crate) fn len(&self) -> usize {
        self.vertices.len()
    }

    pub(crate) fn neighbors(&self, vertex: usize) -> &[u32] {
        &self.neighbors[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// Cuts the part in two that no edge joins, and the separator between them (names in the whole graph): along the
    /// coordinates where they help, else between sets of vertices at the same distance from one. Nothing if the graph does
    /// not fall apart, like a clique.
    pub(crate) fn bisect(&self) -> Option<([Part; 2], Vec<u32>)> {
        let along = (!self.places.is_empty()).then(|| self.heights_along_axes());
        let cut = |heights: Vec<Heights>| {
            let highest = self.highest_neighbors(&heights);
            self.best_plane(&heights, &highest).map(|plane| self.cut(&plane, &heights, &highest))
        };
        along.and_then(cut).or_else(|| cut(self.levels()))
    }

    /// Heights along the two longest principal axes and the diagonals between them.
    fn heights_along_axes(&self) -> Vec<Heights> {
        let at = |place: &[f32; 3]| Vector3::from(place.map(f64::from));
        let count = self.len() as f64;
        let mean = self.places.iter().map(at).sum::<Vector3<f64>>() / count;
        let mut spread = Matrix3::zeros();
        for place in &self.places {
            let offset = at(place) - mean;
            spread += offset * offset.transpose();
        }
        let eigen = spread.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
        let [long, wide] = [order[0], order[1]].map(|axis| eigen.eigenvectors.column(axis).into_owned());
        let axes = [long, wide, long + wide, long - wide].map(|axis| axis.cast::<f32>());
        let mean = mean.cast::<f32>();
        let height = |place: &[f32; 3]| axes.map(|axis| (Vector3::from(*place) - mean).dot(&axis));
        self.places.iter().map(height).collect()
    }

    /// Distances from a vertex at the rim of the graph, in edges; every component starts where the one before ended.
    fn levels(&self) -> Vec<Heights> {
        let start = self.breadth_first(0).last().map_or(0, |&(vertex, _)| vertex);
        let mut heights = vec![[0.0; DIRECTIONS]; self.len()];
        for (vertex, level) in self.breadth_first(start) {
            heights[vertex as usize] = [level as f32, 0.0, 0.0, 0.0];
        }
        heights
    }

    /// All vertices with their levels, component after component, the first from `start`.
    fn breadth_first(&self, start: u32) -> Vec<(u32, u32)> {
        let mut seen = vec![false; self.len()];
        let mut queue: Vec<(u32, u32)> = Vec::with_capacity(self.len());
        let mut at = 0;
        for root in std::iter::once(start).chain(0..self.len() as u32) {
            if std::mem::replace(&mut seen[root as usize], true) {
                continue;
            }
            queue.push((root, queue.last().map_or(0, |&(_, level)| level + 1)));
            while at < queue.len() {
                let (vertex, level) = queue[at];
                at += 1;
                for &other in self.neighbors(vertex as usize) {
                    if !std::mem::replace(&mut seen[other as usize], true) {
                        queue.push((other, level + 1));
                    }
                }
            }
        }
        queue
    }

    /// Per vertex the height of its highest neighbour.
    fn highest_neighbors(&self, heights: &[Heights]) -> Vec<Heights> {
        let highest = |vertex: usize| {
            let mut highest = heights[vertex];
            for &other in self.neighbors(vertex) {
                let other = heights[other as usize];
                (0..DIRECTIONS)
                    .for_each(|i| highest[i] = if other[i] > highest[i] { other[i] } else { highest[i] });
            }
            highest
        };
        (0..self.len()).map(highest).collect()
    }

    /// The plane with the fewest vertices that have neighbours beyond it, over all directions, near the middle.
    fn best_plane(&self, heights: &[Heights], highest: &[Heights]) -> Option<Plane> {
        let planes = (0..DIRECTIONS).filter_map(|direction| {
            let of =
                |heights: &[Heights]| heights.iter().map(|heights| heights[direction]).collect::<Vec<_>>();
            profile(direction, &of(heights), &of(highest))
        });
        planes.min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    fn cut(&self, plane: &Plane, heights: &[Heights], highest: &[Heights]) -> ([Part; 2], Vec<u32>) {
        const SEPARATOR: u8 = 2;
        let below = |vertex: usize| heights[vertex][plane.direction] < plane.height;
        let (mut left, mut starts, mut neighbors) = (Vec::new(), vec![0], Vec::new());
        for vertex in (0..self.len()).filter(|&vertex| below(vertex)) {
            if highest[vertex][plane.direction] >= plane.height {
                left.push(vertex as u32);
                neighbors.extend(self.neighbors(vertex).iter().filter(|&&other| !below(other as usize)));
                starts.push(neighbors.len());
            }
        }
        let separator = minimum_cover(&Crossing::new(left, starts, neighbors));
        let mut side: Vec<u8> = (0..self.len()).map(|vertex| u8::from(!below(vertex))).collect();
        separator.iter().for_each(|&vertex| side[vertex as usize] = SEPARATOR);
        let names = separator.iter().map(|&vertex| self.vertices[vertex as usize]).collect();
        ([self.side(&side, 0), self.side(&side, 1)], names)
    }

    /// The vertices of one side, with the edges among them.
    fn side(&self, side: &[u8], which: u8) -> Part {
        let kept: Vec<u32> =
            (0..self.len() as u32).filter(|&vertex| side[vertex as usize] == which).collect();
        let mut renamed = vec![0u32; self.len()];
        kept.iter().enumerate().for_each(|(place, &vertex)| renamed[vertex as usize] = place as u32);
        let mut starts = Vec::with_capacity(kept.len() + 1);
        let mut neighbors = Vec::with_capacity(self.neighbors.len() * kept.len() / self.len().max(1));
        starts.push(0);
        for &vertex in &kept {
            let inside =
                self.neighbors(vertex as usize).iter().filter(|&&other| side[other as usize] == which);
            neighbors.extend(inside.map(|&other| renamed[other as usize]));
            starts.push(neighbors.len() as u32);
        }
        let vertices = kept.iter().map(|&vertex| self.vertices[vertex as usize]).collect();
        let places = match self.places.is_empty() {
            true => Vec::new(),
            false => kept.iter().map(|&vertex| self.places[vertex as usize]).collect(),
        };
        Part { vertices, places, starts, neighbors }
    }
}

/// The best plane along one direction: for every step the vertices below and, of these, those with a neighbour above.
fn profile(direction: usize, heights: &[f32], highest: &[f32]) -> Option<Plane> {
    let lowest = heights.iter().copied().fold(f32::INFINITY, f32::min);
    let top = heights.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    let step = (top - lowest) / BINS as f32;
    if !(step > 0.0 && step.is_finite()) {
        return None;
    }
    // Rounded like the comparison with the plane's height, which stands at the bottom of a step.
    let bin = |height: f32| (((height - lowest) / step) as usize).min(BINS - 1);
    let (mut counts, mut layers) = ([0i32; BINS], [0i32; BINS + 1]);
    for (&height, &highest) in heights.iter().zip(highest) {
        let (own, last) = (bin(height), bin(highest));
        counts[own] += 1;
        layers[own + 1] += 1;
        layers[last + 1] -= 1;
    }
    let (mut below, mut crossing) = (0, 0);
    let mut best: Option<Plane> = None;
    for at in 0..BINS {
        crossing += layers[at];
        let share = below as f32 / heights.len() as f32;
        let balance = share.min(1.0 - share);
        // A lopsided cut is taken only where there is no other.
        let penalty = if balance < BALANCE { 1e6 * (1.0 - balance) } else { 1.0 + 0.5 - balance };
        let cost = (1 + crossing) as f32 * penalty;
        if balance >= LEAST_BALANCE && best.as_ref().is_none_or(|best| cost < best.cost) {
            best = Some(Plane { direction, height: lowest + at as f32 * step, cost });
        }
        below += counts[at];
    }
    best
}
