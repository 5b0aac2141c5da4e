//! How frames are packed.

/// How frames are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Codec {
    /// FFV1: lossless, RGB as it is.
    Ffv1,
    /// H.264 by x264 at CRF 23: lossy, 4:2:0.
    H264,
    /// Motion JPEG: lossy, 4:2:0, every frame by itself.
    Mjpg,
}

impl Codec {
    /// Four letters that name the codec in a file.
    pub(crate) fn letters(self) -> [char; 4] {
        match self {
            Self::Ffv1 => ['F', 'F', 'V', '1'],
            Self::H264 => ['a', 'v', 'c', '1'],
            Self::Mjpg => ['M', 'J', 'P', 'G'],
        }
    }

    /// The endings that a file of this codec may have, the usual one first: they choose the container.
    #[must_use]
    pub fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Ffv1 | Self::Mjpg => &["avi", "mkv"],
            Self::H264 => &["mp4", "mkv"],
        }
    }
}

impl std::fmt::Display for Codec {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Ffv1 => "FFV1",
            Self::H264 => "H.264",
            Self::Mjpg => "MJPG",
        })
    }
}
