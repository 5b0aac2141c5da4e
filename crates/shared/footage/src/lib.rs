//! Video files in and out: the only room that links OpenCV's video I/O.
//!
//! [`VideoWriter`] and [`VideoReader`] go through OpenCV's FFmpeg back-end and no other, so that a file reads alike
//! everywhere. Pixels are 8-bit RGB, row after row from the top. What comes back of what was written:
//!
//! | codec | container | pixels | same bytes each time |
//! |---|---|---|---|
//! | [`Codec::Ffv1`] | `.avi` | bit-exact (stored as BGR, all of it) | yes |
//! | [`Codec::Ffv1`] | `.mkv` | bit-exact | no: Matroska files carry a random id; times are rounded to 1 ms |
//! | [`Codec::H264`] | `.mp4`, `.mkv` | lossy, CRF 23, chroma at half resolution both ways (4:2:0) | no: small pictures may differ |
//! | [`Codec::Mjpg`] | `.avi`, `.mkv` | lossy, about 3 bits a pixel, 4:2:0 | `.avi` yes |
//!
//! OpenCV 4.6 lets nobody choose the quality of H.264 and MJPG, and its writer takes even image sizes only. Where a file
//! is broken FFmpeg says so on standard error, beside our own error; `OPENCV_FFMPEG_LOGLEVEL=-8` in the environment
//! silences it.
//!
//! Frames are counted as they decode, never by seeking, and [`Error::EndsEarly`] says where a file is cut, or gives fewer than
//! its list of frames promises; see [`VideoReader::counts_frames`] for containers without such a list.
//!
//! Pixels deeper than 8 bits: OpenCV's FFmpeg back-end converts all that it decodes to 8 bits a channel, so that nothing
//! deeper can be had here; [`Frame`] is the place where it would come out.
//!
//! ```
//! use footage::{Codec, VideoReader, VideoWriter};
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("clip.avi");
//! let picture: Vec<u8> = (0..16 * 12 * 3).map(|i| (i % 251) as u8).collect();
//! let mut writer = VideoWriter::create(&path, Codec::Ffv1, [16, 12], (25, 2))?;
//! writer.write(&picture)?;
//! writer.finish()?;
//!
//! let reader = VideoReader::open(&path)?;
//! assert_eq!((reader.image_size(), reader.rate(), reader.claimed_frames()), ([16, 12], (25, 2), Some(1)));
//! for frame in reader {
//!     assert_eq!(frame?.rgb, picture);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod codec;
mod error;
mod quiet;
mod rate;
mod reader;
mod swap;
mod whole;
mod writer;

pub use codec::Codec;
pub use error::Error;
pub use reader::{Frame, Passed, VideoReader};
pub use writer::VideoWriter;
