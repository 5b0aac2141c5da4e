//! Changes measured wrinkles by a list of edits that can be replayed [BickelBotsch2007, Sec. 6.2]: deeper or wider, gone, renamed, taken
//! over from another frame, drawn by hand.
//!
//! [`Edits`] is the list, [`Editor`] replays it on [`Moment`]s, the frames of `sections` and `wrinkles-2d` together. [`Show`] draws
//! curves and profiles over an image.
//!
//! ```
//! use artifact::{Profile, Wrinkle};
//! use wrinkle_edit::{Editor, Edits, Head, Moment, Params};
//! let brow = Wrinkle { id: "brow".into(), paint: None };
//! let head = Head { cameras: vec!["w1".into()], wrinkles: vec![brow], profile: Profile::Rounded };
//! let list = "wrinkle-edits/1\n\
//!     draw frown in w1 at 1001 through 10,20 40,25 70,20 width 6 depth 0,2.5,0 # tapers off\n\
//!     scale depth 2 of f*";
//! let edits = Edits::parse(list, &head)?;
//! let here = |camera: &str| [(camera.to_string(), Default::default())].into();
//! let mut moment = Moment { frame: 1001, sections: Some(here("w1")), curves: None };
//! let mut editor = Editor::new(&edits, &Params::default())?;
//! editor.apply(std::slice::from_mut(&mut moment))?;
//! let sections = &moment.sections.unwrap_or_default()["w1"]["frown"];
//! assert!((sections[sections.len() / 2].d_px - 5.0).abs() < 0.2 && sections[0].d_px == 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod carry;
mod change;
mod draw;
mod edit;
mod error;
mod list;
mod moment;
mod names;
mod params;
mod read;
mod read_drawn;
mod scope;
mod show;
mod spline;
mod words;

pub use error::Error;
pub use list::{Editor, Edits, VERSION};
pub use moment::{Head, Moment};
pub use params::Params;
pub use show::{Show, Window};
