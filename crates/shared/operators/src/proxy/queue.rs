//! Edges that may go, least cost first.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Bins between no cost and the greatest at the start: a heap of one bin fits into a near cache, one of all edges into none.
const BINS: usize = 4096;

/// An edge that may go. Sorted by cost, then by its ends, so that the result does not depend on the heap's mood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    pub(super) cost: f64,
    pub(super) ends: [u32; 2],
}

impl Eq for Candidate {}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.cost.total_cmp(&other.cost).then(self.ends.cmp(&other.ends))
    }
}

/// A priority queue: one heap for the bin at hand and all cheaper ones, unsorted lists for those to come.
pub(super) struct Queue {
    near: BinaryHeap<Reverse<Candidate>>,
    bins: Vec<Vec<Candidate>>,
    /// The bin that was taken last.
    at: usize,
    per_cost: f64,
}

impl Queue {
    pub(super) fn new(candidates: Vec<Candidate>) -> Self {
        let largest = candidates.iter().map(|candidate| candidate.cost).filter(|cost| cost.is_finite());
        let largest = largest.fold(0.0, f64::max);
        let per_cost = if largest > 0.0 { (BINS - 1) as f64 / largest } else { 0.0 };
        let mut queue = Self { near: BinaryHeap::new(), bins: vec![Vec::new(); BINS], at: 0, per_cost };
        candidates.into_iter().for_each(|candidate| queue.push(candidate));
        queue
    }

    /// The bin of a cost: never lower for a higher one, and all that is no number comes last, as in the order of candidates.
    fn bin(&self, cost: f64) -> usize {
        if cost.is_nan() { BINS - 1 } else { (cost * self.per_cost).min((BINS - 1) as f64) as usize }
    }

    pub(super) fn push(&mut self, candidate: Candidate) {
        match self.bin(candidate.cost) {
            bin if bin > self.at => self.bins[bin].push(candidate),
            _ => self.near.push(Reverse(candidate)),
        }
    }

    /// The cheapest of all that are there.
    pub(super) fn pop(&mut self) -> Option<Candidate> {
        while self.near.is_empty() && self.at + 1 < BINS {
            self.at += 1;
            let bin = std::mem::take(&mut self.bins[self.at]);
            self.near = bin.into_iter().map(Reverse).collect();
        }
        self.near.pop().map(|Reverse(candidate)| candidate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A number below 1, and the state after it.
    fn draw(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 40) as f64 / (1u64 << 24) as f64
    }

    #[test]
    fn it_is_a_heap() {
        let mut state = 1;
        let mut candidate = |scale: f64| Candidate {
            cost: (scale * draw(&mut state) * 100.0).floor() / 100.0,
            ends: [0, 1].map(|_| (5.0 * draw(&mut state)) as u32),
        };
        let first: Vec<Candidate> = (0..500).map(|_| candidate(1.0)).collect();
        let mut heap: BinaryHeap<Reverse<Candidate>> = first.iter().copied().map(Reverse).collect();
        let mut queue = Queue::new(first);
        for _ in 0..2000 {
            let expected = heap.pop().map(|Reverse(candidate)| candidate);
            assert_eq!(queue.pop(), expected);
            if expected.is_none() {
                break;
            }
            // Cheaper than the bin at hand, and dearer than all at the start.
            if !heap.len().is_multiple_of(3) {
                let fresh = candidate(1.5);
                heap.push(Reverse(fresh));
                queue.push(fresh);
            }
        }
    }
}
