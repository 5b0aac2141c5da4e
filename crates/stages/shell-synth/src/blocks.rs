//! Adding up what elements do at each free vertex: gradients, and the Gauss–Newton matrix of 3 × 3 blocks.
//!
//! Every vertex gathers from the elements around it, in their order: threads do not meet, and the sum does not depend on them.
//! Of the matrix only the blocks are made that the factorisation reads: those of rows eliminated after their column.

use crate::jet::Jets;
use crate::patch::{Joint, Tile};
use crate::surface::{NONE, Surface};
use nalgebra::{Point3, Vector3};
use operators::{CsMat, Factor, FactorError, Ordering};
use rayon::prelude::*;

/// Vertices that one task works on.
const CHUNK: usize = 512;
/// No block.
const NO_SLOT: u16 = u16::MAX;

/// Elements around each free vertex: number and corner.
struct Incidence {
    starts: Vec<u32>,
    items: Vec<(u32, u8)>,
}

impl Incidence {
    fn of<const N: usize>(count: usize, elements: impl Iterator<Item = [u32; N]> + Clone) -> Self {
        let mut starts = vec![0u32; count + 2];
        for vertex in elements.clone().flatten().filter(|&vertex| (vertex as usize) < count) {
            starts[vertex as usize + 2] += 1;
        }
        (2..count + 2).for_each(|at| starts[at] += starts[at - 1]);
        let mut items = vec![(0, 0); starts[count + 1] as usize];
        for (number, vertices) in (0u32..).zip(elements) {
            for (corner, vertex) in (0u8..).zip(vertices) {
                if (vertex as usize) < count {
                    let end = &mut starts[vertex as usize + 1];
                    items[*end as usize] = (number, corner);
                    *end += 1;
                }
            }
        }
        starts.pop();
        Self { starts, items }
    }

    fn range(&self, vertex: usize) -> std::ops::Range<usize> {
        self.starts[vertex] as usize..self.starts[vertex + 1] as usize
    }

    fn at(&self, vertex: usize) -> impl Iterator<Item = (u32, usize)> {
        self.items[self.range(vertex)].iter().map(|&(number, corner)| (number, usize::from(corner)))
    }
}

/// Who adds to what.
pub(crate) struct Blocks {
    joints: Incidence,
    tiles: Incidence,
    /// Per item of an incidence and corner of its element, which of the column's blocks is theirs.
    joint_slots: Vec<[u16; 4]>,
    tile_slots: Vec<[u16; 3]>,
    /// Which of a column's blocks is the diagonal's.
    diagonals: Vec<u16>,
    /// Free vertices that share a hinge.
    pattern: CsMat<f64>,
    /// Free vertices, first eliminated first.
    order: Vec<u32>,
    /// Per free vertex where its column of blocks starts.
    starts: Vec<usize>,
    matrix: CsMat<f64>,
}

impl Blocks {
    /// `free`: the mesh's vertices that are free; elements are of places among them; `ranks`: as in [`crate::patch::Freed`].
    pub(crate) fn new(
        surface: &Surface,
        free: &[u32],
        joints: &[Joint],
        tiles: &[Tile],
        ranks: &[u32],
    ) -> Self {
        let joint_corners = Incidence::of(free.len(), joints.iter().map(|joint| joint.vertices));
        let tile_corners = Incidence::of(free.len(), tiles.iter().map(|tile| tile.vertices));
        let neighbors = |vertex: usize, into: &mut Vec<u32>| {
            let around = joint_corners.at(vertex).flat_map(|(joint, _)| joints[joint as usize].vertices);
            into.extend(around.filter(|&other| (other as usize) < free.len()));
            into.push(vertex as u32);
            into.sort_unstable();
            into.dedup();
        };
        let (starts, rows) = columns(free.len(), neighbors);
        let pattern = graph(&starts, &rows);
        let order = elimination_order(surface, free, ranks, &pattern);
        let mut place = vec![0u32; free.len()];
        (0u32..).zip(&order).for_each(|(at, &vertex)| place[vertex as usize] = at);
        let later = |vertex: usize, into: &mut Vec<u32>| {
            let all = rows[starts[vertex]..starts[vertex + 1]].iter().copied();
            into.extend(all.filter(|&other| place[other as usize] >= place[vertex]));
        };
        let (starts, rows) = columns(free.len(), later);
        let slot = |vertex: usize, other: u32| {
            let column = &rows[starts[vertex]..starts[vertex + 1]];
            column.iter().position(|&row| row == other).map_or(NO_SLOT, |slot| slot as u16)
        };
        let vertices = || (0..free.len()).into_par_iter();
        let joint_slots = vertices()
            .flat_map_iter(|vertex| {
                let slots =
                    move |joint: u32| joints[joint as usize].vertices.map(|other| slot(vertex, other));
                joint_corners.at(vertex).map(move |(joint, _)| slots(joint))
            })
            .collect();
        let tile_slots = vertices()
            .flat_map_iter(|vertex| {
                let slots = move |tile: u32| tiles[tile as usize].vertices.map(|other| slot(vertex, other));
                tile_corners.at(vertex).map(move |(tile, _)| slots(tile))
            })
            .collect();
        let diagonals = vertices().map(|vertex| slot(vertex, vertex as u32)).collect();
        let matrix = blank_matrix(&starts, &rows);
        Self {
            joints: joint_corners,
            tiles: tile_corners,
            joint_slots,
            tile_slots,
            diagonals,
            pattern,
            order,
            starts,
            matrix,
        }
    }

    pub(crate) fn matrix(&self) -> &CsMat<f64> {
        &self.matrix
    }

    /// Analyses and factors the matrix.
    pub(crate) fn factor(&self) -> Result<Factor, FactorError> {
        Factor::of_blocks(&self.pattern, &self.order, 3, &self.matrix)
    }

    /// Sets a value per free vertex from the corners that meet there: vertex, joints, tiles.
    pub(crate) fn gather<T: Send>(
        &self,
        into: &mut [T],
        of: impl Fn(usize, &mut dyn Iterator<Item = (u32, usize)>, &mut dyn Iterator<Item = (u32, usize)>) -> T
        + Sync,
    ) {
        into.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(|(vertex, value)| {
            *value = of(vertex, &mut self.joints.at(vertex), &mut self.tiles.at(vertex));
        });
    }

    /// Fills the matrix. `springs`: per vertex stiffnesses, along a unit vector or in all directions.
    pub(crate) fn fill<I: Iterator<Item = (f64, Option<Vector3<f64>>)>>(
        &mut self,
        jets: &Jets,
        springs: impl Fn(usize) -> I + Sync,
    ) {
        let Self { joints, tiles, joint_slots, tile_slots, diagonals, starts, matrix, .. } = self;
        let vertices = starts.len() - 1;
        let chunks = pieces(matrix.data_mut(), starts);
        chunks.into_par_iter().enumerate().for_each(|(chunk, values)| {
            let first = chunk * CHUNK;
            let base = 9 * starts[first];
            values.fill(0.0);
            for vertex in first..vertices.min(first + CHUNK) {
                let height = 3 * (starts[vertex + 1] - starts[vertex]);
                let values = &mut values[9 * starts[vertex] - base..9 * starts[vertex + 1] - base];
                let mut column = Column { values, height };
                for at in joints.range(vertex) {
                    let (joint, corner) = joints.items[at];
                    let (jet, slots, corner) =
                        (&jets.joints[joint as usize], joint_slots[at], usize::from(corner));
                    let own = jet.slopes[corner] * jet.bend_stiffness;
                    slots.iter().zip(&jet.slopes).for_each(|(&slot, row)| column.add(slot, row, &own));
                    if corner < 2 {
                        let own = jet.unit * jet.edge_stiffness;
                        column.add(slots[corner], &jet.unit, &own);
                        column.add(slots[1 - corner], &jet.unit, &-own);
                    }
                }
                for at in tiles.range(vertex) {
                    let (tile, corner) = tiles.items[at];
                    let jet = &jets.tiles[tile as usize];
                    let own = jet.slopes[usize::from(corner)] * jet.stiffness;
                    tile_slots[at]
                        .iter()
                        .zip(&jet.slopes)
                        .for_each(|(&slot, row)| column.add(slot, row, &own));
                }
                for (stiffness, along) in springs(vertex) {
                    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
                    let axes = along.as_ref().map_or(&axes[..], std::slice::from_ref);
                    axes.iter().for_each(|axis| column.add(diagonals[vertex], axis, &(axis * stiffness)));
                }
            }
        });
    }
}

/// A column of blocks.
struct Column<'a> {
    values: &'a mut [f64],
    height: usize,
}

impl Column<'_> {
    /// Adds `row columnᵀ` to a block.
    fn add(&mut self, slot: u16, row: &Vector3<f64>, column: &Vector3<f64>) {
        if slot == NO_SLOT {
            return;
        }
        let first = 3 * usize::from(slot);
        for c in 0..3 {
            let into = &mut self.values[c * self.height + first..][..3];
            (0..3).for_each(|r| into[r] += row[r] * column[c]);
        }
    }
}

/// The values of every [`CHUNK`] columns.
fn pieces<'a>(mut values: &'a mut [f64], starts: &[usize]) -> Vec<&'a mut [f64]> {
    let mut pieces = Vec::new();
    let count = starts.len() - 1;
    for first in (0..count).step_by(CHUNK) {
        let (head, tail) = values.split_at_mut(9 * (starts[count.min(first + CHUNK)] - starts[first]));
        pieces.push(head);
        values = tail;
    }
    pieces
}

/// Lists of equal meaning for every vertex, one after the other.
fn columns(count: usize, list: impl Fn(usize, &mut Vec<u32>) + Sync) -> (Vec<usize>, Vec<u32>) {
    let chunk = |first: usize| {
        let (mut ends, mut rows, mut column) = (Vec::new(), Vec::new(), Vec::new());
        for vertex in first..count.min(first + CHUNK) {
            column.clear();
            list(vertex, &mut column);
            rows.extend_from_slice(&column);
            ends.push(rows.len());
        }
        (ends, rows)
    };
    let firsts: Vec<usize> = (0..count).step_by(CHUNK).collect();
    let chunks: Vec<(Vec<usize>, Vec<u32>)> = firsts.into_par_iter().map(chunk).collect();
    let (mut starts, mut rows) = (vec![0], Vec::new());
    for (ends, some) in chunks {
        let base = rows.len();
        starts.extend(ends.into_iter().map(|end| base + end));
        rows.extend(some);
    }
    (starts, rows)
}

/// The graph of some vertices' neighbours, as a matrix.
pub(crate) fn graph(starts: &[usize], rows: &[u32]) -> CsMat<f64> {
    let count = starts.len() - 1;
    let indices = rows.iter().map(|&row| row as usize).collect();
    CsMat::new_csc((count, count), starts.to_vec(), indices, vec![1.0; rows.len()])
}

/// The free vertices in an elimination order: that of the ranks, or their own where there is one without.
fn elimination_order(surface: &Surface, free: &[u32], ranks: &[u32], pattern: &CsMat<f64>) -> Vec<u32> {
    if free.iter().any(|&vertex| ranks[vertex as usize] == NONE) {
        let points: Vec<Point3<f64>> = free.iter().map(|&vertex| surface.rest[vertex as usize]).collect();
        return Ordering::nested_dissection(pattern, &points).vertices().to_vec();
    }
    let mut order: Vec<u32> = (0..free.len() as u32).collect();
    order.sort_unstable_by_key(|&vertex| ranks[free[vertex as usize] as usize]);
    order
}

/// Per vertex of the mesh its place in an elimination order of some vertices (rising); [`NONE`] elsewhere.
pub(crate) fn ranks(surface: &Surface, some: &[u32]) -> Vec<u32> {
    let mut local = vec![NONE; surface.rest.len()];
    (0u32..).zip(some).for_each(|(at, &vertex)| local[vertex as usize] = at);
    let neighbors = |at: usize, into: &mut Vec<u32>| {
        for &triangle in surface.around(some[at]) {
            for side in surface.sides[triangle as usize] {
                let around = surface.hinges[side as usize].vertices;
                into.extend(
                    around.iter().filter(|&&other| other != NONE).map(|&other| local[other as usize]),
                );
            }
        }
        into.retain(|&other| other != NONE);
        into.push(at as u32);
        into.sort_unstable();
        into.dedup();
    };
    let (starts, rows) = columns(some.len(), neighbors);
    let points: Vec<Point3<f64>> = some.iter().map(|&vertex| surface.rest[vertex as usize]).collect();
    let order = Ordering::nested_dissection(&graph(&starts, &rows), &points);
    let mut ranks = vec![NONE; surface.rest.len()];
    (0u32..).zip(order.vertices()).for_each(|(rank, &at)| ranks[some[at as usize] as usize] = rank);
    ranks
}

fn blank_matrix(starts: &[usize], rows: &[u32]) -> CsMat<f64> {
    let count = starts.len() - 1;
    let (mut column_starts, mut indices) = (vec![0], Vec::with_capacity(9 * rows.len()));
    for column in 0..count {
        for _ in 0..3 {
            let blocks = &rows[starts[column]..starts[column + 1]];
            indices.extend(blocks.iter().flat_map(|&row| (0..3).map(move |r| 3 * row as usize + r)));
            column_starts.push(indices.len());
        }
    }
    let values = vec![0.0; indices.len()];
    CsMat::new_csc((3 * count, 3 * count), column_starts, indices, values)
}
