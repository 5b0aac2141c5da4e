//! Schemas and frozen files: what was written once is read for ever.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod support;

use artifact::provenance::Provenance;
use artifact::{
    Correspondence, Document, FrameReader, FrameWriter, HandleFrame, Handles, HeadPose, HeadTrajectories,
    LargeScale, MarkerFrame, MeshRef, ResponseBasis, SampleStatus, Stream, Take, Trajectories3d, Unit,
    VertexMapping, VertexPath, VertexSet, Warp, document_schema, read_document, stream_schema,
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
        (provenance, schema, fixture("provenance-1/handles.jsonl.prov.json")),
    ]
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
fn the_docs_hold_no_other_schema() {
    let mut known: Vec<String> = kinds().into_iter().map(|(name, ..)| format!("{name}.json")).collect();
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
    for (name, schema, file) in kinds() {
        let validator = jsonschema::validator_for(&schema).unwrap();
        for value in values(&file) {
            let errors: Vec<String> = validator.iter_errors(&value).map(|error| error.to_string()).collect();
            assert!(errors.is_empty(), "{name}: {errors:?}\n{value}");
        }
    }
}

#[test]
fn schemas_refuse_what_the_readers_refuse() {
    for (name, schema, file) in kinds() {
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
    let path = fixture(&format!("{0}-1/{0}.json", T::NAME));
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
    let path = fixture(&format!("{0}-1/{0}.jsonl", S::NAME));
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

/// That an artifact refers to the frozen mesh.
#[track_caller]
fn refers_to_the_mesh(mesh: &MeshRef) {
    assert_eq!(mesh.file.sha256, artifact::sha256(&fixture("obj/mesh.obj")).unwrap());
    assert_eq!((mesh.unit, mesh.vertex_count), (Unit::Mm, 5));
}

#[test]
fn a_frozen_take_reads() {
    let take: Take = document();
    assert_eq!((take.first_frame, take.rate.frames, take.rate.seconds), (1001, 30000, 1001));
    assert_eq!(take.start_timecode.as_deref(), Some("10:00:00;00"));
    assert_eq!(take.references["scan"].name, "mesh.obj");
    assert_eq!(take.cameras[0].image_size, [1920, 1080]);
    assert_eq!(take.consent.licence, "CC0-1.0");
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
