//! Units, rates, frame ranges, and references to other files.

use crate::Violation;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A unit of length. Inside Furrow all lengths are millimetres; files say theirs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Unit {
    /// millimetre
    Mm,
    /// centimetre
    Cm,
    /// metre
    M,
}

impl Unit {
    /// Millimetres in one of this unit.
    #[must_use]
    pub fn in_mm(self) -> f64 {
        match self {
            Self::Mm => 1.0,
            Self::Cm => 10.0,
            Self::M => 1000.0,
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Mm => "mm",
            Self::Cm => "cm",
            Self::M => "m",
        })
    }
}

impl FromStr for Unit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim().to_ascii_lowercase().as_str() {
            "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => Ok(Self::Mm),
            "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => Ok(Self::Cm),
            "m" | "meter" | "meters" | "metre" | "metres" => Ok(Self::M),
            other => Err(format!("'{other}' is not a unit of length; say mm, cm or m")),
        }
    }
}

/// Frames per second as a fraction, since 30000/1001 exists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rate {
    /// Frames …
    pub frames: u32,
    /// … in so many seconds.
    pub seconds: u32,
}

impl Rate {
    /// A whole number of frames a second.
    #[must_use]
    pub fn per_second(frames: u32) -> Self {
        Self { frames, seconds: 1 }
    }

    /// Frames per second.
    #[must_use]
    pub fn hz(self) -> f64 {
        f64::from(self.frames) / f64::from(self.seconds)
    }

    /// Refuses a rate that is not positive, naming the place.
    ///
    /// # Errors
    /// A [`Violation`] at `place`.
    pub fn check(self, place: &str) -> Result<(), Violation> {
        match self.frames > 0 && self.seconds > 0 {
            true => Ok(()),
            false => {
                let what = format!("{} frames in {} seconds is no rate", self.frames, self.seconds);
                Err(Violation::new(place, what))
            }
        }
    }

    /// The fraction closest to a rate that a file gives as a decimal number: whole, or over 1001, or over 1000.
    #[must_use]
    pub fn from_hz(hz: f64) -> Option<Self> {
        if !(hz.is_finite() && hz > 0.0 && hz < 1e6) {
            return None;
        }
        let over = |seconds: u32| Self { frames: (hz * f64::from(seconds)).round() as u32, seconds };
        let fits = |rate: &Self| rate.frames > 0 && (rate.hz() - hz).abs() <= 1e-5 * hz;
        [1, 1001, 1000].into_iter().map(over).find(fits)
    }
}

impl fmt::Display for Rate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.seconds {
            1 => write!(f, "{} Hz", self.frames),
            seconds => write!(f, "{}/{seconds} Hz", self.frames),
        }
    }
}

/// Frames A to B, both included, as `--frames A-B` says; `A-`, `-B` and `A` are short forms. Frame numbers are
/// absolute and may start anywhere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameRange {
    /// First frame.
    pub first: i64,
    /// Last frame.
    pub last: i64,
}

impl FrameRange {
    /// Every frame.
    pub const ALL: Self = Self { first: i64::MIN, last: i64::MAX };

    /// Whether a frame is in the range.
    #[must_use]
    pub fn contains(&self, frame: i64) -> bool {
        (self.first..=self.last).contains(&frame)
    }
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |part: &str, open: i64| match part.trim() {
            "" => Ok(open),
            part => part
                .parse::<i64>()
                .map_err(|_| format!("'{text}' is not a range of frames; say e.g. 1001-1100")),
        };
        let (first, last) = match text.split_once('-') {
            Some((first, last)) => (number(first, i64::MIN)?, number(last, i64::MAX)?),
            None => (number(text, 0)?, number(text, 0)?),
        };
        if text.trim().is_empty() || first > last {
            return Err(format!("'{text}' is an empty range of frames; say e.g. 1001-1100"));
        }
        Ok(Self { first, last })
    }
}

impl fmt::Display for FrameRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::ALL => f.write_str("all"),
            Self { first: i64::MIN, last } => write!(f, "-{last}"),
            Self { first, last: i64::MAX } => write!(f, "{first}-"),
            Self { first, last } if first == last => write!(f, "{first}"),
            Self { first, last } => write!(f, "{first}-{last}"),
        }
    }
}

/// Another file, by name and hash. The hash decides; the name is for people.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FileRef {
    /// File name without folders.
    pub name: String,
    /// SHA-256 of its bytes, as `sha256sum` prints it.
    pub sha256: String,
}

impl fmt::Display for FileRef {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (sha256 {}…)", self.name, &self.sha256.get(..12).unwrap_or(&self.sha256))
    }
}

/// A mesh that an artifact was made for: its file, the unit that its coordinates were read in, its vertex count.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshRef {
    /// The mesh file.
    pub file: FileRef,
    /// Unit of the file's coordinates.
    pub unit: Unit,
    /// Number of vertices.
    pub vertex_count: usize,
}

impl MeshRef {
    /// Why `other` is not the mesh that this refers to, if it is not.
    #[must_use]
    pub fn mismatch(&self, other: &Self) -> Option<String> {
        if self.file.sha256 != other.file.sha256 {
            return Some(format!("was made for mesh {}, not for {}", self.file, other.file));
        }
        (self.unit != other.unit)
            .then(|| format!("was made with {} in {}, not in {}", self.file.name, self.unit, other.unit))
    }
}
