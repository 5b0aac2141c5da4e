//! What a person does for a take, in a browser: names dots, picks points, marks paint, draws wrinkles.
//!
//! Purpose: both papers need a hand at six places. Each place is a page, which needs what stages made and writes what stages read.
//! This library knows what pages there are ([`pages`]), which files they edit ([`Document`]), who may write at the moment
//! ([`Claim`]), and what helps to see: where a dot may lie in another camera ([`epipolar`]), a mesh as a graphics card takes it
//! ([`buffers`]). The binary serves it, reads and writes.
//!
//! ```
//! use workbench::Document;
//! let mask = Document::of("paint/w1").ok_or("no such document")?;
//! assert_eq!(mask.path(), "paint-mask/w1.png");
//! assert_eq!(Document::of("paint/../labels"), None);
//! # Ok::<(), &'static str>(())
//! ```

pub mod buffers;
mod claim;
mod document;
pub mod epipolar;
mod error;
mod page;

pub use claim::{Claim, Standing};
pub use document::{Document, Form};
pub use error::Error;
pub use page::{CAMERAS, HEAD, IMAGES, Need, Page, Place, SCAN, pages};
