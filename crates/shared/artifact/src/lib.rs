//! Every kind of file that Furrow's stages read and write; one room per kind.
//!
//! Stages meet only in artifacts, so this crate is the house's contract with its users: what it writes, later
//! versions read. It knows no algorithms.
//!
//! - *Envelope* ([`read_document`], [`FrameReader`], …): JSON for static kinds, JSON Lines for kinds with frames;
//!   the schema (`kind/version`) comes first and is checked first.
//! - *Outputs* are [`Staged`]: written under a temporary name, shown by [`Staged::publish`].
//! - *Errors* name the file, the place in it, what is wrong and what to do.
//! - Lengths are millimetres in every kind of ours; formats of others ([`obj`], [`ply`], [`pc2`], [`c3d`], [`trc`],
//!   [`usda`], [`gltf`], cameras as [`opencv`], [`anipose`], [`colmap`], …) are converted where
//!   they are read and written.
//!
//! ```no_run
//! # fn main() -> artifact::Result<()> {
//! use artifact::{FrameReader, Handles, Unit};
//! let scan = artifact::obj::read("scan.obj".as_ref(), Unit::Cm)?;
//! let handles = FrameReader::<Handles>::open("handles.jsonl".as_ref())?;
//! println!("{} vertices, {} handles", scan.positions.len(), handles.header().handles.len());
//! # Ok(())
//! # }
//! ```

mod distinct;
mod envelope;
mod error;
mod finite;
mod icc;
mod ids;
mod image8;
mod image_pattern;
mod quantity;
mod source;
mod staged;
mod subsampling;

mod baked_maps;
mod blend_weights;
mod camera_file;
mod cameras;
#[cfg(feature = "canvas")]
pub mod canvas;
mod correspondence;
#[cfg(feature = "exr")]
mod exr_file;
mod frames;
mod handles;
mod head_pose;
mod labels;
mod landmark_file;
mod landmarks;
mod large_scale;
mod marker_file;
mod markers;
mod mesh_file;
mod mesh_sequence;
mod paint_model;
mod photograph;
mod poses;
mod profile;
mod response_basis;
mod sections;
mod sync;
mod take;
mod timecode;
mod tracks_2d;
mod trajectories;
mod transfer;
mod valleys;
mod vertices;
mod warp;
mod wrinkled;
mod wrinkles_2d;

pub mod c3d;
pub mod gltf;
pub mod marker_csv;
pub mod npy;
pub mod obj;
pub mod pc2;
pub mod picks;
pub mod picture;
pub mod ply;
pub mod provenance;
pub mod timestamps;
pub mod trc;
pub mod usda;

pub use baked_maps::{BakedMaps, BakedTile, GreenAxis};
pub use blend_weights::{BlendWeights, BlendWeightsFrame, BlendWeightsHeader};
pub use camera_file::{CameraFormat, Stated, anipose, colmap, opencv, read_cameras, write_cameras};
pub use cameras::{CameraDeviation, CameraRig, RigCamera};
pub use correspondence::{Correspondence, Pair};
pub use envelope::{
    Document, FrameReader, FrameWriter, Kind, Stream, document_schema, read_document, stream_schema,
    write_document,
};
pub use error::{Error, Result, Violation};
#[cfg(feature = "exr")]
pub use exr_file::write_exr;
pub use finite::finite;
pub use frames::{CameraFrames, FrameRun, Frames};
pub use handles::{Handle, HandleFrame, Handles, HandlesHeader};
pub use head_pose::{HeadPose, HeadPoseFrame, HeadPoseHeader};
pub use ids::{PerCamera, matches};
pub use image_pattern::{files, image_numbers, image_path, subfolders};
pub use labels::Labels;
pub use landmark_file::{LandmarkFile, read_landmarks};
pub use landmarks::{Landmark, Landmarks};
pub use large_scale::{LargeScale, SequenceForm};
pub use marker_file::{check_marker_unit, read_trajectories, write_trajectories};
pub use markers::Extent;
pub use mesh_file::{read_mesh, write_mesh};
pub use mesh_sequence::{MeshCursor, MeshSequence};
pub use paint_model::{LearntPaint, PaintModel, SupportPixel};
pub use photograph::{Photograph, read_photograph};
pub use poses::{BonePlacement, Poses, ReferencePose};
pub use profile::{Profile, ProfileShape};
pub use quantity::{FileRef, FrameRange, MeshRef, Rate, Unit};
pub use response_basis::ResponseBasis;
pub use sections::{Section, SectionDeviation, SectionState, Sections, SectionsFrame, SectionsHeader};
pub use source::{file_name, read_bytes, read_text, sha256, sha256_of};
pub use staged::{
    Sink, Staged, discard_unfinished, is_standard_stream, remove_frames, require_new_folder, stage_bytes,
    stage_link, withdraw,
};
pub use sync::{Shown, SyncCamera, SyncFrame, SyncHeader, SyncSource, TimeBase};
pub use take::{Axis, Clock, Consent, Footage, Take, TakeCamera, TakeRef};
pub use timecode::Timecode;
pub use tracks_2d::{Sample2d, TrackState, Tracks2d, Tracks2dFrame, Tracks2dHeader};
pub use trajectories::{
    Accuracy, HeadTrajectories, MarkerFrame, MarkerHeader, MeasuredFrame, MeasuredTrajectories, SampleStatus,
    Trajectories, Trajectories3d,
};
pub use transfer::{Transfer, UnknownTransfer};
pub use valleys::{Space, ValleyPoint, Valleys, ValleysFrame, ValleysHeader};
pub use vertices::{VertexMapping, VertexPath, VertexSet};
pub use warp::{Interpolant, Warp, WarpFit};
pub use wrinkled::Wrinkled;
pub use wrinkles_2d::{
    Curve2d, CurveState, PaintWidth, Wrinkle, Wrinkles2d, Wrinkles2dFrame, Wrinkles2dHeader,
};
