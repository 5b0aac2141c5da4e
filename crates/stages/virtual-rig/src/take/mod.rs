//! A whole take, from a scenario.

mod hands;
mod paint_plan;
mod rig;
mod spaces;

pub use hands::Hands;
pub use paint_plan::PaintPlan;
pub use rig::{Placement, Role, paper_rig};
pub use spaces::Spaces;
