//! What a stage made of a take, against the truth.
//!
//! One file and one pure function per kind of artifact; each takes truth and result as they are in memory and returns
//! [`Metric`]s. Definitions, once for all kinds:
//!
//! - Frames are paired by number, things by id. What the result lacks is counted, what the truth lacks is counted or refused: nothing
//!   is passed over in silence. A result of another take (by hash), with unknown ids, of another mesh, unit or rate is refused
//!   by name ([`ScoreError`]).
//! - Root mean squares in pixels are radial: √(dx² + dy²) per sample. Percentiles are linear between neighbours in order.
//! - A metric that cannot be measured has no value, but a reason; it reaches no target.
//! - Truth fed back as a result scores exactly 0, shares of what was found exactly 1.
//!
//! ```
//! use virtual_rig::score::{Metric, Table};
//! let metrics = vec![Metric::error("rms_mm", "mm", Ok(0.04)), Metric::share("coverage", Err("no marker is visible".into()))];
//! let table = Table::new("triangulate", metrics).target("rms_mm", 0.07).target("coverage", 0.99);
//! assert!(!table.passes());
//! assert_eq!(table.to_json()[0]["metric"], "triangulate/rms_mm");
//! ```

mod align;
mod bulge;
mod cameras;
mod error;
mod grid;
mod head_pose;
mod high_pass;
mod masks;
mod metric;
mod normals;
mod polyline;
mod region;
mod same;
mod sections;
mod spread;
mod surface;
mod sync;
mod table;
mod tracks_2d;
mod trajectories;
mod valleys;
mod wrinkled;
mod wrinkles_2d;

pub use cameras::cameras;
pub use error::ScoreError;
pub use head_pose::{Poses, head_pose};
pub use masks::{MaskPair, masks};
pub use metric::{Better, Metric};
pub use normals::{NormalField, normal_fields, normals, surface_normals};
pub use sections::{MIN_WIDTH_PX, RATIOS, SHALLOW, sections};
pub use surface::large_scale;
pub use sync::{TimeBase, sync};
pub use table::Table;
pub use tracks_2d::{GATE_PX, Tracks, tracks_2d};
pub use trajectories::{head_trajectories, seen_by_two, trajectories_3d};
pub use valleys::{ValleyCurves, valleys};
pub use wrinkled::{CUTOFF_MM, OUTSIDE_WIDTHS, REGION_WIDTHS, WrinkledFrame, WrinkledScene, wrinkled};
pub use wrinkles_2d::{CREASE_RATIO, Curves, ID_GATE_PX, TrueSections, wrinkles_2d};
