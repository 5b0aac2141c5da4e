//! A whole take, from a scenario.
//!
//! A [`Studio`] holds what stays the same; a [`Pose`] is the face at one moment, a [`Set`] what stands before the cameras
//! while their shutters are open. Nothing here touches the disk.

mod hands;
mod headband;
mod paint_plan;
mod pose;
mod rig;
mod schedule;
mod shapes;
mod shot;
mod spaces;
mod station;
mod studio;
mod truth;

pub use hands::Hands;
pub use paint_plan::PaintPlan;
pub use pose::Pose;
pub use rig::{Placement, Role, paper_rig};
pub use schedule::{Shot, shots_by_frame};
pub use shot::Set;
pub use spaces::Spaces;
pub use station::Station;
pub use studio::{Given, Studio};
pub use truth::ImageTruth;
