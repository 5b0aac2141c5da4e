//! What a user should know about a warp that was fitted all the same.

use std::fmt;

/// Something doubtful about a fit.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// Picked markers that could not be used, by id, with the reason.
    LeftOut {
        /// Marker id.
        marker: String,
        /// Why.
        reason: String,
    },
    /// A marker that is missing at rest was taken from its neighbours in time.
    FilledAtRest {
        /// Marker id.
        marker: String,
        /// The rest frame.
        frame: i64,
    },
    /// The markers do not determine the whole polynomial.
    TermsDropped {
        /// Terms that are determined …
        rank: usize,
        /// … of so many.
        terms: usize,
        /// Of c, or of the map the other way round.
        of: &'static str,
    },
    /// Markers and scan differ in size by what looks like a unit.
    Units {
        /// Scale from mocap to face.
        scale: f64,
    },
    /// A reflection of the markers fits the scan much better.
    Mirrored {
        /// Root mean square residual of the best similarity, mm.
        rms_mm: f64,
        /// … with the markers reflected, mm.
        mirrored_mm: f64,
    },
    /// Markers and scan differ by wrong pairs, or an expression far from rest.
    Unlike {
        /// Root mean square residual of the best similarity, mm.
        rms_mm: f64,
        /// Root mean square distance of the vertices from their centroid, mm.
        spread_mm: f64,
    },
    /// One marker is far from where the others expect it.
    Suspicious {
        /// Marker id.
        marker: String,
        /// Leave-one-out error, mm.
        error_mm: f64,
        /// Median over all markers, mm.
        median_mm: f64,
    },
    /// Space is folded over near the face.
    Folded {
        /// Smallest determinant.
        determinant: f64,
        /// The vertex where it is, or a marker.
        place: String,
    },
    /// Vertices near the markers that c does not reach.
    Unreached {
        /// How many.
        count: usize,
        /// One of them.
        vertex: usize,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LeftOut { marker, reason } => write!(f, "marker {marker} is left out: {reason}"),
            Self::FilledAtRest { marker, frame } => {
                write!(f, "marker {marker} is missing in the rest frame {frame}; taken from frames beside it")
            }
            Self::TermsDropped { rank, terms, of } => write!(
                f,
                "the markers determine only {rank} of {terms} polynomial terms of {of} (they lie near a plane or a \
                 quadric); the rest follows the best similarity"
            ),
            Self::Units { scale } => write!(
                f,
                "the scan is {scale:.4} times as large as the marker set: do the units disagree? Check --unit and \
                 --marker-unit"
            ),
            Self::Mirrored { rms_mm, mirrored_mm } => write!(
                f,
                "markers and scan look mirrored: they are {rms_mm:.1} mm apart at best, {mirrored_mm:.1} mm with the \
                 markers reflected; check left and right in the picks, and the axes of both"
            ),
            Self::Unlike { rms_mm, spread_mm } => write!(
                f,
                "the markers at rest are {rms_mm:.1} mm from the scan at best, in a set that spreads over \
                 {spread_mm:.1} mm: check the picks, the marker names and the rest frame"
            ),
            Self::Suspicious { marker, error_mm, median_mm } => write!(
                f,
                "marker {marker} is {error_mm:.1} mm from where the others expect it (median {median_mm:.1} mm): was it \
                 picked on the right vertex?"
            ),
            Self::Folded { determinant, place } => write!(
                f,
                "the warp folds over near the face (smallest Jacobian determinant {determinant:.3} at {place}): check \
                 the picks beside it"
            ),
            Self::Unreached { count, vertex } => write!(
                f,
                "the warp reaches no point at {count} vertices near the markers, e.g. vertex {vertex}: check the picks \
                 beside them"
            ),
        }
    }
}

/// Whether a scale looks like a confusion of units, or of persons: the scan and the markers are of one face.
pub(crate) fn is_doubtful_scale(scale: f64) -> bool {
    !(0.67..=1.5).contains(&scale)
}
