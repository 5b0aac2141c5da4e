//! Why markers cannot be tracked.

/// Why markers cannot be tracked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter out of its range.
    #[error("{name} is {value}; {allowed}")]
    Parameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What would do.
        allowed: &'static str,
    },
    /// An image that is not as large as the first.
    #[error("the image has {} × {} px, the others have {} × {}", .found[0], .found[1], .wanted[0], .wanted[1])]
    ImageSize {
        /// Width, height.
        found: [usize; 2],
        /// Of the labelled image.
        wanted: [usize; 2],
    },
    /// No label lies on the image.
    #[error(
        "none of the places lies on the image\n  to do: name places in pixels, (0, 0) at the top left; leave out cameras that see no marker"
    )]
    NoLabels,
    /// The labelled places look like what surrounds them.
    #[error(
        "the labelled places have the colour of what surrounds them\n  to do: check that the labels are of this image, and that they are in pixels"
    )]
    NoContrast,
    /// A colour that no pixel shows.
    #[error("no pixel shows the color #{:02x}{:02x}{:02x}\n  to do: take the color of a dot from the image itself", .0[0], .0[1], .0[2])]
    NoColor([u8; 3]),
    /// A label outside the image.
    #[error("marker {marker}: the label at {} lies outside the image, {} × {} px", place(at), .size[0], .size[1])]
    Outside {
        /// The marker.
        marker: String,
        /// The label, px.
        at: [f64; 2],
        /// Width, height.
        size: [usize; 2],
    },
    /// A label with no dot under it.
    #[error("marker {marker}: no dot lies at the label {}; {}", place(at), nearest_words(.nearest))]
    NoBlob {
        /// The marker.
        marker: String,
        /// The label, px.
        at: [f64; 2],
        /// Middle of the nearest dot.
        nearest: Option<[f64; 2]>,
    },
    /// Two labels on one dot.
    #[error("marker {marker}: the label at {} lies on the dot of {other}", place(at))]
    SameDot {
        /// The marker.
        marker: String,
        /// The label, px.
        at: [f64; 2],
        /// The marker that has the dot.
        other: String,
    },
    /// Most labels of a camera cannot be used.
    #[error("{} of {labels} labels cannot be used{}\n  to do: check that the labels are of this image, and that they are in pixels; marker-track detect draws what is found", .faults.len(), lines(.faults))]
    Labels {
        /// Why not, of each.
        faults: Vec<Error>,
        /// How many labels there are.
        labels: usize,
    },
    /// A line of a list of edits.
    #[error("line {line}: {what}")]
    Edit {
        /// Its number, from 1.
        line: usize,
        /// What is wrong there.
        what: String,
    },
    /// Numbers cannot be drawn.
    #[error(transparent)]
    Font(#[from] artifact::canvas::FontError),
}

impl Error {
    /// The marker whose label cannot be used.
    #[must_use]
    pub fn marker(&self) -> Option<&String> {
        match self {
            Self::Outside { marker, .. } | Self::NoBlob { marker, .. } | Self::SameDot { marker, .. } => {
                Some(marker)
            }
            _ => None,
        }
    }
}

/// Faults that a message lists.
const LISTED: usize = 12;

fn lines(faults: &[Error]) -> String {
    let more = faults.len().saturating_sub(LISTED);
    let listed = faults.iter().take(LISTED).map(|fault| format!("\n  {fault}"));
    listed.chain((more > 0).then(|| format!("\n  and {more} more"))).collect()
}

/// Large numbers as powers of ten: nobody counts digits.
fn place([x, y]: &[f64; 2]) -> String {
    match x.abs().max(y.abs()) < 1e6 {
        true => format!("({x:.1}, {y:.1})"),
        false => format!("({x:.1e}, {y:.1e})"),
    }
}

fn nearest_words(nearest: &Option<[f64; 2]>) -> String {
    match nearest {
        Some(at) => format!("the nearest is at {}", place(at)),
        None => "the image shows none".to_string(),
    }
}
