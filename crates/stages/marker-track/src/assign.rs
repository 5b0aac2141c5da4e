//! The one cheapest assignment of dots to tracks, over a whole image.
//!
//! Gates leave few pairs, so the graph falls apart into small groups; in each, the Hungarian method with shortest augmenting
//! paths [JonkerVolgenant1987] finds the assignment of least total cost. A track may also stay without a dot, at a price.

/// A track and a dot that may belong together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pair {
    pub(crate) track: usize,
    pub(crate) dot: usize,
    pub(crate) cost: f64,
}

/// Per track its dot; `alone` is the price of having none.
pub(crate) fn assign(pairs: &[Pair], tracks: usize, dots: usize, alone: f64) -> Vec<Option<usize>> {
    let mut parents: Vec<usize> = (0..tracks + dots).collect();
    for pair in pairs {
        let (a, b) = (root(&mut parents, pair.track), root(&mut parents, tracks + pair.dot));
        parents[a.max(b)] = a.min(b);
    }
    let mut groups: Vec<Vec<Pair>> = vec![Vec::new(); tracks + dots];
    for pair in pairs {
        groups[root(&mut parents, pair.track)].push(*pair);
    }
    let mut dot_of = vec![None; tracks];
    for group in groups.iter().filter(|group| !group.is_empty()) {
        assign_group(group, alone, &mut dot_of);
    }
    dot_of
}

fn root(parents: &mut [usize], mut at: usize) -> usize {
    while parents[at] != at {
        parents[at] = parents[parents[at]];
        at = parents[at];
    }
    at
}

fn assign_group(group: &[Pair], alone: f64, dot_of: &mut [Option<usize>]) {
    let ids = |of: &dyn Fn(&Pair) -> usize| {
        let mut ids: Vec<usize> = group.iter().map(of).collect();
        ids.sort_unstable();
        ids.dedup();
        ids
    };
    let (tracks, dots) = (ids(&|pair| pair.track), ids(&|pair| pair.dot));
    // Columns: the dots, then one way of staying alone per track.
    let width = dots.len() + tracks.len();
    let mut costs = vec![f64::INFINITY; tracks.len() * width];
    for pair in group {
        let (Ok(row), Ok(column)) = (tracks.binary_search(&pair.track), dots.binary_search(&pair.dot)) else {
            continue;
        };
        costs[row * width + column] = pair.cost;
    }
    for row in 0..tracks.len() {
        costs[row * width + dots.len() + row] = alone;
    }
    for (row, column) in cheapest(&costs, tracks.len(), width).into_iter().enumerate() {
        dot_of[tracks[row]] = dots.get(column).copied();
    }
}

/// Per row its column in the assignment of least total cost; `costs` holds `rows` × `width` values, row by row, and each row has
/// a finite column of its own.
fn cheapest(costs: &[f64], rows: usize, width: usize) -> Vec<usize> {
    const NONE: usize = usize::MAX;
    let (mut row_price, mut column_price) = (vec![0.0; rows], vec![0.0; width]);
    let mut row_of = vec![NONE; width];
    for start in 0..rows {
        let mut least = vec![f64::INFINITY; width];
        let mut before = vec![NONE; width];
        let mut done = vec![false; width];
        let (mut row, mut column) = (start, NONE);
        loop {
            let (mut step, mut next) = (f64::INFINITY, NONE);
            for j in (0..width).filter(|&j| !done[j]) {
                let reduced = costs[row * width + j] - row_price[row] - column_price[j];
                if reduced < least[j] {
                    (least[j], before[j]) = (reduced, column);
                }
                if least[j] < step {
                    (step, next) = (least[j], j);
                }
            }
            if next == NONE {
                break;
            }
            row_price[start] += step;
            for j in 0..width {
                if done[j] {
                    row_price[row_of[j]] += step;
                    column_price[j] -= step;
                } else {
                    least[j] -= step;
                }
            }
            (done[next], column) = (true, next);
            if row_of[next] == NONE {
                break;
            }
            row = row_of[next];
        }
        // The path's columns change their rows, from its end to its start.
        while column != NONE {
            let previous = before[column];
            row_of[column] = if previous == NONE { start } else { row_of[previous] };
            column = previous;
        }
    }
    let mut column_of = vec![NONE; rows];
    row_of.iter().enumerate().filter(|(_, row)| **row != NONE).for_each(|(j, &row)| column_of[row] = j);
    column_of
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The least cost over all assignments, tried one by one.
    fn tried(pairs: &[Pair], track: usize, tracks: usize, taken: &mut Vec<usize>, alone: f64) -> f64 {
        if track == tracks {
            return 0.0;
        }
        let mut best = alone + tried(pairs, track + 1, tracks, taken, alone);
        for pair in pairs.iter().filter(|pair| pair.track == track) {
            if !taken.contains(&pair.dot) {
                taken.push(pair.dot);
                best = best.min(pair.cost + tried(pairs, track + 1, tracks, taken, alone));
                taken.pop();
            }
        }
        best
    }

    #[test]
    fn no_assignment_is_cheaper() {
        use rand::{Rng, SeedableRng};
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(3);
        for _ in 0..300 {
            let (tracks, dots) = (rng.random_range(1..6), rng.random_range(1..6));
            let mut pairs = Vec::new();
            for track in 0..tracks {
                for dot in 0..dots {
                    if rng.random_bool(0.5) {
                        pairs.push(Pair { track, dot, cost: rng.random_range(0.0..10.0) });
                    }
                }
            }
            let dot_of = assign(&pairs, tracks, dots, 6.0);
            let cost: f64 = dot_of
                .iter()
                .enumerate()
                .map(|(track, dot)| match dot {
                    Some(dot) => {
                        pairs.iter().find(|pair| (pair.track, pair.dot) == (track, *dot)).unwrap().cost
                    }
                    None => 6.0,
                })
                .sum();
            let best = tried(&pairs, 0, tracks, &mut Vec::new(), 6.0);
            assert!((cost - best).abs() < 1e-9, "{cost} {best}");
            let mut used: Vec<usize> = dot_of.into_iter().flatten().collect();
            let count = used.len();
            used.sort_unstable();
            used.dedup();
            assert_eq!(used.len(), count, "a dot went to two tracks");
        }
    }

    #[test]
    fn the_nearest_dot_is_not_always_the_right_one() {
        // Greedily, track 0 would take dot 0 and leave track 1 alone.
        let pair = |track, dot, cost| Pair { track, dot, cost };
        let pairs = [pair(0, 0, 1.0), pair(0, 1, 2.0), pair(1, 0, 1.5)];
        assert_eq!(assign(&pairs, 2, 2, 9.0), [Some(1), Some(0)]);
    }
}
