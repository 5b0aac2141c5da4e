//! Why no normal map can be made.

/// Why no normal map can be made. `side` names the photograph: neutral or expression.
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
    /// Landmarks are too few to say how the skin moved.
    #[error(
        "{count} landmarks have the same id in both pictures; at least 4 are needed\n  to do: mark the same places in both under the same ids"
    )]
    FewLandmarks {
        /// How many there are.
        count: usize,
    },
    /// All landmarks lie on a line.
    #[error("the landmarks lie on one line\n  to do: mark places all over the face")]
    LandmarksOnALine,
    /// Planes of different sizes.
    #[error(
        "the {name} has {found:?} px, the neutral photograph {wanted:?}\n  to do: give it the size of the neutral photograph"
    )]
    Size {
        /// What has the wrong size.
        name: String,
        /// Its width and height.
        found: [usize; 2],
        /// Those of the neutral photograph.
        wanted: [usize; 2],
    },
    /// Nothing of the neutral photograph can be compared.
    #[error("no pixel of the region can be compared: {why}\n  to do: {fix}")]
    NothingToCompare {
        /// Why not.
        why: &'static str,
        /// What would help.
        fix: &'static str,
    },
    /// Both photographs show the same.
    #[error(
        "both photographs show the same pixels: there is no expression to take over\n  to do: give a photograph of an expression"
    )]
    Identical,
    /// Too few frames for a modulation function.
    #[error(
        "{count} frames show {what}; at least 3 are needed\n  to do: film the way from rest to the full expression"
    )]
    FewFrames {
        /// How many frames count.
        count: usize,
        /// What they show.
        what: &'static str,
    },
}
