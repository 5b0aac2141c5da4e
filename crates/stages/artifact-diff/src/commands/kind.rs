//! What a file is, by its ending and, for JSON Lines, by its schema.

use anyhow::bail;
use artifact::{FrameReader, Handles, HeadTrajectories, Trajectories3d};
use std::path::Path;

/// What can be compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Mesh,
    Sequence,
    /// Markers in mocap space, or in a format that does not say.
    Markers,
    HeadMarkers,
    Handles,
    Image,
}

impl Kind {
    pub(crate) fn of(path: &Path) -> anyhow::Result<Self> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref().unwrap_or("") {
            "obj" | "ply" => Ok(Self::Mesh),
            "pc2" | "json" => Ok(Self::Sequence),
            "c3d" | "trc" | "csv" => Ok(Self::Markers),
            "png" => Ok(Self::Image),
            "jsonl" => Self::of_stream(path),
            _ => bail!(
                "{}: has an ending that is not known here\n  to do: give .obj, .ply, .json, .pc2, .jsonl, .c3d, .trc, .csv or .png",
                path.display()
            ),
        }
    }

    fn of_stream(path: &Path) -> anyhow::Result<Self> {
        // The first reader's error is the one that is shown: all three say what the file is instead.
        let markers = FrameReader::<Trajectories3d>::open(path).map(|_| Self::Markers);
        let kind = markers
            .or_else(|error| {
                FrameReader::<HeadTrajectories>::open(path).map(|_| Self::HeadMarkers).map_err(|_| error)
            })
            .or_else(|error| FrameReader::<Handles>::open(path).map(|_| Self::Handles).map_err(|_| error));
        Ok(kind?)
    }

    pub(crate) fn noun(self) -> &'static str {
        match self {
            Self::Mesh => "a mesh",
            Self::Sequence => "a mesh sequence",
            Self::Markers => "markers",
            Self::HeadMarkers => "markers in head space",
            Self::Handles => "handles",
            Self::Image => "an image",
        }
    }

    pub(crate) fn is_markers(self) -> bool {
        matches!(self, Self::Markers | Self::HeadMarkers)
    }
}
