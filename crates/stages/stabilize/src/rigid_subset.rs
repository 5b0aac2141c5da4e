//! The head among unnamed markers: the group that keeps its distances best over the take.

use crate::Error;
use crate::rigid_body::{RigidBody, Row};
use nalgebra::{DMatrix, Point3, Vector3};

/// Share of the markers that the first group holds: fewer could be a jaw, which is rigid too.
const GROUP_SHARE: f64 = 0.3;
/// Smallest group.
const GROUP_LEAST: usize = 4;
/// Frames looked at, spread over the take.
const FRAMES: usize = 400;
/// A marker belongs to the head if it strays at most this many times as far as the group's usual marker.
const STRAY_RATIO: f64 = 1.5;
/// Rounds of fitting and choosing again.
const ROUNDS: usize = 4;

/// The least deforming markers, in the take's order.
///
/// Method: the variance of each pair's distance over the take; from each marker a group grows by the marker whose
/// distances to it vary least; the group with the least variation for its extent wins (a turn of the head is
/// known as well as distances are kept over the group's extent). Then, in turns, the group is fitted to all frames
/// and every marker that strays little from its place joins, every other leaves.
///
/// # Errors
/// [`Error::TooFewMarkers`], or as [`RigidBody::estimate`].
pub(crate) fn least_deforming(frames: &[&Row], ids: &[String]) -> Result<Vec<usize>, Error> {
    let frames: Vec<&Row> = frames.iter().step_by(frames.len().div_ceil(FRAMES).max(1)).copied().collect();
    let seen = |marker: &usize| 2 * frames.iter().filter(|row| row[*marker].is_some()).count() > frames.len();
    let candidates: Vec<usize> = (0..ids.len()).filter(seen).collect();
    if candidates.len() < 3 {
        return Err(Error::TooFewMarkers(candidates.len()));
    }
    let size = GROUP_LEAST.max((GROUP_SHARE * candidates.len() as f64).ceil() as usize).min(candidates.len());
    let variance = distance_variance(&frames, &candidates);
    let middles = middles(&frames, &candidates);
    let mut group = best_group(&variance, &middles, size);
    for _ in 0..ROUNDS {
        let members: Vec<usize> = group.iter().map(|&i| candidates[i]).collect();
        let stray = strays(&frames, &candidates, &members, ids)?;
        let next = choose(&stray, &group, size);
        if next == group {
            break;
        }
        group = next;
    }
    Ok(group.into_iter().map(|i| candidates[i]).collect())
}

/// Per pair the variance of its distance, mm²; infinite where a pair is never seen together.
fn distance_variance(frames: &[&Row], candidates: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(candidates.len(), candidates.len(), |i, j| {
        if i == j {
            return 0.0;
        }
        let (mut count, mut mean, mut square) = (0.0, 0.0, 0.0);
        for row in frames {
            let (Some(a), Some(b)) = (row[candidates[i]], row[candidates[j]]) else { continue };
            let distance = (a - b).norm();
            count += 1.0;
            let off = distance - mean;
            mean += off / count;
            square += off * (distance - mean);
        }
        if count < 2.0 { f64::INFINITY } else { square / count }
    })
}

/// Mean position of each marker: enough to tell how far a group extends.
fn middles(frames: &[&Row], candidates: &[usize]) -> Vec<Point3<f64>> {
    let middle = |&marker: &usize| {
        let seen: Vec<Vector3<f64>> = frames.iter().filter_map(|row| row[marker]).map(|p| p.coords).collect();
        Point3::from(seen.iter().sum::<Vector3<f64>>() / seen.len() as f64)
    };
    candidates.iter().map(middle).collect()
}

fn best_group(variance: &DMatrix<f64>, middles: &[Point3<f64>], size: usize) -> Vec<usize> {
    let grown = (0..middles.len()).map(|seed| {
        let mut group = vec![seed];
        while group.len() < size {
            let varies = |i: usize| group.iter().map(|&j| variance[(i, j)]).sum::<f64>();
            let free = (0..middles.len()).filter(|i| !group.contains(i));
            let Some(next) = free.min_by(|&a, &b| varies(a).total_cmp(&varies(b))) else { break };
            group.push(next);
        }
        group.sort_unstable();
        (cost(variance, middles, &group), group)
    });
    grown.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, group)| group).unwrap_or_default()
}

/// Variation of the distances within a group, over its extent: an angle, so to speak.
fn cost(variance: &DMatrix<f64>, middles: &[Point3<f64>], group: &[usize]) -> f64 {
    let pairs: f64 = group.iter().flat_map(|&i| group.iter().map(move |&j| variance[(i, j)])).sum();
    let mean = group.iter().map(|&i| middles[i].coords).sum::<Vector3<f64>>() / group.len() as f64;
    let extent: f64 = group.iter().map(|&i| (middles[i].coords - mean).norm_squared()).sum();
    (pairs / extent.max(f64::MIN_POSITIVE)).sqrt()
}

/// Per candidate its root mean square distance from its own middle, seen from the group, mm.
fn strays(
    frames: &[&Row],
    candidates: &[usize],
    members: &[usize],
    ids: &[String],
) -> Result<Vec<f64>, Error> {
    let body = RigidBody::estimate(frames, members, ids)?;
    let mut samples = vec![Vec::new(); candidates.len()];
    for row in frames {
        let Some(fit) = body.fit(row) else { continue };
        for (samples, &marker) in samples.iter_mut().zip(candidates) {
            samples
                .extend(row[marker].map(|point| fit.world_from_body.inverse_transform_point(&point).coords));
        }
    }
    let stray = |samples: &Vec<Vector3<f64>>| {
        let count = samples.len().max(1) as f64;
        let mean = samples.iter().sum::<Vector3<f64>>() / count;
        (samples.iter().map(|sample| (sample - mean).norm_squared()).sum::<f64>() / count).sqrt()
    };
    Ok(samples.iter().map(stray).collect())
}

/// The `size` markers that stray least, and all that stray little more than the group's usual one.
fn choose(stray: &[f64], group: &[usize], size: usize) -> Vec<usize> {
    let mut usual: Vec<f64> = group.iter().map(|&i| stray[i]).collect();
    let limit = STRAY_RATIO * crate::robust::median(&mut usual);
    let mut order: Vec<usize> = (0..stray.len()).collect();
    order.sort_by(|&a, &b| stray[a].total_cmp(&stray[b]));
    let mut chosen: Vec<usize> = order
        .iter()
        .enumerate()
        .filter(|&(rank, &i)| rank < size || stray[i] <= limit)
        .map(|(_, &i)| i)
        .collect();
    chosen.sort_unstable();
    chosen
}
