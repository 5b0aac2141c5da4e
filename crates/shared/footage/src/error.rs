//! What can go wrong with a video file.

use std::path::{Path, PathBuf};

/// Why a video could not be read or written. Each message names the file and says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file is not there, or may not be read or written.
    #[error("{}: cannot be {action}: {cause}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was tried: `read`, `written`.
        action: &'static str,
        /// What the system says.
        cause: std::io::Error,
    },
    /// The file is no video, or one that cannot be decoded here.
    #[error("{}: cannot be opened as a video: it is none, its end is missing, or its codec is unknown here\n  to do: check that this is the right file; convert it to H.264 (.mp4) or FFV1 (.avi)", .path.display())]
    NotVideo {
        /// The file.
        path: PathBuf,
    },
    /// The file holds fewer frames than it says.
    #[error("{}: ends early: frame {frame} of {claimed} is missing or damaged\n  to do: copy the file again, or go on with the {frame} frames before it", .path.display())]
    EndsEarly {
        /// The file.
        path: PathBuf,
        /// The first frame that is not there, from 0; also the number of good ones.
        frame: u64,
        /// How many frames the file says it has.
        claimed: u64,
    },
    /// A frame has another size than the first.
    #[error("{}: frame {frame} is {}×{} pixels, the frames before it are {}×{}", .path.display(), .size[0], .size[1], .expected[0], .expected[1])]
    SizeChanges {
        /// The file.
        path: PathBuf,
        /// The frame, from 0.
        frame: u64,
        /// Its width and height.
        size: [u32; 2],
        /// Width and height of the first.
        expected: [u32; 2],
    },
    /// The file's name has the wrong ending for the codec.
    #[error("{}: {codec} goes into a file that ends in {}", .path.display(), endings(*.codec))]
    Ending {
        /// The file.
        path: PathBuf,
        /// What was to be written.
        codec: crate::Codec,
    },
    /// The image size cannot be written.
    #[error("{}: images of {}×{} pixels cannot be written: OpenCV's writer takes even widths and heights only (and would cut the last column or row in silence)\n  to do: write PNG pictures, or pad to an even size", .path.display(), .size[0], .size[1])]
    Size {
        /// The file.
        path: PathBuf,
        /// Width and height.
        size: [u32; 2],
    },
    /// Not a rate.
    #[error("{}: {} frames in {} seconds is no rate", .path.display(), .rate.0, .rate.1)]
    Rate {
        /// The file.
        path: PathBuf,
        /// Frames, in so many seconds.
        rate: (u32, u32),
    },
    /// The encoder is missing or refuses the size or rate.
    #[error("{}: OpenCV cannot write {codec} here\n  to do: install FFmpeg's encoder for it, or choose another codec", .path.display())]
    NoEncoder {
        /// The file.
        path: PathBuf,
        /// What was to be written.
        codec: crate::Codec,
    },
    /// Not all was written, most likely for want of space.
    #[error("{}: {found} of {written} frames arrived in the file\n  to do: make room on the disk", .path.display())]
    Incomplete {
        /// The file.
        path: PathBuf,
        /// Frames that the file claims.
        found: u64,
        /// Frames that were written to it.
        written: u64,
    },
    /// OpenCV failed.
    #[error("{}: {cause}", .path.display())]
    OpenCv {
        /// The file.
        path: PathBuf,
        /// What OpenCV says.
        cause: opencv::Error,
    },
}

impl Error {
    /// The same about another name of the file: the one that the user knows, where the video was written to a temporary one.
    #[must_use]
    pub fn in_file(mut self, name: &Path) -> Self {
        let (Self::Io { path, .. }
        | Self::NotVideo { path }
        | Self::EndsEarly { path, .. }
        | Self::SizeChanges { path, .. }
        | Self::Ending { path, .. }
        | Self::Size { path, .. }
        | Self::Rate { path, .. }
        | Self::NoEncoder { path, .. }
        | Self::Incomplete { path, .. }
        | Self::OpenCv { path, .. }) = &mut self;
        *path = name.to_path_buf();
        self
    }

    pub(crate) fn io(path: &Path, action: &'static str) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_path_buf();
        move |cause| Self::Io { path, action, cause }
    }

    pub(crate) fn opencv(path: &Path) -> impl Fn(opencv::Error) -> Self {
        let path = path.to_path_buf();
        move |cause| Self::OpenCv { path: path.clone(), cause }
    }
}

fn endings(codec: crate::Codec) -> String {
    codec.endings().iter().map(|ending| format!(".{ending}")).collect::<Vec<_>>().join(" or ")
}
