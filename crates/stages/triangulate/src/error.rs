//! Why tracks cannot be triangulated.

use std::path::Path;

/// Why tracks cannot be triangulated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The tracks name a camera that the rig has not.
    #[error("names camera {camera}, which the rig has not (it has {})", list(.known))]
    UnknownCamera {
        /// The camera.
        camera: String,
        /// Cameras of the rig.
        known: Vec<String>,
    },
    /// The time base says nothing of a camera.
    #[error("names camera {0}, of which the time base says nothing")]
    UnsyncedCamera(String),
    /// One camera gives no depth.
    #[error("has tracks of {0} camera(s); two are needed to triangulate")]
    TooFewCameras(usize),
    /// A point far outside its camera's image: the calibration is of another image size.
    #[error(
        "the point ({}, {}) px lies outside the camera's image of {width} × {height} px: tracks and \
         calibration are of different image sizes",
        short(*.x),
        short(*.y)
    )]
    OutsideImage {
        /// Frame.
        frame: i64,
        /// Camera.
        camera: String,
        /// Marker.
        marker: String,
        /// Where the point is, px.
        x: f64,
        /// Where the point is, px.
        y: f64,
        /// Width of the camera's image, px.
        width: u32,
        /// Height of the camera's image, px.
        height: u32,
    },
    /// Nothing is seen by two cameras at once.
    #[error("no marker is seen by two cameras in the same frame, so none can be triangulated")]
    NothingSeenTwice,
    /// Markers are seen by two cameras, but nowhere do the rays meet.
    #[error(
        "in no frame do the rays of any marker meet: {0} samples are seen by two cameras or more, none agrees"
    )]
    NothingAgrees(usize),
    /// The cameras contradict each other.
    #[error(
        "the cameras contradict each other: {percent:.0} % of all views are outliers{}",
        hint(.beyond)
    )]
    Contradiction {
        /// Share of the views that are outliers.
        percent: f64,
        /// Camera, its image size and the right lower end of what was seen in it, px, where all cameras saw their points in the
        /// left upper part of the image alone.
        beyond: Option<(String, [u32; 2], [f64; 2])>,
    },
    /// The tracks hold no frames.
    #[error("holds no frames")]
    NoFrames,
    /// A length of time was asked for, but the frame rate is unknown.
    #[error("states no frame rate, so milliseconds cannot be counted in frames")]
    NoRate,
    /// A parameter outside its range.
    #[error("{name} is {value}; {allowed}")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
}

impl Error {
    /// The same, said of a file: which one, where in it, what to do.
    #[must_use]
    pub fn in_file(&self, path: &Path) -> artifact::Error {
        let error = artifact::Error::new(path, self.to_string());
        let error = match self {
            Self::OutsideImage { frame, camera, marker, .. } => {
                error.at(format!("frame {frame}, camera {camera}, marker {marker}"))
            }
            Self::UnknownCamera { .. } | Self::UnsyncedCamera(_) => error.at("header"),
            _ => error,
        };
        match self.fix() {
            Some(fix) => error.fix(fix),
            None => error,
        }
    }

    fn fix(&self) -> Option<&'static str> {
        Some(match self {
            Self::UnknownCamera { .. } => {
                "give the calibration of this rig, with the cameras' ids as in the take"
            }
            Self::UnsyncedCamera(_) => "give the time base of this take, or leave --sync out",
            Self::TooFewCameras(_) => "track the markers in more cameras",
            Self::OutsideImage { .. } => "calibrate with images of the footage's size",
            Self::NothingSeenTwice => {
                "check that the cameras' tracks are of one take and use the same marker ids"
            }
            Self::NothingAgrees(_) => {
                "check that the calibration is of this rig and that the tracks' marker ids mean the same everywhere"
            }
            Self::Contradiction { beyond: Some(_), .. } => "calibrate with images of the footage's size",
            Self::Contradiction { .. } => {
                "check that the calibration is of this rig and of this take's image size, and that the cameras' ids, marker ids \
                 and synchronisation are right"
            }
            Self::NoFrames => "the program that wrote it may have been cut off",
            Self::NoRate => "give --sync, or --no-filter and --fill-ms 0",
            Self::Parameter { .. } => return None,
        })
    }
}

fn list(ids: &[String]) -> String {
    if ids.is_empty() { "none".to_string() } else { ids.join(", ") }
}

/// A number of pixels; what is far beyond any image, by its power.
fn short(pixels: f64) -> String {
    if pixels.abs() < 1e6 { format!("{pixels:.1}") } else { format!("{pixels:.1e}") }
}

fn hint(beyond: &Option<(String, [u32; 2], [f64; 2])>) -> String {
    let Some((camera, [width, height], [x, y])) = beyond else { return String::new() };
    format!(
        ". The calibration is of {width} × {height} px, but camera {camera} saw nothing beyond ({x:.0}, {y:.0}) px: it may be of \
         a larger image size than the footage"
    )
}
