//! When each camera films, and with which faults.

use crate::Error;
use crate::clock::{Clock, Entry, Faults, Schedule, Timed, Trigger};
use crate::scenario::FaultKind;
use crate::take::{Role, Station, Studio};
use artifact::{Shown, SyncCamera, SyncSource};
use std::collections::BTreeMap;

/// An image that is taken for a frame of the mocap clock.
#[derive(Debug, Clone)]
pub struct Shot {
    /// The camera's id.
    pub camera: String,
    /// When and as which image of its footage.
    pub entry: Entry,
    /// How often it stands in the footage.
    pub copies: usize,
}

impl Studio {
    /// When each camera films.
    ///
    /// # Errors
    /// Clocks or faults that leave a camera without an image of the take's frames, a flash that a camera misses.
    pub fn schedule(&self) -> Result<Schedule, Error> {
        let extent = &self.scenario.extent;
        let cameras: Vec<Timed> = self.stations.iter().map(|(id, station)| self.timed(id, station)).collect();
        let duration_s = f64::from(extent.frames) / extent.rate.hz();
        let schedule = Schedule::plan(&cameras, extent.rate, duration_s, self.scenario.seed)?;
        self.check_flash(&schedule)?;
        let captured = |entry: &Entry| (0..i64::from(extent.frames)).contains(&entry.mocap_frame);
        match schedule.cameras.iter().find(|(_, entries)| !entries.iter().any(captured)) {
            None => Ok(schedule),
            Some((id, _)) => {
                let last = extent.first_frame + i64::from(extent.frames) - 1;
                let what = format!(
                    "none of its images shows a frame of the take, {} to {last}; lessen its offset, or take more frames",
                    extent.first_frame
                );
                Err(Error::parameter(format!("cameras.{id}"), what))
            }
        }
    }

    /// The absolute number of the frame that an image is filmed with: its own, but cameras may begin earlier and end later
    /// than the motion capture, and such images come with the take's first and last frame.
    ///
    /// `mocap_frame`: counted from the first one.
    #[must_use]
    pub fn filmed_with(&self, mocap_frame: i64) -> i64 {
        let extent = &self.scenario.extent;
        extent.first_frame + mocap_frame.clamp(0, i64::from(extent.frames) - 1)
    }

    fn timed(&self, id: &str, station: &Station) -> Timed {
        let extent = &self.scenario.extent;
        let fault = |kind| self.scenario.fault(kind, id);
        let (offset, drift) = (fault(FaultKind::Offset), fault(FaultKind::Drift));
        let (every, phase) = match station.role {
            Role::Mocap => (1, 0),
            Role::Wrinkle => (extent.wrinkle_every, extent.wrinkle_phase),
        };
        let frame_s = f64::from(every) / extent.rate.hz();
        let clock = Clock {
            trigger: if offset.is_some() || drift.is_some() { Trigger::Own } else { Trigger::Shared },
            every,
            phase,
            offset_s: offset.unwrap_or(0.0) * frame_s,
            drift_ppm: drift.unwrap_or(0.0),
            ..Clock::default()
        };
        let faults = Faults {
            drop_share: fault(FaultKind::Dropped).unwrap_or(0.0),
            double_share: fault(FaultKind::Doubled).unwrap_or(0.0),
            ..Faults::default()
        };
        Timed { id: id.to_string(), clock, faults }
    }
}

/// The images of each frame of the mocap clock (counted from the first one), cameras in order, at most one image of each.
/// Frames below 0 or from `frames` on are images of times when nothing was captured.
#[must_use]
pub fn shots_by_frame(schedule: &Schedule, frames: u32) -> BTreeMap<i64, Vec<Shot>> {
    let mut shots: BTreeMap<i64, Vec<Shot>> =
        (0..i64::from(frames)).map(|frame| (frame, Vec::new())).collect();
    for (camera, entries) in &schedule.cameras {
        for entry in entries {
            let of_frame = shots.entry(entry.mocap_frame).or_default();
            match of_frame.last_mut().filter(|shot| entry.is_double && shot.camera == *camera) {
                Some(shot) => shot.copies += 1,
                None => of_frame.push(Shot { camera: camera.clone(), entry: *entry, copies: 1 }),
            }
        }
    }
    shots
}

impl Studio {
    /// How a camera's clock stands to the mocap clock, as `sync` says it.
    #[must_use]
    pub fn sync_of(&self, id: &str, station: &Station) -> SyncCamera {
        let extent = &self.scenario.extent;
        let clock = self.timed(id, station).clock;
        let rate = extent.rate;
        let late_frames = clock.late_frames(rate.hz());
        // What its clock has lost when the first exposure is due, which need not be at 0.
        let lost = 1e-6 * clock.drift_ppm * f64::from(clock.phase);
        SyncCamera {
            rate: artifact::Rate { frames: rate.frames, seconds: rate.seconds * clock.every },
            every: clock.every,
            phase: extent.first_frame + i64::from(clock.phase) + late_frames,
            offset_frames: clock.offset_s * rate.hz() - late_frames as f64 + lost,
            drift_ppm: clock.drift_ppm,
            source: SyncSource::Stated,
        }
    }
}

impl Shot {
    /// The image as `sync` names it. Where it stands twice in the footage, the first copy is the image; the second has a
    /// number that no frame shows.
    #[must_use]
    pub fn shown(&self) -> Shown {
        Shown { index: self.entry.index as i64, time_s: Some(self.entry.stamp_s), doubled: false }
    }
}
