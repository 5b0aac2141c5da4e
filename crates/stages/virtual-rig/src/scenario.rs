//! What shall be filmed, by whom, with what: the file that a take is made from.
//!
//! A scenario is composed of the parameters of the rooms, so that its type lives here and not among the artifacts that
//! stages share.

mod check;
mod fault;
mod preset;
mod version;

pub use fault::{Fault, FaultKind};
pub use preset::{Length, PRESETS, preset};

use crate::act::{ClipParams, Event, HeadMotion, Timeline};
use crate::clock::Flash;
use crate::film::{Film, Sensor, Transfer};
use crate::light::Ambient;
use crate::take::{Hands, PaintPlan, Placement, Spaces};
use crate::{Error, calibration, wrinkle};
use artifact::{Document, Kind, Rate, Violation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A scenario: everything that a take depends on, but for what is given beside it (a scan, an expression set, recorded
/// weights).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Name with its version, e.g. `standard-1`: a published scenario never changes.
    pub name: String,
    /// Who acts, what they do, how they wrinkle, where the paint runs, what the noise is.
    pub seed: u64,
    /// How long the take is.
    pub extent: Extent,
    /// Vertices of the face, 500 to 1 500 000; a scan is subdivided until it has about as many.
    pub vertices: usize,
    /// Depth of the pores, mm; 0.02 looks right. They show where edges are shorter than 0.2 mm: on 1 400 000 vertices.
    #[serde(default)]
    pub pores_mm: f64,
    /// Length of edges along the wrinkles' lines, mm, so that sharp creases are not cut off; 0: as beside them.
    #[serde(default)]
    pub crease_mm: f64,
    /// How the recording differs from the scan.
    #[serde(default)]
    pub spaces: Spaces,
    /// What the face does.
    pub performance: Performance,
    /// What it does on top.
    #[serde(default)]
    pub events: Vec<Event>,
    /// What the head does.
    pub head: HeadMotion,
    /// Which lines the face folds along.
    #[serde(default)]
    pub lines: wrinkle::Style,
    /// How deep they fold, with which profile.
    #[serde(default)]
    pub folds: wrinkle::Params,
    /// Dots and strokes.
    #[serde(default)]
    pub paint: PaintPlan,
    /// What gets between the face and the cameras.
    #[serde(default)]
    pub hands: Hands,
    /// The cameras by id; the paper's rig if empty.
    #[serde(default)]
    pub cameras: BTreeMap<String, Placement>,
    /// Size of all images, as a share of what the cameras give.
    #[serde(default = "whole")]
    pub image_scale: f64,
    /// The light on painted wrinkles and around them, and on the rest.
    pub light: Ambient,
    /// How light is gathered.
    #[serde(default)]
    pub film: Film,
    /// How long the shutter is open, ms.
    pub exposure_ms: f64,
    /// Slow rise and fall of the gain, share.
    #[serde(default)]
    pub gain_drift: f64,
    /// Lens blur, noise, coding.
    pub sensor: Sensor,
    /// Boards and wands, filmed before the take.
    #[serde(default)]
    pub calibration: calibration::Params,
    /// A flash that all cameras see.
    #[serde(default)]
    pub flash: Option<Flash>,
    /// What goes wrong, one by one.
    #[serde(default)]
    pub faults: Vec<Fault>,
}

fn whole() -> f64 {
    1.0
}

/// What the face does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Performance {
    /// Brow raise, frown, smile, squint, jaw, speech and blinks, fitted to the length.
    Standard,
    /// These events.
    Events(Timeline),
    /// The recorded weights that are given beside the scenario.
    Recording(ClipParams),
}

impl Performance {
    /// Where the list of events stands in a scenario.
    pub(crate) const EVENTS: &'static str = "performance.events.events";
}

/// How long a take is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Extent {
    /// Frames of the mocap clock.
    pub frames: u32,
    /// Number of the first one.
    pub first_frame: i64,
    /// Frames of the mocap clock per second.
    pub rate: Rate,
    /// A wrinkle camera takes every so-many-th frame of the mocap clock.
    pub wrinkle_every: u32,
    /// The first frame that a wrinkle camera takes, counted from the first one.
    #[serde(default)]
    pub wrinkle_phase: u32,
    /// Seconds of the performance per second of the take: a few frames can hold much of it.
    #[serde(default = "whole")]
    pub pace: f64,
}

impl Extent {
    /// Length of the performance, s.
    #[must_use]
    pub fn performance_s(&self) -> f64 {
        f64::from(self.frames) / self.rate.hz() * self.pace
    }
}

impl Scenario {
    /// Whether such a take can be made.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn validate(&self) -> Result<(), Error> {
        self.extent.check()?;
        let positive = |x: f64| x > 0.0 && x.is_finite();
        if !(500..=1_500_000).contains(&self.vertices) {
            return Err(Error::parameter("vertices", "must lie between 500 and 1 500 000"));
        }
        if !(0.0..=0.2).contains(&self.pores_mm) {
            return Err(Error::parameter("pores_mm", "must lie between 0 and 0.2 mm"));
        }
        if self.crease_mm != 0.0 && !(0.02..=5.0).contains(&self.crease_mm) {
            return Err(Error::parameter("crease_mm", "must lie between 0.02 and 5 mm, or be 0"));
        }
        if !positive(self.image_scale) || self.image_scale > 8.0 {
            return Err(Error::parameter("image_scale", "must be above 0 and at most 8"));
        }
        if !(0.0..=1e3).contains(&self.exposure_ms) {
            return Err(Error::parameter("exposure_ms", "must lie between 0 and 1000 ms"));
        }
        if !(0.0..=0.9).contains(&self.gain_drift) {
            return Err(Error::parameter("gain_drift", "must lie between 0 and 0.9"));
        }
        self.spaces.check()?;
        self.head.check("head")?;
        self.lines.check()?;
        self.folds.check()?;
        self.paint.check()?;
        self.hands.check()?;
        self.light.check()?;
        self.film.check()?;
        self.sensor.check()?;
        self.calibration.check()?;
        self.check_performance()?;
        self.check_cameras()?;
        self.check_flash()?;
        if let Some(paint) =
            self.lines.paints.iter().find(|&paint| !self.paint.stroke_colors.contains_key(paint))
        {
            let what = format!("the colour {paint} of lines.paints is not among them");
            return Err(Error::parameter("paint.stroke_colors", what));
        }
        self.check_faults()
    }

    /// The cameras as placed, at the size of the images.
    #[must_use]
    pub fn placements(&self) -> BTreeMap<String, Placement> {
        let all = self.all_cameras().into_iter();
        all.map(|(id, camera)| (id, camera.scaled(self.image_scale))).collect()
    }

    fn all_cameras(&self) -> BTreeMap<String, Placement> {
        match self.cameras.is_empty() {
            true => crate::take::paper_rig(self.seed),
            false => self.cameras.clone(),
        }
    }

    /// Leaves only some of the cameras; all if none is named.
    ///
    /// # Errors
    /// Names the camera that the rig lacks.
    pub fn keep_cameras(&mut self, ids: &[String]) -> Result<(), Error> {
        let all = self.all_cameras();
        if let Some(id) = ids.iter().find(|id| !all.contains_key(*id)) {
            let known = all.into_keys().collect::<Vec<_>>().join(", ");
            return Err(Error::parameter("cameras", format!("there is no {id}; the rig has {known}")));
        }
        if !ids.is_empty() {
            self.cameras = all.into_iter().filter(|(id, _)| ids.contains(id)).collect();
        }
        Ok(())
    }

    /// The sum of the amounts of a fault for a camera, if it has any.
    #[must_use]
    pub fn fault(&self, kind: FaultKind, camera: &str) -> Option<f64> {
        let mut amounts =
            self.faults.iter().filter(|fault| fault.kind == kind && fault.hits(camera)).peekable();
        amounts.peek().is_some().then(|| amounts.map(|fault| fault.amount).sum())
    }

    /// A camera's sensor, with its faults.
    #[must_use]
    pub fn sensor_of(&self, camera: &str) -> Sensor {
        let mut sensor = self.sensor.clone();
        if let Some(blur) = self.fault(FaultKind::Defocused, camera) {
            sensor.lens_blur_px = sensor.lens_blur_px.hypot(blur);
        }
        if let Some(gamma) = self.fault(FaultKind::Gamma, camera) {
            sensor.transfer = Transfer::Gamma(gamma);
        }
        sensor
    }
}

impl Kind for Scenario {
    const NAME: &'static str = "scenario";
    const VERSION: u32 = 1;
}

impl Document for Scenario {
    fn check(&self) -> Result<(), Violation> {
        self.validate().map_err(|error| match error {
            Error::Parameter { place, what } => Violation::new(place, what),
        })
    }
}
