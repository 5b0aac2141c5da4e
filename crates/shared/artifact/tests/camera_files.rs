//! Cameras in the formats of others: what other programs wrote, round trips, and real calibrations.

#![allow(
    clippy::unwrap_used,
    clippy::disallowed_methods,
    clippy::print_stdout,
    reason = "a test may fail, looks at files, and says what it skips"
)]

mod support;

use artifact::{
    CameraDeviation, CameraFormat, CameraRig, RigCamera, Staged, Stated, Unit, read_cameras, write_cameras,
};
use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector2, Vector3};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use support::{Place, bytes, refusal, says};

const METRES: Stated = Stated { unit: Unit::M, image_size: None };
/// Files are in tenths of micrometres at worst, and cv2 computes in other orders: far below what an image shows.
const CLOSE_PX: f64 = 1e-9;

fn written_by_others(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/camera_files").join(name)
}

fn read(names: &[&str], format: CameraFormat, stated: &Stated) -> (CameraRig, Vec<String>) {
    let paths: Vec<PathBuf> = names.iter().map(|name| written_by_others(name)).collect();
    read_cameras(&paths, format, stated).unwrap()
}

#[derive(serde::Deserialize)]
struct Seen {
    points_m: Vec<[f64; 3]>,
    pixels: BTreeMap<String, Vec<[f64; 2]>>,
}

/// That a camera sees what OpenCV says; `world_from_points` in mm.
fn sees(camera: &Camera, name: &str, world_from_points: &Isometry3<f64>) {
    let seen: Seen = serde_json::from_slice(&bytes(&written_by_others("pixels.json"))).unwrap();
    for (point, pixel) in seen.points_m.iter().zip(&seen.pixels[name]) {
        let point = world_from_points * (Point3::from(*point) * 1000.0);
        let off = (camera.project(&point).unwrap() - Vector2::from(*pixel)).norm();
        assert!(off < CLOSE_PX, "{name}: {off} px at {point}");
    }
}

#[test]
fn opencv_writes_one_camera() {
    for name in ["opencv4.yml", "opencv4.json", "opencv5.yml", "opencv5.json"] {
        let (rig, warnings) = read(&[name], CameraFormat::Opencv, &METRES);
        assert_eq!(rig.cameras.keys().collect::<Vec<_>>(), ["left"], "{name}");
        assert!(warnings.is_empty(), "{warnings:?}");
        let left = &rig.cameras["left"];
        assert_eq!((left.rms_px, left.views, left.camera.image_size), (Some(0.125), Some(24), [656, 490]));
        assert_eq!(left.camera.lens.distortion.k3, 0.004);
        sees(&left.camera, "left", &Isometry3::identity());
    }
}

#[test]
fn opencv_writes_a_stereo_pair() {
    let stated = Stated { image_size: Some([656, 490]), ..METRES };
    let (single, _) = read(&["opencv5.yml"], CameraFormat::Opencv, &METRES);
    let first_from_points = single.cameras["left"].camera.cam_from_world;
    for name in ["pair4.yml", "pair5.yml"] {
        let (rig, _) = read(&[name], CameraFormat::Opencv, &stated);
        assert_eq!(rig.cameras["1"].camera.cam_from_world, Isometry3::identity());
        sees(&rig.cameras["1"].camera, "left", &first_from_points);
        sees(&rig.cameras["2"].camera, "right", &first_from_points);
    }
}

#[test]
fn aniposelib_and_colmap_write_two_cameras() {
    for (name, format) in [("anipose.toml", CameraFormat::Anipose), ("colmap", CameraFormat::Colmap)] {
        let (rig, warnings) = read(&[name], format, &METRES);
        assert!(warnings.is_empty(), "{warnings:?}");
        assert_eq!(rig.cameras["right"].camera.image_size, [1384, 1038]);
        for id in ["left", "right"] {
            sees(&rig.cameras[id].camera, id, &Isometry3::identity());
        }
    }
}

#[test]
fn ros_writes_plain_yaml() {
    let text = "image_width: 640\nimage_height: 480\ncamera_name: head # no tags\ncamera_matrix:\n  rows: 3\n  cols: 3\n  \
                data: [430.2, 0., 306.9, 0, 430.5, 227.2, 0, 0, 1]\ndistortion_model: plumb_bob\n\
                distortion_coefficients: {rows: 1, cols: 5, data: [-0.3, 0.1, 1e-3, 0., 0.]}\n\
                projection_matrix:\n  rows: 3\n  cols: 4\n  data:\n  - 1.\n  - 0.\n";
    let place = Place::new();
    let (rig, warnings) = read_cameras(&[place.file("a.yaml", text)], CameraFormat::Opencv, &METRES).unwrap();
    assert_eq!(rig.cameras["head"].camera.lens.focal_px, Vector2::new(430.2, 430.5));
    assert_eq!(rig.cameras["head"].camera.lens.distortion.p1, 1e-3);
    says(&warnings[0], &["head", "no pose", "origin"]);
    assert_eq!(warnings.len(), 1);
}

#[test]
fn cameras_may_be_maps_by_name_and_matrices_lists() {
    let one = |shift: f64| {
        format!(
            "{{\"K\": [[800, 0, 320], [0, 800, 240], [0, 0, 1]], \"dist\": [[0, 0, 0, 0]], \"rvec\": [0, 0, 0],\n\
             \"tvec\": [{shift}, 0, 1.], // no comma before a comment\n \"image_size\": [640, 480]}}"
        )
    };
    let text = format!("{{\"a\": {},\n\"b\": {}}}\n", one(0.0), one(0.5));
    let place = Place::new();
    let (rig, warnings) =
        read_cameras(&[place.file("a.json", &text)], CameraFormat::Opencv, &METRES).unwrap();
    says(&warnings[1], &["b.dist has 4 coefficients, taken for k1, k2, p1, p2", "fisheye"]);
    let shifts = ["a", "b"].map(|id| rig.cameras[id].camera.cam_from_world.translation.vector);
    assert_eq!(shifts, [Vector3::new(0.0, 0.0, 1000.0), Vector3::new(500.0, 0.0, 1000.0)]);
}

#[test]
fn a_real_stereo_calibration_has_a_coefficient_too_many() {
    let Some(folder) = testkit::data("stereo_opencv_chessboard") else { return };
    let stated = Stated { unit: Unit::Cm, image_size: Some([640, 480]) };
    let files = ["intrinsics.yml", "extrinsics.yml"].map(|name| folder.join(name));
    says(
        &refusal(read_cameras(&files, CameraFormat::Opencv, &stated)),
        &["intrinsics.yml, line 9, D1", "k6 = -0.4046901661327459", "five coefficients"],
    );
    says(
        &refusal(read_cameras(&files[..1], CameraFormat::Opencv, &stated)),
        &["intrinsics.yml: lacks R", "intrinsics and the file of the extrinsics together"],
    );
    // Without it, all else comes in.
    let plain = ["-4.0469016613274594e-01", "-1.9692458400989710e-01"];
    let intrinsics =
        String::from_utf8(bytes(&files[0])).unwrap().replace(plain[0], "0.").replace(plain[1], "0.");
    let place = Place::new();
    let files = [place.file("intrinsics.yml", intrinsics), files[1].clone()];
    let (rig, _) = read_cameras(&files, CameraFormat::Opencv, &stated).unwrap();
    let right = &rig.cameras["2"].camera;
    assert_eq!(right.lens.center_px, Vector2::new(314.06466877037155, 242.22537573117978));
    assert!((right.cam_from_world.translation.x + 33.425_631_770_444_57).abs() < 1e-12);
    assert!(
        (right.cam_from_world.rotation.to_rotation_matrix()[(0, 1)] - 4.739_170_924_609_971e-3).abs() < 1e-12
    );
}

#[test]
fn a_real_session_of_caliscope_fits_its_points() {
    let Some(folder) = testkit::data("multicam_caliscope_4cam") else { return };
    let files = [folder.join("camera_array.toml")];
    let (rig, _) = read_cameras(&files, CameraFormat::Anipose, &METRES).unwrap();
    assert_eq!(rig.cameras.keys().collect::<Vec<_>>(), ["cam_0", "cam_1", "cam_2", "cam_3"]);
    assert_eq!((rig.cameras["cam_0"].rms_px, rig.cameras["cam_0"].views), (Some(0.19), Some(24)));
    // Corners of the board that several cameras saw, by frame and number.
    let mut corners = BTreeMap::<_, Vec<(&Camera, Vector2<f64>)>>::new();
    let mut rows = csv::Reader::from_path(folder.join("xy.csv")).unwrap();
    for row in rows.records() {
        let row = row.unwrap();
        let camera = &rig.cameras[&format!("cam_{}", &row[1])].camera;
        let pixel = Vector2::new(row[6].parse().unwrap(), row[7].parse().unwrap());
        corners.entry((row[0].to_string(), row[5].to_string())).or_default().push((camera, pixel));
    }
    let (mut sum, mut count) = (0.0, 0);
    for views in corners.values().filter(|views| views.len() > 1) {
        let point = Camera::nearest_to_rays(views.iter().copied()).unwrap();
        for (camera, pixel) in views {
            sum += (camera.project(&point).unwrap() - pixel).norm_squared();
            count += 1;
        }
    }
    let rms = (sum / f64::from(count)).sqrt();
    // The nearest point is not the one that fits the images best, but close to it.
    assert!(count > 1000 && rms < 1.2, "{rms} px of {count}");
}

/// Any camera; `k3`: whether it may have that coefficient.
fn any_camera() -> impl Strategy<Value = RigCamera> {
    let numbers = proptest::array::uniform5(-0.3..0.3f64);
    let turn = (proptest::array::uniform3(-1.0..1.0f64), 0.0..std::f64::consts::PI);
    let place = (proptest::array::uniform3(-2000.0..2000.0f64), proptest::array::uniform2(0.0..2000.0f64));
    ((1..4000u32, 1..4000u32), 100.0..5000.0f64, 0..3, numbers, turn, place).prop_map(
        |((width, height), focal, model, [k1, k2, p1, p2, k3], (axis, angle), (shift, center))| {
            let full = BrownConrady { k1, k2, p1, p2, k3 };
            let distortion = match model {
                0 => BrownConrady::default(),
                1 => BrownConrady { k3: 0.0, ..full },
                _ => full,
            };
            let axis = Vector3::from(axis).try_normalize(1e-3).unwrap_or(Vector3::x());
            let pose = Isometry3::from_parts(
                Vector3::from(shift).into(),
                UnitQuaternion::from_scaled_axis(axis * angle),
            );
            let lens =
                Lens { focal_px: Vector2::new(focal, focal * 1.01), center_px: center.into(), distortion };
            RigCamera::from(Camera { image_size: [width, height], lens, cam_from_world: pose })
        },
    )
}

const EVERY: [(CameraFormat, &str); 5] = [
    (CameraFormat::Furrow, "a.json"),
    (CameraFormat::Opencv, "a.yml"),
    (CameraFormat::Opencv, "b.json"),
    (CameraFormat::Anipose, "a.toml"),
    (CameraFormat::Colmap, "a"),
];

fn publish(written: artifact::Result<(Vec<Staged>, Vec<String>)>) -> Vec<String> {
    let (files, warnings) = written.unwrap();
    files.into_iter().for_each(|file| file.publish().unwrap());
    warnings
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn what_is_written_comes_back(
        cameras in proptest::collection::btree_map("[a-zA-Z0-9_.\"äß-]{1,8}", any_camera(), 1..12),
        unit in prop_oneof![Just(Unit::Mm), Just(Unit::Cm), Just(Unit::M)],
    ) {
        let rig = CameraRig { cameras, take: None };
        for (format, name) in EVERY {
            let place = Place::new();
            let path = place.path(name);
            let unit = if format == CameraFormat::Furrow { Unit::Mm } else { unit };
            publish(write_cameras(&path, &rig, format, unit));
            let stated = Stated { unit, image_size: None };
            let (again, _) = read_cameras(&[path], format, &stated).unwrap();
            prop_assert_eq!(again.cameras.len(), rig.cameras.len());
            for (id, RigCamera { camera, .. }) in &rig.cameras {
                let back = &again.cameras[id].camera;
                prop_assert_eq!(back.image_size, camera.image_size);
                prop_assert_eq!(back.lens.distortion, camera.lens.distortion);
                prop_assert_eq!(back.lens.focal_px, camera.lens.focal_px);
                // Half a pixel to and fro, and a change of units, cost the last digit.
                prop_assert!((back.lens.center_px - camera.lens.center_px).norm() < 1e-12);
                let off = back.cam_from_world.to_homogeneous() - camera.cam_from_world.to_homogeneous();
                prop_assert!(off.fixed_view::<3, 3>(0, 0).amax() < 1e-14, "{}", off);
                prop_assert!(off.fixed_view::<3, 1>(0, 3).amax() < 1e-12, "{}", off);
            }
        }
    }
}

#[test]
fn what_a_format_has_no_place_for_is_told() {
    let (mut rig, _) = read(&["opencv5.yml"], CameraFormat::Opencv, &METRES);
    let deviation = CameraDeviation {
        focal_px: [1.0; 2],
        center_px: [1.0; 2],
        rotation_rad: [0.1; 3],
        translation_mm: [0.1; 3],
    };
    rig.cameras.get_mut("left").unwrap().deviation = Some(deviation);
    let place = Place::new();
    let told: Vec<usize> = EVERY
        .iter()
        .map(|(format, name)| publish(write_cameras(&place.path(name), &rig, *format, Unit::Mm)).len())
        .collect();
    assert_eq!(told, [0, 1, 1, 2, 2]);
    let again = |name: &str| {
        read_cameras(&[place.path(name)], CameraFormat::Opencv, &Stated { unit: Unit::Mm, ..METRES })
    };
    assert_eq!(again("a.yml").unwrap().0.cameras["left"].rms_px, Some(0.125));
    assert_eq!(again("b.json").unwrap().0.cameras["left"].views, Some(24));
}
