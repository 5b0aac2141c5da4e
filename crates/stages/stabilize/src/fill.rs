//! Short gaps, filled from how the neighbours moved meanwhile.

use crate::layout::Layout;
use crate::samples::Samples;
use artifact::SampleStatus;
use nalgebra::{Matrix4, Matrix4x3, Vector3, Vector4};

/// With fewer neighbours the gap is interpolated over time.
const LEAST_NEIGHBORS: usize = 4;
/// Resistance of the affine map's linear part, as a share of the neighbours' spread: faces are flat, and across
/// the surface nothing else holds the map.
const RIDGE: f64 = 0.05;

/// A sample that was filled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Filled {
    /// Position of the frame in the take.
    pub(crate) frame: usize,
    pub(crate) marker: usize,
    pub(crate) status: SampleStatus,
}

/// Fills gaps of at most `longest` frames between two samples of a marker; longer ones, and those at the ends of
/// the take, stay gaps. `is_known` says in which frames the head's pose is known: elsewhere nothing is filled.
///
/// Method: from the frame before the gap to a frame in it, the neighbours' motion is fitted by an affine map (least
/// squares with weights falling over distance), which moves the marker; the same from the frame after the gap; the
/// two are blended linearly, so that the filled path meets the marker's own ends.
pub(crate) fn fill_gaps(
    head: &mut Samples,
    layout: &Layout,
    longest: i64,
    is_known: impl Fn(usize) -> bool,
) -> Vec<Filled> {
    let measured = head.clone();
    let mut filled = Vec::new();
    for marker in 0..head.marker_count() {
        for pair in measured.seen(marker).windows(2) {
            let (a, b) = (pair[0], pair[1]);
            if b == a + 1 || head.numbers[b] - head.numbers[a] - 1 > longest {
                continue;
            }
            for frame in (a + 1..b).filter(|&f| is_known(f)) {
                let Some((place, status)) = place_between(&measured, layout, marker, (a, b), frame) else {
                    continue;
                };
                head.points[frame][marker] = Some(place.into());
                filled.push(Filled { frame, marker, status });
            }
        }
    }
    filled
}

fn place_between(
    samples: &Samples,
    layout: &Layout,
    marker: usize,
    (a, b): (usize, usize),
    frame: usize,
) -> Option<(Vector3<f64>, SampleStatus)> {
    let number = |f: usize| samples.numbers[f] as f64;
    let share = (number(frame) - number(a)) / (number(b) - number(a));
    let (from, to) = (samples.points[a][marker]?.coords, samples.points[b][marker]?.coords);
    let moved = |end| affine_motion(samples, layout, marker, end, frame);
    Some(match (moved(a), moved(b)) {
        (Some(after_a), Some(before_b)) => {
            ((from + after_a).lerp(&(to + before_b), share), SampleStatus::NeighborFilled)
        }
        _ => (from.lerp(&to, share), SampleStatus::Interpolated),
    })
}

/// How the neighbours' motion from frame `end` to `frame` moves the place that the marker has at `end`.
fn affine_motion(
    samples: &Samples,
    layout: &Layout,
    marker: usize,
    end: usize,
    frame: usize,
) -> Option<Vector3<f64>> {
    let here = samples.points[end][marker]?;
    let arms: Vec<(Vector3<f64>, Vector3<f64>)> = layout.neighbors[marker]
        .iter()
        .filter_map(|&other| {
            let there = samples.points[end][other]?;
            Some((there - here, samples.points[frame][other]? - there))
        })
        .collect();
    if arms.len() < LEAST_NEIGHBORS {
        return None;
    }
    let mean_square = arms.iter().map(|(arm, _)| arm.norm_squared()).sum::<f64>() / arms.len() as f64;
    let mut normal = Matrix4::zeros();
    let mut right = Matrix4x3::zeros();
    for (arm, motion) in &arms {
        let weight = (-0.5 * arm.norm_squared() / mean_square).exp();
        let row = Vector4::new(arm.x, arm.y, arm.z, 1.0);
        normal += weight * row * row.transpose();
        right += weight * row * motion.transpose();
    }
    let ridge = RIDGE * normal.fixed_view::<3, 3>(0, 0).trace();
    (0..3).for_each(|i| normal[(i, i)] += ridge);
    let map = normal.cholesky()?.solve(&right);
    Some(map.row(3).transpose())
}
