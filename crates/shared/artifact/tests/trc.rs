//! TRC: round trips, the habits of other writers, and what is malformed.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests")]

mod marker_support;

use artifact::{Error, Rate, Trajectories, Trajectories3d, Unit, trc};
use marker_support::{any_trajectories, small, trajectories, written};
use proptest::prelude::*;
use std::path::Path;

fn text_of(trajectories: &Trajectories) -> String {
    String::from_utf8(written("take.trc", |path| trc::write(path, trajectories)).unwrap()).unwrap()
}

fn parse(text: &str) -> Result<(Trajectories, Vec<String>), Error> {
    trc::parse(Path::new("take.trc"), text, None)
}

fn refusal(text: &str) -> String {
    parse(text).expect_err("it is malformed").to_string()
}

const WRITTEN: &str = "PathFileType\t4\t(X/Y/Z)\ttake.trc\n\
DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n\
120\t120\t3\t2\tmm\t120\t1001\t3\n\
Frame#\tTime\tbrow_l\t\t\tbrow_r\t\t\n\
\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\
\n\
1001\t0.000000\t1.5\t-2.25\t300\t-40.125\t5\t0.5\n\
1002\t0.008333\t-40.125\t5\t0.5\t\t\t\n\
1003\t0.016667\t-40.125\t5\t0.5\t1.5\t-2.25\t300\n";

#[test]
fn the_text_is_that_of_the_format() {
    assert_eq!(text_of(&small()), WRITTEN);
    assert_eq!(parse(WRITTEN).unwrap(), (small(), vec![]));
}

#[test]
fn samples_at_the_origin_are_told() {
    let (take, warnings) = parse(&WRITTEN.replace("0.5\t\t\t\n", "0.5\t0\t0\t0\n")).unwrap();
    assert_eq!(take.frames[1].points[1], Some(nalgebra::Point3::origin()));
    assert!(
        warnings[0].contains("exactly at the origin") && warnings[0].contains("brow_r in 1"),
        "{warnings:?}"
    );
    assert_eq!(warnings.len(), 1);
}

#[test]
fn decimal_commas_are_named() {
    let message = refusal(&WRITTEN.replace("-2.25", "-2,25"));
    assert!(message.contains("frame 1001, marker brow_l: '-2,25' has a decimal comma"), "{message}");
    assert!(message.contains("export it with decimal points"), "{message}");
}

#[test]
fn latin_1_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("take.trc");
    let bytes = [
        b"PathFileType\t4\t(X/Y/Z)\tm\xfcller.trc".as_slice(),
        &WRITTEN.as_bytes()[WRITTEN.find('\n').unwrap()..],
    ];
    artifact::stage_bytes(&path, bytes.concat().as_slice()).unwrap().publish().unwrap();
    assert_eq!(trc::read(&path, None).unwrap(), (small(), vec![]));
}

#[test]
fn habits_of_other_writers_are_read() {
    let same = |text: String, warnings: usize| {
        let (take, told) = parse(&text).unwrap();
        assert_eq!(take, small(), "{text}");
        assert_eq!(told.len(), warnings, "{told:?}");
    };
    same(WRITTEN.replace('\n', "\r\n"), 0);
    same(WRITTEN.replace("\n\n", "\n"), 0);
    same(WRITTEN.replace("0.5\t\t\t", "0.5\tNaN\tnan\tNAN"), 0);
    same(WRITTEN.replace("0.5\t\t\t", "0.5"), 1);
    same(WRITTEN.replace("brow_l\t\t\tbrow_r\t\t", "brow_l\tbrow_r"), 1);
    same(WRITTEN.replace("brow_r\t\t", "brow_r"), 0);
    same(WRITTEN.replace("\t300\n", "\t300\t\n"), 0);
    same(WRITTEN.replace("\tmm\t", "\tmillimeters\t"), 0);
    same(WRITTEN.replace("1001\t0.0", "1001.0\t0.0"), 0);
    same(format!("\u{feff}{}", WRITTEN.trim_end()), 1);
    same(WRITTEN.replace("120\t120\t3", "120\t120\t2"), 1);
    same(WRITTEN.replace("0.016667", "9.0"), 1);
}

#[test]
fn units_are_converted_stated_or_refused() {
    let (take, _) = parse(&WRITTEN.replace("\tmm\t", "\tm\t")).unwrap();
    assert_eq!(take.frames[0].points[0].unwrap().z, 300_000.0);
    let stated = |text: &str, unit| trc::parse(Path::new("x.trc"), &WRITTEN.replace("\tmm\t", text), unit);
    assert!(stated("\tmm\t", Some(Unit::Cm)).unwrap_err().what.contains("--marker-unit says cm"));
    assert!(stated("\t\t", None).unwrap_err().fix.unwrap().contains("--marker-unit"));
    assert_eq!(stated("\t\t", Some(Unit::Mm)).unwrap().0, small());
    assert!(stated("\tinches\t", Some(Unit::Mm)).is_err());
}

#[test]
fn malformed_files_are_refused_at_their_place() {
    let cases = [
        ("PathFileType", "Point", "line 1: is not a TRC"),
        ("\t-2.25\t300\n1002", "\t-2.25\tthree\n1002", "marker brow_r"),
        ("-40.125\t5\t0.5\n1002", "-40.125\t\t0.5\n1002", "line 7, frame 1001, marker brow_r: has only some"),
        ("1002\t", "1001\t", "line 8: frame 1001 follows frame 1001"),
        ("1002\t", "b\t", "line 8, column 1: 'b' is not a frame number"),
        ("120\t120\t3\t2", "120\t120\t3\t3", "NumMarkers says 3"),
        ("120\t120\t3\t2", "120\t120\t3\t0", "no markers"),
        ("120\t120\t3\t2", "120\t120\t300\t2", "holds 3 frames of 300"),
        ("120\t120\t3\t2", "120\t120\t3\t9999999999999999999", "NumMarkers says 9"),
        ("\t300\n1002", "\t300\t7\n1002", "beyond the 2 markers"),
        ("\t\tX1", "\t\tQ1", "line 5"),
        ("\t300\n1002", "\tinf\n1002", "not a finite number"),
    ];
    for (from, to, said) in cases {
        let text = WRITTEN.replace(
            "1001\t0.000000\t1.5\t-2.25\t300\t-40.125\t5\t0.5",
            "1001\t0.000000\t-40.125\t5\t0.5\t1.5\t-2.25\t300",
        );
        let text = match from.starts_with("-40") {
            true => WRITTEN.replace(from, to),
            false => text.replace(from, to),
        };
        let message = refusal(&text);
        assert!(message.contains(said), "{said}: {message}");
    }
}

#[test]
fn cuts_never_pass_for_whole() {
    for cut in 0..WRITTEN.len() - 1 {
        match parse(&WRITTEN[..cut]) {
            // Only a cut within the last number can pass, with a warning.
            Ok((_, warnings)) => assert!(cut >= WRITTEN.len() - 4 && !warnings.is_empty(), "{cut}"),
            Err(error) => assert!(error.place.is_some(), "{error}"),
        }
    }
}

#[test]
fn the_writer_refuses_what_the_format_cannot_hold() {
    let mut take = small();
    take.header.markers[1] = "a\tb".into();
    assert!(written("take.trc", |path| trc::write(path, &take)).unwrap_err().to_string().contains("a\\tb"));
    take = small();
    take.header.rate = None;
    assert!(written("take.trc", |path| trc::write(path, &take)).is_err());
}

#[test]
fn the_ending_chooses_the_format() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["take.trc", "take.c3d", "take.jsonl", "TAKE.TRC"] {
        let path = folder.path().join(name);
        artifact::write_trajectories::<Trajectories3d>(&path, &small()).unwrap().publish().unwrap();
        let read = artifact::read_trajectories::<Trajectories3d>(&path, Some(Unit::Mm)).unwrap();
        assert_eq!(read, (small(), vec![]), "{name}");
        let other = artifact::read_trajectories::<Trajectories3d>(&path, Some(Unit::M)).unwrap_err();
        assert!(other.what.contains("says mm, but --marker-unit says m"), "{other}");
    }
    let unknown = folder.path().join("take.bvh");
    assert!(artifact::write_trajectories::<Trajectories3d>(&unknown, &small()).is_err());
    let error = artifact::read_trajectories::<Trajectories3d>(&unknown, None).unwrap_err();
    assert!(error.fix.unwrap().contains(".c3d"));
}

#[test]
fn a_marker_missing_everywhere_stays() {
    let take = trajectories(Rate::per_second(60), &["a", "b"], &[(-3, &[None, None]), (7, &[None, None])]);
    assert_eq!(parse(&text_of(&take)).unwrap().0, take);
}

proptest! {
    #[test]
    fn round_trip(take in any_trajectories()) {
        let (read, warnings) = parse(&text_of(&take)).unwrap();
        prop_assert_eq!(read, take);
        prop_assert_eq!(warnings, Vec::<String>::new());
    }

    #[test]
    fn flips_are_read_or_refused(flips in prop::collection::vec((0usize..WRITTEN.len(), 0u8..127), 1..8)) {
        let mut bytes = WRITTEN.as_bytes().to_vec();
        for (at, value) in flips {
            bytes[at] = value;
        }
        let _ = parse(&String::from_utf8(bytes).unwrap());
    }

    #[test]
    fn any_text_is_read_or_refused(text in "(PathFileType\n)?([\t\n0-9a-zX.-]{0,9}\n?){0,30}") {
        let _ = parse(&text);
    }
}
