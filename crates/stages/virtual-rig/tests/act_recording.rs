//! Real weight curves.

#![allow(clippy::expect_used, clippy::panic, reason = "helpers of tests may fail like tests")]

use virtual_rig::act::{Clip, ClipParams};
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

#[test]
fn a_real_recording_plays() {
    let Some(path) = testkit::data("arkit_performance/alex_rom_3.csv") else { return };
    let clip = Clip::parse(&artifact::read_text(&path).expect("text")).expect("a recording");
    assert_eq!((clip.times_s.len(), clip.names.len()), (4030, 61));
    let interval = clip.length_s() / 4029.0;
    assert!((interval - 1.0 / 30.0).abs() < 1e-4, "{interval} s");
    assert_eq!(clip.undriven(&names(&MUSCLES)), Vec::<&str>::new());
    assert_eq!(clip.undriven(&names(&FACEKIT)), Vec::<&str>::new());
    assert_eq!(clip.undriven(&names(&["browDown_L", "cheekPuff_R", "tail"])), ["tail"]);
    let params = ClipParams { start_s: clip.times_s[3500], ..ClipParams::default() };
    let performance = clip.bind(&params, &names(&MUSCLES)).expect("curves");
    assert_eq!(performance.weights(0.0), [0.0; 14], "neutral at first");
    // The set's own excerpt of the recording says what its row 3570 holds.
    let weights = performance.weights(clip.times_s[3570] - params.start_s);
    for (name, value) in
        [("jaw_open", 0.691_791), ("blink_l", 0.271_489), ("pucker", 0.266_945), ("smile_l", 0.0)]
    {
        assert!((weights[index(name)] - value).abs() < 1e-6, "{name} {}", weights[index(name)]);
    }
    for step in 0..2000 {
        let weights = performance.weights(f64::from(step) * 0.01);
        assert!(weights.iter().all(|weight| (0.0..=1.0).contains(weight)));
    }
    let beyond = ClipParams { start_s: 1000.0, ..params };
    let said = clip.bind(&beyond, &names(&MUSCLES)).expect_err("past its end").to_string();
    assert!(
        said.starts_with("performance.recording.start_s: 1000 s is past the end of the recording (134."),
        "{said}"
    );
    let said = clip.bind(&params, &names(&["tail"])).expect_err("no curve").to_string();
    assert_eq!(said, "performance.recording: no curve drives any shape of this body (tail)");
}

const TEXT: &str = "Timecode,BlendShapeCount,JawOpen,TongueOut\n23:59:59:58.000,2,0.0,0\n00:00:00:00.000,2,0.5,0\n00:00:00:02.500,2,1.2,0\n";

#[test]
fn recordings_pass_midnight() {
    let clip = Clip::parse(TEXT).expect("a recording");
    let expected = [0.0, 2.0 / 60.0, 4.5 / 60.0];
    assert!(clip.times_s.iter().zip(expected).all(|(time, expected)| (time - expected).abs() < 1e-9));
    let params = ClipParams { start_s: 0.0, speed: 0.1, join_s: 0.01 };
    let jaw = clip.bind(&params, &names(&["jaw_open"])).expect("a jaw");
    assert!((jaw.weights(20.0 / 60.0)[0] - 0.5).abs() < 1e-6);
    assert_eq!(jaw.weights(5.0), [1.0], "it stays where it ends, and within its bounds");
}

#[test]
fn faults_of_a_recording_are_named() {
    let said = |from: &str, to: &str| {
        assert!(TEXT.contains(from));
        Clip::parse(&TEXT.replacen(from, to, 1)).expect_err("refused").to_string()
    };
    assert_eq!(said("0.5", "half"), "line 3, column JawOpen: 'half' is not a number");
    assert_eq!(said("1.2", "NaN"), "line 4, column JawOpen: 'NaN' is not a finite number");
    assert_eq!(
        said("00:00:00:02.500", "00:00:00:61"),
        "line 4, column Timecode: '00:00:00:61' is not HH:MM:SS:FF.mmm"
    );
    let same = said("00:00:00:02.500", "00:00:00:00.000");
    assert_eq!(same, "line 4, column Timecode: '00:00:00:00.000' is not later than the row before");
    assert_eq!(said("2,0.5,0", "2,0.5"), "line 3: 3 columns; the header has 4");
    assert_eq!(said("Timecode", "Time"), "line 1: the header has no column Timecode");
    assert_eq!(Clip::parse("").expect_err("empty").to_string(), "line 1: the file is empty");
    assert_eq!(
        Clip::parse("Timecode,A\n").expect_err("no rows").to_string(),
        "line 1: no rows follow the header"
    );
}
