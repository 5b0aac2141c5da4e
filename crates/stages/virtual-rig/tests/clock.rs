//! Laws of when frames are taken, and of what goes wrong with them.
#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

use artifact::Rate;
use proptest::prelude::*;
use virtual_rig::clock::{Clock, Entry, Faults, Flash, Schedule, Timed, Trigger, time_stamps_csv};

fn camera(id: &str, clock: Clock, faults: Faults) -> Timed {
    Timed { id: id.into(), clock, faults }
}

fn plan_one(clock: Clock, faults: Faults, rate: Rate, duration_s: f64, seed: u64) -> Vec<Entry> {
    let mut schedule = Schedule::plan(&[camera("m1", clock, faults)], rate, duration_s, seed).unwrap();
    schedule.cameras.remove(0).1
}

/// One camera at 50 Hz for 2 s.
fn plan(clock: Clock, faults: Faults) -> Vec<Entry> {
    plan_one(clock, faults, Rate::per_second(50), 2.0, 1)
}

#[test]
fn without_faults_frame_n_is_at_n_over_rate() {
    for rate in [Rate::per_second(50), Rate { frames: 30000, seconds: 1001 }, Rate { frames: 25, seconds: 2 }]
    {
        let entries = plan_one(Clock::default(), Faults::default(), rate, 10.0, 1);
        assert_eq!(entries.len(), (10.0 * rate.hz()).ceil() as usize, "{rate}");
        for (n, entry) in entries.iter().enumerate() {
            let time_s = n as f64 * f64::from(rate.seconds) / f64::from(rate.frames);
            assert_eq!((entry.index, entry.exposure, entry.mocap_frame), (n, n as i64, n as i64));
            assert_eq!((entry.time_s, entry.stamp_s, entry.is_double), (time_s, time_s, false));
        }
    }
}

#[test]
fn a_duration_of_so_many_frames_holds_so_many() {
    for frames in 1..200 {
        let duration_s = f64::from(frames) / 50.0;
        let entries = plan_one(Clock::default(), Faults::default(), Rate::per_second(50), duration_s, 1);
        assert_eq!(entries.len(), frames as usize);
    }
}

#[test]
fn wrinkle_cameras_take_every_fourth_frame() {
    let clock = Clock { every: 4, phase: 1, ..Clock::default() };
    let entries = plan(clock, Faults::default());
    let frames: Vec<i64> = entries.iter().map(|entry| entry.mocap_frame).collect();
    assert_eq!(frames, (0..25).map(|n| 4 * n + 1).collect::<Vec<_>>());
    assert!(entries.iter().all(|entry| entry.time_s == entry.mocap_frame as f64 / 50.0));
    // 7 pictures beside 25 frames, as in the short scenarios.
    let short =
        plan_one(Clock { every: 4, ..Clock::default() }, Faults::default(), Rate::per_second(50), 0.5, 1);
    assert_eq!(short.len(), 7);
}

#[test]
fn a_dropped_picture_moves_the_later_ones_forward() {
    let entries = plan(Clock::default(), Faults { dropped: vec![10, 11, 40], ..Faults::default() });
    assert_eq!(entries.len(), 97);
    assert_eq!((entries[9].mocap_frame, entries[10].mocap_frame), (9, 12));
    assert_eq!((entries[37].mocap_frame, entries[38].mocap_frame), (39, 41));
    assert!(entries.iter().enumerate().all(|(index, entry)| entry.index == index));
    assert_eq!(entries[10].stamp_s, 12.0 / 50.0, "the stamps show the gap");
}

#[test]
fn a_doubled_picture_moves_the_later_ones_back() {
    let entries = plan(Clock::default(), Faults { doubled: vec![10], ..Faults::default() });
    assert_eq!(entries.len(), 101);
    let shown: Vec<(i64, bool)> =
        entries[9..13].iter().map(|entry| (entry.mocap_frame, entry.is_double)).collect();
    assert_eq!(shown, [(9, false), (10, false), (10, true), (11, false)]);
    assert_eq!((entries[11].time_s, entries[11].stamp_s), (entries[10].time_s, entries[10].stamp_s));
    // A picture that stands in for a lost one leaves the count as it is.
    let entries =
        plan(Clock::default(), Faults { doubled: vec![10], dropped: vec![11], ..Faults::default() });
    assert_eq!((entries.len(), entries[11].is_double, entries[12].mocap_frame), (100, true, 12));
}

#[test]
fn a_late_start_lacks_the_first_exposures_and_an_early_one_has_more() {
    let late = |late_start| plan(Clock::default(), Faults { late_start, ..Faults::default() });
    assert_eq!((late(7).len(), late(7)[0].mocap_frame, late(7)[0].stamp_s), (93, 7, 0.14));
    assert_eq!((late(-3).len(), late(-3)[0].mocap_frame, late(-3)[0].time_s), (103, -3, -0.06));
    let clock = Clock { stamps_from_first: true, ..Clock::default() };
    let hidden = plan(clock, Faults { late_start: 7, ..Faults::default() });
    assert_eq!((hidden[0].stamp_s, hidden[0].time_s), (0.0, 0.14));
    assert!((hidden[5].stamp_s - 0.1).abs() < 1e-12);
}

#[test]
fn a_triggered_camera_only_misreads_the_time() {
    let clock = Clock { offset_s: 0.25, drift_ppm: 200.0, ..Clock::default() };
    for (n, entry) in plan(clock, Faults::default()).iter().enumerate() {
        assert_eq!((entry.mocap_frame, entry.time_s), (n as i64, n as f64 / 50.0));
        assert!((0.25 + entry.stamp_s * 1.000_2 - entry.time_s).abs() < 1e-12);
    }
}

#[test]
fn a_free_camera_drifts_away_and_does_not_know() {
    let clock = Clock { trigger: Trigger::Own, offset_s: 0.013, drift_ppm: 5000.0, ..Clock::default() };
    let entries = plan(clock, Faults::default());
    for (n, entry) in entries.iter().enumerate() {
        assert!((entry.stamp_s - n as f64 / 50.0).abs() < 1e-12, "its own stamps look perfect");
        assert!((entry.time_s - (0.013 + 1.005 * n as f64 / 50.0)).abs() < 1e-12);
        assert_eq!(entry.mocap_frame, n as i64 + 1, "0.65 frames late: a frame later, by count");
    }
}

/// A camera that is so fast or slow that it gains or loses a frame still has one image of each.
#[test]
fn a_camera_that_drifts_past_a_frame_skips_none_and_shows_none_twice() {
    for (every, drift_ppm) in [(1, 50_000.0), (1, -50_000.0), (4, 50_000.0)] {
        let clock = Clock { trigger: Trigger::Own, every, phase: every - 1, drift_ppm, ..Clock::default() };
        let late = Clock { offset_s: -0.033, ..clock.clone() };
        for (clock, late_frames) in [(clock, 0), (late, -2)] {
            let frames: Vec<i64> =
                plan(clock, Faults::default()).iter().map(|entry| entry.mocap_frame).collect();
            let count = i64::from(100 / every);
            let expected = (1..=count).map(|n| n * i64::from(every) - 1 + late_frames);
            assert_eq!(frames, expected.collect::<Vec<_>>(), "every {every}, {drift_ppm} ppm");
        }
    }
}

#[test]
fn faults_by_chance_come_as_often_as_asked() {
    let faults = Faults { drop_share: 0.02, double_share: 0.01, ..Faults::default() };
    let entries = plan_one(Clock::default(), faults, Rate::per_second(50), 400.0, 3);
    let doubles = entries.iter().filter(|entry| entry.is_double).count();
    let dropped = 20_000 - (entries.len() - doubles);
    assert!((300..500).contains(&dropped), "{dropped} of 20000 dropped");
    assert!((140..260).contains(&doubles), "{doubles} of 20000 doubled");
}

#[test]
fn jitter_has_its_size_and_nothing_else_changes() {
    let clock = Clock { jitter_s: 5e-4, stamp_jitter_s: 2e-4, ..Clock::default() };
    let entries = plan_one(clock, Faults::default(), Rate::per_second(50), 100.0, 3);
    let spread = |values: Vec<f64>| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64;
        assert!(mean.abs() < 5e-5, "mean {mean}");
        variance.sqrt()
    };
    let true_spread = spread(entries.iter().map(|e| e.time_s - e.mocap_frame as f64 / 50.0).collect());
    let stamp_spread = spread(entries.iter().map(|e| e.stamp_s - e.time_s).collect());
    assert!((true_spread / 5e-4 - 1.0).abs() < 0.05 && (stamp_spread / 2e-4 - 1.0).abs() < 0.05);
    assert!(entries.windows(2).all(|pair| pair[0].time_s < pair[1].time_s));
}

#[test]
fn cameras_have_their_own_luck_and_seeds_theirs() {
    let faults = Faults { drop_share: 0.1, ..Faults::default() };
    let cameras = ["m1", "m2"].map(|id| camera(id, Clock::default(), faults.clone()));
    let plan = |seed| Schedule::plan(&cameras, Rate::per_second(50), 4.0, seed).unwrap();
    let schedule = plan(1);
    assert_eq!(schedule, plan(1));
    assert_ne!(schedule, plan(2));
    assert_ne!(schedule.cameras[0].1, schedule.cameras[1].1);
}

#[test]
fn stamps_are_written_as_the_camera_believes() {
    let m1 = camera("m1", Clock::default(), Faults { doubled: vec![1], ..Faults::default() });
    let w1 = camera(
        "w,1",
        Clock { every: 4, offset_s: 0.02, ..Clock::default() },
        Faults { dropped: vec![1], ..Faults::default() },
    );
    let schedule = Schedule::plan(&[m1, w1], Rate { frames: 30000, seconds: 1001 }, 0.4, 1).unwrap();
    let texts: Vec<(&str, String)> = time_stamps_csv(&schedule).collect();
    let lines: Vec<&str> = texts[0].1.lines().collect();
    assert_eq!(
        (texts[0].0, &lines[..4]),
        ("m1", &["index,time_s", "0,0.000000", "1,0.033367", "2,0.033367"][..])
    );
    let lines: Vec<&str> = texts[1].1.lines().collect();
    assert_eq!((texts[1].0, &lines[1..]), ("w,1", &["0,-0.020000", "1,0.246933"][..]));
    assert!(!texts[0].1.contains("-0.000000"));
}

#[test]
fn a_flash_lights_the_pictures_it_burns_in() {
    let rate = Rate::per_second(50);
    let flash = Flash { mocap_frame: 20, length_s: 0.1, factor: 3.0 };
    assert_eq!(flash.brightness(rate, 0.38, 0.003), 1.0);
    assert!((flash.brightness(rate, 0.40, 0.003) - 2.0).abs() < 1e-9, "it flares up in mid-exposure");
    assert_eq!(flash.brightness(rate, 0.42, 0.003), 3.0);
    assert_eq!(flash.brightness(rate, 0.52, 0.003), 1.0);
    assert_eq!((flash.brightness(rate, 0.40, 0.0), flash.brightness(rate, 0.5, 0.0)), (3.0, 1.0));
    let wrinkle = camera("w1", Clock { every: 4, phase: 3, ..Clock::default() }, Faults::default());
    let cameras = [camera("m1", Clock::default(), Faults::default()), wrinkle];
    let schedule = Schedule::plan(&cameras, rate, 2.0, 1).unwrap();
    flash.check(&schedule, rate, 0.003).unwrap();
    let short = Flash { length_s: 0.01, ..flash.clone() };
    let message = short.check(&schedule, rate, 0.003).unwrap_err().to_string();
    assert!(message.contains("flash.mocap_frame: camera w1 has no picture of it"), "{message}");
    let dark = Flash { factor: 0.5, ..flash };
    assert!(dark.check(&schedule, rate, 0.003).unwrap_err().to_string().contains("flash.factor"));
}

#[test]
fn what_makes_no_sense_is_named() {
    let message = |clock: Clock, faults: Faults, duration_s: f64| {
        let cameras = [camera("m3", clock, faults)];
        Schedule::plan(&cameras, Rate::per_second(50), duration_s, 1).unwrap_err().to_string()
    };
    let clock = Clock::default;
    let faults = Faults::default;
    assert_eq!(
        message(Clock { every: 0, ..clock() }, faults(), 1.0),
        "cameras.m3.clock.every: 0; 1 is every frame"
    );
    let cases = [
        (Clock { every: 4, phase: 4, ..clock() }, faults(), 1.0, "clock.phase: 4 is not below every = 4"),
        (Clock { jitter_s: 0.01, ..clock() }, faults(), 1.0, "clock.jitter_s: 0.01 s"),
        (Clock { drift_ppm: f64::NAN, ..clock() }, faults(), 1.0, "clock.drift_ppm"),
        (Clock { offset_s: f64::INFINITY, ..clock() }, faults(), 1.0, "clock.offset_s"),
        (clock(), Faults { drop_share: 2.0, ..faults() }, 1.0, "faults.drop_share: 2; 0 to 1"),
        (clock(), Faults { drop_share: 1.0, ..faults() }, 1.0, "cameras.m3: no picture is left"),
        (
            clock(),
            Faults { dropped: vec![4], doubled: vec![4], ..faults() },
            1.0,
            "exposure 4 is dropped already",
        ),
        (clock(), faults(), -1.0, "duration_s: -1 s is no duration"),
    ];
    for (clock, faults, duration_s, expected) in cases {
        let message = message(clock, faults, duration_s);
        assert!(message.contains(expected), "{message}");
    }
    assert!(serde_json::from_str::<Clock>(r#"{"drift": 3}"#).is_err());
    let clock: Clock = serde_json::from_str(r#"{"trigger": "own", "every": 4}"#).unwrap();
    assert_eq!((clock.trigger, clock.every, clock.phase), (Trigger::Own, 4, 0));
}

proptest! {
    /// Whatever happens, the file's indices have no gap, true times never fall, and stamp and truth keep the clock's law.
    #[test]
    fn every_file_is_in_order(
        seed in 0_u64..1000,
        drop_share in 0.0..0.3,
        double_share in 0.0..0.3,
        offset_s in -1.0..1.0,
        drift_ppm in -500.0..500.0,
        late_start in -5_i64..5,
        own in any::<bool>(),
    ) {
        let trigger = if own { Trigger::Own } else { Trigger::Shared };
        let clock = Clock { trigger, offset_s, drift_ppm, jitter_s: 1e-4, ..Clock::default() };
        let faults = Faults { drop_share, double_share, late_start, ..Faults::default() };
        let entries = plan_one(clock, faults, Rate::per_second(50), 2.0, seed);
        for (index, entry) in entries.iter().enumerate() {
            prop_assert_eq!(entry.index, index);
            let own_s = (entry.time_s - offset_s) / (1.0 + 1e-6 * drift_ppm);
            prop_assert!((own_s - entry.stamp_s).abs() < 1e-9);
            // Half a frame of the offset, and 0.05 frames of drift.
            prop_assert!((entry.time_s * 50.0 - entry.mocap_frame as f64).abs() <= 0.57);
        }
        for pair in entries.windows(2) {
            prop_assert_eq!(pair[1].is_double, pair[0].exposure == pair[1].exposure);
            prop_assert!(pair[1].is_double || pair[1].time_s > pair[0].time_s);
        }
    }

    /// More faults take pictures away or add some; those that are left stay as they are.
    #[test]
    fn faults_change_nothing_but_themselves(seed in 0_u64..1000, share in 0.0..0.5) {
        let clock = Clock { jitter_s: 1e-3, ..Clock::default() };
        let rate = Rate::per_second(50);
        let whole = plan_one(clock.clone(), Faults::default(), rate, 1.0, seed);
        let faults = Faults { drop_share: share, double_share: share, ..Faults::default() };
        for entry in plan_one(clock, faults, rate, 1.0, seed) {
            let before = whole[entry.exposure as usize];
            prop_assert_eq!((entry.time_s, entry.stamp_s), (before.time_s, before.stamp_s));
        }
    }
}
