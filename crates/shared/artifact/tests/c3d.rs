//! C3D: real files, round trips, and everything that can be wrong with a file.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests")]

mod marker_support;

use artifact::c3d::{self, C3d, Storage};
use artifact::{Error, Rate, Trajectories, Trajectories3d, Unit};
use marker_support::{any_trajectories, small, trajectories, without_gaps, written};
use proptest::prelude::*;
use std::path::Path;

fn bytes_of(trajectories: &Trajectories) -> Vec<u8> {
    written("take.c3d", |path| c3d::write(path, trajectories)).unwrap()
}

fn parse(bytes: &[u8]) -> Result<C3d, Error> {
    c3d::parse(Path::new("take.c3d"), bytes, None)
}

fn refusal(bytes: &[u8]) -> String {
    parse(bytes).expect_err("it is malformed").to_string()
}

/// Where the value of a parameter of the written file starts.
fn value_of(bytes: &[u8], name: &str) -> usize {
    let mut named = vec![name.len() as u8, 1];
    named.extend(name.as_bytes());
    let at = bytes.windows(named.len()).position(|window| window == named).expect("the parameter is there");
    let dimensions = at + named.len() + 3;
    dimensions + 1 + usize::from(bytes[dimensions])
}

fn with(bytes: &[u8], at: usize, patch: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[at..at + patch.len()].copy_from_slice(patch);
    bytes
}

fn missing(trajectories: &Trajectories, marker: &str) -> usize {
    let marker = trajectories.marker(marker).expect("the marker is there");
    trajectories.frames.iter().filter(|frame| frame.points[marker].is_none()).count()
}

#[test]
fn integer_and_real_of_one_take_are_equal() {
    let (Some(integer), Some(real)) = (testkit::data("c3d/Eb015pi.c3d"), testkit::data("c3d/Eb015pr.c3d"))
    else {
        return;
    };
    let (integer, real) = (c3d::read(&integer, None).unwrap(), c3d::read(&real, Some(Unit::Mm)).unwrap());
    assert_eq!((integer.storage, real.storage), (Storage::Integer, Storage::Real));
    assert_eq!(integer.trajectories, real.trajectories);
    let take = integer.trajectories;
    assert_eq!(take.header.rate, Some(Rate::per_second(50)));
    assert_eq!((take.header.markers.len(), take.frames.len(), take.frames[0].frame), (26, 450, 1));
    assert_eq!(take.header.markers[..4], ["RFT1", "RFT2", "RFT3", "LFT1"]);
    let gaps = take.frames.iter().flat_map(|frame| &frame.points).filter(|point| point.is_none()).count();
    assert_eq!(format!("{:.2}", 100.0 * gaps as f64 / (26.0 * 450.0)), "1.93");
}

/// Intel, DEC and SGI, as integers and as reals: six files of one take.
#[test]
fn all_six_encodings_of_one_take_are_equal() {
    let Some(path) = testkit::data("c3d/Eb015pi.c3d") else { return };
    let intel = c3d::read(&path, None).unwrap();
    for (file, storage) in [
        ("pr", Storage::Real),
        ("si", Storage::Integer),
        ("sr", Storage::Real),
        ("vi", Storage::Integer),
        ("vr", Storage::Real),
    ] {
        let read = c3d::read(&testkit::data(&format!("c3d/Eb015{file}.c3d")).unwrap(), None).unwrap();
        assert_eq!((read.storage, read.unit), (storage, intel.unit), "{file}");
        assert_eq!(read.trajectories, intel.trajectories, "{file}");
        assert_eq!(read.warnings, intel.warnings, "{file}");
    }
}

#[test]
fn an_unknown_processor_is_refused_by_name() {
    let mut bytes = bytes_of(&small());
    bytes[515] = 90;
    let error = parse(&bytes).unwrap_err();
    assert!(error.to_string().contains("processor type 90"), "{error}");
    assert_eq!(error.place.as_deref(), Some("byte 515"));
}

#[test]
fn a_malformed_face_take_is_read_with_a_warning() {
    let Some(path) = testkit::data("c3d/Facial-Sing_frames0001-1500.c3d") else { return };
    let (take, warnings) = artifact::read_trajectories::<Trajectories3d>(&path, None).unwrap();
    assert_eq!((take.header.markers.len(), take.frames.len()), (38, 1500));
    assert_eq!(take.header.rate, Some(Rate::per_second(100)));
    assert_eq!((take.frames[0].frame, take.frames[1499].frame), (1, 1500));
    assert_eq!(take.header.markers[0], "root-1");
    assert_eq!(take.header.markers[37], "Unlabeled1");
    let counts = ["section3-1", "section4-1", "section4-2", "section13-2"].map(|id| missing(&take, id));
    assert_eq!(counts, [33, 42, 110, 55]);
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].contains("POINT:LABELS") && warnings[0].contains("Facial-Sing"), "{warnings:?}");
}

#[test]
fn a_malformed_body_take_is_read_with_a_warning() {
    let Some(path) = testkit::data("c3d/mocap36_optitrack.c3d") else { return };
    let read = c3d::read(&path, None).unwrap();
    let take = &read.trajectories;
    assert_eq!((take.header.markers.len(), take.frames.len()), (36, 1380));
    let gaps: usize = take.header.markers.iter().map(|id| missing(take, id)).sum();
    assert_eq!(format!("{:.1}", 100.0 * gaps as f64 / (36.0 * 1380.0)), "16.6");
    assert!(read.warnings[0].contains("description"), "{:?}", read.warnings);
}

#[test]
fn real_takes_come_back_unchanged() {
    for name in ["Eb015pi.c3d", "Facial-Sing_frames0001-1500.c3d", "mocap36_optitrack.c3d"] {
        let Some(path) = testkit::data(&format!("c3d/{name}")) else { return };
        let take = c3d::read(&path, None).unwrap().trajectories;
        let again = parse(&bytes_of(&take)).unwrap();
        assert_eq!(again.trajectories, take);
        assert_eq!(again.warnings, Vec::<String>::new());
    }
}

#[test]
fn units_are_read_stated_or_refused() {
    let bytes = bytes_of(&small());
    let at = value_of(&bytes, "UNITS");
    assert_eq!(parse(&bytes).unwrap().unit, Unit::Mm);
    let metres = with(&bytes, at, b"m ");
    let mm = c3d::parse(Path::new("x.c3d"), &metres, Some(Unit::M)).unwrap().trajectories;
    assert_eq!(mm.frames[0].points[0].unwrap().z, 300_000.0);
    let stated = |text: &[u8; 2], unit| c3d::parse(Path::new("x.c3d"), &with(&bytes, at, text), unit);
    assert!(stated(b"cm", Some(Unit::Mm)).unwrap_err().what.contains("--marker-unit says mm"));
    assert!(stated(b"  ", None).unwrap_err().fix.unwrap().contains("--marker-unit"));
    assert!(stated(b"??", None).unwrap_err().what.contains("'??'"));
    assert!(stated(b"in", Some(Unit::Mm)).unwrap_err().what.contains("'in'"));
    assert_eq!(stated(b"  ", Some(Unit::Cm)).unwrap().unit, Unit::Cm);
    assert_eq!(stated(b"??", Some(Unit::Cm)).unwrap().warnings.len(), 1);
}

#[test]
fn what_is_no_c3d_is_refused() {
    assert!(refusal(b"").contains("is empty"));
    assert!(refusal(b"PathFileType\t4").contains("is not a C3D file"));
    assert!(refusal(&[2, 0x50, 1, 0]).contains("cut short"));
    assert!(refusal(&with(&bytes_of(&small()), 515, &[99])).contains("processor type 99"));
}

#[test]
fn a_short_file_says_how_many_frames_it_holds() {
    let bytes = bytes_of(&small());
    let data = bytes.len() - 512;
    let message = refusal(&bytes[..data + 70]);
    assert!(message.contains("holds 2 whole frames of 3"), "{message}");
    assert!(message.contains(&format!("byte {}", data + 70)), "{message}");
    // What is cut off the padding only does no harm.
    assert_eq!(parse(&bytes[..data + 96]).unwrap().trajectories, small());
}

#[test]
fn a_header_that_lies_is_refused() {
    let bytes = bytes_of(&small());
    let used = value_of(&bytes, "USED");
    let lie = |patch: &[u8]| refusal(&with(&with(&bytes, 2, patch), used, patch));
    assert!(lie(&200u16.to_le_bytes()).contains("holds 0 whole frames of 3"));
    assert!(lie(&0u16.to_le_bytes()).contains("holds no points"));
    let analog_only = with(&with(&with(&bytes, 2, &[0, 0]), used, &[0, 0]), 4, &[8, 0]);
    let analog_only = with(&analog_only, value_of_analog(&bytes), &[8, 0]);
    assert!(refusal(&with(&analog_only, 18, &[1, 0])).contains("analog data only"));
    let long = bytes_of(&without_gaps(trajectories(
        Rate::per_second(60),
        &["a"],
        &[(1, &[Some([1.0; 3])]), (200, &[Some([1.0; 3])])],
    )));
    let fewer =
        with(&with(&long, 8, &100u16.to_le_bytes()), value_of(&long, "FRAMES"), &100u16.to_le_bytes());
    assert!(refusal(&fewer).contains("does not end there"), "{}", refusal(&fewer));
}

fn value_of_analog(bytes: &[u8]) -> usize {
    bytes.windows(6).position(|window| window == b"\x04\x02USED").expect("ANALOG:USED") + 10
}

#[test]
fn the_size_of_the_file_decides_between_header_and_parameters() {
    let points: Vec<Option<[f64; 3]>> = (0..40).map(|i| Some([f64::from(i), 1.0, 2.0])).collect();
    let names: Vec<String> = (0..40).map(|i| format!("m{i}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let frames: Vec<(i64, &[Option<[f64; 3]>])> = (5..45).map(|frame| (frame, &points[..])).collect();
    let take = trajectories(Rate::per_second(60), &names, &frames);
    let bytes = bytes_of(&take);
    let patches: [(usize, &[u8], &str); 5] = [
        (2, &39u16.to_le_bytes(), "points"),
        (8, &46u16.to_le_bytes(), "frames"),
        (12, &0.1f32.to_le_bytes(), "storage"),
        (16, &5u16.to_le_bytes(), "start of the data"),
        (4, &7u16.to_le_bytes(), "analog"),
    ];
    for (at, patch, about) in patches {
        let read = parse(&with(&bytes, at, patch)).unwrap();
        assert_eq!(read.trajectories, take, "{about}");
        assert!(read.warnings.len() == 1 && read.warnings[0].starts_with(about), "{:?}", read.warnings);
    }
    let both = with(&with(&bytes, 2, &39u16.to_le_bytes()), value_of(&bytes, "USED"), &38u16.to_le_bytes());
    assert!(refusal(&both).contains("contradicts itself"));
}

#[test]
fn frames_that_may_be_padding_are_not_read() {
    let bytes = bytes_of(&small());
    let read = parse(&with(&bytes, 8, &1004u16.to_le_bytes())).unwrap();
    assert_eq!(read.trajectories, small());
    assert!(read.warnings[0].contains("the header says 4, POINT:FRAMES says 3"), "{:?}", read.warnings);
    let points = refusal(&with(&bytes, 2, &3u16.to_le_bytes()));
    assert!(points.contains("more than one fits"), "{points}");
}

#[test]
fn rates_that_disagree_are_told() {
    let bytes = bytes_of(&small());
    let read = parse(&with(&bytes, 20, &60f32.to_le_bytes())).unwrap();
    assert_eq!(read.trajectories.header.rate, Some(Rate::per_second(120)));
    assert!(read.warnings[0].contains("60 Hz"), "{:?}", read.warnings);
    let none = with(&with(&bytes, 20, &[0; 4]), value_of(&bytes, "RATE"), &[0; 4]);
    let read = parse(&none).unwrap();
    assert_eq!((read.trajectories.header.rate, read.warnings.len()), (None, 1));
}

#[test]
fn labels_that_are_empty_or_doubled_get_other_names() {
    let bytes = bytes_of(&small());
    let at = value_of(&bytes, "LABELS");
    let doubled = parse(&with(&bytes, at, b"brow_rbrow_r")).unwrap();
    assert_eq!(doubled.trajectories.header.markers, ["brow_r", "brow_r_2"]);
    let empty = parse(&with(&bytes, at, b"brow_l      ")).unwrap();
    assert_eq!(empty.trajectories.header.markers, ["brow_l", "marker_2"]);
    assert_eq!((doubled.warnings.len(), empty.warnings.len()), (1, 1));
    let latin = parse(&with(&bytes, at, b"br\xe4w_l")).unwrap();
    assert_eq!(latin.trajectories.header.markers[0], "bräw_l");
}

#[test]
fn coordinates_that_are_no_numbers_are_refused_unless_marked() {
    let bytes = bytes_of(&small());
    let data = bytes.len() - 512;
    let bad = with(&bytes, data + 32 + 4, &f32::NAN.to_le_bytes());
    let message = refusal(&bad);
    assert!(message.contains("frame 1002, marker brow_l"), "{message}");
    let marked = parse(&with(&bad, data + 32 + 12, &(-1f32).to_le_bytes())).unwrap();
    assert_eq!(marked.trajectories.frames[1].points, [None, None]);
}

#[test]
fn the_origin_is_kept_but_told() {
    let take = trajectories(Rate::per_second(60), &["a"], &[(1, &[Some([0.0; 3])])]);
    let read = parse(&bytes_of(&take)).unwrap();
    assert_eq!(read.trajectories, take);
    assert!(read.warnings[0].contains("origin"), "{:?}", read.warnings);
}

#[test]
fn more_than_255_labels_go_on_in_labels2() {
    let names: Vec<String> = (0..700).map(|i| format!("marker-{i}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let points: Vec<Option<[f64; 3]>> = (0..700).map(|i| Some([f64::from(i), 2.0, 3.0])).collect();
    let take = trajectories(Rate::per_second(60), &names, &[(0, &points)]);
    let bytes = bytes_of(&take);
    assert!(bytes.windows(7).any(|window| window == b"LABELS3"));
    assert_eq!(parse(&bytes).unwrap().trajectories, take);
}

#[test]
fn frame_numbers_beyond_16_bits_survive() {
    let one: &[Option<[f64; 3]>] = &[Some([1.0, 2.0, 3.0])];
    for (first, last) in [(65_000, 65_535), (65_000, 70_000), (70_000, 70_010), (1, 70_000), (0, 65_535)] {
        let take = trajectories(Rate::per_second(60), &["a"], &[(first, one), (last, one)]);
        let read = parse(&bytes_of(&take)).unwrap();
        assert_eq!(read.trajectories, without_gaps(take), "{first}-{last}");
        assert_eq!(read.warnings, Vec::<String>::new(), "{first}-{last}");
    }
}

#[test]
fn a_count_that_stopped_at_65535_is_read_by_the_data() {
    let one: &[Option<[f64; 3]>] = &[Some([1.0, 2.0, 3.0])];
    let take = trajectories(Rate::per_second(60), &["a"], &[(1, one), (70_000, one)]);
    let mut bytes = bytes_of(&take);
    for name in [&b"LONG_FRAMES"[..], b"ACTUAL_START_FIELD", b"ACTUAL_END_FIELD"] {
        let at = bytes.windows(name.len()).position(|window| window == name).unwrap();
        bytes[at] = b'_';
    }
    let read = parse(&bytes).unwrap();
    assert_eq!(read.trajectories, without_gaps(take));
    assert!(read.warnings[0].contains("65535"), "{:?}", read.warnings);
}

#[test]
fn the_writer_refuses_what_the_format_cannot_hold() {
    let refuse = |change: &dyn Fn(&mut Trajectories)| {
        let mut take = small();
        change(&mut take);
        written("take.c3d", |path| c3d::write(path, &take)).unwrap_err().to_string()
    };
    assert!(refuse(&|take| take.header.rate = None).contains("no frame rate"));
    assert!(refuse(&|take| take.frames.clear()).contains("no frames"));
    assert!(refuse(&|take| take.frames[0].frame = -1).contains("-1"));
    assert!(refuse(&|take| take.frames[2].frame = 1 << 25).contains("16777216"));
    assert!(refuse(&|take| take.header.markers[0] = " a".into()).contains("' a'"));
    assert!(refuse(&|take| take.header.markers[0] = "a".repeat(128)).contains("127 bytes"));
    assert!(refuse(&|take| take.header.markers[0] = "brow_r".into()).contains("twice"));
    let infinite = refuse(&|take| take.frames[1].points[0] = Some([f64::NAN, 0.0, 0.0].into()));
    assert!(infinite.contains("frame 1002, marker brow_l"), "{infinite}");
    assert!(refuse(&|take| take.frames[1].points[0] = Some([1e39, 0.0, 0.0].into())).contains("too large"));
}

/// A file with analog values between the points, integers, its group after the parameters, all of it by hand.
#[test]
fn analog_values_are_passed_over() {
    let mut bytes = vec![0u8; 1024];
    bytes[..4].copy_from_slice(&[2, 0x50, 1, 0]);
    for (at, word) in [(4, 6u16), (6, 10), (8, 11), (16, 3), (18, 2)] {
        bytes[at..at + 2].copy_from_slice(&word.to_le_bytes());
    }
    bytes[12..16].copy_from_slice(&0.5f32.to_le_bytes());
    bytes[20..24].copy_from_slice(&59.94f32.to_le_bytes());
    bytes[512..516].copy_from_slice(&[0, 0, 1, 84]);
    let list: &[&[u8]] =
        &[b"\x05\x07UNITS\x08\x00\xff\x01\x02cm\x00", b"\xfb\xf9POINT\x03\x00\x00", b"\x00\x00"];
    let list = list.concat();
    bytes[516..516 + list.len()].copy_from_slice(&list);
    for frame in 0..2i16 {
        let words = [10 + frame, -20, 30, if frame == 0 { 0 } else { -1 }, 901, 902, 903, 904, 905, 906];
        words.iter().for_each(|word| bytes.extend(word.to_le_bytes()));
    }
    let read = parse(&bytes).unwrap();
    let take = trajectories(
        Rate { frames: 60_000, seconds: 1001 },
        &["marker_1"],
        &[(10, &[Some([50.0, -100.0, 150.0])]), (11, &[None])],
    );
    assert_eq!(read.trajectories, take);
    assert_eq!((read.storage, read.unit), (Storage::Integer, Unit::Cm));
}

#[test]
fn cuts_and_flips_never_panic() {
    let bytes = bytes_of(&small());
    for cut in 0..bytes.len() {
        let _ = parse(&bytes[..cut]);
    }
    // One flip in the header or the parameters, anywhere, then a cut as well.
    for at in 0..bytes.len() {
        for value in [0, 1, 2, 127, 128, 255, bytes[at].wrapping_add(1)] {
            let flipped = with(&bytes, at, &[value]);
            let _ = parse(&flipped);
            let _ = parse(&flipped[..bytes.len() - 450]);
        }
    }
}

proptest! {
    #[test]
    fn round_trip(take in any_trajectories()) {
        let read = parse(&bytes_of(&take)).unwrap();
        prop_assert_eq!(read.trajectories, without_gaps(take));
        prop_assert_eq!(read.storage, Storage::Real);
    }

    #[test]
    fn any_bytes_are_read_or_refused(mut bytes in prop::collection::vec(any::<u8>(), 0..3000)) {
        let _ = parse(&bytes);
        // Past the first checks too.
        for (at, value) in [(0, 2), (1, 0x50), (515, 84)] {
            if let Some(byte) = bytes.get_mut(at) {
                *byte = value;
            }
        }
        let _ = parse(&bytes);
    }

    #[test]
    fn many_flips_are_read_or_refused(flips in prop::collection::vec((0usize..1536, any::<u8>()), 1..12)) {
        let mut bytes = bytes_of(&small());
        for (at, value) in flips {
            if at != 515 && at > 1 {
                bytes[at] = value;
            }
        }
        let _ = parse(&bytes);
    }
}
