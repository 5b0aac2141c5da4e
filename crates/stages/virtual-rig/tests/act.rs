//! What the face does over time: bounds, smoothness, durations, and a real recording.

#![allow(clippy::expect_used, clippy::panic, reason = "helpers of tests may fail like tests")]

use nalgebra::Point3;
use proptest::prelude::*;
use virtual_rig::act::{HeadMotion, Performance, Timeline, preset_names};
use virtual_rig::body::MUSCLES;

const FACEKIT: [&str; 8] = [
    "brow_inner_up",
    "smile",
    "jaw_open",
    "eye_blink",
    "nose_sneer",
    "mouth_pucker",
    "cheek_puff",
    "mouth_frown",
];

fn names(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_string()).collect()
}

fn index(name: &str) -> usize {
    MUSCLES.iter().position(|muscle| *muscle == name).expect(name)
}

/// Largest |second difference| over h², over all shapes; grows as 1/h where a curve has a kink.
fn bend(performance: &Performance, until_s: f64, h: f64) -> f64 {
    let steps = (until_s / h) as u32;
    let at = |step: u32| performance.weights(f64::from(step) * h);
    let mut window = [at(0), at(1), at(2)];
    let mut most: f64 = 0.0;
    for step in 3..steps {
        for shape in 0..window[0].len() {
            let second = window[0][shape] - 2.0 * window[1][shape] + window[2][shape];
            most = most.max(second.abs() / (h * h));
        }
        window = [std::mem::take(&mut window[1]), std::mem::take(&mut window[2]), at(step)];
    }
    most
}

/// Spans of time (s) where a weight is above a level.
fn spans(performance: &Performance, shape: usize, level: f64, until_s: f64) -> Vec<f64> {
    const STEP_S: f64 = 5e-5;
    let mut spans = Vec::new();
    let mut inside = 0u32;
    for step in 0..(until_s / STEP_S) as u32 {
        match performance.weights(f64::from(step) * STEP_S)[shape] > level {
            true => inside += 1,
            false if inside > 0 => spans.push(f64::from(std::mem::take(&mut inside)) * STEP_S),
            false => {}
        }
    }
    spans
}

#[test]
fn ten_seconds_show_everything() {
    for seed in 0..4 {
        let performance = Timeline::standard(10.0, seed).bind(&names(&MUSCLES)).expect("a performance");
        let mut most = [0.0f64; 14];
        for step in 0..2000 {
            let weights = performance.weights(f64::from(step) * 0.005);
            assert!(weights.iter().all(|weight| (0.0..=1.0).contains(weight)));
            most.iter_mut().zip(weights).for_each(|(most, weight)| *most = most.max(weight));
        }
        for name in
            ["brow_raise_l", "brow_raise_r", "frown", "smile_l", "smile_r", "squint", "blink_l", "blink_r"]
        {
            assert!(most[index(name)] > 0.8, "{name} {}", most[index(name)]);
        }
        assert!(most[index("jaw_open")] > 0.6);
        for name in ["pucker", "lips_funnel", "mouth_stretch"] {
            assert!(most[index(name)] > 0.25, "speech moves {name}");
        }
        assert_eq!(performance.weights(10.0), [0.0; 14], "all is over in time");
    }
}

#[test]
fn long_takes_go_on() {
    let performance = Timeline::standard(25.0, 3).bind(&names(&MUSCLES)).expect("a performance");
    for second in [1, 11] {
        let brow = performance.weights(f64::from(second))[index("brow_raise_l")];
        assert!(brow > 0.8, "{second} s: {brow}");
    }
}

#[test]
fn a_blink_takes_60_ms_and_is_half_closed_for_30() {
    for length_s in [7.0, 10.0] {
        let blinks = Timeline::standard(length_s, 1).bind(&names(&MUSCLES)).expect("a performance");
        let whole = spans(&blinks, index("blink_l"), 0.0, length_s);
        let half = spans(&blinks, index("blink_l"), 0.5, length_s);
        assert_eq!((whole.len(), half.len()), (4, 4));
        assert!(whole.iter().all(|span| (span - 0.060).abs() < 0.0005), "{whole:?}");
        assert!(half.iter().all(|span| (span - 0.030).abs() < 0.0005), "{half:?}");
    }
}

#[test]
fn short_takes_end_in_wrinkles() {
    for (length_s, rate, least) in [(0.5, 50.0, 0.95), (2.0, 50.0, 0.99), (0.06, 50.0, 0.2)] {
        let performance = Timeline::standard(length_s, 1).bind(&names(&MUSCLES)).expect("a performance");
        let last = performance.weights(length_s - 1.0 / rate);
        assert!(
            last[index("brow_raise_l")] > least && last[index("smile_r")] > 0.85 * least,
            "{length_s}: {last:?}"
        );
    }
}

#[test]
fn takes_begin_at_rest() {
    for (length_s, still_s) in
        [(0.06, 0.0), (0.24, 0.04), (0.5, 0.04), (5.0, 0.04), (10.0, 0.04), (30.0, 0.04)]
    {
        for seed in 0..8 {
            let performance =
                Timeline::standard(length_s, seed).bind(&names(&MUSCLES)).expect("a performance");
            for step in -20..=20 {
                let time_s = still_s * f64::from(step) / 20.0;
                assert_eq!(performance.weights(time_s), [0.0; 14], "{length_s} s, at {time_s} s");
            }
        }
    }
}

#[test]
fn weights_bend_nowhere_sharply() {
    let performance = Timeline::standard(10.0, 2).bind(&names(&MUSCLES)).expect("a performance");
    let (coarse, fine) = (bend(&performance, 10.0, 1e-3), bend(&performance, 10.0, 2.5e-4));
    // A blink of 30 ms bends by 10/√3/0.03² at most; a kink would double with each halving of the step.
    assert!(fine < 1.05 * coarse && fine < 6500.0, "{coarse} {fine}");
}

#[test]
fn seeds_speak_differently_and_repeat() {
    let say = |seed| Timeline::standard(10.0, seed).weights(7.9, &names(&MUSCLES)).expect("weights");
    assert_eq!(say(1), say(1));
    assert_ne!(say(1), say(2));
}

/// Between two and six times a second, the jaw opens and closes.
#[test]
fn speech_has_its_rhythm() {
    let speech = Timeline::default().with("speech", 0.0, [0.1, 20.0, 0.1], 1.0);
    let performance = speech.bind(&names(&MUSCLES)).expect("a performance");
    let jaw = |time_s: f64| performance.weights(time_s)[index("jaw_open")];
    let values: Vec<f64> = (0..3800).map(|step| jaw(0.5 + f64::from(step) * 0.005)).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let crossings = values.windows(2).filter(|pair| (pair[0] < mean) != (pair[1] < mean)).count();
    let hz = crossings as f64 / 2.0 / 19.0;
    assert!((2.0..6.0).contains(&hz), "{hz} Hz");
    assert!(values.iter().fold(0.0f64, |most, jaw| most.max(*jaw)) > 0.3);
}

#[test]
fn presets_know_other_bodies() {
    for name in preset_names() {
        let event = Timeline::default().with(name, 0.0, [0.1, 1.0, 0.1], 1.0);
        event.weights(0.5, &names(&MUSCLES)).expect(name);
    }
    let weights = |action: &str| {
        let event = Timeline::default().with(action, 0.0, [0.1, 1.0, 0.1], 1.0);
        event.weights(0.5, &names(&FACEKIT)).expect(action)
    };
    assert_eq!(weights("blink")[3], 1.0);
    assert_eq!(weights("brow_raise")[0], 1.0);
    assert_eq!(weights("smile")[1], 1.0);
    assert!(weights("frown")[7] > 0.5 && weights("squint")[3] > 0.0);
    Timeline::standard(10.0, 1).bind(&names(&FACEKIT)).expect("all events");
}

#[test]
fn what_cannot_be_is_named() {
    let said =
        |timeline: Timeline, shapes: &[&str]| timeline.bind(&names(shapes)).expect_err("refused").to_string();
    let event = |action, times, strength| {
        Timeline::default().with("blink", 0.0, [0.1; 3], 1.0).with(action, 1.0, times, strength)
    };
    let unknown = said(event("wink", [0.1; 3], 1.0), &MUSCLES);
    assert!(unknown.starts_with("events[1].action: 'wink' is no shape of this body (jaw_open, smile_l"));
    assert!(unknown.contains("no preset (brow_raise, frown, smile"), "{unknown}");
    let lacking = said(Timeline::default().with("blink", 0.0, [0.1; 3], 1.0), &["jaw_open"]);
    assert!(lacking.starts_with("events[0].action: 'blink' needs blink_l and blink_r or"), "{lacking}");
    let fast = said(event("smile", [0.0, 1.0, 0.1], 1.0), &MUSCLES);
    assert!(fast.starts_with("events[1].rise_s: 0 s is too fast"), "{fast}");
    let strong = said(event("smile", [0.1; 3], 1.5), &MUSCLES);
    assert_eq!(strong, "events[1].strength: 1.5 is not from 0 to 1");
    let unread =
        serde_json::from_str::<Timeline>(r#"{"events":[{"action":"smile","start_s":0,"rize_s":1}]}"#);
    assert!(unread.expect_err("unknown key").to_string().contains("rize_s"));
}

proptest! {
    #[test]
    fn heads_stay_within_their_bounds(seed in 0u64..1000, time_s in -100.0..1000.0f64, turn_rad in 0.0..0.5f64) {
        let motion = HeadMotion { turn_rad, seed, ..HeadMotion::default() };
        let pivot = Point3::new(3.0, -40.0, -50.0);
        let pose = motion.world_from_head(time_s, &pivot);
        prop_assert!(pose.rotation.angle() <= turn_rad + 1e-12);
        prop_assert!((pose * pivot - pivot).norm() <= motion.shift_mm + 1e-9);
        prop_assert_eq!(pose, motion.world_from_head(time_s, &pivot));
    }
}

#[test]
fn heads_move_smoothly_from_rest() {
    let pivot = Point3::new(0.0, -40.0, -50.0);
    let tip = Point3::new(0.0, 6.0, 95.0);
    for seed in 0..5 {
        let motion = HeadMotion { seed, ..HeadMotion::default() };
        let still = motion.world_from_head(0.0, &pivot);
        assert!((still.to_homogeneous() - nalgebra::Matrix4::identity()).norm() < 1e-12);
        let at = |time_s: f64| motion.world_from_head(time_s, &pivot) * tip;
        let (mut farthest, mut sharpest, mut widest) = (0.0f64, 0.0f64, 0.0f64);
        for step in 0..3000 {
            let time_s = f64::from(step) * 0.01;
            farthest = farthest.max((at(time_s) - tip).norm());
            let bend = at(time_s - 0.001).coords - 2.0 * at(time_s).coords + at(time_s + 0.001).coords;
            sharpest = sharpest.max(bend.norm() / 1e-6);
            widest = widest.max(motion.world_from_head(time_s, &pivot).rotation.angle());
        }
        assert!((3.0..14.0).contains(&farthest), "{farthest} mm");
        // 14 mm at 1 Hz.
        assert!(sharpest < 14.0 * std::f64::consts::TAU.powi(2), "{sharpest} mm/s²");
        assert!(widest > 1f64.to_radians());
    }
}

#[test]
fn head_parameters_are_checked() {
    let said = |motion: HeadMotion| motion.check("head").expect_err("refused").to_string();
    assert_eq!(
        said(HeadMotion { period_s: 0.0, ..HeadMotion::default() }),
        "head.period_s: 0 is not from 0.2 to 1000"
    );
    assert_eq!(
        said(HeadMotion { turn_rad: -1.0, ..HeadMotion::default() }),
        "head.turn_rad: -1 is not from 0 to 1"
    );
    HeadMotion::still().check("head").expect("stillness is fine");
}
