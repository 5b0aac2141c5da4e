//! From recordings to a time base.

use crate::cadence::Cadence;
use crate::time_base::{self, Synchronized, TakeClock};
use crate::timeline::{Loss, Paced, Timeline};
use crate::{Error, Mode, Params, Recording, correlation, extent, flash, stamps};
use artifact::{SyncFrame, SyncHeader, SyncSource};
use serde::Serialize;

/// What was found of a camera.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CameraReport {
    /// Images that belong to the take.
    pub images: usize,
    /// Exposures that no image shows, between its first image and its last.
    pub dropped: i64,
    /// Images that only repeat the one before them.
    pub doubled: usize,
    /// Mocap frames, within the take, that it should show and does not.
    pub missing: usize,
    /// How much later than the mocap frames it takes its images, mocap frames, at the first of them.
    pub offset_frames: f64,
    /// How much that grows, ppm.
    pub drift_ppm: f64,
    /// Standard deviation of the offset, or of the stamps about their line, mocap frames.
    pub sigma_frames: Option<f64>,
    /// Those of the dropped images of which only motion told, and where.
    pub losses: Vec<Loss>,
}

/// Finds the time base of a take's cameras.
///
/// Images before a camera's `first` do not belong to the take. Two steps: the *cadence* of each camera says which exposure
/// each image is, so that dropped images leave a gap and doubled ones none; then a line through its exposures says when they
/// were. `recordings` need time stamps or readings of their images, as the mode asks.
///
/// # Errors
/// Names the camera: without images, stamps or readings; with a rate that is not the stated one; with stamps of another unit
/// or clock; with so few images of a time so long that they tell nothing; without a flash or anything
/// that moves as it does elsewhere.
pub fn synchronize(
    clock: &TakeClock,
    recordings: &[Recording],
    params: &Params,
) -> Result<Synchronized, Error> {
    params.check()?;
    let recordings: Vec<Recording> = recordings.iter().map(of_take).collect();
    if recordings.is_empty() {
        return Err(Error::NoCameras);
    }
    if let Some(empty) = recordings.iter().find(|recording| recording.images.is_empty()) {
        return Err(Error::NoImages(empty.id.clone()));
    }
    if let Some(id) = params.late.keys().find(|id| !recordings.iter().any(|recording| recording.id == **id)) {
        return Err(Error::NoSuchCamera(id.clone()));
    }
    extent::check_rates(clock, &recordings, params.use_stamps)?;
    let mut cameras: Vec<Paced> = recordings
        .iter()
        .map(|recording| Paced {
            recording,
            cadence: Cadence::of(recording, params.use_stamps),
            is_stamped: params.use_stamps && recording.is_stamped(),
            losses: Vec::new(),
        })
        .collect();
    cameras.iter().try_for_each(extent::check_cadence)?;
    let (mut lines, zero_s) = timelines(&mut cameras, clock, params)?;
    for (camera, line) in cameras.iter().zip(&mut lines) {
        line.start += params.late.get(camera.id()).copied().unwrap_or(0.0);
    }
    let sync = cameras
        .iter()
        .zip(&lines)
        .map(|(camera, line)| (camera.id().to_string(), time_base::sync_camera(camera, line, clock)));
    let header = SyncHeader { rate: clock.rate, clock: clock.clock, cameras: sync.collect(), take: None };
    let frames = time_base::frames(&cameras, &lines, &header, clock)?;
    let report = |(camera, line): (&Paced, &Timeline)| {
        (camera.id().to_string(), camera_report(camera, line, &header, &frames))
    };
    let report = cameras.iter().zip(&lines).map(report).collect();
    Ok(Synchronized { header, frames, report, zero_s })
}

fn camera_report(camera: &Paced, line: &Timeline, header: &SyncHeader, frames: &[SyncFrame]) -> CameraReport {
    let sync = &header.cameras[camera.id()];
    CameraReport {
        images: camera.recording.images.len(),
        dropped: camera.cadence.dropped(),
        doubled: camera.cadence.doubled(),
        missing: frames.iter().filter(|frame| frame.shows.get(camera.id()) == Some(&None)).count(),
        offset_frames: sync.offset_frames,
        drift_ppm: sync.drift_ppm,
        sigma_frames: line.sigma_frames,
        losses: camera.losses.clone(),
    }
}

fn of_take(recording: &Recording) -> Recording {
    let images = recording.images.iter().filter(|image| image.index >= recording.first).cloned().collect();
    Recording { images, ..recording.clone() }
}

fn timelines(
    cameras: &mut [Paced],
    clock: &TakeClock,
    params: &Params,
) -> Result<(Vec<Timeline>, Option<f64>), Error> {
    let stated: Vec<Timeline> =
        cameras.iter().map(|camera| Timeline::stated(camera.recording, clock.rate)).collect();
    match params.mode {
        Mode::Stated => Ok((stated, None)),
        Mode::Timestamps => {
            let (lines, zero) = stamps::timelines(cameras, clock.rate, params)?;
            Ok((lines, Some(zero)))
        }
        Mode::Flash => {
            let coarse = flash::timelines(cameras, clock.rate, params)?;
            let guess: Vec<(f64, f64)> =
                coarse.iter().map(|(line, within)| (line.start, within + 1.0)).collect();
            let fine = correlation::timelines(cameras, &guess, clock.rate, params, SyncSource::Flash);
            // Where nothing moves, the flash alone must do.
            let mut lines = match fine {
                Err(Error::NoCorrelation { .. }) => coarse.into_iter().map(|(line, _)| line).collect(),
                other => other?,
            };
            correlation::settle(&mut lines, cameras, clock.rate);
            Ok((lines, None))
        }
        Mode::Correlation => {
            let guess: Vec<(f64, f64)> =
                stated.iter().map(|line| (line.start, params.search_s * clock.rate.hz())).collect();
            let mut lines =
                correlation::timelines(cameras, &guess, clock.rate, params, SyncSource::Correlation)?;
            correlation::settle(&mut lines, cameras, clock.rate);
            Ok((lines, None))
        }
    }
}
