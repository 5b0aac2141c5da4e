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
    /// Values that make no picture.
    #[error("{values} values make no picture of {} × {} pixels", .size[0], .size[1])]
    Pixels {
        /// Width, height.
        size: [usize; 2],
        /// How many values there are.
        values: usize,
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
        "no label lies on the image\n  to do: label the markers that this camera sees, or leave the camera out"
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
    #[error("marker {marker}: the label at ({:.1}, {:.1}) lies outside the image, {} × {} px\n  to do: label it where it is, or take the label out", .at[0], .at[1], .size[0], .size[1])]
    Outside {
        /// The marker.
        marker: String,
        /// The label, px.
        at: [f64; 2],
        /// Width, height.
        size: [usize; 2],
    },
    /// A label with no dot under it.
    #[error("marker {marker}: no dot lies at the label ({:.1}, {:.1}); {}\n  to do: put the label on its dot, or take it out; marker-track detect draws what is found", .at[0], .at[1], nearest_words(.nearest))]
    NoBlob {
        /// The marker.
        marker: String,
        /// The label, px.
        at: [f64; 2],
        /// Middle of the nearest dot.
        nearest: Option<[f64; 2]>,
    },
    /// A line of a list of edits.
    #[error("line {line}: {what}")]
    Edit {
        /// Its number, from 1.
        line: usize,
        /// What is wrong there.
        what: String,
    },
}

fn nearest_words(nearest: &Option<[f64; 2]>) -> String {
    match nearest {
        Some([x, y]) => format!("the nearest is at ({x:.1}, {y:.1})"),
        None => "the image shows none".to_string(),
    }
}
