//! Laws of time bases, on synthetic cameras with known clocks.
#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use artifact::{Clock, Rate, SyncFrame};
use capture_sync::{
    CELL_COUNT, Error, Image, Mode, Params, Reading, Recording, TakeClock, skews, synchronize,
};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

const FIRST: i64 = 1001;

fn clock() -> TakeClock {
    TakeClock { rate: Rate::per_second(50), first_frame: FIRST, clock: Clock::Free }
}

/// A camera with a known clock: exposure n at the mocap time `start + every · (1 + drift) · n`.
#[derive(Clone)]
struct Camera {
    id: &'static str,
    every: u32,
    start: f64,
    drift_ppm: f64,
    jitter_s: f64,
    dropped: Vec<i64>,
    doubled: Vec<i64>,
}

impl Camera {
    fn new(id: &'static str, every: u32, start: f64, drift_ppm: f64) -> Self {
        Self { id, every, start, drift_ppm, jitter_s: 0.0, dropped: vec![], doubled: vec![] }
    }

    fn time(&self, n: i64) -> f64 {
        self.start + f64::from(self.every) * (1.0 + 1e-6 * self.drift_ppm) * n as f64
    }

    /// Where an exposure first stands in its footage.
    fn index(&self, n: i64) -> i64 {
        let before = |some: &[i64]| some.iter().filter(|other| **other < n).count() as i64;
        n - before(&self.dropped) + before(&self.doubled)
    }

    /// Its footage of so many mocap frames: stamps by the common clock, and readings of a moving thing.
    fn film(&self, frames: i64, pictures: bool, seed: u64) -> Recording {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let view: Vec<[f64; 3]> =
            (0..CELL_COUNT).map(|_| std::array::from_fn(|_| rng.random_range(-1.0..1.0))).collect();
        let mut images = Vec::new();
        for n in 0..frames / i64::from(self.every) {
            let jitter = self.jitter_s * rng.random_range(-1.0..1.0);
            let noise: Vec<f64> = (0..CELL_COUNT).map(|_| rng.random_range(-2e-3..2e-3)).collect();
            if self.dropped.contains(&n) {
                continue;
            }
            let moved = motion(self.time(n) / 50.0);
            let cells = view.iter().zip(&noise).map(|(view, noise)| {
                (0.4 + 0.02 * view.iter().zip(moved).map(|(a, b)| a * b).sum::<f64>() + noise) as f32
            });
            let reading =
                pictures.then(|| Reading { light: 0.2, cells: cells.collect(), fingerprint: n as u64 });
            let time_s = Some(self.time(n) / 50.0 + jitter);
            for _ in 0..=usize::from(self.doubled.contains(&n)) {
                images.push(Image { index: images.len() as i64, time_s, reading: reading.clone() });
            }
        }
        Recording { id: self.id.into(), rate: Rate { frames: 50, seconds: self.every }, first: 0, images }
    }
}

/// Three things that move, below 6 Hz.
fn motion(t: f64) -> [f64; 3] {
    let wave = |k: f64| {
        (t * (2.1 + k)).sin()
            + 0.7 * (t * (9.7 + 1.3 * k) + k).sin() * (0.31 * t + k).sin()
            + 0.3 * (31.0 * t + k).sin()
    };
    [wave(0.0), wave(1.7), wave(3.1)]
}

fn params(mode: Mode) -> Params {
    Params { mode, ..Params::default() }
}

/// Drops and doubles that are not where they were planted, cameras in order: (missed, invented).
fn faults(cameras: &[Camera], frames: &[SyncFrame]) -> (usize, usize) {
    let (mut missed, mut invented) = (0, 0);
    for camera in cameras {
        for frame in frames {
            let Some(shown) = frame.shows.get(camera.id) else { continue };
            let n = (((frame.frame - FIRST) as f64 - camera.start)
                / f64::from(camera.every)
                / (1.0 + 1e-6 * camera.drift_ppm))
                .round() as i64;
            // Where two images are nearly as near, or a slow clock has none within half a frame, a hair decides.
            let lag = (camera.time(n) - (frame.frame - FIRST) as f64).abs() / f64::from(camera.every);
            if lag > 0.45 {
                continue;
            }
            let is_gap = camera.dropped.contains(&n) || n < 0;
            missed += usize::from(is_gap && shown.is_some());
            invented += usize::from(!is_gap && shown.is_none_or(|shown| shown.doubled));
            // Of an image that stands twice the first counts; the second one is nobody's.
            missed += usize::from(!is_gap && shown.is_some_and(|shown| shown.index != camera.index(n)));
        }
    }
    (missed, invented)
}

/// Ten minutes with everything that goes wrong.
fn ten_minutes() -> Vec<Camera> {
    let mut cameras = vec![
        Camera::new("m1", 1, 0.0, 0.0),
        Camera::new("m2", 1, 0.0, 0.0),
        Camera::new("m3", 1, 0.0, 0.0),
        Camera::new("m4", 1, 2.3, 0.0),
        Camera::new("m5", 1, 0.1, 120.0),
        Camera::new("w1", 4, 1.2, -60.0),
    ];
    cameras[1].dropped = (1..29_000).step_by(173).collect();
    cameras[2].doubled = (5..29_000).step_by(211).collect();
    cameras[4].dropped = vec![100, 101, 102, 103, 15_000];
    cameras[5].dropped = vec![7, 4000];
    cameras
}

/// The error of a camera's times, mocap frames and ppm, after what all have in common (the first camera is in step).
fn clock_errors(cameras: &[Camera], found: &capture_sync::Synchronized) -> (f64, f64) {
    let (mut offset, mut drift) = (0.0_f64, 0.0_f64);
    for camera in cameras {
        let sync = &found.header.cameras[camera.id];
        drift = drift.max((sync.drift_ppm - camera.drift_ppm).abs());
        for frame in
            found.frames.iter().filter(|frame| frame.shows.get(camera.id).is_some_and(Option::is_some))
        {
            let late = camera.start + 1e-6 * camera.drift_ppm * (frame.frame - FIRST) as f64;
            let every = f64::from(camera.every);
            let error = late - (sync.phase - FIRST) as f64 - sync.lag_frames(frame.frame);
            offset = offset.max((error - every * (error / every).round()).abs());
        }
    }
    (offset, drift)
}

#[test]
fn ten_minutes_of_jittered_stamps_give_offset_and_drift_and_every_gap() {
    let mut cameras = ten_minutes();
    cameras.iter_mut().for_each(|camera| camera.jitter_s = 0.003);
    let recordings: Vec<Recording> =
        (1..).zip(&cameras).map(|(seed, camera)| camera.film(30_000, false, seed)).collect();
    let found = synchronize(&clock(), &recordings, &params(Mode::Timestamps)).unwrap();
    let (offset, drift) = clock_errors(&cameras, &found);
    assert!(offset < 0.02 && drift < 1.0, "{offset} frames, {drift} ppm");
    assert_eq!(faults(&cameras, &found.frames[..29_990]), (0, 0));
}

#[test]
fn ten_minutes_of_motion_give_offset_and_drift() {
    let cameras = ten_minutes();
    let recordings: Vec<Recording> =
        (1..).zip(&cameras).map(|(seed, camera)| camera.film(30_000, true, seed)).collect();
    let found = synchronize(&clock(), &recordings, &params(Mode::Correlation)).unwrap();
    let (offset, drift) = clock_errors(&cameras, &found);
    assert!(offset < 0.1 && drift < 5.0, "{offset} frames, {drift} ppm");
    assert_eq!(faults(&cameras, &found.frames[..29_990]), (0, 0));
}

/// Shifting all clocks alike changes nothing.
#[test]
fn a_shift_of_all_clocks_changes_nothing() {
    let cameras =
        [Camera::new("m1", 1, 0.0, 0.0), Camera::new("m2", 1, 0.4, 30.0), Camera::new("w1", 4, 2.0, 0.0)];
    let shifted = |shift: f64| {
        let film = |camera: &Camera| {
            let mut recording = camera.film(400, false, 1);
            recording
                .images
                .iter_mut()
                .for_each(|image| image.time_s = image.time_s.map(|time| time + shift));
            recording
        };
        let recordings: Vec<Recording> = cameras.iter().map(film).collect();
        synchronize(&clock(), &recordings, &params(Mode::Timestamps)).unwrap()
    };
    let (here, there) = (shifted(100.0), shifted(48_033.0));
    for (id, camera) in &here.header.cameras {
        let other = &there.header.cameras[id];
        assert!((camera.offset_frames - other.offset_frames).abs() < 1e-6);
        assert!((camera.drift_ppm - other.drift_ppm).abs() < 1e-3 && camera.phase == other.phase);
    }
    let images = |frames: &[SyncFrame]| -> Vec<Vec<Option<i64>>> {
        frames
            .iter()
            .map(|frame| frame.shows.values().map(|shown| shown.map(|shown| shown.index)).collect())
            .collect()
    };
    assert_eq!(images(&here.frames), images(&there.frames));
}

#[test]
fn a_single_stamped_image_stands_where_its_stamp_says() {
    let (first, mut second) =
        (Camera::new("m1", 1, 0.0, 0.0), Camera::new("w1", 4, 2.0, 0.0).film(4, false, 2));
    let found = |second: &Recording| {
        synchronize(&clock(), &[first.film(6, false, 1), second.clone()], &params(Mode::Timestamps)).unwrap()
    };
    let shows = |second: &Recording| -> Vec<i64> {
        let shown = |frame: &SyncFrame| frame.shows.get("w1").copied().flatten().is_some();
        found(second).frames.iter().filter(|frame| shown(frame)).map(|frame| frame.frame).collect()
    };
    assert_eq!(second.images.len(), 1);
    assert_eq!(shows(&second), [FIRST + 2]);
    let clock = &found(&second).header.cameras["w1"];
    assert_eq!((clock.phase, clock.offset_frames), (FIRST + 2, 0.0));
    second.images[0].time_s = Some(0.085);
    assert_eq!(shows(&second), [FIRST + 4]);
    assert!((found(&second).header.cameras["w1"].offset_frames - 0.25).abs() < 1e-9);
}

#[test]
fn a_late_stamp_is_no_drop() {
    let mut recording = Camera::new("m1", 1, 0.0, 0.0).film(200, false, 1);
    // Delivered late, then in time again.
    recording.images[50].time_s = Some(50.7 / 50.0);
    let found = synchronize(&clock(), &[recording], &params(Mode::Timestamps)).unwrap();
    assert!(found.frames.iter().all(|frame| frame.shows["m1"].is_some()));
}

/// 30 Hz beside 50 Hz: every image is shown once, by the frame nearest to it.
#[test]
fn a_ratio_that_is_not_whole_shows_each_image_once() {
    let mut other = Camera::new("b", 1, 0.0, 0.0).film(120, false, 1);
    other.rate = Rate { frames: 30_000, seconds: 1001 };
    other.images.iter_mut().for_each(|image| image.time_s = Some(image.index as f64 * 1001.0 / 30_000.0));
    let found = synchronize(
        &clock(),
        &[Camera::new("a", 1, 0.0, 0.0).film(200, false, 1), other],
        &params(Mode::Timestamps),
    )
    .unwrap();
    let shown: Vec<i64> = found.frames.iter().filter_map(|frame| Some(frame.shows["b"]?.index)).collect();
    assert_eq!(shown, (0..120).collect::<Vec<_>>());
}

#[test]
fn an_image_in_the_place_of_a_lost_one_shows_nothing() {
    let mut recording = Camera::new("m1", 1, 0.0, 0.0).film(100, true, 1);
    recording.images[40].reading = recording.images[39].reading.clone();
    let found = synchronize(&clock(), &[recording], &params(Mode::Timestamps)).unwrap();
    assert_eq!(found.frames[40].shows["m1"], None);
    assert_eq!(found.frames[41].shows["m1"].unwrap().index, 41);
}

#[test]
fn a_flash_lines_up_still_cameras() {
    let film = |id: &'static str, late: usize| {
        let mut recording = Camera::new(id, 1, 0.0, 0.0).film(100, true, 1);
        for (i, image) in recording.images.iter_mut().enumerate() {
            let reading = image.reading.as_mut().unwrap();
            reading.cells.fill(0.3);
            reading.light =
                if (30 + late..33 + late).contains(&i) { 0.5 } else { 0.2 + 1e-4 * (i % 3) as f64 };
        }
        recording
    };
    let recordings = [film("a", 0), film("b", 0), film("c", 2)];
    let found = synchronize(&clock(), &recordings, &params(Mode::Flash)).unwrap();
    assert_eq!(found.frames[10].shows["a"].unwrap().index, 10);
    assert_eq!(found.frames[10].shows["c"].unwrap().index, 12, "c was started two frames before the others");
    let mut dark = recordings;
    dark[1].images.iter_mut().for_each(|image| image.reading.as_mut().unwrap().light = 0.2);
    assert_eq!(synchronize(&clock(), &dark, &params(Mode::Flash)), Err(Error::NoFlash("b".into())));
}

#[test]
fn what_cannot_be_correlated_is_refused() {
    let a = Camera::new("a", 1, 0.0, 0.0).film(600, true, 1);
    let mut b = Camera::new("b", 1, 0.0, 0.0).film(600, true, 2);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for image in &mut b.images {
        image.reading.as_mut().unwrap().cells.iter_mut().for_each(|cell| *cell = rng.random());
    }
    let error = synchronize(&clock(), &[a, b], &params(Mode::Correlation)).err();
    assert!(matches!(&error, Some(Error::NoCorrelation { .. })), "{error:?}");
}

#[test]
fn skew_is_lag_in_ms_and_mm() {
    let cameras =
        [Camera::new("m1", 1, 0.0, 0.0), Camera::new("m2", 1, 0.0, 0.0), Camera::new("m3", 1, 0.25, 0.0)];
    let recordings: Vec<Recording> = cameras.iter().map(|camera| camera.film(100, false, 1)).collect();
    let found = synchronize(&clock(), &recordings, &params(Mode::Timestamps)).unwrap();
    let skews = skews(&found.header, &found.frames, Some(200.0));
    assert!((skews["m3"].mean_ms - 5.0).abs() < 1e-2 && (skews["m3"].mean_mm.unwrap() - 1.0).abs() < 1e-2);
    assert!(skews["m1"].worst_ms.abs() < 1e-3);
}

/// Frames that show another image than they should, further than `near` exposures from where images were lost.
fn shifted(cameras: &[Camera], frames: &[SyncFrame], near: i64) -> usize {
    let is_shifted = |camera: &Camera, frame: &SyncFrame| {
        let n = frame.frame - FIRST;
        let is_near = camera.dropped.iter().any(|lost| (n - lost).abs() <= near);
        frame.shows[camera.id].map(|shown| shown.index) != Some(camera.index(n)) && !is_near
    };
    cameras.iter().map(|camera| frames.iter().filter(|frame| is_shifted(camera, frame)).count()).sum()
}

/// Lost images of which neither stamps nor numbers tell leave gaps: motion tells.
#[test]
fn images_lost_without_a_trace_leave_gaps() {
    let params = Params { use_stamps: false, ..params(Mode::Correlation) };
    let mut cameras =
        [Camera::new("m1", 1, 0.0, 0.0), Camera::new("m2", 1, 0.0, 0.0), Camera::new("m3", 1, 0.0, 0.0)];
    let film = |cameras: &[Camera]| -> Vec<Recording> {
        (1..).zip(cameras).map(|(seed, camera)| camera.film(1500, true, seed)).collect()
    };
    let whole = synchronize(&clock(), &film(&cameras), &params).unwrap();
    assert!(whole.report.values().all(|camera| camera.losses.is_empty()), "none is invented");
    cameras[1].dropped = [(600..612).collect::<Vec<_>>(), vec![900]].concat();
    cameras[2].dropped = vec![400, 1300];
    let found = synchronize(&clock(), &film(&cameras), &params).unwrap();
    assert_eq!(found.report["m1"].dropped, 0);
    assert_eq!((found.report["m2"].dropped, found.report["m2"].losses.len()), (13, 2));
    assert_eq!((found.report["m3"].dropped, found.report["m3"].losses.len()), (2, 2));
    assert_eq!(shifted(&cameras, &found.frames[..1490], 3), 0);

    // Of two cameras each may be the one that lost images; the way in which the lag jumps tells.
    let mut pair = [cameras[0].clone(), cameras[2].clone()];
    pair[0].dropped = vec![200, 201];
    let found = synchronize(&clock(), &film(&pair), &params).unwrap();
    assert_eq!((found.report["m1"].dropped, found.report["m3"].dropped), (2, 2));
    assert_eq!(shifted(&pair, &found.frames[..1490], 3), 0);
}

/// An image that repeats the one before it is a copy, or stands for one that was lost: motion tells which.
#[test]
fn motion_tells_copies_from_stale_images() {
    let params = Params { use_stamps: false, ..params(Mode::Correlation) };
    let mut cameras =
        [Camera::new("m1", 1, 0.0, 0.0), Camera::new("m2", 1, 0.0, 0.0), Camera::new("m3", 1, 0.0, 0.0)];
    cameras[1].doubled = vec![500];
    let mut recordings: Vec<Recording> =
        (1..).zip(&cameras).map(|(seed, camera)| camera.film(1000, true, seed)).collect();
    recordings[2].images[700].reading = recordings[2].images[699].reading.clone();
    let found = synchronize(&clock(), &recordings, &params).unwrap();
    assert_eq!(found.report["m2"].losses, []);
    assert!(found.report["m3"].losses.iter().map(|loss| (loss.before_image, loss.images)).eq([(700, 1)]));
    assert_eq!(found.frames[700].shows["m3"], None);
    assert_eq!(found.frames[701].shows["m3"].unwrap().index, 701);
    assert_eq!(found.frames[501].shows["m2"].unwrap().index, 502);
}

fn stamped(id: &'static str, change: impl Fn(usize, f64) -> f64) -> Recording {
    let mut recording = Camera::new(id, 1, 0.0, 0.0).film(60, false, 1);
    for (i, image) in recording.images.iter_mut().enumerate() {
        image.time_s = image.time_s.map(|time| change(i, time));
    }
    recording
}

/// Stamps of another unit, of another clock or that jump: neither a frame for each millisecond, nor memory for it.
#[test]
fn stamps_that_cannot_be_are_refused_before_frames_are_made() {
    let refused = |change: &dyn Fn(usize, f64) -> f64| {
        let recordings = [stamped("a", |_, time| time), stamped("b", change)];
        synchronize(&clock(), &recordings, &params(Mode::Timestamps)).unwrap_err()
    };
    for change in [&(|_, time| 1e3 * time) as &dyn Fn(usize, f64) -> f64, &|_, _| 5.0, &|_, time| 0.1 * time]
    {
        let error = refused(change);
        assert!(matches!(&error, Error::Period { camera, .. } if camera == "b"), "{error}");
    }
    let error = refused(&|_, time| time + 3600.0);
    assert!(
        matches!(&error, Error::NoCommonTime { early, late, .. } if early == "a" && late == "b"),
        "{error}"
    );
    let error = refused(&|i, time| if i < 30 { time } else { time + 1e6 });
    assert!(matches!(&error, Error::Gap { before_image: 30, .. }), "{error}");
    let error = refused(&|i, time| if i < 59 { time } else { 1e300 });
    assert!(matches!(&error, Error::Gap { before_image: 59, .. }), "{error}");
}

#[test]
fn takes_that_cannot_be_are_refused() {
    let refused = |clock: TakeClock, seconds: u32| {
        let mut recording = Camera::new("a", 1, 0.0, 0.0).film(60, false, 1);
        recording.rate = Rate { frames: 1, seconds };
        synchronize(&clock, &[recording], &Params { use_stamps: false, ..params(Mode::Stated) }).unwrap_err()
    };
    let rate = Rate { frames: u32::MAX, seconds: 1 };
    assert_eq!(refused(TakeClock { rate, ..clock() }, 1), Error::TakeRate(rate));
    assert_eq!(refused(TakeClock { first_frame: i64::MAX, ..clock() }, 1), Error::FirstFrame(i64::MAX));
    let error = refused(clock(), 1_000_000);
    assert!(matches!(&error, Error::TooLong { images: 60, .. }), "{error}");
}

/// What is known from elsewhere is added: the camera then shows later frames, and its part of a frame is said.
#[test]
fn a_camera_that_is_known_to_be_late_shows_later_frames() {
    let recordings = [stamped("a", |_, time| time), stamped("b", |_, time| time)];
    for mode in [Mode::Stated, Mode::Timestamps] {
        let late = |id: &str| Params { late: [(id.to_string(), 2.3)].into(), ..params(mode) };
        let found = synchronize(&clock(), &recordings, &late("b")).unwrap();
        assert!((found.header.cameras["b"].offset_frames - 0.3).abs() < 1e-6);
        assert_eq!(found.frames[1].shows["b"], None, "it was not there yet");
        assert_eq!(
            (found.frames[12].shows["a"].unwrap().index, found.frames[12].shows["b"].unwrap().index),
            (12, 10)
        );
        let error = synchronize(&clock(), &recordings, &late("c")).unwrap_err();
        assert_eq!(error, Error::NoSuchCamera("c".into()));
    }
}

#[test]
fn a_short_take_says_how_many_images_correlation_needs() {
    let film = |id| Camera::new(id, 1, 0.0, 0.0).film(25, true, 1);
    let error = synchronize(&clock(), &[film("a"), film("b")], &params(Mode::Correlation)).unwrap_err();
    assert!(error.to_string().contains("60 at least are needed"), "{error}");
}
