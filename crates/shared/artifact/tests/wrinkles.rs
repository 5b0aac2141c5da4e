//! Wrinkles: curves, cross-sections, valleys on the mesh, wrinkled sequences.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod support;

use artifact::{
    Curve2d, CurveState, LargeScale, MeshSequence, PaintWidth, PerCamera, Profile, Section, SectionDeviation,
    SectionState, Sections, SectionsFrame, SectionsHeader, Space, ValleyPoint, Valleys, ValleysFrame,
    ValleysHeader, Wrinkle, Wrinkled, Wrinkles2d, Wrinkles2dFrame, Wrinkles2dHeader,
};
use proptest::collection::{btree_map, vec};
use proptest::prelude::*;
use std::collections::BTreeMap;
use support::{
    any_number, document_again, document_refusal, fixture, frame_refusal, header_refusal, mesh_ref, refusal,
    says, stream_again, stream_refusal, text, written_refusal,
};

fn wrinkles() -> Vec<Wrinkle> {
    let wrinkle = |id: &str, paint: Option<&str>| Wrinkle { id: id.into(), paint: paint.map(String::from) };
    vec![wrinkle("brow_1", Some("red")), wrinkle("brow_2", None)]
}

fn one<T>(value: T) -> PerCamera<T> {
    [("w1".to_string(), [("brow_1".to_string(), value)].into())].into()
}

fn any_id<const N: usize>(ids: [&'static str; N]) -> impl Strategy<Value = String> {
    prop::sample::select(ids.map(String::from).to_vec())
}

/// Values of some wrinkles in some cameras.
fn anywhere<T: std::fmt::Debug>(value: impl Strategy<Value = T>) -> impl Strategy<Value = PerCamera<T>> {
    btree_map(any_id(["w1", "w2"]), btree_map(any_id(["brow_1", "brow_2"]), value, 0..3), 0..3)
}

/// Places along a curve: rising.
fn rising(most: f64, count: usize) -> impl Strategy<Value = Vec<f64>> {
    vec(0.0..most, 0..count).prop_map(|mut places| {
        places.sort_by(f64::total_cmp);
        places.dedup();
        places
    })
}

fn any_unit<const N: usize>() -> impl Strategy<Value = [f64; N]> {
    vec(-1.0..1.0f64, N).prop_filter_map("too short", |vector| {
        let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
        let unit: Vec<f64> = vector.iter().map(|x| x / length).collect();
        (length > 0.1).then(|| unit.try_into().unwrap())
    })
}

// Curves

fn curves_header() -> Wrinkles2dHeader {
    Wrinkles2dHeader { cameras: vec!["w1".into(), "w2".into()], wrinkles: wrinkles(), rate: None, take: None }
}

fn any_curve() -> impl Strategy<Value = Curve2d> {
    let state = prop::sample::select(vec![CurveState::Seen, CurveState::Held, CurveState::Edited]);
    let sure = prop_oneof![Just(1.0), 0.0..=1.0];
    (vec(prop::array::uniform2(any_number()), 4..13), state, sure).prop_flat_map(
        |(controls, state, confidence)| {
            rising((controls.len() - 3) as f64, 5).prop_map(move |places| {
                let width = |u| PaintWidth { u, left_px: u + 0.5, right_px: 2.0 * u };
                let paint = places.into_iter().map(width).collect();
                Curve2d { controls: controls.clone(), state, confidence, paint }
            })
        },
    )
}

proptest! {
    #[test]
    fn curves_come_back(all in vec(anywhere(any_curve()), 0..4)) {
        let frame = |(i, curves)| Wrinkles2dFrame { frame: i as i64 + 1001, curves };
        let frames: Vec<Wrinkles2dFrame> = all.into_iter().enumerate().map(frame).collect();
        prop_assert_eq!(stream_again::<Wrinkles2d>(&curves_header(), &frames), frames);
    }
}

#[test]
fn curves_that_make_no_sense_are_refused() {
    let sound = Curve2d {
        controls: vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [4.0, 0.0]],
        state: CurveState::Seen,
        confidence: 1.0,
        paint: vec![
            PaintWidth { u: 0.0, left_px: 1.0, right_px: 1.0 },
            PaintWidth { u: 2.0, left_px: 0.0, right_px: 1.0 },
        ],
    };
    type Break = (&'static str, fn(&mut Curve2d));
    let breaks: [Break; 8] = [
        (": 3 control points make no cubic curve", |curve| curve.controls.truncate(3)),
        (", controls: NaN is not a finite number", |curve| curve.controls[1][1] = f64::NAN),
        (": the confidence 2 is not in 0.0..=1.0", |curve| curve.confidence = 2.0),
        (", paint: u 2.5 is not in 0.0..=2.0", |curve| curve.paint[1].u = 2.5),
        (", paint: u NaN is not in 0.0..=2.0", |curve| curve.paint[1].u = f64::NAN),
        (", paint: u 0 follows u 0; they must rise", |curve| curve.paint[1].u = 0.0),
        (", paint: left_px -1 is not in 0.0..inf", |curve| curve.paint[0].left_px = -1.0),
        (", paint: right_px inf is not in 0.0..inf", |curve| curve.paint[0].right_px = f64::INFINITY),
    ];
    let refused = |curve: &Curve2d| {
        let frame = Wrinkles2dFrame { frame: 3, curves: one(curve.clone()) };
        frame_refusal::<Wrinkles2d>(curves_header(), &frame)
    };
    for (message, break_it) in breaks {
        let mut curve = sound.clone();
        break_it(&mut curve);
        assert_eq!(refused(&curve), format!("a.jsonl, frame 3, camera w1, wrinkle brow_1{message}"));
    }
}

#[test]
fn frames_name_only_cameras_and_wrinkles_of_the_header() {
    let sound = text("wrinkles-2d-1/wrinkles-2d.jsonl");
    let message = stream_refusal::<Wrinkles2d>(&sound.replacen(r#""left":{}"#, r#""top":{}"#, 1));
    assert_eq!(message, "a.jsonl, line 2, frame 1001, camera top: is not among the header's cameras");
    let message =
        stream_refusal::<Wrinkles2d>(&sound.replace(r#""brow_2":{"controls""#, r#""brow_3":{"controls""#));
    says(&message, &["line 4, frame 1004, camera right, wrinkle brow_3: is not among the header's wrinkles"]);
    says(
        &stream_refusal::<Wrinkles2d>(&sound.replace("held", "kept")),
        &["line 3, column", "`kept`", "`held`"],
    );
    let twice = Wrinkles2dHeader { wrinkles: vec![wrinkles()[0].clone(); 2], ..curves_header() };
    assert_eq!(header_refusal::<Wrinkles2d>(twice), "a.jsonl, wrinkles: the id brow_1 stands twice");
    let unnamed = Wrinkles2dHeader { cameras: vec![String::new()], ..curves_header() };
    assert_eq!(header_refusal::<Wrinkles2d>(unnamed), "a.jsonl, cameras: a camera has an empty id");
}

// Sections

fn sections_header(profile: Profile) -> SectionsHeader {
    let Wrinkles2dHeader { cameras, wrinkles, rate, take } = curves_header();
    SectionsHeader { cameras, wrinkles, profile, rate, take }
}

fn any_section(u: f64) -> impl Strategy<Value = Section> {
    let states = [SectionState::Measured, SectionState::Flat, SectionState::Failed, SectionState::Edited];
    let state = prop::sample::select(states.to_vec());
    let deviation = (0.0..9.0, 0.0..9.0).prop_map(|(w_px, d_px)| SectionDeviation { w_px, d_px });
    let optional = (prop::option::of(any_number()), prop::option::of(deviation), prop::option::of(0.0..9.0));
    let shape = (0.1..99.0, 0.1..99.0, 0.0..0.999, -0.999..0.999);
    (prop::array::uniform2(any_number()), any_unit(), shape, optional, state).prop_map(
        move |(at, normal, (w_px, d_px, epsilon, kappa), (tilt_rad, deviation, residual), state)| {
            let d_px = if state == SectionState::Flat { 0.0 } else { d_px };
            Section { u, at, normal, w_px, d_px, epsilon, kappa, tilt_rad, deviation, residual, state }
        },
    )
}

fn any_sections() -> impl Strategy<Value = Vec<Section>> {
    rising(20.0, 5).prop_flat_map(|places| places.into_iter().map(any_section).collect::<Vec<_>>())
}

proptest! {
    #[test]
    fn sections_come_back(all in vec(anywhere(any_sections()), 0..4)) {
        let frame = |(i, sections)| SectionsFrame { frame: i as i64 + 1001, sections };
        let frames: Vec<SectionsFrame> = all.into_iter().enumerate().map(frame).collect();
        prop_assert_eq!(stream_again::<Sections>(&sections_header(Profile::Rounded), &frames), frames);
    }
}

fn sound_section() -> Section {
    Section {
        u: 0.5,
        at: [10.0, 20.0],
        normal: [0.6, -0.8],
        w_px: 4.0,
        d_px: 1.0,
        epsilon: 0.0,
        kappa: 0.0,
        tilt_rad: None,
        deviation: None,
        residual: None,
        state: SectionState::Measured,
    }
}

#[test]
fn sections_that_make_no_sense_are_refused() {
    type Break = (&'static str, fn(&mut Section));
    let breaks: [Break; 12] = [
        ("NaN is not a finite number", |section| section.at[1] = f64::NAN),
        ("inf is not a finite number", |section| section.tilt_rad = Some(f64::INFINITY)),
        ("the normal has length 0.5, not 1", |section| section.normal = [0.0, 0.5]),
        ("the normal has length NaN, not 1", |section| section.normal = [0.0, f64::NAN]),
        ("w_px -1 is not in 0.0..inf", |section| section.w_px = -1.0),
        ("d_px NaN is not in 0.0..inf", |section| section.d_px = f64::NAN),
        ("epsilon 1 is not in 0.0..1.0", |section| section.epsilon = 1.0),
        ("kappa -1 is not between -1 and 1", |section| section.kappa = -1.0),
        ("the residual -1 is not in 0.0..inf", |section| section.residual = Some(-1.0)),
        ("the deviation inf is not in 0.0..inf", |section| {
            section.deviation = Some(SectionDeviation { w_px: f64::INFINITY, d_px: 0.0 });
        }),
        ("is flat with a depth of 1 px", |section| section.state = SectionState::Flat),
        ("is measured, but has no width or no depth; say flat or failed", |section| section.d_px = 0.0),
    ];
    let refused = |profile, section| {
        let frame = SectionsFrame { frame: 3, sections: one(vec![section]) };
        frame_refusal::<Sections>(sections_header(profile), &frame)
    };
    let place = "a.jsonl, frame 3, camera w1, wrinkle brow_1, u 0.5: ";
    for (message, break_it) in breaks {
        let mut section = sound_section();
        break_it(&mut section);
        assert_eq!(refused(Profile::Rounded, section), format!("{place}{message}"));
    }
    let rounded = Section { epsilon: 0.1, ..sound_section() };
    says(&refused(Profile::S, rounded), &[place, "which the profile s has not"]);
    let negative = Section { u: -0.5, ..sound_section() };
    says(&refused(Profile::S, negative), &["brow_1, u -0.5: u -0.5 is not in 0.0.."]);
    let frame = SectionsFrame { frame: 3, sections: one(vec![sound_section(); 2]) };
    let message = frame_refusal::<Sections>(sections_header(Profile::S), &frame);
    says(&message, &["wrinkle brow_1: u 0.5 follows u 0.5; they must rise"]);
}

// Valleys

fn valleys_header() -> ValleysHeader {
    ValleysHeader { mesh: mesh_ref(5), wrinkles: wrinkles(), rate: None, take: None, space: Space::Face }
}

fn any_valley_point(x_mm: f64) -> impl Strategy<Value = ValleyPoint> {
    let shares = (0.0..=1.0f64, 0.0..=1.0f64).prop_map(|(a, b)| [a, (1.0 - a) * b, (1.0 - a) * (1.0 - b)]);
    let shape = (0.0..99.0, 0.0..99.0, 0.0..0.999, -0.999..0.999);
    (any::<u32>(), shares, prop::array::uniform3(any_number()), any_unit(), any_unit(), shape).prop_map(
        move |(face, barycentric, at_mm, normal, across, (w_mm, d_mm, epsilon, kappa))| ValleyPoint {
            x_mm,
            face,
            barycentric,
            at_mm,
            normal,
            across,
            w_mm,
            d_mm,
            epsilon,
            kappa,
        },
    )
}

fn any_valley() -> impl Strategy<Value = Vec<ValleyPoint>> {
    rising(80.0, 5).prop_flat_map(|places| places.into_iter().map(any_valley_point).collect::<Vec<_>>())
}

proptest! {
    #[test]
    fn valleys_come_back(all in vec(btree_map(any_id(["brow_1", "brow_2"]), any_valley(), 0..3), 0..4)) {
        let frame = |(i, valleys)| ValleysFrame { frame: i as i64 + 1001, valleys };
        let frames: Vec<ValleysFrame> = all.into_iter().enumerate().map(frame).collect();
        prop_assert_eq!(stream_again::<Valleys>(&valleys_header(), &frames), frames);
    }
}

#[test]
fn valleys_that_make_no_sense_are_refused() {
    let sound = ValleyPoint {
        x_mm: 1.0,
        face: 2,
        barycentric: [0.5, 0.25, 0.25],
        at_mm: [0.0; 3],
        normal: [0.0, 0.0, 1.0],
        across: [1.0, 0.0, 0.0],
        w_mm: 1.5,
        d_mm: 0.5,
        epsilon: 0.0,
        kappa: 0.0,
    };
    type Break = (&'static str, fn(&mut ValleyPoint));
    let breaks: [Break; 8] = [
        ("NaN is not a finite number", |point| point.at_mm[2] = f64::NAN),
        ("inf is not a finite number", |point| point.x_mm = f64::INFINITY),
        ("the shares [1.5, -0.5, 0.0] lie outside the triangle", |point| {
            point.barycentric = [1.5, -0.5, 0.0]
        }),
        ("the sum of the shares 0.75 is not in 0.999999..=1.000001", |point| point.barycentric[0] = 0.25),
        ("the normal has length 2, not 1", |point| point.normal[2] = 2.0),
        ("the direction across has length 0, not 1", |point| point.across[0] = 0.0),
        ("w_mm -1 is not in 0.0..inf", |point| point.w_mm = -1.0),
        ("kappa NaN is not between -1 and 1", |point| point.kappa = f64::NAN),
    ];
    let refused = |id: &str, points| {
        let frame = ValleysFrame { frame: 3, valleys: BTreeMap::from([(id.to_string(), points)]) };
        frame_refusal::<Valleys>(valleys_header(), &frame)
    };
    for (message, break_it) in breaks {
        let mut point = sound;
        break_it(&mut point);
        let message = format!("a.jsonl, frame 3, wrinkle brow_1, point 1: {message}");
        assert_eq!(refused("brow_1", vec![ValleyPoint { x_mm: 0.0, ..sound }, point]), message);
    }
    let message = refused("brow_1", vec![sound, sound]);
    assert_eq!(message, "a.jsonl, frame 3, wrinkle brow_1: x_mm 1 follows x_mm 1; they must rise");
    says(&refused("chin", vec![]), &["frame 3, wrinkle chin: is not among the header's wrinkles"]);
    let elsewhere = text("valleys-1/valleys.jsonl").replace(r#""space":"face""#, r#""space":"world""#);
    says(&stream_refusal::<Valleys>(&elsewhere), &["a.jsonl, line 1, column", "unknown variant `world`"]);
    let twice = ValleysHeader { wrinkles: vec![wrinkles()[1].clone(); 2], ..valleys_header() };
    assert_eq!(header_refusal::<Valleys>(twice), "a.jsonl, wrinkles: the id brow_2 stands twice");
}

// Wrinkled sequences

proptest! {
    #[test]
    fn a_wrinkled_index_comes_back(mut frames in vec(any::<i64>(), 0..9)) {
        frames.sort_unstable();
        frames.dedup();
        let (mesh, cache, form) = (mesh_ref(3), "a.pc2".to_string(), artifact::SequenceForm::Pc2);
        let index = Wrinkled(LargeScale { mesh, cache, form, rate: None, frames, take: None });
        prop_assert_eq!(document_again(&index), index);
    }
}

#[test]
fn a_wrinkled_index_is_a_kind_of_its_own() {
    let wrinkled = text("wrinkled-1/wrinkled.json");
    let message = document_refusal::<LargeScale>(&wrinkled);
    says(&message, &["a.json, schema: holds 'wrinkled/1', not 'large-scale/1'"]);
    let message = document_refusal::<Wrinkled>(&text("large-scale-1/large-scale.json"));
    says(&message, &["a.json, schema: holds 'large-scale/1', not 'wrinkled/1'"]);
    let mut index: Wrinkled = artifact::read_document(&fixture("wrinkled-1/wrinkled.json")).unwrap();
    index.0.frames = vec![3, 3];
    says(&written_refusal(&index), &["a.json, frames: frame 3 follows frame 3; they must rise"]);
}

#[test]
fn a_sequence_opens_from_an_index_of_either_kind_and_no_other() {
    let place = support::Place::new();
    std::fs::copy(fixture("wrinkled-1/wrinkled.pc2"), place.path("wrinkled.pc2")).unwrap();
    let wrinkled = text("wrinkled-1/wrinkled.json");
    for (name, kind) in [("a.json", "wrinkled/1"), ("b.json", "large-scale/1")] {
        let path = place.file(name, wrinkled.replace("wrinkled/1", kind));
        assert_eq!(MeshSequence::open(&path, None).unwrap().vertex_count(), 5, "{kind}");
    }
    let newer = place.file("c.json", wrinkled.replace("wrinkled/1", "wrinkled/2"));
    says(&refusal(MeshSequence::open(&newer, None)), &["is wrinkled/2; this program reads up to wrinkled/1"]);
    let other = place.file("d.json", wrinkled.replace("wrinkled/1", "warp/1"));
    says(&refusal(MeshSequence::open(&other, None)), &["holds 'warp/1', not 'large-scale/1'"]);
}
