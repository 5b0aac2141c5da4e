//! What an examination finds.

use serde::Serialize;

/// Kinds of findings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The image size is not that of the footage.
    ImageSize,
    /// The focal length is odd in itself.
    Focal,
    /// Pixels are not square.
    Aspect,
    /// The principal point is far from the middle.
    Center,
    /// The lens folds within the image.
    Fold,
    /// Too little of the image was looked at.
    Coverage,
    /// Points lie behind the camera that sees them.
    Behind,
    /// The images are mirrored or stand on their head.
    Mirrored,
    /// The images are another camera's.
    Exchanged,
    /// The pose is the other one of the two that a flat board allows.
    Flipped,
    /// The camera is turned.
    Turned,
    /// The camera stands elsewhere.
    Moved,
    /// The focal length does not fit the images.
    Zoomed,
    /// The images come too late or too early.
    Late,
    /// What the camera sees does not fit the others, and no single fault explains it.
    Unexplained,
    /// Known lengths come out wrong.
    Length,
}

/// Something that is wrong.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// The camera; none if it is the whole rig.
    pub camera: Option<String>,
    /// What is wrong.
    pub kind: Kind,
    /// How much, in `unit`.
    pub number: f64,
    /// Of the number.
    pub unit: &'static str,
    /// The same in words.
    pub what: String,
    /// What to do.
    pub advice: &'static str,
}

/// How one camera does.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CameraReport {
    /// Its id.
    pub camera: String,
    /// Sightings that the others can judge.
    pub sightings: usize,
    /// Root mean square distance from where the others say the points are, the worst tenth left out, px.
    pub residual_px: Option<f64>,
    /// How late its images come, frames; none where nothing moves, or another fault would pass for lateness.
    pub late_frames: Option<f64>,
    /// Share of the image within the hull of what it saw.
    pub coverage: Option<f64>,
}

/// The outcome of an examination.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Examination {
    /// What is wrong, by camera.
    pub findings: Vec<Finding>,
    /// How each camera does.
    pub cameras: Vec<CameraReport>,
    /// Known lengths, all together: measured over stated, the mean.
    pub length_ratio: Option<f64>,
    /// Whether cameras were held against each other: there are points that two of them see.
    pub compared: bool,
    /// Cameras that the others could not judge, and why.
    pub unjudged: Vec<String>,
    /// What was not checked, and why.
    pub unchecked: Vec<String>,
}

impl Kind {
    /// What to do about it.
    pub(super) fn advice(self) -> &'static str {
        match self {
            Self::ImageSize => {
                "calibrate with images of the footage's size, or scale the calibration on import"
            }
            Self::Focal | Self::Aspect | Self::Center => {
                "check the image size and the board's squares, hold the focal ratio, and use more tilted views"
            }
            Self::Fold => "set fewer distortion terms free, or show the board in the corners of the image",
            Self::Coverage => "calibrate with the board or the wand in all parts of the image",
            Self::Behind => "calibrate this camera's pose again",
            Self::Mirrored => "switch off mirroring in the camera or its recorder, or flip the footage",
            Self::Exchanged => "give the cameras' calibrations or their footage each other's names",
            Self::Flipped => "calibrate its pose from more, and more tilted, views of the board",
            Self::Turned | Self::Moved => {
                "calibrate its pose again; fix the camera: it was touched after the calibration, or during it"
            }
            Self::Zoomed => {
                "calibrate its lens again with the zoom and the focus of the footage, and tape them"
            }
            Self::Late => {
                "run capture-sync again with --late, by so many of its frames (a camera that is early here takes its images late), and track again"
            }
            Self::Unexplained => "look at its footage: other faults than these, or several at once",
            Self::Length => "check the size of the board's squares or the stated length",
        }
    }
}
