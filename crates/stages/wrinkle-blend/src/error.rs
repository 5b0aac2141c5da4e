//! What can go wrong.

/// Why wrinkles cannot be blended.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// A parameter outside its range.
    #[error("{0}")]
    Params(String),
    /// No such mesh, or none at all.
    #[error("there is no mesh '{name}'\n  to do: name one of {known}")]
    UnknownMesh {
        /// What was asked for.
        name: String,
        /// The meshes there are.
        known: String,
    },
    /// No bone of that name.
    #[error("pose {pose}: there is no bone '{bone}'\n  to do: correct the name; near it are {near}")]
    UnknownBone {
        /// The pose that names it.
        pose: String,
        /// The name.
        bone: String,
        /// Bones whose names are like it.
        near: String,
    },
    /// The bone that defines the head's space is not told.
    #[error("no bone is the head's: {what}\n  to do: name it with --head-bone; the topmost are {known}")]
    HeadBone {
        /// What was looked for.
        what: String,
        /// Some bones.
        known: String,
    },
    /// The skin hangs on no bone below the head.
    #[error(
        "mesh {mesh}: no vertex hangs on a bone below '{head}'\n  to do: name a bone nearer the root with --head-bone"
    )]
    NoBones {
        /// The mesh.
        mesh: String,
        /// The head's bone.
        head: String,
    },
    /// A pose like the neutral one.
    #[error(
        "pose {pose}: is the neutral pose: no bone moves by {least_mm:.2} mm or more in the head's space (the most: {most_mm:.3} mm)\n  to do: pose the face as its wrinkle map shows it; if the file's unit is not what --mm-per-unit says, correct that"
    )]
    NeutralPose {
        /// The pose.
        pose: String,
        /// What it would take, mm.
        least_mm: f64,
        /// How far its farthest bone goes, mm.
        most_mm: f64,
    },
    /// No poses.
    #[error("there is no reference pose\n  to do: give a file with --poses, or --pose ID=SECONDS")]
    NoPoses,
    /// A map of another size than the neutral one.
    #[error(
        "{map}: is {width} × {height}, but the neutral map {neutral_width} × {neutral_height}\n  to do: make all maps in one size"
    )]
    MapSize {
        /// The map.
        map: String,
        /// Its width, px.
        width: usize,
        /// Its height, px.
        height: usize,
        /// The neutral map's width, px.
        neutral_width: usize,
        /// The neutral map's height, px.
        neutral_height: usize,
    },
    /// Values that make no map.
    #[error("{map}: {values} values make no map of {width} × {height}")]
    NoMap {
        /// The map.
        map: String,
        /// How many values.
        values: usize,
        /// Width, px.
        width: usize,
        /// Height, px.
        height: usize,
    },
    /// Without texture coordinates no map lies on the mesh.
    #[error("mesh {mesh}: has no texture coordinates\n  to do: unwrap it, and export it with TEXCOORD_0")]
    NoUvs {
        /// The mesh.
        mesh: String,
    },
    /// More poses than a graphics card takes from vertices to pixels.
    #[error(
        "{count} poses are too many to draw, {most} are the most\n  to do: leave out poses, or find a smaller set with fit-poses"
    )]
    ManyPoses {
        /// How many there are.
        count: usize,
        /// How many may be.
        most: usize,
    },
    /// No set of poses is near enough to all frames.
    #[error(
        "{count} poses leave {error_mm:.2} mm, more than the {tolerance_mm} mm allowed\n  to do: allow more poses (--most), or a larger --tolerance-mm"
    )]
    TooFewPoses {
        /// How many were allowed.
        count: usize,
        /// What they leave, mm.
        error_mm: f64,
        /// What may be left, mm.
        tolerance_mm: f64,
    },
}
