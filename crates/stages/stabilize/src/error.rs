//! Why a take cannot be stabilised.

use crate::words::{counted, extent};
use std::path::Path;

/// Why a take cannot be stabilised.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A marker id, or a pattern with `*` or `?`, that no marker of the take has.
    #[error("the take has no marker '{wanted}'")]
    UnknownMarker {
        /// What was asked for.
        wanted: String,
        /// Ids of the take that look like it, best first.
        close: Vec<String>,
    },
    /// Fewer than three head markers.
    #[error("{} ({}); three that are no line are needed", counted(.0.len(), "head marker"), .0.join(", "))]
    TooFewHeadMarkers(Vec<String>),
    /// The head markers are all that there is.
    #[error("the head markers ({}) are all {count} markers of the take, so none is left to write", .wanted.join(", "))]
    NothingLeft {
        /// The ids and patterns that named them.
        wanted: Vec<String>,
        /// Markers of the take.
        count: usize,
    },
    /// No names given, and too few markers to look for a rigid group.
    #[error(
        "has {} seen in half of the frames; three are needed to find the head among them",
        counted(*.0, "marker")
    )]
    TooFewMarkers(usize),
    /// The head markers lie on a line.
    #[error("the head markers {} lie on a line, so the head's rotation about it is unknown", .0.join(", "))]
    Collinear(Vec<String>),
    /// Three head markers that are no line are not seen together in any frame.
    #[error("no frame shows three head markers that are no line and keep their distances (of {})", .0.join(", "))]
    NeverSeen(Vec<String>),
    /// The reference frame is not in the take.
    #[error("the take has no such frame; it {}", extent(*first, *last))]
    NoReferenceFrame {
        /// The frame asked for.
        frame: i64,
        /// The take's first frame.
        first: i64,
        /// The take's last frame.
        last: i64,
    },
    /// The head's pose is unknown at the reference frame.
    #[error("the head's pose is unknown at this reference frame: {seen} of {of} head markers are seen")]
    ReferenceUnseen {
        /// The frame asked for.
        frame: i64,
        /// Head markers seen there.
        seen: usize,
        /// Head markers.
        of: usize,
    },
    /// The take holds no frames.
    #[error("holds no frames")]
    NoFrames,
    /// A length of time was asked for, but the frame rate is unknown.
    #[error("states no frame rate, so milliseconds cannot be counted in frames")]
    NoRate,
    /// A parameter outside its range.
    #[error("{name} is {value}; {allowed}")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
}

impl Error {
    /// The same, said of a file: which one, where in it, what to do.
    #[must_use]
    pub fn in_file(&self, path: &Path) -> artifact::Error {
        let error = artifact::Error::new(path, self.to_string());
        let error = match self.place() {
            Some(place) => error.at(place),
            None => error,
        };
        match self.fix() {
            Some(fix) => error.fix(fix),
            None => error,
        }
    }

    fn place(&self) -> Option<String> {
        match self {
            Self::UnknownMarker { wanted, .. } => Some(format!("marker {wanted}")),
            Self::NoReferenceFrame { frame, .. } | Self::ReferenceUnseen { frame, .. } => {
                Some(format!("frame {frame}"))
            }
            _ => None,
        }
    }

    fn fix(&self) -> Option<String> {
        Some(match self {
            Self::UnknownMarker { close, .. } if close.is_empty() => {
                "name markers of the take, or use a pattern such as 'root-*'".into()
            }
            Self::UnknownMarker { close, .. } => format!("did you mean {}?", close.join(" or ")),
            Self::TooFewHeadMarkers(_) | Self::Collinear(_) => {
                "name more head markers, spread over the head, or none: then the least deforming ones are used"
                    .into()
            }
            Self::NothingLeft { .. } => "name only markers on rigid parts, or say --keep-head-markers".into(),
            Self::TooFewMarkers(_) => "a take of the whole face is needed".into(),
            Self::NeverSeen(_) => "check the names of the head markers and the take's labels".into(),
            Self::NoReferenceFrame { .. } => "give a frame of the take, or --reference-frame auto".into(),
            Self::ReferenceUnseen { .. } => {
                "give a frame that shows the head markers, or --reference-frame auto".into()
            }
            Self::NoFrames => "the program that wrote it may have been cut off".into(),
            Self::NoRate => {
                "give the take manifest with --take, or --smooth-ms 0 --fill-ms 0 and --jump-mm in mm".into()
            }
            Self::Parameter { .. } => return None,
        })
    }
}
