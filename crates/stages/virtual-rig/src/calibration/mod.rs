//! Boards and wands to calibrate cameras with.
//!
//! A [`Board`] is a flat pattern with corners of known places; [`board_poses`] waves it before the cameras, [`BoardCamera`]
//! renders it, [`corners_in_image`] says where its corners truly are. [`wand_path`] waves a bright point through the
//! volume that all cameras see, [`render_led`] renders it. Pictures are linear radiance; the sensor comes after.
//!
//! *Board* space: origin at the pattern's top-left corner (the margin lies outside), x to the right, y down, z into the
//! board, mm.

mod board;
mod dictionary;
mod led;
mod params;
mod picture;
mod poses;
mod render;
mod volume;
mod wand;

pub use board::{Board, Corner, Dictionary, Quad};
pub use led::render_led;
pub use params::{BoardViews, Params, Wand};
pub use picture::Picture;
pub use poses::{CornerInImage, board_poses, corners_in_image, is_seen_whole};
pub use render::{BoardCamera, BoardLight};
pub use volume::{Volume, common_volume};
pub use wand::wand_path;
