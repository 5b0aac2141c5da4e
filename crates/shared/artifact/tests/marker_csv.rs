//! Markers in CSV: columns, units, rates out of times, and what is malformed.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests")]

mod marker_support;

use artifact::{Error, Rate, Trajectories, Trajectories3d, Unit, marker_csv};
use marker_support::{small, trajectories};
use proptest::prelude::*;
use std::fmt::Write;
use std::path::Path;

fn parse(text: &str) -> Result<(Trajectories, Vec<String>), Error> {
    marker_csv::parse(Path::new("take.csv"), text.as_bytes(), Some(Unit::Mm))
}

fn refusal(text: &str) -> String {
    parse(text).expect_err("it is malformed").to_string()
}

const FRAMES: &str = "frame,time_s,brow_l_x,brow_l_y,brow_l_z,brow_r_x,brow_r_y,brow_r_z
1001,8.341667,1.5,-2.25,300,-40.125,5,0.5
1002,8.350000,-40.125,5,0.5,,,
1003,8.358333,-40.125,5,0.5,1.5,-2.25,300
";

fn times(hz: f64, digits: usize, frames: impl Iterator<Item = i64>) -> String {
    frames.fold("time_s,a_x,a_y,a_z\n".to_string(), |mut text, frame| {
        writeln!(text, "{:.digits$},1,2,3", frame as f64 / hz).unwrap();
        text
    })
}

#[test]
fn columns_are_read_by_name() {
    assert_eq!(parse(FRAMES).unwrap(), (small(), vec![]));
    let (take, _) = parse(&FRAMES.replace(",,,", ",NaN,nan,").replace('\n', "\r\n")).unwrap();
    assert_eq!(take, small());
    assert_eq!(parse(&format!("\u{feff}{FRAMES}")).unwrap().0, small());
}

#[test]
fn without_times_there_is_no_rate() {
    let (take, warnings) = parse("frame,a_x,a_y,a_z\n-2,1,2,3\n5,4,5,6\n").unwrap();
    let mut expected = trajectories(
        Rate::per_second(1),
        &["a"],
        &[(-2, &[Some([1.0, 2.0, 3.0])]), (5, &[Some([4.0, 5.0, 6.0])])],
    );
    expected.header.rate = None;
    assert_eq!((take, warnings.len()), (expected, 1));
}

#[test]
fn the_rate_follows_from_the_times() {
    let rates = [24, 25, 30, 50, 60, 90, 100, 120, 144, 240, 300]
        .map(Rate::per_second)
        .into_iter()
        .chain([24_000, 30_000, 60_000, 120_000].map(|frames| Rate { frames, seconds: 1001 }))
        .chain([Rate { frames: 12_500, seconds: 1000 }]);
    for rate in rates {
        let text = times(rate.hz(), 6, 0..400);
        let (take, _) = parse(&text).unwrap();
        let same = take.header.rate.is_some_and(|found| (found.hz() - rate.hz()).abs() < 1e-9);
        assert!(same, "{rate}: {:?}", take.header.rate);
        assert_eq!((take.frames[0].frame, take.frames[399].frame), (0, 399), "{rate}");
    }
    // Rounded to milliseconds.
    let (take, _) = parse(&times(60.0, 3, 0..400)).unwrap();
    assert_eq!(take.header.rate, Some(Rate::per_second(60)));
    let (take, _) = parse(&times(240.0, 3, 0..400)).unwrap();
    assert_eq!(take.header.rate, Some(Rate::per_second(240)));
}

#[test]
fn gaps_in_time_are_gaps_in_frames() {
    let (take, _) = parse(&times(60.0, 6, (600..650).chain(660..700))).unwrap();
    assert_eq!(take.header.rate, Some(Rate::per_second(60)));
    let numbers: Vec<i64> = take.frames.iter().map(|frame| frame.frame).collect();
    assert_eq!(numbers, (600..650).chain(660..700).collect::<Vec<_>>());
}

#[test]
fn real_face_markers_are_read_in_centimetres() {
    for (name, frame_count) in [("eyebrows", 902), ("jaw", 1590)] {
        let Some(path) = testkit::data(&format!("face_markers_animface/{name}.csv")) else { return };
        let (take, warnings) = artifact::read_trajectories::<Trajectories3d>(&path, Some(Unit::Cm)).unwrap();
        assert_eq!((take.header.markers.len(), take.frames.len()), (41, frame_count));
        assert_eq!(take.header.rate, Some(Rate::per_second(60)));
        assert_eq!((take.frames[0].frame, take.frames[frame_count - 1].frame), (0, frame_count as i64 - 1));
        assert_eq!(take.header.markers[0], "ForeHead_M");
        assert!(take.frames.iter().all(|frame| frame.points.iter().all(Option::is_some)));
        let x = take.frames[0].points[0].unwrap().x;
        assert!((100.0..200.0).contains(&x), "{x} mm");
        assert!(warnings.is_empty(), "{warnings:?}");
        let error = artifact::read_trajectories::<Trajectories3d>(&path, None).unwrap_err();
        assert!(error.fix.unwrap().contains("--marker-unit"));
    }
}

#[test]
fn malformed_files_are_refused_at_their_place() {
    let header = "time_s,a_x,a_y,a_z\n";
    let cases = [
        (String::new(), "is empty"),
        ("a_x,a_y,a_z\n1,2,3\n".into(), "line 1, column 1: 'a_x' where time_s or frame"),
        ("time_s;a_x;a_y;a_z\n".into(), "separate columns by commas"),
        ("frame,frame,a_x,a_y,a_z\n".into(), "line 1, column 1"),
        ("time_s,a_x,a_y\n0,1,2\n".into(), "line 1, column 2"),
        ("time_s,a_x,b_y,a_z\n".into(), "are not the three columns of a marker"),
        ("time_s\n0\n".into(), "no markers"),
        (header.into(), "line 2: holds no frames"),
        (format!("{header}0,1,2\n"), "line 2: has 3 cells"),
        (format!("{header}0,1,2,3\n0.1,1,,3\n"), "line 3, marker a: has only some"),
        (format!("{header}0,1,2,3\n0.1,1,q,3\n"), "line 3, marker a: 'q' is not a number"),
        (format!("{header}0,1,2,3\n0.1,1,-inf,3\n"), "not a finite number"),
        (format!("{header}0,1,2,3\n,1,2,3\n"), "line 3: the time is missing"),
        (format!("{header}0,1,2,3\n0,1,2,3\n"), "line 3: time 0 follows"),
        (format!("{header}0,1,2,3\n0.1,1,2,3\n0.137,1,2,3\n0.2,1,2,3\n0.3,1,2,3\n"), "no whole frames"),
        ("frame,a_x,a_y,a_z\n1.5,1,2,3\n".into(), "'1.5' is not a frame number"),
        ("frame,a_x,a_y,a_z\n2,1,2,3\n1,1,2,3\n".into(), "line 3: frame 1 follows frame 2"),
        ("frame,a_x,a_y,a_z\n1,\"168,68\",2,3\n".into(), "marker a: '168,68' has a decimal comma"),
        ("frame,a_x,a_y,a_z\n1,168,68,2,3\n".into(), "export it with decimal points"),
    ];
    for (text, said) in cases {
        let message = refusal(&text);
        assert!(message.contains(said), "{said}: {message}");
    }
    let binary = marker_csv::parse(Path::new("x.csv"), b"frame,a_x,a_y,a_z\n1,\xff\0,2,3\n", Some(Unit::Mm));
    assert!(binary.unwrap_err().to_string().contains("line 2 (byte 20): is not text"));
}

#[test]
fn latin_1_names_are_read() {
    let bytes = b"frame,M\xfcller_x,M\xfcller_y,M\xfcller_z\n1,1,2,3\n";
    let (take, _) = marker_csv::parse(Path::new("x.csv"), bytes, Some(Unit::Mm)).unwrap();
    assert_eq!(take.header.markers, ["M\u{fc}ller"]);
}

#[test]
fn samples_at_the_origin_are_told() {
    let (_, warnings) = parse("frame,time_s,a_x,a_y,a_z\n0,0,0,0,0\n1,0.1,1,2,3\n2,0.2,-0,0,0\n").unwrap();
    assert!(warnings[0].contains("exactly at the origin") && warnings[0].contains("a in 2"), "{warnings:?}");
}

#[test]
fn doubled_markers_get_other_names() {
    let (take, warnings) = parse("frame,a_x,a_y,a_z,a_x,a_y,a_z,_x,_y,_z\n1,1,2,3,4,5,6,7,8,9\n").unwrap();
    assert_eq!(take.header.markers, ["a", "a_2", "marker_3"]);
    assert_eq!(warnings.len(), 3);
}

#[test]
fn a_cut_last_line_is_told() {
    let (_, warnings) = parse(FRAMES.trim_end()).unwrap();
    assert!(warnings[0].contains("no line end"), "{warnings:?}");
    for cut in 0..FRAMES.len() - 1 {
        let whole_lines = FRAMES[..cut].ends_with('\n');
        if let Ok((_, warnings)) = parse(&FRAMES[..cut]) {
            assert!(whole_lines || !warnings.is_empty(), "{cut}");
        }
    }
}

proptest! {
    #[test]
    fn flips_are_read_or_refused(flips in prop::collection::vec((0usize..FRAMES.len(), any::<u8>()), 1..8)) {
        let mut bytes = FRAMES.as_bytes().to_vec();
        for (at, value) in flips {
            bytes[at] = value;
        }
        let _ = marker_csv::parse(Path::new("x.csv"), &bytes, Some(Unit::Cm));
    }

    #[test]
    fn any_times_are_read_or_refused(times in prop::collection::vec(prop::num::f64::ANY, 1..6)) {
        let mut text = "time_s,a_x,a_y,a_z\n".to_string();
        times.iter().for_each(|time| writeln!(text, "{time},1,2,3").unwrap());
        let _ = parse(&text);
        let text = text.replace("time_s", "frame,time_s").replace("\n", "\n1,");
        let _ = parse(&text);
    }
}
