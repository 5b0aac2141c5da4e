//! What the cameras are calibrated with.

use super::{Board, BoardLight};
use crate::Error;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the cameras are calibrated with.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Params {
    /// Boards held before the cameras.
    pub boards: BoardViews,
    /// A bright point waved in the dark.
    pub wand: Wand,
}

/// Views of a board.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BoardViews {
    /// The board.
    pub board: Board,
    /// How many views; 0 leaves them out.
    pub count: usize,
    /// Nearest and farthest, as shares of the distance from the camera to where the cameras' views meet.
    pub distance: [f64; 2],
    /// Largest tilt from facing the cameras, degrees.
    pub tilt_deg: f64,
    /// Largest turn in the board's own plane to either side, degrees.
    pub turn_deg: f64,
    /// Samples in a pixel through which an edge runs.
    pub samples: u32,
    /// The light on the board.
    pub light: BoardLight,
}

impl Default for BoardViews {
    fn default() -> Self {
        Self {
            board: Board::default(),
            count: 40,
            distance: [0.75, 1.2],
            tilt_deg: 40.0,
            turn_deg: 25.0,
            samples: 96,
            light: BoardLight::default(),
        }
    }
}

/// A waved bright point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Wand {
    /// How many frames; 0 leaves it out.
    pub frames: usize,
    /// How many frames a sweep from side to side takes, about.
    pub frames_per_sweep: f64,
    /// How far the wand goes, as a share of the ball that all cameras see; above 1 some cameras lose it at times.
    pub reach: f64,
    /// Radius of the glowing ball, mm.
    pub radius_mm: f64,
    /// Linear radiance of the ball as red, green, blue; 1 is the sensor's white.
    pub radiance: [f32; 3],
    /// Linear radiance of the room.
    pub room: f32,
}

impl Default for Wand {
    fn default() -> Self {
        Self {
            frames: 200,
            frames_per_sweep: 25.0,
            reach: 1.0,
            radius_mm: 2.5,
            radiance: [1.6, 1.5, 1.3],
            room: 0.004,
        }
    }
}

fn refuse(place: &str, what: String) -> Result<(), Error> {
    Err(Error::Parameter { place: format!("calibration.{place}"), what })
}

impl Params {
    /// Refuses what makes no sense.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self) -> Result<(), Error> {
        self.boards.check()?;
        self.wand.check()
    }
}

impl BoardViews {
    /// Refuses what makes no sense.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self) -> Result<(), Error> {
        self.board.check("calibration.boards.board")?;
        self.light.check("calibration.boards.light")?;
        let [near, far] = self.distance;
        if !(near > 0.0 && near <= far && far.is_finite()) {
            return refuse("boards.distance", format!("from {near} to {far} is no range; e.g. [0.75, 1.2]"));
        }
        if !(0.0..=60.0).contains(&self.tilt_deg) {
            return refuse("boards.tilt_deg", format!("{} degrees; 0 to 60 will do", self.tilt_deg));
        }
        if !(0.0..=180.0).contains(&self.turn_deg) {
            return refuse("boards.turn_deg", format!("{} degrees; 0 to 180 will do", self.turn_deg));
        }
        match (1..=4096).contains(&self.samples) {
            true => Ok(()),
            false => refuse("boards.samples", format!("{}; 1 to 4096 will do", self.samples)),
        }
    }
}

impl Wand {
    /// Refuses what makes no sense.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self) -> Result<(), Error> {
        for (key, value) in [
            ("frames_per_sweep", self.frames_per_sweep),
            ("reach", self.reach),
            ("radius_mm", self.radius_mm),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return refuse(&format!("wand.{key}"), format!("{value} is not positive"));
            }
        }
        let light = self.radiance.iter().chain(std::iter::once(&self.room));
        match light.clone().all(|value| value.is_finite() && *value >= 0.0) {
            true => Ok(()),
            false => refuse("wand.radiance, room", "negative light".into()),
        }
    }
}
