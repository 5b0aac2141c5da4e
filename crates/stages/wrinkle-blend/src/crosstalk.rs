//! Which poses show each other's wrinkles.

use crate::{Blender, Pose};

/// At reference pose m, how much of pose k's wrinkles shows, as a share of what shows at k itself: `[m][k]`, summed over
/// vertices. 1 on the diagonal; what stands beside it is wrong, unless two poses share wrinkles on purpose.
#[must_use]
pub fn crosstalk(blender: &Blender, poses: &[Pose]) -> Vec<Vec<f64>> {
    let mut weights = Vec::new();
    let mut shown = |pose: &Pose| -> Vec<f64> {
        blender.vertex_weights(&blender.shares(pose), &mut weights);
        let rows = weights.chunks_exact(blender.vertex_count().max(1));
        rows.map(|row| row.iter().map(|weight| f64::from(*weight)).sum()).collect()
    };
    let sums: Vec<Vec<f64>> = poses.iter().map(&mut shown).collect();
    let share = |m: usize, k: usize| if sums[k][k] > 0.0 { sums[m][k] / sums[k][k] } else { 0.0 };
    (0..sums.len()).map(|m| (0..sums.len()).map(|k| share(m, k)).collect()).collect()
}

/// Per reference pose the least of its own shares over the bones that are of it: 1 where the pose is recognised.
#[must_use]
pub fn recovery(blender: &Blender, poses: &[Pose]) -> Vec<f64> {
    let own = |(k, pose): (usize, &Pose)| {
        let shares = blender.shares(pose);
        let of_pose = (0..blender.bones().len()).filter(|&bone| blender.way(k, bone).is_some());
        of_pose.map(|bone| shares.0[k][bone]).fold(1.0, f64::min)
    };
    poses.iter().enumerate().map(own).collect()
}
