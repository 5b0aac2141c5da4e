//! How long a take may be: what stamps, numbers and rates claim is bounded before anything is allocated by it.

use crate::stamps;
use crate::timeline::{Paced, Timeline, stated_step};
use crate::{Error, Recording, TakeClock};

/// So many exposures or frames for each image are believed: a camera that lost more tells nothing.
const MOST_PER_IMAGE: f64 = 20.0;
/// So many are no burden, however few images there are.
const FREE: f64 = 1000.0;
/// A camera shows every so manyth frame at least.
const SLOWEST: f64 = 100.0;
/// No clock is faster, Hz.
const FASTEST_HZ: f64 = 1e5;
/// No take starts at a higher number.
const MOST_FIRST: u64 = 1_000_000_000_000;
/// A step between stamps that is longer or shorter than the period by this factor is none.
const FAR: f64 = 4.0;

/// Refuses rates that no camera has, and stamps that come at quite another one.
pub(crate) fn check_rates(
    clock: &TakeClock,
    recordings: &[Recording],
    uses_stamps: bool,
) -> Result<(), Error> {
    if clock.rate.hz() > FASTEST_HZ {
        return Err(Error::TakeRate(clock.rate));
    }
    if clock.first_frame.unsigned_abs() > MOST_FIRST {
        return Err(Error::FirstFrame(clock.first_frame));
    }
    for recording in recordings.iter().filter(|recording| uses_stamps && recording.is_stamped()) {
        if let Some(step_s) = stamps::typical_step_s(recording) {
            let periods = step_s * recording.rate.hz();
            if !(1.0 / FAR..=FAR).contains(&periods) {
                let (camera, stated) = (recording.id.clone(), recording.rate);
                return Err(Error::Period { camera, step_s, stated });
            }
        }
    }
    Ok(())
}

/// Refuses a camera that lost nearly all its images.
pub(crate) fn check_cadence(camera: &Paced) -> Result<(), Error> {
    let exposures = &camera.cadence.exposures;
    let most = FREE + MOST_PER_IMAGE * exposures.len() as f64;
    let gaps = (1..exposures.len()).map(|i| (exposures[i] - exposures[i - 1] - 1, i));
    match (exposures.last(), gaps.max()) {
        (Some(last), Some((lost, at))) if *last as f64 > most => Err(Error::Gap {
            camera: camera.id().to_string(),
            lost,
            before_image: camera.recording.images[at].index,
        }),
        _ => Ok(()),
    }
}

/// Refuses a take of many more frames than its images can show; `last`: of each camera, the mocap frame that its last image
/// shows.
pub(crate) fn check_frames(
    cameras: &[Paced],
    lines: &[Timeline],
    clock: &TakeClock,
    last: i64,
) -> Result<(), Error> {
    let images = |camera: &Paced| {
        camera.recording.images.len() as f64 * stated_step(camera.recording, clock.rate).min(SLOWEST)
    };
    let most = FREE + MOST_PER_IMAGE * cameras.iter().map(images).fold(0.0, f64::max);
    if last as f64 <= most {
        return Ok(());
    }
    let end = |c: &usize| lines[*c].at(cameras[*c].cadence.exposures.last().copied().unwrap_or(0) as f64);
    let camera = (0..cameras.len()).max_by(|a, b| end(a).total_cmp(&end(b))).map(|c| &cameras[c]);
    Err(Error::TooLong {
        camera: camera.map(|camera| camera.id().to_string()).unwrap_or_default(),
        images: camera.map_or(0, |camera| camera.recording.images.len()),
        frames: last.saturating_add(1),
    })
}
