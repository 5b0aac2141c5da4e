//! The numeric factorisation: the multifrontal method [DuffReid1983, Liu1992].
//!
//! Front after front, from the leaves of the tree up: gather the matrix' entries and what the children pass up, eliminate
//! the pivots, pass up what they take from the rows below.

use crate::dense::{NotPositive, Trapezoid, eliminate, update_of};
use crate::elimination_tree::Permuted;
use crate::symbolic::Symbolic;
use crate::tree::Tree;
use crate::walk::{Ascent, Passed};

/// A pivot below this share of its diagonal entry has lost 42 of its 52 bits: what is left is rounding error, and the
/// system does not determine that vertex.
const LOST: f64 = 1.0 / (1u64 << 42) as f64;

/// Values of a factor in the making.
pub(crate) struct Elimination<'a> {
    pub(crate) symbolic: &'a Symbolic,
    pub(crate) matrix: Permuted<'a>,
}

/// Of one thread's walk.
pub(crate) struct Scratch {
    /// Per row its place in the front at hand; meaningful for the rows of that front only.
    places: Vec<u32>,
    /// Per pivot of the front at hand, the least value that counts.
    limits: Vec<f64>,
}

impl Ascent for Elimination<'_> {
    type Item = f64;
    type Scratch = Scratch;
    /// The column whose pivot is not positive.
    type Error = usize;

    fn tree(&self) -> &Tree {
        &self.symbolic.tree
    }

    fn scratch(&self) -> Scratch {
        Scratch { places: vec![0; self.symbolic.order.len()], limits: Vec::new() }
    }

    fn start(&self, front: usize) -> usize {
        self.symbolic.value_starts[front]
    }

    fn passes(&self, front: usize) -> usize {
        let below = self.symbolic.below(front);
        Trapezoid::new(below, below).len()
    }

    fn visit(
        &self,
        front: usize,
        values: &mut [f64],
        children: Passed<'_, f64>,
        update: &mut [f64],
        scratch: &mut Scratch,
        wide: bool,
    ) -> Result<(), usize> {
        let shape = self.symbolic.shape(front);
        self.gather(front, values, scratch);
        for (child, passed) in children.iter() {
            self.add(child, passed, shape, values, Columns::Pivots);
        }
        eliminate(shape, values, &scratch.limits, wide)
            .map_err(|NotPositive { column }| self.symbolic.starts[front] as usize + column)?;
        update_of(shape, values, update, wide);
        for (child, passed) in children.iter() {
            self.add(child, passed, shape, update, Columns::Below);
        }
        Ok(())
    }
}

/// Which columns of a front a child's update is added to.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Columns {
    Pivots,
    Below,
}

impl Elimination<'_> {
    /// The matrix' entries in the pivot columns.
    fn gather(&self, front: usize, values: &mut [f64], scratch: &mut Scratch) {
        let shape = self.symbolic.shape(front);
        let first = self.symbolic.starts[front];
        for (place, &row) in self.symbolic.rows(front).iter().enumerate() {
            scratch.places[row as usize] = (shape.columns + place) as u32;
        }
        // Fresh pages are written before they are read: that is one fault instead of two.
        values.fill(0.0);
        scratch.limits.clear();
        for pivot in 0..shape.columns {
            let column = first + pivot as u32;
            let diagonal = shape.diagonal(pivot);
            for (row, value) in self.matrix.column(column as usize).filter(|&(row, _)| row >= column) {
                let inside = (row - first) as usize;
                let place =
                    if inside < shape.columns { inside } else { scratch.places[row as usize] as usize };
                values[diagonal + place - pivot] += value;
            }
            scratch.limits.push(LOST * values[diagonal]);
        }
    }

    /// Adds the part of a child's update that belongs to the pivot columns, or to the columns below.
    fn add(&self, child: usize, passed: &[f64], shape: Trapezoid, into: &mut [f64], columns: Columns) {
        let places = self.symbolic.in_parent(child);
        let source = Trapezoid::new(places.len(), places.len());
        let among_pivots = places.partition_point(|&place| (place as usize) < shape.columns);
        let (range, target, offset) = match columns {
            Columns::Pivots => (0..among_pivots, shape, 0),
            Columns::Below => {
                let below = shape.rows - shape.columns;
                (among_pivots..places.len(), Trapezoid::new(below, below), shape.columns)
            }
        };
        let runs = runs(places);
        let mut first_run = 0;
        for column in range {
            let from = &passed[source.diagonal(column)..];
            let start = places[column] as usize;
            let into = &mut into[target.diagonal(start - offset)..];
            first_run += runs[first_run..].iter().take_while(|run| run.end <= column).count();
            for run in &runs[first_run..] {
                let begin = run.start.max(column);
                let place = run.place + (begin - run.start) - start;
                let length = run.end - begin;
                let from = &from[begin - column..][..length];
                into[place..place + length].iter_mut().zip(from).for_each(|(sum, value)| *sum += value);
            }
        }
    }
}

/// Rows of a child that stand one after the other in its parent, too.
struct Run {
    start: usize,
    end: usize,
    /// Of the first, in the parent.
    place: usize,
}

fn runs(places: &[u32]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (at, &place) in places.iter().enumerate() {
        match runs.last_mut() {
            Some(run) if run.place + (at - run.start) == place as usize => run.end = at + 1,
            _ => runs.push(Run { start: at, end: at + 1, place: place as usize }),
        }
    }
    runs
}
