//! Schemas and frozen files: what was written once is read for ever.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod support;

use artifact::provenance::Provenance;
use artifact::{
    BakedMaps, BlendWeights, CameraRig, Correspondence, CurveState, Document, FrameReader, FrameWriter,
    Frames, GreenAxis, HandleFrame, Handles, HeadPose, HeadTrajectories, Labels, Landmarks, LargeScale,
    MarkerFrame, MeasuredTrajectories, MeshRef, PaintModel, Poses, ResponseBasis, SampleStatus, SectionState,
    Sections, Stream, Take, TimeBase, TrackState, Tracks2d, Trajectories3d, Unit, Valleys, VertexMapping,
    VertexPath, VertexSet, Warp, Wrinkled, Wrinkles2d, document_schema, read_document, stream_schema,
    write_document,
};
use serde_json::Value;
use std::path::PathBuf;
use support::{Place, bytes, fixture, in_repository};

/// Every kind of ours: name, schema, frozen file.
fn kinds() -> Vec<(String, Value, PathBuf)> {
    fn document<T: Document>() -> (String, Value, PathBuf) {
        let name = format!("{}-{}", T::NAME, T::VERSION);
        let file = fixture(&format!("{name}/{}.json", T::NAME));
        (name, document_schema::<T>(), file)
    }
    fn stream<S: Stream>() -> (String, Value, PathBuf) {
        let name = format!("{}-{}", S::NAME, S::VERSION);
        let file = fixture(&format!("{name}/{}.jsonl", S::NAME));
        (name, stream_schema::<S>(), file)
    }
    let (provenance, schema, _) = document::<Provenance>();
    vec![
        document::<Take>(),
        document::<CameraRig>(),
        stream::<TimeBase>(),
        document::<Frames>(),
        document::<Labels>(),
        document::<Landmarks>(),
        document::<PaintModel>(),
        stream::<Tracks2d>(),
        stream::<Wrinkles2d>(),
        stream::<Sections>(),
        stream::<Valleys>(),
        document::<Wrinkled>(),
        stream::<Trajectories3d>(),
        stream::<HeadTrajectories>(),
        stream::<HeadPose>(),
        document::<Correspondence>(),
        document::<Warp>(),
        stream::<Handles>(),
        document::<VertexSet>(),
        document::<VertexPath>(),
        document::<VertexMapping>(),
        document::<ResponseBasis>(),
        document::<LargeScale>(),
        document::<BakedMaps>(),
        document::<Poses>(),
        stream::<BlendWeights>(),
        (provenance, schema, fixture("provenance-1/handles.jsonl.prov.json")),
    ]
}

/// Versions that are only read by now: name, frozen file, hash of the schema, which nothing makes anew.
const OLDER: [(&str, &str, &str); 1] =
    [("take-1", "take-1/take.json", "05972a501b087529023f8741a2c13b70f351fe394dd4a1a4a230a2d8a0aaac1c")];

/// A kind that a stage has to itself, and tests itself.
const OF_STAGES: [&str; 1] = ["scenario-1.json"];

/// Every kind and version of ours: name, schema, frozen file.
fn all_versions() -> Vec<(String, Value, PathBuf)> {
    let older = OLDER.map(|(name, file, _)| {
        let schema = values(&in_repository(&format!("docs/schema/{name}.json"))).remove(0);
        (name.to_string(), schema, fixture(file))
    });
    kinds().into_iter().chain(older).collect()
}

/// The JSON values of a file: one, or one per line.
fn values(path: &std::path::Path) -> Vec<Value> {
    let text = String::from_utf8(bytes(path)).unwrap();
    match path.extension().is_some_and(|ending| ending == "jsonl") {
        true => text.lines().map(|line| serde_json::from_str(line).unwrap()).collect(),
        false => vec![serde_json::from_str(&text).unwrap()],
    }
}

#[test]
fn schemas_in_the_docs_are_those_of_the_code() {
    let rewrite = std::env::var("FURROW_WRITE_SCHEMA").is_ok_and(|value| value == "1");
    for (name, schema, _) in kinds() {
        let path = in_repository(&format!("docs/schema/{name}.json"));
        let wanted = serde_json::to_string_pretty(&schema).unwrap() + "\n";
        if rewrite {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(&path, &wanted).unwrap();
        }
        let found = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(
            found == wanted,
            "docs/schema/{name}.json is not what the code says. If the change only adds an optional field or a \
             comment, run the test with FURROW_WRITE_SCHEMA=1; otherwise the kind needs a new version."
        );
    }
}

#[test]
fn schemas_of_older_versions_stay_as_they_are() {
    for (name, _, hash) in OLDER {
        let path = in_repository(&format!("docs/schema/{name}.json"));
        assert_eq!(artifact::sha256(&path).unwrap(), hash, "{name}");
    }
}

#[test]
fn the_docs_hold_no_other_schema() {
    let mut known: Vec<String> =
        all_versions().into_iter().map(|(name, ..)| format!("{name}.json")).collect();
    known.extend(OF_STAGES.map(String::from));
    known.sort();
    let mut found: Vec<String> = std::fs::read_dir(in_repository("docs/schema"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    found.sort();
    assert_eq!(found, known);
}

#[test]
fn frozen_files_follow_their_schema() {
    for (name, schema, file) in all_versions() {
        let validator = jsonschema::validator_for(&schema).unwrap();
        for value in values(&file) {
            let errors: Vec<String> = validator.iter_errors(&value).map(|error| error.to_string()).collect();
            assert!(errors.is_empty(), "{name}: {errors:?}\n{value}");
        }
    }
}

#[test]
fn schemas_refuse_what_the_readers_refuse() {
    for (name, schema, file) in all_versions() {
        let validator = jsonschema::validator_for(&schema).unwrap();
        for mut value in values(&file) {
            value["surprise"] = 1.into();
            assert!(!validator.is_valid(&value), "{name}: an unknown field");
            value.as_object_mut().unwrap().shift_remove("surprise");
            let first = value.as_object().unwrap().keys().next().unwrap().clone();
            value.as_object_mut().unwrap().shift_remove(&first);
            assert!(!validator.is_valid(&value), "{name}: no {first}");
        }
        let mut newer = values(&file).remove(0);
        newer["schema"] =
            format!("{}/99", newer["schema"].as_str().unwrap().split('/').next().unwrap()).into();
        assert!(!validator.is_valid(&newer), "{name}: another version");
    }
}

/// Reads a frozen document, and checks that writing it again gives the same bytes.
#[track_caller]
fn document<T: Document>() -> T {
    let path = fixture(&format!("{0}-{1}/{0}.json", T::NAME, T::VERSION));
    let document: T = read_document(&path).unwrap();
    let place = Place::new();
    let again = place.path("again.json");
    write_document(&again, &document).unwrap().publish().unwrap();
    assert!(bytes(&again) == bytes(&path), "{}: {}", T::NAME, String::from_utf8_lossy(&bytes(&again)));
    document
}

/// The same for a kind with frames.
#[track_caller]
fn stream<S: Stream>() -> (S::Header, Vec<S::Frame>) {
    let path = fixture(&format!("{0}-{1}/{0}.jsonl", S::NAME, S::VERSION));
    let reader = FrameReader::<S>::open(&path).unwrap();
    let header = reader.header().clone();
    let frames: Vec<S::Frame> = reader.map(Result::unwrap).collect();
    let place = Place::new();
    let again = place.path("again.jsonl");
    let mut writer = FrameWriter::<S>::create(&again, header.clone()).unwrap();
    frames.iter().for_each(|frame| writer.write(frame).unwrap());
    writer.finish().unwrap().publish().unwrap();
    assert!(bytes(&again) == bytes(&path), "{}: {}", S::NAME, String::from_utf8_lossy(&bytes(&again)));
    assert_eq!(frames.iter().map(S::number).collect::<Vec<_>>(), [1001, 1002, 1004]);
    (header, frames)
}

/// That an artifact refers to the frozen take.
#[track_caller]
fn refers_to_the_take(take: Option<&artifact::TakeRef>) {
    assert_eq!(take.unwrap().sha256, artifact::sha256(&fixture("take-2/take.json")).unwrap());
}

/// That an artifact refers to the frozen mesh.
#[track_caller]
fn refers_to_the_mesh(mesh: &MeshRef) {
    assert_eq!(mesh.file.sha256, artifact::sha256(&fixture("obj/mesh.obj")).unwrap());
    assert_eq!((mesh.unit, mesh.vertex_count), (Unit::Mm, 5));
}

#[test]
fn frozen_baked_maps_read() {
    let maps: BakedMaps = document();
    refers_to_the_mesh(&maps.mesh);
    assert_eq!((maps.frame, maps.size, maps.green), (Some(1004), 2048, GreenAxis::Directx));
    assert_eq!((maps.black_mm, maps.tiles[1].tile), (-0.9, 1012));
}

#[test]
fn a_frozen_take_reads() {
    let take: Take = document();
    assert_eq!((take.first_frame, take.rate.frames, take.rate.seconds), (1001, 30000, 1001));
    assert_eq!(take.start_timecode.as_deref(), Some("10:00:00;00"));
    assert_eq!(take.references["scan"].name, "mesh.obj");
    assert_eq!(take.cameras[0].image_size, [1920, 1080]);
    assert_eq!(take.consent.licence, "CC0-1.0");
    let footage: Vec<_> = take.cameras.iter().map(|camera| camera.footage.as_ref()).collect();
    assert_eq!(footage[0].unwrap().image(17).as_deref(), Some("footage/front/000017.png"));
    assert_eq!((footage[0].unwrap().first, footage[1].unwrap().first), (5, 0));
    assert_eq!(footage[1].unwrap().file.as_deref(), Some("footage/left.mkv"));
    assert_eq!((footage[1].unwrap().image(17), footage[2]), (None, None));
}

#[test]
fn a_take_of_version_1_reads_as_one_without_footage() {
    let older: Take = read_document(&fixture("take-1/take.json")).unwrap();
    let mut take: Take = document();
    take.cameras.truncate(1);
    take.cameras[0].footage = None;
    assert_eq!(older, take);
}

#[test]
fn frozen_cameras_read() {
    let rig: CameraRig = document();
    refers_to_the_take(rig.take.as_ref());
    let front = &rig.cameras["front"];
    assert_eq!((front.rms_px, front.views), (Some(0.125), Some(24)));
    assert_eq!(front.deviation.unwrap().translation_mm, [0.0625, 0.0625, 0.125]);
    // On the axis of the view, the principal point; 10 mm off it, to the right and down.
    let project = |x, y, z| front.camera.project(&nalgebra::Point3::new(x, y, z)).unwrap();
    assert_eq!(project(0.0, 10.0, 0.0), nalgebra::Vector2::new(959.5, 539.5));
    let seen = project(10.0, 0.0, 0.0) - nalgebra::Vector2::new(959.5, 539.5);
    assert!((seen.x - 30.0).abs() < 0.01 && (seen.y - 30.0).abs() < 0.02, "{seen}");
    let left = &rig.cameras["left"];
    let eye = left.camera.eye_in_world();
    assert_eq!(eye, nalgebra::Point3::new(700.0, -1.5, 0.0), "on the subject's left, lying on its side");
    assert_eq!((left.rms_px, left.views, left.deviation), (None, None, None));
    assert_eq!(left.camera.lens.distortion.k3, 0.5);
}

#[test]
fn a_frozen_time_base_reads() {
    let (header, frames) = stream::<TimeBase>();
    refers_to_the_take(header.take.as_ref());
    let due = |frame| ["front", "left", "right"].map(|id| header.cameras[id].is_due(frame));
    assert_eq!([due(1001), due(1002)], [[true, false, true], [true, true, false]]);
    assert_eq!(frames[0].shows["front"].unwrap().index, 5);
    assert!(frames[1].shows["front"].is_none() && !frames[1].shows.contains_key("right"));
    let left = frames[2].shows["left"].unwrap();
    assert_eq!((left.index, left.time_s, left.doubled), (3, Some(0.1084417), true));
}

#[test]
fn frozen_frames_and_labels_read() {
    let frames: Frames = document();
    refers_to_the_take(frames.take.as_ref());
    let front: Vec<_> = frames.cameras["front"].images().collect();
    assert_eq!((front.len(), &front[2]), (9, &(1004, "front/001004.png".to_string())));
    let right: Vec<i64> = frames.cameras["right"].images().map(|(frame, _)| frame).collect();
    assert_eq!(right, [1001, 1004, 1007, 1010]);
    assert_eq!(frames.cameras["right"].image(1004).as_deref(), Some("right/1004.png"));
    assert_eq!(frames.cameras["right"].image(1005), None);
    let labels: Labels = document();
    refers_to_the_take(labels.take.as_ref());
    assert_eq!((labels.frame, labels.cameras["left"]["brow_l"]), (1001, [200.5, 0.1]));
    assert!(labels.cameras["right"].is_empty());
}

#[test]
fn a_frozen_paint_model_reads() {
    let model: PaintModel = document();
    refers_to_the_take(model.take.as_ref());
    let [green, violet] = &model.paints[..] else { panic!("{model:?}") };
    assert_eq!((green.mark, green.support[1].coefficient), ([107, 255, 146], -1.75));
    assert_eq!((violet.gamma, violet.c, violet.bias, model.floor), (2.0, 1.0, 0.125, 0.004));
}

#[test]
fn frozen_tracks_read() {
    let (header, frames) = stream::<Tracks2d>();
    refers_to_the_take(header.take.as_ref());
    let front = |i: usize| frames[i].cameras[0].as_ref().unwrap();
    assert_eq!(front(0)[2].unwrap().at, nalgebra::Point2::new(960.0, 540.0));
    assert_eq!((front(1)[0].unwrap().confidence, front(1)[1]), (0.75, None));
    assert_eq!(front(2)[0].unwrap().state, TrackState::Predicted);
    assert_eq!((front(2)[2].unwrap().state, front(2)[2].unwrap().confidence), (TrackState::Edited, 1.0));
    assert_eq!(frames[1].cameras[1], None, "no image");
    assert_eq!(frames[2].cameras[1], Some(vec![None; 3]), "an image without markers");
}

#[test]
fn frozen_wrinkles_sections_and_valleys_read() {
    let (header, frames) = stream::<Wrinkles2d>();
    refers_to_the_take(header.take.as_ref());
    assert_eq!((header.wrinkles[0].paint.as_deref(), &header.wrinkles[1].paint), (Some("red"), &None));
    let curve = |i: usize, id: &str| &frames[i].curves["right"][id];
    assert_eq!((curve(0, "brow_1").controls[3], curve(0, "brow_1").paint[1].right_px), ([130.0, 200.0], 4.0));
    assert_eq!((curve(1, "brow_1").state, curve(1, "brow_1").confidence), (CurveState::Held, 0.5));
    assert_eq!((curve(2, "brow_2").state, curve(2, "brow_2").confidence), (CurveState::Edited, 1.0));
    assert!(frames[0].curves["left"].is_empty() && !frames[1].curves.contains_key("left"));

    let (header, frames) = stream::<Sections>();
    refers_to_the_take(header.take.as_ref());
    let sections = &frames[1].sections["right"]["brow_1"];
    assert_eq!((sections[0].kappa, sections[0].tilt_rad), (-0.25, Some(0.5)));
    assert_eq!((sections[1].state, sections[1].d_px), (SectionState::Flat, 0.0));

    let (header, frames) = stream::<Valleys>();
    refers_to_the_take(header.take.as_ref());
    refers_to_the_mesh(&header.mesh);
    let valley = &frames[1].valleys["brow_1"];
    assert_eq!((valley[1].face, valley[1].barycentric, valley[1].d_mm), (1, [0.25, 0.5, 0.25], 0.25));
    assert!(frames[0].valleys.is_empty() && frames[2].valleys["brow_2"].is_empty());
}

#[test]
fn frozen_trajectories_read() {
    let (header, frames) = stream::<Trajectories3d>();
    let (other_header, other_frames) = stream::<HeadTrajectories>();
    assert_eq!((&header, &frames), (&other_header, &other_frames));
    assert_eq!(header.markers, ["brow_l", "lip_r", "nose"]);
    assert_eq!(header.take.unwrap().sha256, artifact::sha256(&fixture("take-1/take.json")).unwrap());
    let MarkerFrame { points, status, .. } = &frames[1];
    assert_eq!(points[0], None, "null is missing");
    assert_eq!(points[2].unwrap().z, 0.1 + 0.2, "0.30000000000000004 survives");
    assert_eq!(status[..], [SampleStatus::Measured, SampleStatus::SingleCamera, SampleStatus::Interpolated]);
}

/// What is said of accuracy is optional: who knows it reads it, who does not reads the same markers.
#[test]
fn frozen_trajectories_with_accuracy_read() {
    let path = fixture("trajectories-3d-1/measured.jsonl");
    let reader = FrameReader::<MeasuredTrajectories>::open(&path).unwrap();
    let header = reader.header().clone();
    let frames: Vec<_> = reader.map(Result::unwrap).collect();
    let accuracy = frames[0].accuracy[0].as_ref().unwrap();
    assert_eq!(accuracy.covariance_mm2, [0.0025, 0.0, 0.0005, 0.0025, -0.0005, 0.01]);
    assert_eq!(accuracy.views, ["front", "left"]);
    assert_eq!((&frames[0].accuracy[1], &frames[1].accuracy), (&None, &vec![None; 3]));
    let place = Place::new();
    let mut writer = FrameWriter::<MeasuredTrajectories>::create(&place.path("again.jsonl"), header).unwrap();
    frames.iter().for_each(|frame| writer.write(frame).unwrap());
    writer.finish().unwrap().publish().unwrap();
    assert_eq!(bytes(&place.path("again.jsonl")), bytes(&path));
    let plain = FrameReader::<Trajectories3d>::open(&path).unwrap().map(Result::unwrap);
    assert!(plain.eq(stream::<Trajectories3d>().1), "without its accuracy it is the same take");
}

#[test]
fn accuracy_of_what_is_not_there_is_refused() {
    let text = String::from_utf8(bytes(&fixture("trajectories-3d-1/measured.jsonl"))).unwrap();
    let place = Place::new();
    for (from, to, what) in [
        ("\"nose\":[0.1,0.2,0.3]}", "\"nose\":null}", "marker nose: has an accuracy, but no position"),
        ("[0.001,0.0,0.0,0.001", "[0.001,0.0,0.0,-0.001", "the variance -0.001 mm² is negative"),
        ("[\"front\",\"left\"]", "[\"\"]", "a camera has an empty id"),
        ("\"views\":{\"brow_l\"", "\"views\":{\"ghost\"", "ghost"),
    ] {
        let path = place.file("bad.jsonl", text.replace(from, to).into_bytes());
        let error = FrameReader::<Trajectories3d>::open(&path).unwrap().next().unwrap().unwrap_err();
        assert!(error.to_string().contains(what), "{error}");
    }
}

#[test]
fn frozen_head_poses_read() {
    let (header, frames) = stream::<HeadPose>();
    assert_eq!(header.reference_frame, 1001);
    assert_eq!(frames[0].world_from_head, Some(nalgebra::Isometry3::identity()));
    let pose = frames[1].world_from_head.unwrap();
    // A turn about y by 2 acos 0.8, then the translation.
    let moved = pose * nalgebra::Point3::new(0.0, 0.0, 1.0);
    assert!((moved - nalgebra::Point3::new(1.96, -2.0, 0.78)).norm() < 1e-12, "{moved}");
    assert_eq!((frames[2].world_from_head, frames[2].residual_mm, frames[2].markers_used), (None, None, 0));
}

#[test]
fn a_frozen_correspondence_and_warp_read() {
    let correspondence: Correspondence = document();
    refers_to_the_mesh(&correspondence.mesh);
    let mesh = artifact::read_mesh(&fixture("obj/mesh.obj"), Unit::Mm).unwrap();
    for pair in &correspondence.pairs {
        assert_eq!(mesh.positions[pair.vertex as usize], pair.position_mm.into(), "{}", pair.marker);
    }
    let warp: Warp = document();
    refers_to_the_mesh(&warp.mesh);
    assert_eq!(warp.markers, ["brow_l", "lip_r", "nose", "temple"]);
    assert_eq!(warp.face_from_mocap.centers[1], [0.5, -0.5, 0.05]);
    assert_eq!(warp.face_from_mocap.polynomial.len(), 4);
    assert_eq!(warp.fit.left_out["chin"], "has no vertex");
    let trajectories = fixture("head-trajectories-1/head-trajectories.jsonl");
    assert_eq!(warp.trajectories.sha256, artifact::sha256(&trajectories).unwrap());
}

#[test]
fn frozen_handles_read() {
    let (header, frames) = stream::<Handles>();
    refers_to_the_mesh(&header.mesh);
    assert_eq!(header.handles[1].vertex, 3);
    assert_eq!(header.warp.unwrap().sha256, artifact::sha256(&fixture("warp-1/warp.json")).unwrap());
    let HandleFrame { displacements, weights, .. } = &frames[1];
    assert_eq!(displacements[0].unwrap(), nalgebra::Vector3::new(0.0, 0.5, -0.125));
    assert_eq!((displacements[1], weights[0], weights[1]), (None, Some(2.5), None));
}

#[test]
fn frozen_vertex_sets_paths_and_maps_read() {
    let set: VertexSet = document();
    refers_to_the_mesh(&set.mesh);
    assert_eq!((set.name.as_str(), set.vertices.as_slice()), ("ear", [1, 2, 4].as_slice()));
    let path: VertexPath = document();
    refers_to_the_mesh(&path.mesh);
    assert_eq!((path.name.as_str(), path.vertices.as_slice()), ("mouth", [4, 1, 2].as_slice()));
    let map: VertexMapping = document();
    refers_to_the_mesh(&map.old);
    assert_eq!(map.new_from_old, [None, Some(0), Some(1), None, Some(2)]);
    assert_eq!(map.old_from_new, [1, 2, 4]);
}

#[test]
fn a_frozen_response_basis_reads() {
    let basis: ResponseBasis = document();
    refers_to_the_mesh(&basis.mesh);
    let array = fixture("response-basis-1/basis.npy");
    assert_eq!(basis.array.sha256, artifact::sha256(&array).unwrap());
    let (shape, values) = artifact::npy::read_f32(&array).unwrap();
    assert_eq!(shape, [5, basis.handles.len()]);
    assert_eq!(values, [1.0, 0.0, 0.5, 0.0, 0.25, 0.5, 0.0, 1.0, 0.125, 0.0]);
    let place = Place::new();
    let again = place.path("again.npy");
    artifact::npy::write(&again, shape, &values).unwrap().publish().unwrap();
    assert_eq!(bytes(&again), bytes(&array));
}

#[test]
fn a_frozen_sequence_reads() {
    let sequence: LargeScale = document();
    refers_to_the_mesh(&sequence.mesh);
    let cache = fixture(&format!("large-scale-1/{}", sequence.cache));
    let mut reader = artifact::pc2::Reader::open(&cache).unwrap();
    assert_eq!((reader.vertex_count(), reader.sample_count(), reader.start_frame()), (5, 3, 1001));
    assert_eq!(sequence.frames, [1001, 1002, 1004]);
    let place = Place::new();
    let again = place.path("again.pc2");
    let mut writer = artifact::pc2::Writer::create(&again, 5, 1001).unwrap();
    let mut lifts = Vec::new();
    while let Some(sample) = reader.read().unwrap() {
        lifts.push(sample[14]);
        writer.write(&sample).unwrap();
    }
    writer.finish().unwrap().publish().unwrap();
    assert_eq!(lifts, [1.0, 1.5, 2.0]);
    assert_eq!(bytes(&again), bytes(&cache));
}

#[test]
fn a_frozen_wrinkled_sequence_reads() {
    let index: Wrinkled = document();
    refers_to_the_mesh(&index.0.mesh);
    refers_to_the_take(index.0.take.as_ref());
    let sequence = artifact::MeshSequence::open(&fixture("wrinkled-1/wrinkled.json"), None).unwrap();
    assert_eq!(sequence.frames(), [1001, 1002, 1004]);
    assert_eq!(sequence.cursor().unwrap().read(1002).unwrap()[4].z, 1.5);
}

#[test]
fn a_frozen_side_car_reads() {
    let path = fixture("provenance-1/handles.jsonl.prov.json");
    let record: Provenance = read_document(&path).unwrap();
    assert_eq!(record.stage, "rbf-warp handles");
    assert_eq!(record.results["frames"], 3);
    let place = Place::new();
    artifact::provenance::write(&place.path("handles.jsonl"), &record).unwrap().publish().unwrap();
    assert_eq!(bytes(&place.path("handles.jsonl.prov.json")), bytes(&path));
}

#[test]
fn frozen_meshes_read() {
    let place = Place::new();
    for file in ["obj/mesh.obj", "ply/mesh.ply"] {
        let path = fixture(file);
        let mesh = artifact::read_mesh(&path, Unit::Mm).unwrap();
        assert_eq!((mesh.positions.len(), mesh.polygons.len()), (5, 2), "{file}");
        assert_eq!(mesh.positions[3], [0.0, 10.0, -0.25].into());
        assert_eq!(mesh.polygons.face(0), [0, 1, 2, 3]);
        assert_eq!(mesh.polygons.face(1), [1, 4, 2]);
        assert_eq!(mesh.uvs[mesh.corner_uvs[5] as usize], nalgebra::Vector2::new(1.5, 0.5), "a second tile");
        let again = place.path(&artifact::file_name(&path));
        artifact::write_mesh(&again, &mesh, Unit::Mm).unwrap().publish().unwrap();
        assert_eq!(bytes(&again), bytes(&path), "{file}");
    }
}

/// The frozen markers in the formats of other systems: read as what they were, and written the same again.
#[test]
fn frozen_c3d_and_trc_read() {
    use artifact::{HeadTrajectories, read_trajectories, write_trajectories};
    let (_, frames) = stream::<Trajectories3d>();
    for name in ["c3d/markers.c3d", "trc/markers.trc"] {
        let (read, warnings) = read_trajectories::<HeadTrajectories>(&fixture(name), None).unwrap();
        assert_eq!(warnings, Vec::<String>::new(), "{name}");
        assert_eq!(read.header.markers, ["brow_l", "lip_r", "nose"], "{name}");
        assert_eq!(read.header.rate.unwrap().hz(), 30_000.0 / 1001.0, "{name}");
        for frame in &frames {
            let same = read.frames.iter().find(|other| other.frame == frame.frame).unwrap();
            for (a, b) in frame.points.iter().zip(&same.points) {
                // C3D holds 32-bit floats.
                assert!(
                    a.is_some() == b.is_some() && a.zip(*b).is_none_or(|(a, b)| (a - b).norm() < 1e-5),
                    "{name}"
                );
            }
        }
        let place = Place::new();
        let again = place.path(name.split('/').next_back().unwrap());
        write_trajectories::<HeadTrajectories>(&again, &read).unwrap().publish().unwrap();
        assert_eq!(bytes(&again), bytes(&fixture(name)), "{name}");
    }
}

#[test]
fn frozen_reference_poses_read() {
    let poses: Poses = document();
    assert_eq!(poses.poses.iter().map(|pose| pose.id.as_str()).collect::<Vec<_>>(), ["brows-up", "smile"]);
    let jaw = &poses.poses[0].bones["jaw"];
    assert_eq!((jaw.translation, jaw.rotation_wxyz), (None, Some([0.6, 0.8, 0.0, 0.0])));
    assert_eq!(poses.poses[0].map.as_ref().unwrap().name, "brows-up.png");
    assert_eq!(poses.modulation.unwrap()[1], [0.5, 0.125]);
}

#[test]
fn frozen_blend_weights_read() {
    let (header, frames) = stream::<BlendWeights>();
    assert_eq!(
        (header.vertex_count, header.bones.len(), header.rate.unwrap().hz()),
        (3, 2, 30_000.0 / 1001.0)
    );
    assert_eq!(frames[0].vertices.as_ref().unwrap()["brows-up"], [0.0, 0.5, 0.1]);
    assert_eq!(frames[1].vertices.as_ref().unwrap().len(), 0);
    assert_eq!((frames[2].vertices.as_ref(), frames[2].bones["smile"]["jaw"]), (None, 0.1 + 0.2));
}
