//! Why no time base was found.

/// Why no time base was found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is nothing to synchronise.
    #[error("the take has no camera with footage")]
    NoCameras,
    /// A camera without images.
    #[error("camera {0}: its footage has no image that belongs to the take")]
    NoImages(String),
    /// A mode that needs time stamps.
    #[error("camera {0}: has no time stamps, which this mode needs")]
    NoStamps(String),
    /// A mode that needs images.
    #[error("camera {0}: its images were not read, which this mode needs")]
    NotRead(String),
    /// The stamps do not fit the rate.
    #[error("camera {camera}: its time stamps come at {found_hz:.4} Hz, but the take says {stated}")]
    Rate {
        /// The camera.
        camera: String,
        /// By the stamps.
        found_hz: f64,
        /// By the take.
        stated: artifact::Rate,
    },
    /// Nothing to correlate.
    #[error(
        "camera {camera}: nothing in its images moves together with camera {reference}'s (canonical correlation {correlation:.2})"
    )]
    NoCorrelation {
        /// The camera.
        camera: String,
        /// The camera that it was compared with.
        reference: String,
        /// The best that was found.
        correlation: f64,
    },
    /// Too few images to correlate.
    #[error("camera {camera}: {count} pairs of images are too few to correlate; {least} are needed")]
    TooShort {
        /// The camera.
        camera: String,
        /// Images that both cameras have.
        count: usize,
        /// How many are needed.
        least: usize,
    },
    /// New breaks are found wherever one is mended.
    #[error("the cameras' images fall out of step at ever new places")]
    Unsteady,
    /// Two cameras fall out of step, and not as lost images would make them.
    #[error("camera {camera}: falls out of step with camera {reference} near its exposure {exposure}")]
    Break {
        /// The camera.
        camera: String,
        /// The camera that it was compared with.
        reference: String,
        /// Where, about: exposures since its first image.
        exposure: i64,
        /// Whether its time stamps say otherwise.
        is_stamped: bool,
    },
    /// No flash.
    #[error("camera {0}: no flash is seen in its images")]
    NoFlash(String),
    /// Other flashes than another camera's.
    #[error("camera {camera}: sees {found} flashes, camera {reference} {expected}")]
    Flashes {
        /// The camera.
        camera: String,
        /// Flashes that it sees.
        found: usize,
        /// The camera that it was compared with.
        reference: String,
        /// Flashes that that one sees.
        expected: usize,
    },
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
    /// What the user can do about it.
    #[must_use]
    pub fn fix(&self) -> &'static str {
        match self {
            Self::NoCameras => "name the cameras' footage in the take manifest",
            Self::NoImages(_) => "check the footage's path and its 'first' in the take manifest",
            Self::NoStamps(_) => {
                "name the file of its time stamps in the take manifest, or say --mode flash or --mode correlation"
            }
            Self::NotRead(_) => "read its images, or choose another mode",
            Self::Rate { .. } => "state the camera's true rate in the take manifest",
            Self::NoCorrelation { .. } => {
                "say a larger --search-s, or --mode flash, stated or timestamps; a still or unseen face cannot be correlated"
            }
            Self::TooShort { .. } => "record longer, or say --mode flash, stated or timestamps",
            Self::Break { is_stamped: true, .. } => {
                "check that these are the time stamps of this footage, or say --ignore-timestamps"
            }
            Self::Unsteady | Self::Break { .. } => {
                "give time stamps, which say which images were lost, or number the image files by exposure"
            }
            Self::NoFlash(_) | Self::Flashes { .. } => {
                "check that the flash is in every camera's footage, or say --mode correlation"
            }
            Self::Parameter { .. } => "choose a value in the range",
        }
    }
}
