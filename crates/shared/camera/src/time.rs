//! Tracks between the times of images.

use nalgebra::Vector2;

/// Where samples on one side only are near, a track is continued by this much at most, frames.
const LONGEST_EXTRAPOLATION: f64 = 0.5;

/// Samples closer in time than this are of one image, frames: a slow clock's image is the nearest to two frames in a row.
const SAME_IMAGE: f64 = 1e-3;

/// Where a point was in an image at time 0, from samples in the order of their times, frames: Lagrange's polynomial through the
/// nearest two before and after, or as many as there are. Where all lie on one side, a line through the nearest two, if the nearest
/// is within half a frame; else, and from fewer than two, none.
#[must_use]
pub fn place_at_zero(samples: &[(f64, Vector2<f64>)]) -> Option<Vector2<f64>> {
    let mut samples = samples.to_vec();
    samples.dedup_by(|next, last| next.0 - last.0 < SAME_IMAGE);
    let (before, after) = samples.split_at(samples.partition_point(|(time, _)| *time <= 0.0));
    let after = &after[..after.len().min(2)];
    let before = &before[before.len().saturating_sub(2)..];
    let nodes: Vec<(f64, Vector2<f64>)> = before.iter().chain(after).copied().collect();
    let outside = nodes.iter().map(|(time, _)| time.abs()).fold(f64::INFINITY, f64::min);
    let is_inside = !before.is_empty() && !after.is_empty();
    if nodes.len() < 2 || (!is_inside && outside > LONGEST_EXTRAPOLATION) {
        return None;
    }
    Some(lagrange(if is_inside { &nodes } else { nearest_two(&nodes, before.is_empty()) }))
}

/// To the future the first two samples lead, to the past the last two: a higher degree would swing.
fn nearest_two<T>(nodes: &[T], first: bool) -> &[T] {
    if first { &nodes[..2] } else { &nodes[nodes.len() - 2..] }
}

/// The value at time 0 of the polynomial through the nodes.
fn lagrange(nodes: &[(f64, Vector2<f64>)]) -> Vector2<f64> {
    let weight = |i: usize| -> f64 {
        let others = nodes.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, (time, _))| time / (time - nodes[i].0)).product()
    };
    nodes.iter().enumerate().map(|(i, (_, at))| at * weight(i)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(time: f64) -> (f64, Vector2<f64>) {
        (time, Vector2::new(1.0 + time * (2.0 + time * (3.0 - 4.0 * time)), 7.0 * time))
    }

    #[test]
    fn a_cubic_motion_is_met_and_far_ends_are_not_guessed() {
        let place = place_at_zero(&[-1.7, -0.7, 0.3, 1.3].map(sample)).unwrap_or_default();
        assert!((place - Vector2::new(1.0, 0.0)).norm() < 1e-12, "{place}");
        let twice = place_at_zero(&[-1.7, -0.7, -0.7, 0.3, 1.3].map(sample)).unwrap_or_default();
        assert!((place - twice).norm() < 1e-12, "{twice}");
        assert_eq!(place_at_zero(&[0.6, 1.6].map(sample)), None);
        assert!(place_at_zero(&[0.4, 1.4].map(sample)).is_some());
        assert_eq!(place_at_zero(&[sample(0.1)]), None);
    }
}
