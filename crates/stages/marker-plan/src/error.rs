//! Why no markers could be proposed.

/// A failure of the stage, in the words of faces and markers.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter out of range.
    #[error("the {name} is {value}; it must be a number of at least {least}")]
    Parameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The least that it may be.
        least: f64,
    },
    /// Numbers of feature points that have no rule, or do not fit into the count.
    #[error(
        "{lips} lip points and {lids} lid points of {count} markers: lips may have 0, 2, 4 or 8, lids 0, 4 or 8, and the \
         count must hold them"
    )]
    FeaturePoints {
        /// Lip points.
        lips: usize,
        /// Lid points.
        lids: usize,
        /// Markers in all.
        count: usize,
    },
    /// Mouth and eyes could not be told.
    #[error(
        "the mesh has {} openings (boundary loops inside it of {} mm), and mouth and eyes cannot be told from them\n  to do: \
         open a closed mouth or closed lids with `mesh-clip --cut-along`, or name them by a vertex of their rims: \
         --mouth VERTEX --eyes VERTEX,VERTEX", lengths_mm.len(),
        lengths_mm.iter().map(|length| format!("{length:.0}")).collect::<Vec<_>>().join(", ")
    )]
    Openings {
        /// Lengths of the openings, mm.
        lengths_mm: Vec<f64>,
    },
    /// A vertex that is on no rim.
    #[error(
        "vertex {vertex} is on no boundary loop of the mesh\n  to do: pick a vertex on the rim of the {what}"
    )]
    NotOnARim {
        /// The vertex.
        vertex: u32,
        /// What was meant.
        what: &'static str,
    },
    /// Two of mouth and eyes on one rim.
    #[error(
        "two of the vertices that name mouth and eyes are on the same rim\n  to do: pick one vertex on each of three"
    )]
    SharedRim,
    /// Too little skin.
    #[error(
        "only {placed} of {count} markers find a place {least_distance_mm} mm from each other\n  to do: ask for fewer, or allow \
         a smaller --least-distance-mm"
    )]
    NoRoom {
        /// How many found one.
        placed: usize,
        /// How many were asked for.
        count: usize,
        /// The least distance.
        least_distance_mm: f64,
    },
}
