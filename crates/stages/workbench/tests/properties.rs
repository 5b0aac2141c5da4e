//! Laws that hold whatever the take.

use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Point3, Vector2, Vector3};
use proptest::prelude::*;
use std::collections::BTreeMap;
use workbench::epipolar::{Dots, hints};

/// Cameras on an arc, 1 m from a face at the origin, with lenses that bend.
fn rig() -> BTreeMap<String, Camera> {
    let camera = |index: u32| {
        let angle = (f64::from(index) - 1.5) * 0.35;
        let eye = Point3::new(1000.0 * angle.sin(), 80.0 * f64::from(index), 1000.0 * angle.cos());
        let distortion = BrownConrady { k1: -0.18, k2: 0.06, ..BrownConrady::default() };
        let lens = Lens {
            focal_px: Vector2::new(1400.0, 1405.0),
            center_px: Vector2::new(322.0, 250.0),
            distortion,
        };
        let cam_from_world = Camera::pose_looking_at(eye, Point3::origin(), Vector3::y());
        (format!("m{index}"), Camera { image_size: [656, 490], lens, cam_from_world })
    };
    (1..=4).map(camera).collect()
}

fn labels(rig: &BTreeMap<String, Camera>, points: &BTreeMap<String, Point3<f64>>) -> BTreeMap<String, Dots> {
    let dots = |camera: &Camera| {
        let seen =
            |(marker, point): (&String, &Point3<f64>)| Some((marker.clone(), camera.project(point)?.into()));
        points.iter().filter_map(seen).collect()
    };
    rig.iter().map(|(id, camera)| (id.clone(), dots(camera))).collect()
}

proptest! {
    #[test]
    fn a_marker_lies_where_the_other_cameras_say(x in -60.0..60.0f64, y in -80.0..80.0f64, z in -30.0..60.0f64) {
        let rig = rig();
        let all = labels(&rig, &BTreeMap::from([("nose".to_string(), Point3::new(x, y, z))]));
        let hint = &hints(&rig, &all, "m2").unwrap()["nose"];
        prop_assert_eq!(hint.lines.len(), 3);
        prop_assert!(hint.off_px.unwrap() < 1e-3, "{:?}", hint.off_px);
        for line in hint.lines.values() {
            let one = BTreeMap::from([("m2".to_string(), all["m2"].clone()), ("m1".to_string(), all["m1"].clone())]);
            let off = hints(&rig, &one, "m2").unwrap()["nose"].off_px.unwrap();
            prop_assert!(off < 0.5 && line.iter().all(|piece| piece.len() > 1), "{off}");
        }
    }

    #[test]
    fn a_dot_of_another_marker_is_off_its_line(up in 6.0..60.0f64) {
        let rig = rig();
        let points = BTreeMap::from([("a".to_string(), Point3::new(0.0, up, 20.0)), ("b".to_string(), Point3::new(0.0, -up, 20.0))]);
        let mut all = labels(&rig, &points);
        let swapped = BTreeMap::from([("a".to_string(), all["m2"]["b"]), ("b".to_string(), all["m2"]["a"])]);
        all.insert("m2".to_string(), swapped);
        let found = hints(&rig, &all, "m2").unwrap();
        prop_assert!(found.values().all(|hint| hint.off_px.unwrap() > 8.0), "{found:?}");
    }
}

#[test]
fn a_camera_that_is_not_calibrated_is_named() {
    let refused = hints(&rig(), &BTreeMap::new(), "w9").unwrap_err();
    assert_eq!(refused.to_string(), "camera w9 is not calibrated");
}
