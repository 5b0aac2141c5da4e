//! The smallest set of reference poses that explains a performance.

use crate::blender::{Setting, Watched, places, watch};
use crate::{Error, Params, Pose, dual};
use nalgebra::Vector3;
use rayon::prelude::*;

/// What a set of poses must achieve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Goal {
    /// How far any bone of any frame may lie from what its poses explain, mm.
    pub tolerance_mm: f64,
    /// No more poses than these.
    pub most: usize,
}

/// Frames that were chosen as poses, in the order of their use.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// Indices into the frames.
    pub frames: Vec<usize>,
    /// What the set leaves: the farthest bone of the worst frame, mm.
    pub error_mm: f64,
    /// The same before a pose was chosen, after the first, and so on.
    pub errors_mm: Vec<f64>,
}

/// The frames of a performance that should become reference poses.
///
/// A frame is explained if each bone's move is a sum of shares, 0 to 1, of its moves in the poses. Greedily: of the frames
/// in which some bone is the least explained, the one is added that leaves the least, in squares over all bones and frames, until the tolerance is met. Then
/// poses that the later ones made needless are dropped.
///
/// # Errors
/// [`Error::TooFewPoses`] if `most` poses do not meet the tolerance; [`Error::NeutralPose`] if nothing moves at all.
pub fn fit_poses(
    setting: Setting<'_>,
    frames: &[Pose],
    goal: Goal,
    params: &Params,
) -> Result<Chosen, Error> {
    params.check()?;
    let Watched { skeleton, bones, .. } = watch(setting, params.probe)?;
    let neutral = places(&skeleton, &bones, setting.mm_per_unit, setting.neutral);
    let moves: Vec<Vec<Vector3<f64>>> = frames
        .par_iter()
        .map(|pose| {
            let at = places(&skeleton, &bones, setting.mm_per_unit, pose);
            at.iter().zip(&neutral).map(|(place, neutral)| place - neutral).collect()
        })
        .collect();
    let bare = left(&moves, &[], params);
    if bare.worst <= params.least_mm {
        return Err(Error::NeutralPose {
            pose: "performance".into(),
            least_mm: params.least_mm,
            most_mm: bare.worst,
        });
    }
    let (mut chosen, mut now, mut errors_mm) = (Vec::new(), bare, Vec::new());
    errors_mm.push(now.worst);
    while now.worst > goal.tolerance_mm && chosen.len() < goal.most {
        let Some((frame, next)) = best(&moves, &chosen, &now, params) else { break };
        chosen.push(frame);
        now = next;
        errors_mm.push(now.worst);
    }
    if now.worst > goal.tolerance_mm {
        let count = chosen.len();
        return Err(Error::TooFewPoses { count, error_mm: now.worst, tolerance_mm: goal.tolerance_mm });
    }
    drop_needless(&moves, &mut chosen, &mut now, goal, params);
    Ok(Chosen { frames: chosen, error_mm: now.worst, errors_mm })
}

/// What poses leave unexplained.
struct Left {
    /// Per bone the frame that is explained least.
    worst_frames: Vec<usize>,
    /// The farthest bone of the worst frame, mm.
    worst: f64,
    /// Sum of squares over all bones and frames.
    squares: f64,
}

/// The frame among the worst ones of the bones that leaves the least once it is a pose.
fn best(moves: &[Vec<Vector3<f64>>], chosen: &[usize], now: &Left, params: &Params) -> Option<(usize, Left)> {
    let mut candidates = now.worst_frames.clone();
    candidates.sort_unstable();
    candidates.dedup();
    candidates.retain(|frame| !chosen.contains(frame));
    let tried: Vec<(usize, Left)> = candidates
        .into_iter()
        .map(|frame| (frame, left(moves, &[chosen, &[frame]].concat(), params)))
        .collect();
    tried.into_iter().min_by(|a, b| a.1.squares.total_cmp(&b.1.squares).then(a.0.cmp(&b.0)))
}

/// Takes away poses, the earliest first, without which the tolerance is still met.
fn drop_needless(
    moves: &[Vec<Vector3<f64>>],
    chosen: &mut Vec<usize>,
    now: &mut Left,
    goal: Goal,
    params: &Params,
) {
    let mut at = 0;
    while at < chosen.len() && chosen.len() > 1 {
        let mut fewer = chosen.clone();
        fewer.remove(at);
        let without = left(moves, &fewer, params);
        match without.worst <= goal.tolerance_mm {
            true => (*chosen, *now) = (fewer, without),
            false => at += 1,
        }
    }
}

fn left(moves: &[Vec<Vector3<f64>>], poses: &[usize], params: &Params) -> Left {
    let bone_count = moves.first().map_or(0, Vec::len);
    let per_bone: Vec<(usize, f64, f64)> = (0..bone_count)
        .into_par_iter()
        .map(|bone| {
            let ways: Vec<Vector3<f64>> = poses
                .iter()
                .map(|&pose| moves[pose][bone])
                .filter(|way| way.norm() > params.least_mm)
                .collect();
            let mut worst = (0, 0.0, 0.0);
            for (frame, bones) in moves.iter().enumerate() {
                let rest = unexplained(&ways, &bones[bone]);
                worst.2 += rest * rest;
                if rest > worst.1 {
                    (worst.0, worst.1) = (frame, rest);
                }
            }
            worst
        })
        .collect();
    Left {
        worst_frames: per_bone.iter().map(|bone| bone.0).collect(),
        worst: per_bone.iter().map(|bone| bone.1).fold(0.0, f64::max),
        squares: per_bone.iter().map(|bone| bone.2).sum(),
    }
}

/// How far a move lies from what shares of 0 to 1 of the ways make of it, mm.
fn unexplained(ways: &[Vector3<f64>], b: &Vector3<f64>) -> f64 {
    let shares = dual::shares(ways, b);
    let sum =
        ways.iter().zip(shares).fold(Vector3::zeros(), |sum, (way, share)| sum + way * share.clamp(0.0, 1.0));
    (b - sum).norm()
}
