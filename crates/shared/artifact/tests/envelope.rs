//! The envelope: schema first, places of errors, rising frames, finite numbers, exact floats.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod support;

use artifact::{
    Correspondence, FrameReader, FrameWriter, Handle, HandleFrame, Handles, HandlesHeader, HeadPose,
    HeadPoseFrame, HeadPoseHeader, HeadTrajectories, Interpolant, LargeScale, MarkerFrame, MarkerHeader,
    Pair, Rate, ResponseBasis, SampleStatus, Take, Trajectories, Trajectories3d, Unit, VertexMapping,
    VertexSet, Warp, read_document,
};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::path::Path;
use support::{
    Place, any_number, document_refusal, file_ref, fixture, frame_refusal, mesh_ref, refusal, says,
    stream_refusal, text, written_refusal,
};

#[test]
fn another_kind_is_refused_by_name() {
    let message = document_refusal::<Warp>(&text("take-1/take.json"));
    says(&message, &["a.json, schema: holds 'take/1', not 'warp/1'", "to do: give a warp artifact here"]);
    let message = stream_refusal::<Handles>(&text("head-pose-1/head-pose.jsonl"));
    says(&message, &["holds 'head-pose/1', not 'handles/1'"]);
}

#[test]
fn a_newer_version_is_refused_by_name_whatever_its_form() {
    for newer in [
        r#"{"schema":"warp/2","data":{}}"#,
        r#"{"schema":"warp/2","payload":[],"units":"mm"}"#,
        r#"{"data":{"x":1},"schema":"warp/2"}"#,
    ] {
        let message = document_refusal::<Warp>(newer);
        says(&message, &["is warp/2; this program reads up to warp/1", "newer Furrow"]);
    }
    let message = stream_refusal::<Handles>(r#"{"schema":"handles/7","header":{}}"#);
    says(&message, &["is handles/7; this program reads up to handles/1"]);
}

#[test]
fn a_version_that_is_none_is_refused() {
    for odd in ["warp", "warp/", "warp/0", "warp/x", "warp/-1"] {
        let message = document_refusal::<Warp>(&format!(r#"{{"schema":"{odd}","data":{{}}}}"#));
        says(&message, &[&format!("'{odd}' has no version that this program knows")]);
    }
}

#[test]
fn what_is_no_envelope_is_refused_with_its_form() {
    for wrong in
        ["", "[1, 2]", "v 0 0 0\nf 1 2 3\n", "{}", r#"{"schema":1,"data":{}}"#, "{\"schema\":\"warp/1\"}"]
    {
        let message = document_refusal::<Warp>(wrong);
        says(
            &message,
            &["a.json, line 1", "is not a warp/1 artifact", r#"must start with {"schema":"warp/1""#],
        );
    }
}

#[test]
fn unknown_fields_are_refused_everywhere() {
    let vertices = text("vertex-set-1/vertex-set.json");
    let beside = vertices.replace(r#""data":"#, r#""note":"x","data":"#);
    says(&document_refusal::<VertexSet>(&beside), &["unknown field `note`"]);
    let inside = vertices.replace(r#""name":"ear""#, r#""name":"ear","colour":"red""#);
    says(&document_refusal::<VertexSet>(&inside), &["does not follow vertex-set/1: unknown field `colour`"]);
    let deeper = vertices.replace(r#""unit":"mm""#, r#""unit":"mm","axis":"y""#);
    says(&document_refusal::<VertexSet>(&deeper), &["unknown field `axis`"]);
    let frames = text("handles-1/handles.jsonl");
    let in_frame = frames.replace(r#"{"frame":1002,"#, r#"{"frame":1002,"weight":{},"#);
    says(
        &stream_refusal::<Handles>(&in_frame),
        &["line 3, column", "is not a frame of handles/1", "`weight`"],
    );
}

#[test]
fn errors_in_documents_of_many_lines_name_line_and_column() {
    let wrong = "{\n  \"schema\": \"vertex-set/1\",\n  \"data\": {\n    \"mesh\": 7\n  }\n}\n";
    says(&document_refusal::<VertexSet>(wrong), &["a.json, line 4, column 13: does not follow vertex-set/1"]);
    let first_line_of_data = "{\n  \"schema\": \"vertex-set/1\",\n  \"data\": { \"mesh\": 7 }\n}\n";
    says(&document_refusal::<VertexSet>(first_line_of_data), &["a.json, line 3, column 21: "]);
    let no_json = "{\n  \"schema\": \"vertex-set/1\",\n  \"data\": {\n    \"mesh\": ,\n";
    says(&document_refusal::<VertexSet>(no_json), &["a.json, line 4, column 13: ", "expected value"]);
}

#[test]
fn errors_in_frames_name_the_line() {
    let frames = text("handles-1/handles.jsonl");
    let wrong = frames.replace("[0.0,1.0,-0.25]", "[0.0,true,-0.25]");
    says(&stream_refusal::<Handles>(&wrong), &["a.jsonl, line 4, column ", "invalid type: boolean `true`"]);
    let unknown = frames.replace(r#""weights":{"brow_l":2.5}"#, r#""weights":{"brow_r":2.5}"#);
    let message = stream_refusal::<Handles>(&unknown);
    says(&message, &["a.jsonl, line 3, frame 1002, marker brow_r: is not among the header's handles"]);
    let blank_lines_count = format!("{frames}\n\n{{}}\n");
    says(&stream_refusal::<Handles>(&blank_lines_count), &["a.jsonl, line 7, "]);
}

#[test]
fn a_last_line_that_is_cut_short_is_refused_as_such() {
    let frames = text("trajectories-3d-1/trajectories-3d.jsonl");
    let last = frames.trim_end().rfind('\n').unwrap() + 1;
    for cut in last + 1..frames.trim_end().len() {
        let message = stream_refusal::<Trajectories3d>(&frames[..cut]);
        says(&message, &["a.jsonl, line 4, column ", "the file may have been cut short"]);
    }
}

#[test]
fn frames_that_do_not_rise_are_refused() {
    let frames = text("handles-1/handles.jsonl");
    for (number, again) in [("1004", "1002"), ("1004", "7")] {
        let falling = frames.replace(&format!(r#""frame":{number}"#), &format!(r#""frame":{again}"#));
        let message = stream_refusal::<Handles>(&falling);
        says(&message, &[&format!("a.jsonl, line 4: frame {again} follows frame 1002"), "must rise"]);
    }
    let place = Place::new();
    let mut writer =
        FrameWriter::<HeadTrajectories>::create(&place.path("t.jsonl"), marker_header()).unwrap();
    writer.write(&marker_frame(5, 0.0)).unwrap();
    let message = refusal(writer.write(&marker_frame(5, 0.0)));
    says(&message, &["t.jsonl, frame 5: would follow frame 5"]);
}

#[test]
fn a_stream_without_frames_is_refused_where_frames_are_needed() {
    let frames = text("head-trajectories-1/head-trajectories.jsonl");
    let header = frames.lines().next().unwrap();
    let path = Place::new();
    let path = path.file("a.jsonl", header);
    says(&refusal(Trajectories::read::<HeadTrajectories>(&path)), &["holds no frames"]);
    says(&stream_refusal::<HeadTrajectories>(""), &["line 1", "is not a head-trajectories/1 artifact"]);
}

#[test]
fn a_missing_file_is_refused_by_name() {
    let message = refusal(read_document::<Take>(Path::new("no/such/take.json")));
    says(&message, &["take.json: cannot read", "to do: check the path"]);
}

#[test]
fn bytes_that_are_no_text_are_refused_with_their_line() {
    let mut frames = text("handles-1/handles.jsonl").into_bytes();
    let at = frames.len() - 20;
    frames[at] = 0xff;
    let place = Place::new();
    let path = place.file("a.jsonl", &frames);
    let read = FrameReader::<Handles>::open(&path).unwrap().collect::<artifact::Result<Vec<_>>>();
    says(&refusal(read), &["a.jsonl, line 4: cannot read: ", "UTF-8"]);
    let path = place.file("a.json", b"{\"schema\":\n\"warp/1\xff\"}");
    says(&refusal(read_document::<Warp>(&path)), &["a.json, line 2 (byte 18): is not text"]);
}

#[test]
fn a_byte_order_mark_is_passed_over() {
    let place = Place::new();
    let warp = place.file("warp.json", format!("\u{feff}{}", text("warp-1/warp.json")));
    assert_eq!(read_document::<Warp>(&warp).unwrap(), read_document(&fixture("warp-1/warp.json")).unwrap());
    let read = |path: &Path| FrameReader::<Handles>::open(path).unwrap().map(Result::unwrap).count();
    let handles = place.file("handles.jsonl", format!("\u{feff}{}", text("handles-1/handles.jsonl")));
    assert_eq!(read(&handles), read(&fixture("handles-1/handles.jsonl")));
}

#[test]
fn a_document_reads_however_it_is_laid_out() {
    let value: serde_json::Value = serde_json::from_str(&text("warp-1/warp.json")).unwrap();
    let place = Place::new();
    let pretty =
        place.file("pretty.json", serde_json::to_string_pretty(&value).unwrap().replace('\n', "\r\n"));
    let frozen: Warp = read_document(&fixture("warp-1/warp.json")).unwrap();
    assert_eq!(read_document::<Warp>(&pretty).unwrap(), frozen);
}

// Numbers that are not finite

fn marker_header() -> MarkerHeader {
    MarkerHeader { unit: Unit::Mm, rate: None, markers: vec!["a".into(), "b".into()], take: None }
}

fn marker_frame(frame: i64, x: f64) -> MarkerFrame {
    MarkerFrame {
        frame,
        points: vec![None, Some(Point3::new(0.0, x, 0.0))],
        status: vec![SampleStatus::Measured; 2],
    }
}

fn pose_frame(frame: i64, x: f64, residual_mm: f64) -> HeadPoseFrame {
    let pose = Isometry3::from_parts(Translation3::new(0.0, 0.0, x), UnitQuaternion::identity());
    HeadPoseFrame { frame, world_from_head: Some(pose), residual_mm: Some(residual_mm), markers_used: 3 }
}

fn handles_header() -> HandlesHeader {
    let handles = vec![Handle { marker: "a".into(), vertex: 0 }, Handle { marker: "b".into(), vertex: 1 }];
    HandlesHeader { mesh: mesh_ref(2), rate: None, handles, take: None, warp: None }
}

fn handle_frame(frame: i64, x: f64, weight: f64) -> HandleFrame {
    HandleFrame {
        frame,
        displacements: vec![None, Some(Vector3::new(0.0, x, 0.0))],
        weights: vec![None, Some(weight)],
    }
}

#[test]
fn writers_of_frames_refuse_numbers_that_are_not_finite() {
    for x in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let wrong = format!("{x} is not a finite number");
        let message = frame_refusal::<Trajectories3d>(marker_header(), &marker_frame(3, x));
        assert_eq!(message, format!("a.jsonl, frame 3, marker b: {wrong}"));
        let message = frame_refusal::<HeadTrajectories>(marker_header(), &marker_frame(3, x));
        assert_eq!(message, format!("a.jsonl, frame 3, marker b: {wrong}"));
        let header =
            HeadPoseHeader { rate: None, reference_frame: 0, markers: vec!["a".to_string()], take: None };
        let message = frame_refusal::<HeadPose>(header.clone(), &pose_frame(3, x, 0.0));
        assert_eq!(message, format!("a.jsonl, frame 3, world_from_head: {wrong}"));
        let message = frame_refusal::<HeadPose>(header, &pose_frame(3, 0.0, x));
        assert_eq!(message, format!("a.jsonl, frame 3, residual_mm: {wrong}"));
        let message = frame_refusal::<Handles>(handles_header(), &handle_frame(3, x, 1.0));
        assert_eq!(message, format!("a.jsonl, frame 3, marker b: {wrong}"));
        let message = frame_refusal::<Handles>(handles_header(), &handle_frame(3, 0.0, x));
        says(&message, &["a.jsonl, frame 3, marker b: the weight"]);
    }
}

#[test]
fn writers_of_documents_refuse_numbers_that_are_not_finite() {
    let mut pair = Pair { marker: "a".into(), vertex: 0, position_mm: [0.0; 3] };
    pair.position_mm[2] = f64::NAN;
    let message = written_refusal(&Correspondence { mesh: mesh_ref(1), pairs: vec![pair] });
    assert_eq!(message, "a.json, marker a: NaN is not a finite number");

    let sound: Warp = read_document(&fixture("warp-1/warp.json")).unwrap();
    type Break = (&'static str, fn(&mut Warp));
    let breaks: [Break; 6] = [
        ("face_from_mocap: NaN", |warp| warp.face_from_mocap.centers[0][1] = f64::NAN),
        ("mocap_from_face: inf", |warp| warp.mocap_from_face.weights[0][1] = f64::INFINITY),
        ("face_from_mocap: NaN", |warp| warp.face_from_mocap.scale_mm = f64::NAN),
        ("fit: inf", |warp| warp.fit.condition = f64::INFINITY),
        ("fit, marker lip_r: NaN", |warp| *warp.fit.leave_one_out_mm.get_mut("lip_r").unwrap() = f64::NAN),
        ("fit, marker nose: NaN", |warp| {
            *warp.fit.similarity_residual_mm.get_mut("nose").unwrap() = f64::NAN
        }),
    ];
    for (place, break_it) in breaks {
        let mut warp = sound.clone();
        break_it(&mut warp);
        assert_eq!(written_refusal(&warp), format!("a.json, {place} is not a finite number"));
    }

    let mut basis: ResponseBasis = read_document(&fixture("response-basis-1/response-basis.json")).unwrap();
    basis.schur[1][0] = f64::NAN;
    assert_eq!(written_refusal(&basis), "a.json, schur: NaN is not a finite number");
}

#[test]
fn readers_refuse_numbers_that_are_too_large() {
    let frames = text("handles-1/handles.jsonl").replace("0.25,0.0,0.0", "1e999,0.0,0.0");
    says(&stream_refusal::<Handles>(&frames), &["line 4, column ", "number out of range"]);
}

// What makes no sense

#[test]
fn documents_that_make_no_sense_are_refused_with_their_place() {
    let sound: Warp = read_document(&fixture("warp-1/warp.json")).unwrap();
    let odd = Interpolant { polynomial: vec![[0.0; 3]; 3], ..sound.face_from_mocap.clone() };
    let message = written_refusal(&Warp { face_from_mocap: odd, ..sound.clone() });
    says(&message, &["a.json, face_from_mocap: has 4 centers, 4 weights and 3 polynomial terms"]);
    let message = written_refusal(&Warp { vertices: vec![1], ..sound });
    says(&message, &["a.json, markers: 4 ids and 1 vertices for 4 centers"]);

    let set = VertexSet { mesh: mesh_ref(3), name: "n".into(), vertices: vec![0, 2, 1] };
    says(&written_refusal(&set), &["a.json, vertices: vertex 1 follows 2; they must rise"]);
    let set = VertexSet { vertices: vec![0, 3], ..set };
    says(&written_refusal(&set), &["a.json, vertices: names vertex 3 of a mesh that has 3"]);

    let map = VertexMapping {
        old: mesh_ref(3),
        new: mesh_ref(1),
        new_from_old: vec![Some(0), Some(0), None],
        old_from_new: vec![0],
    };
    says(&written_refusal(&map), &["old vertex 1: old_from_new does not lead back from its new vertex"]);

    let scale = LargeScale {
        mesh: mesh_ref(1),
        cache: "a.pc2".into(),
        form: artifact::SequenceForm::Pc2,
        rate: None,
        frames: vec![3, 3],
        take: None,
    };
    says(&written_refusal(&scale), &["a.json, frames: frame 3 follows frame 3; they must rise"]);
    let elsewhere = LargeScale { cache: "../a.pc2".into(), frames: vec![], ..scale.clone() };
    says(&written_refusal(&elsewhere), &["a.json, cache: must be a file name in the same folder"]);
    let timeless = LargeScale {
        form: artifact::SequenceForm::Pc2,
        rate: Some(Rate { frames: 0, seconds: 1 }),
        frames: vec![],
        ..scale
    };
    says(&written_refusal(&timeless), &["a.json, rate: 0 frames in 1 seconds is no rate"]);
}

#[test]
fn headers_that_make_no_sense_are_refused_with_their_place() {
    let place = Place::new();
    let create = |header| FrameWriter::<HeadTrajectories>::create(&place.path("a.jsonl"), header).map(|_| ());
    let doubled = MarkerHeader { markers: vec!["a".into(), "a".into()], ..marker_header() };
    assert_eq!(refusal(create(doubled)), "a.jsonl, markers: the id a stands twice");
    let unnamed = MarkerHeader { markers: vec![String::new()], ..marker_header() };
    assert_eq!(refusal(create(unnamed)), "a.jsonl, markers: a marker has an empty id");
    let metres = MarkerHeader { unit: Unit::M, ..marker_header() };
    assert_eq!(refusal(create(metres)), "a.jsonl, unit: is m; this kind is always in mm");
    let timeless = MarkerHeader { rate: Some(Rate { frames: 30, seconds: 0 }), ..marker_header() };
    assert_eq!(refusal(create(timeless)), "a.jsonl, rate: 30 frames in 0 seconds is no rate");

    let mut header = handles_header();
    header.handles[1].vertex = 0;
    let message = refusal(FrameWriter::<Handles>::create(&place.path("a.jsonl"), header).map(|_| ()));
    assert_eq!(message, "a.jsonl, marker b: sits on vertex 0, as marker a does");
    let header = HandlesHeader { mesh: mesh_ref(1), ..handles_header() };
    let message = refusal(FrameWriter::<Handles>::create(&place.path("a.jsonl"), header).map(|_| ()));
    assert_eq!(message, "a.jsonl, marker b: names vertex 1 of a mesh that has 1");
    assert!(place.names().is_empty());
}

#[test]
fn a_rotation_that_is_none_is_refused() {
    let poses = text("head-pose-1/head-pose.jsonl").replace("[0.8,0.0,0.6,0.0]", "[0.8,0.0,0.7,0.0]");
    says(
        &stream_refusal::<HeadPose>(&poses),
        &["line 3, frame 1002: the rotation's quaternion has length 1.06"],
    );
}

#[test]
fn references_name_what_differs() {
    let this = mesh_ref(4);
    assert_eq!(this.mismatch(&this), None);
    let other = artifact::MeshRef { unit: Unit::Cm, ..this.clone() };
    assert_eq!(this.mismatch(&other).unwrap(), "was made with scan.obj in mm, not in cm");
    let other = artifact::FileRef { sha256: artifact::sha256_of(b"other"), ..file_ref() };
    let other = artifact::MeshRef { file: other, ..this.clone() };
    says(&this.mismatch(&other).unwrap(), &["was made for mesh scan.obj (sha256 ", "not for scan.obj"]);
}

proptest! {
    #[test]
    fn floats_come_back_bit_by_bit(numbers in proptest::collection::vec(prop::array::uniform3(any_number()), 1..9)) {
        let place = Place::new();
        let path = place.path("t.jsonl");
        let frames: Vec<MarkerFrame> = numbers.iter().enumerate().map(|(frame, &point)| MarkerFrame {
            frame: frame as i64 - 3,
            points: vec![Some(point.into()), None],
            status: vec![SampleStatus::Measured; 2],
        }).collect();
        let written = Trajectories { header: marker_header(), frames };
        written.write::<HeadTrajectories>(&path).unwrap().publish().unwrap();
        let read = Trajectories::read::<HeadTrajectories>(&path).unwrap();
        let bits = |all: &Trajectories| -> Vec<[u64; 3]> {
            all.frames.iter().map(|frame| frame.points[0].unwrap().coords.map(f64::to_bits).into()).collect()
        };
        prop_assert_eq!(bits(&read), bits(&written));
        prop_assert_eq!(read, written);
    }

    #[test]
    fn readers_never_panic(text in "\\PC*|(\\{\"schema\":\"handles/1\",\"data\":)?[\\[\\]{}\":,0-9a-z.\n-]{0,60}") {
        let place = Place::new();
        let path = place.file("a", &text);
        let _ = read_document::<Take>(&path);
        let _ = read_document::<Warp>(&path);
        if let Ok(reader) = FrameReader::<Handles>::open(&path) {
            let _ = reader.collect::<artifact::Result<Vec<_>>>();
        }
    }

    /// Any one byte of a sound file changed: it reads as something that can be written, or is refused.
    #[test]
    fn a_changed_byte_never_panics(at in 0usize..100_000, byte in any::<u8>()) {
        let mut bytes = std::fs::read(fixture("head-trajectories-1/head-trajectories.jsonl")).unwrap();
        let at = at % bytes.len();
        bytes[at] = byte;
        let place = Place::new();
        let path = place.file("a.jsonl", &bytes);
        if let Ok(read) = Trajectories::read::<HeadTrajectories>(&path) {
            read.write::<HeadTrajectories>(&place.path("b.jsonl")).unwrap().publish().unwrap();
        }
    }
}
