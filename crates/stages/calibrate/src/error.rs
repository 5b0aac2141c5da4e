//! What can go wrong.

use crate::bundle;

/// The cameras could not be calibrated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter makes no sense.
    #[error("--{name}: {what}")]
    Parameter {
        /// The option's name.
        name: &'static str,
        /// What is wrong.
        what: String,
    },
    /// Nothing was seen.
    #[error(
        "no camera saw the board\n  to do: check that the board described is the one in the pictures (corners are counted inside)"
    )]
    NothingSeen,
    /// A camera saw the board too rarely.
    #[error(
        "camera {camera}: {views} of its pictures show the board, {FEWEST_VIEWS} are needed at least\n  to do: hold the board before it more often, or leave the camera out"
    )]
    FewViews {
        /// The camera.
        camera: String,
        /// Views that could be used.
        views: usize,
    },
    /// No lens explains what a camera saw.
    #[error(
        "camera {camera}: no lens explains its views of the board\n  to do: check the board's description and look at the corners that were found"
    )]
    NoLens {
        /// The camera.
        camera: String,
    },
    /// A camera's views do not tell its lens.
    #[error(
        "camera {camera}: its {views} views do not tell its lens: the board never leaned\n  to do: film the board leaning to all sides, or ask for fewer parameters (--lens, --square-pixels, --centered)"
    )]
    Undetermined {
        /// The camera.
        camera: String,
        /// How many views it has.
        views: usize,
    },
    /// Groups of cameras that never saw the board at the same time.
    #[error(
        "the cameras fall apart: {} never saw the board at the same time\n  to do: hold the board where cameras of two groups see it at once",
        groups(.0)
    )]
    Apart(Vec<Vec<String>>),
    /// A camera is named that is not there.
    #[error("camera {0} is not among the cameras\n  to do: name one of them")]
    UnknownCamera(String),
    /// The frame that shall carry the world is not there.
    #[error(
        "frame {0} shall be the world, but no camera saw the board there\n  to do: name a frame of the corners"
    )]
    UnknownFrame(i64),
    /// No marker was seen by two cameras at once.
    #[error(
        "no marker was seen by two cameras at once, from places where its rays meet\n  to do: give tracks of markers that several cameras see at once, and cameras that are about right"
    )]
    NoTracks,
    /// Two sources say different things of a camera.
    #[error("camera {camera}: {what}")]
    Mismatch {
        /// The camera.
        camera: String,
        /// What differs.
        what: String,
    },
    /// The bundle adjustment refuses.
    #[error(transparent)]
    Bundle(#[from] bundle::Error),
}

/// Fewer views of a plane cannot tell a lens.
pub(crate) const FEWEST_VIEWS: usize = 3;

fn groups(groups: &[Vec<String>]) -> String {
    groups.iter().map(|group| group.join(", ")).collect::<Vec<_>>().join(" | ")
}
