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
    /// The stamps' steps are nowhere near the rate: another unit, or another rate.
    #[error("camera {camera}: its time stamps are {step_s:.6} s apart, but the take says {stated}")]
    Period {
        /// The camera.
        camera: String,
        /// The usual step, s.
        step_s: f64,
        /// By the take.
        stated: artifact::Rate,
    },
    /// The stamps are not of one clock.
    #[error(
        "cameras {early} and {late} have no common time: by its stamps {early} ends at {end_s:.3} s, and {late} begins at {begin_s:.3} s"
    )]
    NoCommonTime {
        /// The camera that ends first.
        early: String,
        /// Where it ends, s.
        end_s: f64,
        /// The camera that begins last.
        late: String,
        /// Where it begins, s.
        begin_s: f64,
    },
    /// Nearly all images of a camera are missing.
    #[error(
        "camera {camera}: before its image {before_image}, {lost} images are missing by its time stamps or numbers"
    )]
    Gap {
        /// The camera.
        camera: String,
        /// Images missing there.
        lost: i64,
        /// The image after the gap.
        before_image: i64,
    },
    /// Many more frames than images.
    #[error("the take would have {frames} frames by camera {camera}, which has {images} images")]
    TooLong {
        /// The camera that lasts longest.
        camera: String,
        /// Its images.
        images: usize,
        /// Mocap frames.
        frames: i64,
    },
    /// A rate that no clock has.
    #[error("the take's rate is {0}, which no camera keeps up with")]
    TakeRate(artifact::Rate),
    /// A number that frames cannot be counted on from.
    #[error("the take's first frame is {0}")]
    FirstFrame(i64),
    /// A shift of a camera that there is not.
    #[error("there is no camera {0} that could be late")]
    NoSuchCamera(String),
    /// Nothing to correlate.
    #[error(
        "camera {camera}: in {count} images nothing moves together with camera {reference}'s (canonical correlation {correlation:.2})"
    )]
    NoCorrelation {
        /// The camera.
        camera: String,
        /// The camera that it was compared with.
        reference: String,
        /// Images of which both cameras' changes are known.
        count: usize,
        /// The best that was found.
        correlation: f64,
    },
    /// Too few images to correlate.
    #[error(
        "camera {camera}: {count} images that others have too are too few to correlate; {least} at least are needed, and ten seconds that move are safe"
    )]
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
            Self::Period { .. } => {
                "check that the stamps are in seconds, and state the camera's true rate in the take manifest"
            }
            Self::NoCommonTime { .. } => {
                "check that all stamps are in seconds and of one clock; of clocks of their own, say --mode correlation"
            }
            Self::Gap { .. } | Self::TooLong { .. } => {
                "check the time stamps, the images' numbers and the rates in the take manifest"
            }
            Self::TakeRate(_) | Self::FirstFrame(_) => "correct it in the take manifest",
            Self::NoSuchCamera(_) => "name a camera of the take that is used",
            Self::NoCorrelation { .. } => {
                "record ten seconds in which the face moves, or say --mode flash, stated or timestamps; where the cameras' starts lie further apart than --search-s, say a larger one"
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
