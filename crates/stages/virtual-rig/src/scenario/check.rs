//! Whether a scenario can be filmed: what no single room can tell.

use super::{Extent, Fault, FaultKind, Performance, Scenario};
use crate::Error;
use crate::act::Timeline;
use crate::clock::Schedule;

/// Brighter flashes, as a factor, are told from white by nobody.
const BRIGHTEST: f64 = 1e6;

impl Extent {
    /// Whether such a take has frames.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self) -> Result<(), Error> {
        let Self { frames, first_frame, rate, wrinkle_every, wrinkle_phase, pace } = self;
        let wrong = |field: &str, what: &str| Err(Error::parameter(format!("extent.{field}"), what));
        if !(1..=1_000_000).contains(frames) {
            return wrong("frames", "must lie between 1 and 1 000 000");
        }
        if first_frame.abs() > 1_000_000_000 {
            return wrong("first_frame", "must lie within a billion of 0");
        }
        if rate.check("extent.rate").is_err() {
            return wrong("rate", "must be a positive number of frames in a positive number of seconds");
        }
        if *wrinkle_every == 0 {
            return wrong("wrinkle_every", "must be at least 1: 4 takes every fourth frame");
        }
        if rate.seconds.checked_mul(*wrinkle_every).is_none() {
            return wrong("wrinkle_every", "makes a wrinkle camera's rate too small to write down");
        }
        if wrinkle_phase >= wrinkle_every {
            let what = format!("is {wrinkle_phase}; it must be below wrinkle_every = {wrinkle_every}");
            return wrong("wrinkle_phase", &what);
        }
        if !(*pace > 0.0 && *pace <= 1e3) {
            return wrong("pace", "must be above 0 and at most 1000");
        }
        Ok(())
    }
}

impl Scenario {
    pub(super) fn check_performance(&self) -> Result<(), Error> {
        match &self.performance {
            Performance::Standard => {}
            Performance::Events(timeline) => timeline.check(Performance::EVENTS)?,
            Performance::Recording(clip) => clip.check("performance.recording")?,
        }
        Timeline { events: self.events.clone(), seed: self.seed }.check("events")
    }

    /// Each camera as it stands in the scenario, then at the size of the images.
    pub(super) fn check_cameras(&self) -> Result<(), Error> {
        for (id, camera) in &self.cameras {
            check_id(id)?;
            camera.check(id)?;
        }
        for (id, camera) in self.placements() {
            if camera.check(&id).is_err() {
                let [width, height] = camera.image_size;
                let what = format!(
                    "makes images of {width} × {height} px for camera {id}; from 16 to 16384 px will do"
                );
                return Err(Error::parameter("image_scale", what));
            }
        }
        Ok(())
    }

    /// The flash itself; whether all cameras see it is known once they are scheduled.
    pub(super) fn check_flash(&self) -> Result<(), Error> {
        let Some(flash) = &self.flash else { return Ok(()) };
        flash.check(&Schedule { cameras: Vec::new() }, self.extent.rate, 0.0)?;
        match flash.factor <= BRIGHTEST {
            true => Ok(()),
            false => {
                let what = format!("{} is too bright; at most {BRIGHTEST} will do", flash.factor);
                Err(Error::parameter("flash.factor", what))
            }
        }
    }

    /// Each fault, and what several of a kind add up to at a camera.
    pub(super) fn check_faults(&self) -> Result<(), Error> {
        let ids: Vec<String> = self.placements().into_keys().collect();
        for (number, fault) in self.faults.iter().enumerate() {
            let place = format!("faults[{number}]");
            fault.check(&place)?;
            if let Some(camera) = fault.camera.as_ref().filter(|camera| !ids.contains(camera)) {
                let what = format!("there is no camera {camera}; there are {}", ids.join(", "));
                return Err(Error::parameter(place, what));
            }
            ids.iter()
                .filter(|id| fault.hits(id))
                .try_for_each(|id| self.check_sum(number, fault.kind, id))?;
        }
        ids.iter().try_for_each(|id| {
            self.sensor_of(id).check().map_err(|Error::Parameter { place, what }| {
                Error::parameter(place, format!("with the faults of camera {id} {what}"))
            })
        })
    }

    /// The faults of a kind at a camera, up to the one of this number, taken together.
    fn check_sum(&self, number: usize, kind: FaultKind, camera: &str) -> Result<(), Error> {
        let so_far = &self.faults[..=number];
        let amounts: Vec<f64> = so_far
            .iter()
            .filter(|fault| fault.kind == kind && fault.hits(camera))
            .map(|fault| fault.amount)
            .collect();
        let sum = Fault { kind, amount: amounts.iter().sum(), camera: Some(camera.to_string()) };
        match amounts.len() {
            0 | 1 => Ok(()),
            count => sum.check(&format!("faults[{number}]: {count} of a kind add up at camera {camera}")),
        }
    }
}

/// Ids become names of files and folders.
fn check_id(id: &str) -> Result<(), Error> {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-');
    match (1..=64).contains(&id.len()) && id.chars().all(plain) {
        true => Ok(()),
        false => {
            let what = format!("{id:?} is no id of a camera; use up to 64 letters, digits, _ and -");
            Err(Error::parameter("cameras", what))
        }
    }
}
