//! Where the data lies and how it is cut into frames.

use super::BLOCK;
use std::fmt::{self, Display};

/// How numbers are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// 16-bit integers times POINT:SCALE.
    Integer,
    /// 32-bit floats.
    Real,
}

impl Storage {
    pub(super) fn of_scale(scale: f64) -> Self {
        if scale < 0.0 { Self::Real } else { Self::Integer }
    }

    /// Bytes of a number.
    pub(super) fn size(self) -> u64 {
        match self {
            Self::Integer => 2,
            Self::Real => 4,
        }
    }
}

impl Display for Storage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Integer => "integers",
            Self::Real => "reals",
        })
    }
}

/// Where the data lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    /// First byte of the first frame.
    pub(super) start: u64,
    pub(super) storage: Storage,
    pub(super) points: u64,
    /// Analog values in a frame.
    pub(super) analog: u64,
    pub(super) frames: u64,
}

impl Layout {
    /// Bytes of a frame. What does not fit a number does not fit the file either.
    pub(super) fn stride(&self) -> u64 {
        self.points.saturating_mul(4).saturating_add(self.analog).saturating_mul(self.storage.size())
    }

    pub(super) fn end(&self) -> u64 {
        self.start.saturating_add(self.frames.saturating_mul(self.stride()))
    }

    /// Whether the frames fill the file, up to the padding of its last block.
    pub(super) fn fits(&self, bytes: &[u8]) -> bool {
        let (end, size) = (self.end(), bytes.len() as u64);
        end <= size && (size - end < BLOCK as u64 || bytes[end as usize..].iter().all(|&byte| byte == 0))
    }
}
