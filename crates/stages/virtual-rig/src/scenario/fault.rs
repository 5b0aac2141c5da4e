//! Single faults, each with a unit: what a stage should notice or survive.

use crate::Error;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// Something that goes wrong with one camera, or with all of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fault {
    /// What goes wrong.
    pub kind: FaultKind,
    /// How much of it, in the unit of its kind.
    pub amount: f64,
    /// The camera that it happens to; every one if absent.
    pub camera: Option<String>,
}

/// What can go wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FaultKind {
    /// Frames are missing from the footage: share of all.
    Dropped,
    /// Frames stand twice in the footage: share of all.
    Doubled,
    /// The clock runs late: frames of the camera, may be broken.
    Offset,
    /// The clock runs slow: parts per million.
    Drift,
    /// The footage is coded with a power law instead of sRGB: the exponent.
    Gamma,
    /// The shutter stays open: ms.
    MotionBlur,
    /// The camera was turned after its calibration: degrees.
    Rotated,
    /// The camera is out of focus: σ of the blur, px.
    Defocused,
    /// The images are mirrored left to right: 1.
    Mirrored,
    /// The zoom was touched after the calibration: share of the focal length.
    Focal,
}

impl FaultKind {
    /// Every kind with its name and unit.
    pub const ALL: [(Self, &'static str, &'static str); 10] = [
        (Self::Dropped, "dropped", "share of the frames"),
        (Self::Doubled, "doubled", "share of the frames"),
        (Self::Offset, "offset", "frames"),
        (Self::Drift, "drift", "ppm"),
        (Self::Gamma, "gamma", "exponent"),
        (Self::MotionBlur, "motion-blur", "ms"),
        (Self::Rotated, "rotated", "degrees"),
        (Self::Defocused, "defocused", "px"),
        (Self::Mirrored, "mirrored", "1"),
        (Self::Focal, "focal", "share"),
    ];
}

impl FromStr for Fault {
    type Err = String;

    /// Reads `KIND=AMOUNT` or `KIND=AMOUNT@CAMERA`.
    fn from_str(text: &str) -> Result<Self, String> {
        let names = || FaultKind::ALL.map(|(_, name, unit)| format!("{name} ({unit})")).join(", ");
        let (name, rest) = text.split_once('=').ok_or("say KIND=AMOUNT, or KIND=AMOUNT@CAMERA")?;
        let (amount, camera) = rest.split_once('@').map_or((rest, None), |(a, c)| (a, Some(c.to_string())));
        let Some(&(kind, ..)) = FaultKind::ALL.iter().find(|(_, other, _)| *other == name) else {
            return Err(format!("'{name}' is no fault; there are {}", names()));
        };
        let amount = amount.parse().map_err(|_| format!("'{amount}' is not a number"))?;
        let fault = Self { kind, amount, camera };
        fault.check("fault").map_err(|error| error.to_string())?;
        Ok(fault)
    }
}

impl Fault {
    /// Whether the amount makes sense.
    ///
    /// # Errors
    /// Names the fault.
    pub fn check(&self, place: &str) -> Result<(), Error> {
        use FaultKind as K;
        let (range, what) = match self.kind {
            K::Dropped | K::Doubled => (0.0..=0.5, "a share from 0 to 0.5"),
            K::Offset => (-1e4..=1e4, "a number of frames"),
            K::Drift => (-1e4..=1e4, "within ±10 000 ppm"),
            K::Gamma => (0.2..=5.0, "an exponent from 0.2 to 5"),
            K::MotionBlur => (0.0..=1e3, "from 0 to 1000 ms"),
            K::Rotated => (-45.0..=45.0, "within ±45 degrees"),
            K::Defocused => (0.0..=20.0, "from 0 to 20 px"),
            K::Mirrored => (1.0..=1.0, "1"),
            K::Focal => (-0.5..=1.0, "from −0.5 to 1"),
        };
        if range.contains(&self.amount) {
            return Ok(());
        }
        let name =
            FaultKind::ALL.iter().find(|(kind, ..)| *kind == self.kind).map_or("fault", |(_, name, _)| name);
        Err(Error::parameter(place, format!("{name}={} is out of range: say {what}", self.amount)))
    }

    /// Whether it happens to a camera.
    #[must_use]
    pub fn hits(&self, camera: &str) -> bool {
        self.camera.as_deref().is_none_or(|hit| hit == camera)
    }
}
