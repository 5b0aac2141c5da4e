//! Why no warp, no correspondence or no displacement could be made.

/// Results of this stage.
pub type Result<T> = std::result::Result<T, Error>;

/// What stops this stage.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// Too few pairs for any warp.
    #[error("{count} markers can be used; a warp needs at least 4\n  to do: pick more markers on the scan")]
    TooFew {
        /// Usable pairs.
        count: usize,
    },
    /// Too few pairs for ten polynomial terms.
    #[error(
        "{count} markers can be used; a quadratic warp needs at least 10\n  to do: pick more, or say --degree linear"
    )]
    TooFewForQuadratic {
        /// Usable pairs.
        count: usize,
    },
    /// Two centers in one place.
    #[error(
        "markers {first} and {second} are in the same place in {space}\n  to do: remove one of them, or correct its label or pick"
    )]
    Coincident {
        /// Marker id.
        first: String,
        /// Marker id.
        second: String,
        /// The space where they meet.
        space: &'static str,
    },
    /// The markers do not fix a rotation.
    #[error("no warp can be fitted from {space}: {cause}\n  to do: pick markers all over the face")]
    Degenerate {
        /// The space that they are in.
        space: &'static str,
        /// What is wrong with them.
        cause: String,
    },
    /// The system is singular although no two centers coincide.
    #[error(
        "the markers in {space} are too close to each other to be told apart numerically\n  to do: look for two markers on one spot"
    )]
    Unsolvable {
        /// The space that they are in.
        space: &'static str,
    },
    /// The rest frame is not among the frames.
    #[error(
        "the trajectories have no frame {frame}; they run from {first} to {last}\n  to do: say --rest-frame with one of them, or auto"
    )]
    NoSuchFrame {
        /// The frame that was asked for.
        frame: i64,
        /// First frame of the trajectories.
        first: i64,
        /// Last frame of the trajectories.
        last: i64,
    },
    /// No frame can be the rest frame.
    #[error(
        "no frame shows four of the picked markers at once; the best one shows {most}\n  to do: check that the marker ids of the correspondence are those of the trajectories"
    )]
    NoUsableFrame {
        /// Picked markers in the frame that shows most of them.
        most: usize,
    },
    /// A pair names a vertex that the mesh does not have, or has elsewhere.
    #[error(
        "marker {marker} was picked on vertex {vertex}, which is not there in this mesh\n  to do: give the mesh that the markers were picked on"
    )]
    OtherMesh {
        /// Marker id.
        marker: String,
        /// Vertex index, 0-based.
        vertex: u32,
    },
    /// A pick is too far from the mesh.
    #[error(
        "marker {marker} was picked {distance_mm:.3} mm from the nearest vertex (vertex {vertex}); at most {limit_mm} mm are allowed\n  to do: check the units of picks and mesh, or raise --max-distance-mm"
    )]
    FarPick {
        /// Marker id.
        marker: String,
        /// Nearest vertex, 0-based.
        vertex: u32,
        /// How far it is.
        distance_mm: f64,
        /// How far it may be.
        limit_mm: f64,
    },
    /// Two picks end on one vertex.
    #[error(
        "markers {first} and {second} are picked on the same vertex ({vertex})\n  to do: correct one of the picks, or use a finer mesh"
    )]
    SameVertex {
        /// Marker id.
        first: String,
        /// Marker id.
        second: String,
        /// Vertex index, 0-based.
        vertex: u32,
    },
    /// A marker is picked twice.
    #[error("marker {marker} is picked twice\n  to do: remove one of the two")]
    PickedTwice {
        /// Marker id.
        marker: String,
    },
    /// A pick names a vertex that is not there.
    #[error(
        "marker {marker} is picked on vertex {vertex} of a mesh that has {vertex_count}\n  to do: give the mesh that was picked on"
    )]
    NoSuchVertex {
        /// Marker id.
        marker: String,
        /// Vertex index, 0-based.
        vertex: u32,
        /// Vertices of the mesh.
        vertex_count: usize,
    },
    /// A pick's coordinates are no numbers.
    #[error("marker {marker} is picked at a point that is not finite\n  to do: correct the pick")]
    NotFinite {
        /// Marker id.
        marker: String,
    },
    /// Nothing was picked, or the mesh is empty.
    #[error("there is nothing to snap: {what}\n  to do: check the file")]
    Nothing {
        /// What is empty.
        what: &'static str,
    },
    /// A parameter makes no sense.
    #[error("{0}")]
    Parameter(String),
}
