//! The capture side before wrinkles: takes with footage, cameras, time base, images, labels, tracks.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod support;

use artifact::{
    CameraDeviation, CameraFrames, CameraRig, Clock, Footage, FrameRun, Frames, Labels, Rate, RigCamera,
    Sample2d, Shown, SyncCamera, SyncFrame, SyncHeader, SyncSource, Take, TimeBase, TrackState, Tracks2d,
    Tracks2dFrame, Tracks2dHeader, image_path, read_document,
};
use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Isometry3, Point2, Point3, UnitQuaternion, Vector2, Vector3};
use proptest::collection::{btree_map, vec};
use proptest::prelude::*;
use std::collections::BTreeMap;
use support::{
    any_number, document_again, document_refusal, fixture, frame_refusal, header_refusal, says, stream_again,
    stream_refusal, text, written_refusal,
};

// Takes with footage

fn take_with(footage: Footage) -> Take {
    let mut take: Take = read_document(&fixture("take-2/take.json")).unwrap();
    take.cameras[0].footage = Some(footage);
    take
}

#[test]
fn footage_is_one_video_or_images_by_number() {
    let file = |name: &str| Footage { file: Some(name.into()), ..Footage::default() };
    let images = |name: &str| Footage { images: Some(name.into()), ..Footage::default() };
    for good in [file("a.mkv"), images("m1/{frame}.png"), images("{frame:04}/b.png")] {
        let take = take_with(good);
        assert_eq!(document_again(&take), take);
    }
    let both = Footage { file: Some("a.mkv".into()), ..images("{frame}.png") };
    for none_or_both in [Footage::default(), both] {
        let message = written_refusal(&take_with(none_or_both));
        says(&message, &["a.json, camera front, footage: name either a video file or images"]);
    }
    says(&written_refusal(&take_with(file(""))), &["camera front, footage: the file has no name"]);
    for odd in
        ["a.png", "{frame}{frame}.png", "{frame:6}.png", "{frame:06", "{frame:0}", "{x}{frame}", "{frame:00}"]
    {
        let message = written_refusal(&take_with(images(odd)));
        says(&message, &["camera front, footage: '", odd, "has not one {frame} or {frame:06}"]);
    }
}

#[test]
fn images_are_named_by_number() {
    let names = [("m/{frame:06}.png", 17), ("m/{frame}.png", 17), ("{frame:02}", 12345), ("{frame:04}", -3)];
    let named = names.map(|(pattern, number)| image_path(pattern, number));
    assert_eq!(named, ["m/000017.png", "m/17.png", "12345", "-0003"]);
}

#[test]
fn images_are_found_by_their_pattern() {
    let folder = tempfile::tempdir().unwrap();
    for name in [
        "a-000009.png",
        "a-000010.png",
        "a-1000000.png",
        "a-11.png",
        "a-000012.PNG",
        "b-000001.png",
        "a-.png",
    ] {
        std::fs::write(folder.path().join(name), "").unwrap();
    }
    let numbers = |name: &str| artifact::image_numbers(&folder.path().join(name));
    assert_eq!(numbers("a-{frame:06}.png").unwrap(), [9, 10, 1_000_000]);
    assert_eq!(numbers("a-{frame}.png").unwrap(), [11, 1_000_000]);
    assert_eq!(numbers("nowhere/a-{frame}.png").unwrap(), [0; 0]);
    says(&numbers("a.png").unwrap_err().to_string(), &["a.png: the file's name has not one {frame}"]);
}

#[test]
fn cameras_of_a_take_stand_once() {
    let twice = text("take-2/take.json").replace(r#""id":"left""#, r#""id":"front""#);
    assert_eq!(document_refusal::<Take>(&twice), "a.json, cameras: the id front stands twice");
}

#[test]
fn cameras_name_folders_and_footage_counts_from_zero() {
    let text = text("take-2/take.json");
    for id in ["../front", "a/b", "a\\\\b", ".hidden", "c:"] {
        let odd = text.replace(r#""id":"front""#, &format!(r#""id":"{id}""#));
        says(&document_refusal::<Take>(&odd), &["its id cannot name a folder"]);
    }
    let early = text.replace(r#""first":5"#, r#""first":-1"#);
    assert_ne!(early, text);
    says(&document_refusal::<Take>(&early), &["footage: first is -1; images are counted from 0"]);
}

// Cameras

fn any_camera() -> impl Strategy<Value = RigCamera> {
    let spread = || prop::array::uniform3(0.0..1e3);
    let deviation = (spread(), spread(), spread()).prop_map(|(image, rotation_rad, translation_mm)| {
        let focal_px = [image[0], image[1]];
        CameraDeviation { focal_px, center_px: [image[1], image[2]], rotation_rad, translation_mm }
    });
    let lens = (prop::array::uniform4(any_number()), vec(any_number(), 5)).prop_map(|(image, k)| Lens {
        focal_px: Vector2::new(image[0].abs() + 1e-3, image[1].abs() + 1e-3),
        center_px: Vector2::new(image[2], image[3]),
        distortion: BrownConrady { k1: k[0], k2: k[1], p1: k[2], p2: k[3], k3: k[4] },
    });
    let pose =
        (prop::array::uniform3(any_number()), prop::array::uniform3(-4.0..4.0)).prop_map(|(at, turn)| {
            let turn = UnitQuaternion::from_scaled_axis(Vector3::from(turn));
            Isometry3::from_parts(at.into(), turn)
        });
    let known = (prop::option::of(0.0..1e9), prop::option::of(0..9usize), prop::option::of(deviation));
    (1..9u32, 1..9u32, lens, pose, known).prop_map(|(width, height, lens, cam_from_world, known)| {
        let camera = Camera { image_size: [width, height], lens, cam_from_world };
        RigCamera { camera, rms_px: known.0, views: known.1, deviation: known.2 }
    })
}

/// All that is read bit by bit: everything but the rotation.
fn without_rotation(rig: &CameraRig) -> CameraRig {
    let mut rig = rig.clone();
    rig.cameras
        .values_mut()
        .for_each(|camera| camera.camera.cam_from_world.rotation = UnitQuaternion::identity());
    rig
}

proptest! {
    #[test]
    fn cameras_come_back(cameras in btree_map("[a-z]{1,3}", any_camera(), 0..3)) {
        let rig = CameraRig { cameras, take: None };
        let again = document_again(&rig);
        prop_assert_eq!(without_rotation(&again), without_rotation(&rig));
        for (id, camera) in &rig.cameras {
            let [was, is] = [camera, &again.cameras[id]].map(|rig| rig.camera.cam_from_world.rotation);
            // `angle_to` loses half the digits of small angles; 2 |q − q'| does not.
            let off = 2.0 * (was.coords - is.coords).norm().min((was.coords + is.coords).norm());
            prop_assert!(off < 1e-14, "{id} turned by {off} rad");
        }
    }
}

/// The frozen cameras with another rotation of the front one.
fn with_rotation(rows: &str) -> String {
    let sound = "[[1.0,0.0,0.0],[0.0,-1.0,0.0],[0.0,0.0,-1.0]]";
    text("cameras-1/cameras.json").replace(sound, rows)
}

#[test]
fn a_rotation_of_seven_digits_becomes_the_nearest_one() {
    let rows = "[[0.8660254,0.0,0.5],[0.0,1.0,0.0],[-0.5,0.0,0.8660254]]";
    let place = support::Place::new();
    let rig: CameraRig = read_document(&place.file("a.json", with_rotation(rows))).unwrap();
    let pose = rig.cameras["front"].camera.cam_from_world;
    let turned = pose.rotation * Vector3::z();
    assert!((turned - Vector3::new(0.5, 0.0, 0.75_f64.sqrt())).norm() < 5e-8, "{turned}");
    assert!((pose.rotation.norm() - 1.0).abs() < 1e-15);
    let rows = pose.rotation.to_rotation_matrix();
    assert!((rows.matrix() * rows.matrix().transpose()).is_identity(1e-15));
}

#[test]
fn what_is_no_rotation_is_refused() {
    let says_of =
        |rows: &str, parts: &[&str]| says(&document_refusal::<CameraRig>(&with_rotation(rows)), parts);
    let off = "the rows of its rotation are not orthonormal (off by ";
    says_of(
        "[[1.0,0.0,0.0],[0.0,1.0,0.0],[0.0,0.0,1.001]]",
        &["does not follow cameras/1: camera front: ", off],
    );
    says_of("[[1.0,0.0,0.0],[0.0,1.0,0.0],[0.0,1e-5,1.0]]", &["camera front: ", off, "1.0e-5"]);
    says_of("[[0.0,0.0,0.0],[0.0,0.0,0.0],[0.0,0.0,0.0]]", &[off]);
    says_of("[[1e300,0.0,0.0],[0.0,1.0,0.0],[0.0,0.0,1.0]]", &[off]);
    says_of("[[1.0,0.0,0.0],[0.0,1.0,0.0],[0.0,0.0,-1.0]]", &["camera front: its rotation mirrors"]);
}

#[test]
fn impossible_cameras_are_refused() {
    type Break = (&'static str, fn(&mut RigCamera));
    let breaks: [Break; 9] = [
        (": the image has no size: 0 × 1080 px", |rig| rig.camera.image_size[0] = 0),
        (": the focal length 0 px is not positive", |rig| rig.camera.lens.focal_px.y = 0.0),
        (": the focal length -5 px is not positive", |rig| rig.camera.lens.focal_px.x = -5.0),
        (", focal_px: inf is not a finite number", |rig| rig.camera.lens.focal_px.x = f64::INFINITY),
        (", center_px: NaN is not a finite number", |rig| rig.camera.lens.center_px.y = f64::NAN),
        (", distortion: NaN is not a finite number", |rig| rig.camera.lens.distortion.k3 = f64::NAN),
        (", cam_from_world: NaN is not a finite number", |rig| {
            rig.camera.cam_from_world.translation.z = f64::NAN
        }),
        (": the error -1 is negative", |rig| rig.rms_px = Some(-1.0)),
        (": NaN is not a finite number", |rig| rig.deviation.as_mut().unwrap().rotation_rad[2] = f64::NAN),
    ];
    for (message, break_it) in breaks {
        let mut rig: CameraRig = read_document(&fixture("cameras-1/cameras.json")).unwrap();
        break_it(rig.cameras.get_mut("front").unwrap());
        assert_eq!(written_refusal(&rig), format!("a.json, camera front{message}"));
    }
    let unnamed = text("cameras-1/cameras.json").replace(r#""left":"#, r#""":"#);
    assert_eq!(document_refusal::<CameraRig>(&unnamed), "a.json, cameras: a camera has an empty id");
}

#[test]
fn a_camera_read_projects_as_the_one_written() {
    let pose = Camera::pose_looking_at(Point3::new(300.0, 50.0, 900.0), Point3::origin(), Vector3::y());
    let distortion = BrownConrady { k1: -0.2, k2: 0.1, p1: 1e-3, p2: -1e-3, k3: 0.05 };
    let lens =
        Lens { focal_px: Vector2::new(900.0, 905.0), center_px: Vector2::new(327.5, 244.5), distortion };
    let camera = Camera { image_size: [656, 490], lens, cam_from_world: pose };
    let cameras = [("m1".to_string(), camera.clone().into())].into();
    let again = document_again(&CameraRig { cameras, take: None });
    let point = Point3::new(40.0, -70.0, 110.0);
    let off = again.cameras["m1"].camera.project(&point).unwrap() - camera.project(&point).unwrap();
    assert!(off.norm() < 1e-10, "{off}");
}

// One time base

fn sync_header() -> SyncHeader {
    let camera = |every, phase| SyncCamera {
        rate: Rate::per_second(50 / every),
        every,
        phase,
        offset_frames: 0.0,
        drift_ppm: 0.0,
        source: SyncSource::Trigger,
    };
    let cameras = [("m1".to_string(), camera(1, 1001)), ("w1".to_string(), camera(4, 1002))].into();
    SyncHeader { rate: Rate::per_second(50), clock: Clock::Trigger, cameras, take: None }
}

fn shows(frame: i64, cameras: &[(&str, Option<i64>)]) -> SyncFrame {
    let shown = |index| Shown { index, time_s: None, doubled: false };
    let shows = cameras.iter().map(|&(id, index)| (id.to_string(), index.map(shown))).collect();
    SyncFrame { frame, shows }
}

#[test]
fn a_camera_shows_a_frame_exactly_where_it_is_due() {
    let refused = |frame: SyncFrame| frame_refusal::<TimeBase>(sync_header(), &frame);
    let message = refused(shows(1003, &[("m1", Some(2)), ("w1", Some(0))]));
    assert_eq!(message, "a.jsonl, frame 1003, camera w1: is not due in this frame");
    let message = refused(shows(1003, &[("m1", Some(2)), ("w1", None)]));
    assert_eq!(message, "a.jsonl, frame 1003, camera w1: is not due in this frame");
    let message = refused(shows(1006, &[("m1", Some(5))]));
    says(&message, &["frame 1006, camera w1: is due in this frame; say null where its image is missing"]);
    let message = refused(shows(998, &[("m1", None)]));
    assert_eq!(message, "a.jsonl, frame 998, camera m1: is not due in this frame");
    let message = refused(shows(1001, &[("m1", None), ("m2", None)]));
    assert_eq!(message, "a.jsonl, frame 1001, camera m2: is not among the header's cameras");
    let mut timeless = shows(1001, &[("m1", Some(0))]);
    timeless.shows.get_mut("m1").unwrap().as_mut().unwrap().time_s = Some(f64::NAN);
    assert_eq!(refused(timeless), "a.jsonl, frame 1001, camera m1, time_s: NaN is not a finite number");
}

#[test]
fn clocks_that_make_no_sense_are_refused() {
    type Break = (&'static str, fn(&mut SyncCamera));
    let breaks: [Break; 4] = [
        ("cannot be due in every 0th frame", |camera| camera.every = 0),
        ("0 frames in 1 seconds is no rate", |camera| camera.rate.frames = 0),
        ("NaN is not a finite number", |camera| camera.offset_frames = f64::NAN),
        ("inf is not a finite number", |camera| camera.drift_ppm = f64::INFINITY),
    ];
    for (message, break_it) in breaks {
        let mut header = sync_header();
        break_it(header.cameras.get_mut("w1").unwrap());
        assert_eq!(header_refusal::<TimeBase>(header), format!("a.jsonl, camera w1: {message}"));
    }
}

fn any_shown() -> impl Strategy<Value = Option<Shown>> {
    let shown = (any::<i64>(), prop::option::of(any_number()), any::<bool>())
        .prop_map(|(index, time_s, doubled)| Shown { index, time_s, doubled });
    prop::option::of(shown)
}

proptest! {
    #[test]
    fn a_time_base_comes_back(start in 0..9i64, shown in vec((any_shown(), any_shown()), 0..9)) {
        let header = sync_header();
        let frame = |(i, (m1, w1)): (usize, (Option<Shown>, Option<Shown>))| {
            let frame = 1000 + start + i as i64;
            let both = [("m1".to_string(), m1), ("w1".to_string(), w1)];
            let due = both.into_iter().filter(|(id, _)| header.cameras[id].is_due(frame));
            SyncFrame { frame, shows: due.collect() }
        };
        let frames: Vec<SyncFrame> = shown.into_iter().enumerate().map(frame).collect();
        prop_assert_eq!(stream_again::<TimeBase>(&header, &frames), frames);
    }
}

// Images

fn camera_frames(frames: Vec<FrameRun>) -> CameraFrames {
    let images = "m1/{frame:04}.png".to_string();
    CameraFrames { images, image_size: [4, 3], transfer: "srgb".into(), bit_depth: 8, frames }
}

fn frames_of(camera: CameraFrames) -> Frames {
    Frames { take: None, cameras: [("m1".to_string(), camera)].into() }
}

proptest! {
    #[test]
    fn frames_fall_into_runs_and_come_back(mut numbers in vec(-40..40i64, 0..30)) {
        numbers.sort_unstable();
        numbers.dedup();
        let frames = frames_of(camera_frames(FrameRun::runs(&numbers)));
        let again = document_again(&frames);
        prop_assert_eq!(&again, &frames);
        let images: Vec<(i64, String)> = again.cameras["m1"].images().collect();
        prop_assert_eq!(images.iter().map(|image| image.0).collect::<Vec<_>>(), numbers.clone());
        for frame in -41..41 {
            let image = images.iter().find(|image| image.0 == frame).map(|image| image.1.clone());
            prop_assert_eq!(again.cameras["m1"].image(frame), image);
        }
    }
}

#[test]
fn frames_at_equal_distances_are_one_run() {
    let run = |first, last, step| FrameRun { first, last, step };
    assert_eq!(FrameRun::runs(&[1001, 1005, 1009]), [run(1001, 1009, 4)]);
    assert_eq!(FrameRun::runs(&[1, 2, 3, 7]), [run(1, 3, 1), run(7, 7, 1)]);
    assert_eq!(
        FrameRun::runs(&[i64::MIN, i64::MAX]),
        [run(i64::MIN, i64::MIN, 1), run(i64::MAX, i64::MAX, 1)]
    );
}

#[test]
fn runs_that_make_no_sense_are_refused() {
    let refused = |runs: &[(i64, i64, u32)]| {
        let runs = runs.iter().map(|&(first, last, step)| FrameRun { first, last, step }).collect();
        written_refusal(&frames_of(camera_frames(runs)))
    };
    let place = "a.json, camera m1, frames: ";
    assert_eq!(refused(&[(5, 4, 1)]), format!("{place}no steps of 1 lead from frame 5 to frame 4"));
    assert_eq!(refused(&[(1, 4, 2)]), format!("{place}no steps of 2 lead from frame 1 to frame 4"));
    assert_eq!(refused(&[(1, 1, 0)]), format!("{place}no steps of 0 lead from frame 1 to frame 1"));
    assert_eq!(refused(&[(1, 4, 1), (4, 6, 1)]), format!("{place}frame 4 follows frame 4; they must rise"));
    let unnumbered = CameraFrames { images: "m1/a.png".into(), ..camera_frames(vec![]) };
    says(
        &written_refusal(&frames_of(unnumbered)),
        &["a.json, camera m1, images: 'm1/a.png' has not one {frame}"],
    );
    let empty = CameraFrames { image_size: [4, 0], ..camera_frames(vec![]) };
    says(&written_refusal(&frames_of(empty)), &["a.json, camera m1: the images have no size: 4 × 0 px"]);
}

// Labels

proptest! {
    #[test]
    fn labels_come_back(
        frame in any::<i64>(),
        cameras in btree_map("[a-z]{1,3}", btree_map("[a-z]{1,3}", prop::array::uniform2(any_number()), 0..4), 0..4),
    ) {
        // Two markers on one point are refused.
        let places = |markers: &BTreeMap<String, [f64; 2]>| {
            markers.values().map(|at| at.map(f64::to_bits)).collect::<std::collections::HashSet<_>>().len()
        };
        prop_assume!(cameras.values().all(|markers| places(markers) == markers.len()));
        let labels = Labels { take: None, frame, cameras };
        prop_assert_eq!(document_again(&labels), labels);
    }
}

#[test]
fn paint_models_that_make_no_sense_are_refused() {
    let model = |change: fn(&mut artifact::LearntPaint)| {
        let pixel = artifact::SupportPixel { ratios: [1.0, -0.5], coefficient: 2.0 };
        let (id, mark) = ("green".to_string(), [0, 255, 0]);
        let mut paint = artifact::LearntPaint {
            id,
            mark,
            gamma: 1.0,
            c: 10.0,
            score: 1.0,
            bias: 0.5,
            support: vec![pixel],
        };
        change(&mut paint);
        artifact::PaintModel { take: None, floor: 0.004, paints: vec![paint] }
    };
    assert_eq!(document_again(&model(|_| ())), model(|_| ()));
    says(&written_refusal(&model(|paint| paint.gamma = 0.0)), &["paint green", "gamma 0"]);
    says(&written_refusal(&model(|paint| paint.score = 1.5)), &["paint green", "score 1.5"]);
    says(
        &written_refusal(&model(|paint| paint.support[0].coefficient = f64::NAN)),
        &["paint green, support: NaN"],
    );
    says(&written_refusal(&model(|paint| paint.id.clear())), &["a paint has an empty id"]);
    says(
        &written_refusal(&artifact::PaintModel { paints: vec![], ..model(|_| ()) }),
        &["paints: there is none"],
    );
}

#[test]
fn labels_that_make_no_sense_are_refused() {
    let labels = |id: &str, markers: &[(&str, [f64; 2])]| {
        let markers = markers.iter().map(|&(marker, at)| (marker.to_string(), at)).collect();
        Labels { take: None, frame: 7, cameras: BTreeMap::from([(id.to_string(), markers)]) }
    };
    let message = written_refusal(&labels("m1", &[("a", [1.0, f64::NAN])]));
    assert_eq!(message, "a.json, camera m1, marker a: NaN is not a finite number");
    let message = written_refusal(&labels("m1", &[("a", [1.0, 2.0]), ("b", [1.0, 2.0])]));
    assert_eq!(message, "a.json, camera m1, marker b: sits at [1.0, 2.0], as marker a does");
    says(&written_refusal(&labels("", &[])), &["a camera or a marker has an empty id"]);
    says(
        &written_refusal(&labels("m1", &[("", [0.0; 2])])),
        &["camera m1: a camera or a marker has an empty id"],
    );
}

// Tracks

fn tracks_header() -> Tracks2dHeader {
    let ids = |ids: [&str; 2]| ids.map(String::from).to_vec();
    Tracks2dHeader { cameras: ids(["m2", "m1"]), markers: ids(["nose", "brow"]), rate: None, take: None }
}

fn any_sample() -> impl Strategy<Value = Sample2d> {
    let state = prop::sample::select(vec![TrackState::Seen, TrackState::Predicted, TrackState::Edited]);
    (prop::array::uniform2(any_number()), state, prop_oneof![Just(1.0), 0.0..=1.0])
        .prop_map(|(at, state, confidence)| Sample2d { at: at.into(), state, confidence })
}

proptest! {
    #[test]
    fn tracks_come_back(
        all in vec(prop::array::uniform2(prop::option::of(prop::array::uniform2(prop::option::of(any_sample())))), 0..5),
    ) {
        let frame = |(i, cameras): (usize, [Option<[Option<Sample2d>; 2]>; 2])| Tracks2dFrame {
            frame: i as i64 - 2,
            cameras: cameras.map(|samples| samples.map(Vec::from)).to_vec(),
        };
        let frames: Vec<Tracks2dFrame> = all.into_iter().enumerate().map(frame).collect();
        prop_assert_eq!(stream_again::<Tracks2d>(&tracks_header(), &frames), frames);
    }
}

#[test]
fn tracks_that_make_no_sense_are_refused() {
    let refused = |sample: Sample2d| {
        let frame = Tracks2dFrame { frame: 3, cameras: vec![None, Some(vec![None, Some(sample)])] };
        frame_refusal::<Tracks2d>(tracks_header(), &frame)
    };
    let place = "a.jsonl, frame 3, camera m1, marker brow: ";
    assert_eq!(
        refused(Sample2d::seen(Point2::new(0.0, f64::NAN))),
        format!("{place}NaN is not a finite number")
    );
    for odd in [-0.5, 1.5, f64::NAN] {
        let message = refused(Sample2d { confidence: odd, ..Sample2d::seen(Point2::origin()) });
        assert_eq!(message, format!("{place}the confidence {odd} is not in 0.0..=1.0"));
    }
    let short = Tracks2dFrame { frame: 3, cameras: vec![None] };
    let message = frame_refusal::<Tracks2d>(tracks_header(), &short);
    assert_eq!(message, "a.jsonl, frame 3: holds 1 cameras, the header names 2");
    let short = Tracks2dFrame { frame: 3, cameras: vec![None, Some(vec![])] };
    let message = frame_refusal::<Tracks2d>(tracks_header(), &short);
    assert_eq!(message, "a.jsonl, frame 3, camera m1: holds 0 markers, the header names 2");
}

#[test]
fn headers_of_tracks_name_everything_once() {
    let twice = Tracks2dHeader { cameras: vec!["m1".into(), "m1".into()], ..tracks_header() };
    assert_eq!(header_refusal::<Tracks2d>(twice), "a.jsonl, cameras: the id m1 stands twice");
    let unnamed = Tracks2dHeader { markers: vec![String::new()], ..tracks_header() };
    assert_eq!(header_refusal::<Tracks2d>(unnamed), "a.jsonl, markers: a marker has an empty id");
    let timeless = Tracks2dHeader { rate: Some(Rate { frames: 0, seconds: 1 }), ..tracks_header() };
    assert_eq!(header_refusal::<Tracks2d>(timeless), "a.jsonl, rate: 0 frames in 1 seconds is no rate");
}

#[test]
fn lines_of_tracks_name_only_what_is_there() {
    let refused = |what: &str, other: &str| {
        let sound = text("tracks-2d-1/tracks-2d.jsonl");
        assert!(sound.contains(what), "{what}");
        stream_refusal::<Tracks2d>(&sound.replace(what, other))
    };
    let message = refused(r#""left":{"brow_l""#, r#""top":{"brow_l""#);
    assert_eq!(message, "a.jsonl, line 2, frame 1001, camera top: is not among the header's cameras");
    let message = refused(r#""left":{"brow_l""#, r#""left":{"chin""#);
    assert_eq!(
        message,
        "a.jsonl, line 2, frame 1001, camera left, marker chin: is not among the header's markers"
    );
    let message =
        refused(r#""confidence":{"front":{"brow_l":0.75"#, r#""confidence":{"front":{"lip_r":0.75"#);
    assert_eq!(
        message,
        "a.jsonl, line 3, frame 1002, camera front, marker lip_r: has a confidence, but no point"
    );
    let message = refused(r#""state":{"front":{"brow_l":"#, r#""state":{"left":{"brow_l":"#);
    assert_eq!(message, "a.jsonl, line 4, frame 1004, camera left, marker brow_l: has a state, but no point");
    says(&refused("predicted", "guessed"), &["line 4, column", "unknown variant `guessed`", "`predicted`"]);
}
