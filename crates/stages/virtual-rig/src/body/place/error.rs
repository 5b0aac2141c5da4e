//! What can be wrong with landmarks.

use super::LEAST;
use artifact::Unit;
use camera::AlignError;

/// Why a scan cannot be laid onto the average face.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlaceError {
    /// A name that no landmark has.
    #[error("landmark {name} is not known; the closest name is {closest}")]
    Unknown {
        /// The name.
        name: String,
        /// A name that exists.
        closest: &'static str,
    },
    /// A vertex that the scan does not have.
    #[error("landmark {name}: vertex {vertex}; the scan has {count} (counted from 0)")]
    NoVertex {
        /// The landmark.
        name: String,
        /// What was picked.
        vertex: u32,
        /// Vertices of the scan.
        count: usize,
    },
    /// Too few to say where the face is.
    #[error("{count} landmarks; at least {LEAST} are needed, spread over the face")]
    TooFew {
        /// Landmarks given.
        count: usize,
    },
    /// No head has this size.
    #[error("the scan is {size_mm:.4} mm large when read in {unit}; a head has 100 to 500 mm{}", match .likely {
        Some(likely) => format!(": is its unit {likely}?"),
        None => String::new(),
    })]
    Size {
        /// Longest side of the box around it.
        size_mm: f64,
        /// The unit that it was read in.
        unit: Unit,
        /// The unit in which it would be a head.
        likely: Option<Unit>,
    },
    /// The landmarks span no face.
    #[error("the landmarks span {scale:.2} times an average face: were they picked in the unit of the scan?")]
    Scale {
        /// Size relative to the average face.
        scale: f64,
    },
    /// A picked point far from the scan.
    #[error(
        "landmark {name} lies {distance_mm:.1} mm off the scan: was it picked on another one, or in another unit?"
    )]
    OffScan {
        /// The landmark.
        name: String,
        /// Distance to the closest vertex.
        distance_mm: f64,
    },
    /// The subject's left and right are mixed up.
    #[error("left and right are exchanged: _l is the subject's left, at +x")]
    Mirrored,
    /// A landmark where none can be.
    #[error(
        "landmark {name} lies {distance_mm:.0} mm from where the others expect it: was another point picked?"
    )]
    Astray {
        /// The landmark.
        name: String,
        /// How far.
        distance_mm: f64,
    },
    /// All in one line.
    #[error("the landmarks do not span a face: {0}")]
    Align(#[from] AlignError),
}
