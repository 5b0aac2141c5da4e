//! What a stage made of a take, against the truth.
mod align;
mod error;
mod head_pose;
mod metric;
mod same;
mod spread;
mod table;
mod trajectories;

pub use error::ScoreError;
pub use head_pose::{Poses, head_pose};
pub use metric::{Better, Metric};
pub use table::Table;
pub use trajectories::{head_trajectories, seen_by_two, trajectories_3d};
