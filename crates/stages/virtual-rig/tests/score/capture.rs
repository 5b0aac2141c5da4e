//! tracks-2d, trajectories, head poses, cameras, sync.

use crate::perturb::*;
use artifact::{HeadPoseFrame, HeadPoseHeader, SampleStatus};
use nalgebra::{Isometry3, Point2, Point3, UnitQuaternion, Vector3};
use virtual_rig::score;

fn score_tracks(change: impl FnOnce(&mut Vec<artifact::Tracks2dFrame>)) -> Vec<score::Metric> {
    let (header, truth) = tracks();
    let mut frames = truth.clone();
    change(&mut frames);
    score::tracks_2d((&header, &truth), (&header, &frames)).unwrap()
}

#[test]
fn tracks_truth_fed_back_is_perfect() {
    assert_perfect(&score_tracks(|_| ()), &[]);
}

#[test]
fn tracks_noise_is_recovered_as_radial_rms() {
    let mut planted = 0.0;
    let metrics = score_tracks(|frames| planted = shake_pixels(frames, 0.1, 1));
    assert_recovered(&metrics, "rms_px", planted);
    assert_eq!(value(&metrics, "recall"), 1.0);
    assert_eq!(metric(&metrics, "rms_px").context["cameras"].as_object().unwrap().len(), 6);
}

#[test]
fn tracks_swaps_are_counted_in_every_frame_and_camera() {
    let metrics = score_tracks(|frames| {
        for frame in &mut frames[10..13] {
            frame.cameras[2].as_mut().unwrap().swap(4, 5);
        }
    });
    assert_eq!(value(&metrics, "swaps"), 6.0);
    assert_eq!(value(&metrics, "outliers") + value(&metrics, "false_positives"), 0.0);
    let whole = 40.0 * 48.0 * 6.0;
    assert_recovered(&metrics, "recall", (whole - 6.0) / whole);
    assert_eq!(metric(&metrics, "swaps").context["cameras"]["m3"], 6);
}

#[test]
fn tracks_lost_samples_frames_and_cameras_cost_recall() {
    let metrics = score_tracks(|frames| {
        samples(frames).step_by(20).for_each(|sample| *sample = None);
    });
    assert_recovered(&metrics, "recall", 0.95);

    let metrics = score_tracks(|frames| {
        frames.drain(4..8);
        frames.iter_mut().for_each(|frame| frame.cameras[0] = None);
    });
    assert_recovered(&metrics, "recall", 0.9 * 5.0 / 6.0);
    assert_eq!(metric(&metrics, "recall").context["frames_missing"], 4);

    let (header, truth) = tracks();
    let fewer = artifact::Tracks2dHeader { cameras: header.cameras[1..].to_vec(), ..header.clone() };
    let cut = |frame: &artifact::Tracks2dFrame| artifact::Tracks2dFrame {
        frame: frame.frame,
        cameras: frame.cameras[1..].to_vec(),
    };
    let frames: Vec<_> = truth.iter().map(cut).collect();
    let metrics = score::tracks_2d((&header, &truth), (&fewer, &frames)).unwrap();
    assert_recovered(&metrics, "recall", 5.0 / 6.0);
    assert_eq!(metric(&metrics, "recall").context["cameras_missing"], 1);
}

#[test]
fn tracks_predictions_are_not_recalled() {
    let metrics = score_tracks(|frames| samples(frames).step_by(10).for_each(|sample| hide(sample, 1.0)));
    assert_recovered(&metrics, "recall", 0.9);
}

#[test]
fn tracks_of_hidden_markers_are_false_unless_their_dot_shows() {
    let (header, seen) = tracks();
    let mut truth = seen.clone();
    for (i, sample) in samples(&mut truth).enumerate().filter(|(i, _)| i % 10 == 0) {
        hide(sample, if i % 20 == 0 { 0.0 } else { 0.4 });
    }
    let metrics = score::tracks_2d((&header, &truth), (&header, &seen)).unwrap();
    assert_eq!(value(&metrics, "false_positives"), 40.0 * 48.0 * 6.0 / 20.0);
    assert_eq!(value(&metrics, "recall"), 1.0);
    assert_eq!(metric(&metrics, "recall").context["partial"], 576);
}

#[test]
fn tracks_beyond_the_gate_are_outliers() {
    let metrics = score_tracks(|frames| {
        samples(frames).step_by(16).flatten().for_each(|sample| sample.at.x += 1.5);
    });
    assert_eq!(value(&metrics, "outliers"), 720.0);
    assert_recovered(&metrics, "recall", 15.0 / 16.0);
    assert_eq!(value(&metrics, "rms_px"), 0.0);
}

#[test]
fn trajectories_truth_fed_back_is_perfect() {
    let truth = markers();
    assert_perfect(&score::trajectories_3d(&truth, &truth).unwrap(), &["filled_rms_mm"]);
    assert_perfect(&score::head_trajectories(&truth, &truth).unwrap(), &["filled_rms_mm"]);
}

#[test]
fn trajectories_noise_is_recovered() {
    let truth = markers();
    let mut result = truth.clone();
    let lengths = shake_points(&mut result.frames, 0.2, 2);
    let metrics = score::trajectories_3d(&truth, &result).unwrap();
    assert_recovered(&metrics, "rms_mm", rms(&lengths));
    assert_recovered(&metrics, "median_mm", lengths[lengths.len() / 2]);
    assert_recovered(&metrics, "p95_mm", lengths[lengths.len() * 95 / 100]);
}

#[test]
fn trajectories_filled_samples_are_scored_apart_and_lost_ones_counted() {
    let truth = markers();
    let mut result = truth.clone();
    for frame in &mut result.frames {
        frame.status[3] = SampleStatus::NeighborFilled;
        frame.points[3].as_mut().unwrap().x += 0.5;
        frame.points[7] = None;
    }
    result.frames.truncate(36);
    let metrics = score::trajectories_3d(&truth, &result).unwrap();
    assert_eq!(value(&metrics, "rms_mm"), 0.0);
    assert_recovered(&metrics, "filled_rms_mm", 0.5);
    assert_eq!(value(&metrics, "missing"), 36.0 + 4.0 * 48.0);
    assert_recovered(&metrics, "coverage", 36.0 * 46.0 / (40.0 * 48.0));
}

#[test]
fn coverage_asks_only_for_what_two_cameras_saw() {
    let (header, mut seen) = tracks();
    for frame in &mut seen[10..] {
        frame.cameras[1..].iter_mut().flatten().for_each(|samples| hide(&mut samples[7], 0.3));
    }
    let truth = score::seen_by_two(&markers(), (&header, &seen));
    let mut result = markers();
    result.frames.iter_mut().skip(10).for_each(|frame| frame.points[7] = None);
    let metrics = score::trajectories_3d(&truth, &result).unwrap();
    assert_eq!(value(&metrics, "coverage"), 1.0);
    assert_eq!(metric(&metrics, "coverage").context["measured"], 40 * 48 - 30);
}

#[test]
fn head_trajectories_forgive_another_head_space_only() {
    let truth = markers();
    let mut result = truth.clone();
    let lengths = shake_points(&mut result.frames, 0.1, 3);
    let moved = Isometry3::new(Vector3::new(3.0, -20.0, 8.0), Vector3::new(0.1, 0.2, -0.05));
    result
        .frames
        .iter_mut()
        .flat_map(|frame| frame.points.iter_mut().flatten())
        .for_each(|point| *point = moved * *point);
    let metrics = score::head_trajectories(&truth, &result).unwrap();
    assert_recovered(&metrics, "rms_mm", rms(&lengths));
    assert!(metric(&metrics, "rms_mm").context["raw_rms_mm"].as_f64().unwrap() > 5.0);
    assert!(value(&score::trajectories_3d(&truth, &result).unwrap(), "rms_mm") > 5.0);
}

fn poses() -> (HeadPoseHeader, Vec<HeadPoseFrame>) {
    let header = HeadPoseHeader {
        rate: None,
        reference_frame: FIRST,
        markers: vec!["p00".into()],
        take: Some(take("t1")),
    };
    let pose = |i: i64| {
        let time = i as f64 * 0.2;
        Isometry3::new(
            Vector3::new(300.0 + 5.0 * time.sin(), 1200.0, 40.0),
            Vector3::new(0.05 * time.sin(), 0.04 * time, 0.02),
        )
    };
    let frame = |i: i64| HeadPoseFrame {
        frame: FIRST + i,
        world_from_head: Some(pose(i)),
        residual_mm: Some(0.0),
        markers_used: 5,
    };
    (header, (0..30).map(frame).collect())
}

#[test]
fn head_pose_errors_are_recovered_in_any_head_space() {
    let (header, truth) = poses();
    assert_perfect(&score::head_pose((&header, &truth), (&header, &truth)).unwrap(), &[]);

    let mut result = truth.clone();
    let other_space = Isometry3::new(Vector3::new(10.0, -40.0, 7.0), Vector3::new(0.3, 0.0, 0.1));
    for (i, frame) in result.iter_mut().enumerate() {
        let head = truth[i].world_from_head.unwrap();
        // From the second frame on: half a degree about the head's origin, and 0.3 mm.
        let turn = UnitQuaternion::from_axis_angle(
            &Vector3::x_axis(),
            0.5f64.to_radians() * f64::from(u8::from(i > 0)),
        );
        let shift = Vector3::new(0.0, 0.3, 0.0) * f64::from(u8::from(i > 0));
        let wrong = head * Isometry3::from_parts(shift.into(), turn);
        frame.world_from_head = Some(wrong * other_space);
    }
    result[20].world_from_head = None;
    let metrics = score::head_pose((&header, &truth), (&header, &result)).unwrap();
    assert_recovered(&metrics, "rotation_rms_deg", 0.5);
    assert_recovered(&metrics, "translation_rms_mm", 0.3);
    assert_recovered(&metrics, "translation_max_mm", 0.3);
    assert_eq!(value(&metrics, "missing"), 1.0);
}

#[test]
fn cameras_truth_fed_back_is_perfect() {
    let rig = rig();
    assert_perfect(&score::cameras(&rig, &rig, &markers(), None).unwrap(), &[]);
    let (header, frames) = tracks();
    assert_perfect(&score::cameras(&rig, &rig, &markers(), Some((&header, &frames))).unwrap(), &[]);
}

#[test]
fn cameras_of_another_world_are_perfect_but_not_of_another_scale() {
    let (truth, markers) = (rig(), markers());
    let world = Isometry3::new(Vector3::new(200.0, 30.0, -70.0), Vector3::new(0.4, -0.3, 0.2));
    let mut moved = truth.clone();
    for camera in moved.cameras.values_mut() {
        camera.camera.cam_from_world *= world;
    }
    let metrics = score::cameras(&truth, &moved, &markers, None).unwrap();
    for name in ["marker_mm", "angle_deg", "position_mm", "focal_rel"] {
        assert!(value(&metrics, name) < 1e-8, "{name}: {}", value(&metrics, name));
    }

    let mut scaled = truth.clone();
    for camera in scaled.cameras.values_mut() {
        camera.camera.cam_from_world.translation.vector *= 1.01;
    }
    let metrics = score::cameras(&truth, &scaled, &markers, None).unwrap();
    let points: Vec<Point3<f64>> =
        markers.frames.iter().flat_map(|frame| frame.points.iter().flatten().copied()).collect();
    let mean = points.iter().map(|point| point.coords).sum::<Vector3<f64>>() / points.len() as f64;
    let spread = rms(&points.iter().map(|point| (point.coords - mean).norm()).collect::<Vec<_>>());
    assert_recovered(&metrics, "marker_mm", 0.01 * spread);
}

#[test]
fn cameras_planted_errors_are_recovered() {
    let (truth, markers) = (rig(), markers());
    let mut result = truth.clone();
    result.cameras.get_mut("m2").unwrap().camera.lens.focal_px *= 1.02;
    let metrics = score::cameras(&truth, &result, &markers, None).unwrap();
    assert_recovered(&metrics, "focal_rel", 0.02);
    assert_eq!(metric(&metrics, "focal_rel").context["per_camera"]["m1"], 0.0);

    let mut result = truth.clone();
    let camera = &mut result.cameras.get_mut("m4").unwrap().camera;
    camera.cam_from_world = Isometry3::rotation(Vector3::z() * 0.3f64.to_radians()) * camera.cam_from_world;
    let metrics = score::cameras(&truth, &result, &markers, None).unwrap();
    assert_recovered(&metrics, "angle_deg", 0.3);
    assert!(value(&metrics, "position_mm") < 0.01, "{}", value(&metrics, "position_mm"));

    let mut result = truth.clone();
    let camera = &mut result.cameras.get_mut("m6").unwrap().camera;
    camera.cam_from_world = Isometry3::translation(0.0, 1.5, 0.0) * camera.cam_from_world;
    let world = Isometry3::new(Vector3::new(200.0, 30.0, -70.0), Vector3::new(0.4, -0.3, 0.2));
    result.cameras.values_mut().for_each(|camera| camera.camera.cam_from_world *= world);
    let metrics = score::cameras(&truth, &result, &markers, None).unwrap();
    assert_recovered(&metrics, "position_mm", 1.5);
    assert!(value(&metrics, "angle_deg") < 1e-4, "{}", value(&metrics, "angle_deg"));
}

#[test]
fn cameras_that_are_missing_are_counted() {
    let (truth, markers) = (rig(), markers());
    let mut result = truth.clone();
    for id in ["m1", "m3", "m4", "m5", "m6"] {
        result.cameras.remove(id);
    }
    let metrics = score::cameras(&truth, &result, &markers, None).unwrap();
    assert_eq!(value(&metrics, "cameras_missing"), 5.0);
    assert_eq!(metric(&metrics, "marker_mm").value, None);
    assert_eq!(metric(&metrics, "marker_mm").context["points_lost"], 40 * 48);
}

#[test]
fn sync_truth_fed_back_is_perfect() {
    let (header, frames) = time_base();
    assert_perfect(&score::sync((&header, &frames), (&header, &frames)).unwrap(), &[]);
}

#[test]
fn sync_offsets_and_drifts_are_recovered_whatever_all_clocks_share() {
    let (header, frames) = time_base();
    let mut result = header.clone();
    for camera in result.cameras.values_mut() {
        camera.offset_frames += 0.4;
        camera.drift_ppm -= 11.0;
    }
    let camera = result.cameras.get_mut("m3").unwrap();
    camera.offset_frames += 0.25;
    result.cameras.get_mut("m5").unwrap().drift_ppm += 40.0;
    let metrics = score::sync((&header, &frames), (&result, &frames)).unwrap();
    assert_recovered(&metrics, "offset_frames", 0.25);
    assert_recovered(&metrics, "drift_ppm", 40.0);
    assert_recovered(&[metric(&metrics, "drift_ppm").clone()], "drift_ppm", 40.0);
}

#[test]
fn sync_an_image_shown_a_frame_late_is_an_offset_of_one_frame() {
    let (header, frames) = time_base();
    let mut result = frames.clone();
    for frame in &mut result {
        if let Some(Some(shown)) = frame.shows.get_mut("m1") {
            shown.index -= 1;
        }
    }
    let metrics = score::sync((&header, &frames), (&header, &result)).unwrap();
    assert_recovered(&metrics, "offset_frames", 1.0);
    assert_eq!(value(&metrics, "wrong_images"), 200.0);
}

#[test]
fn sync_drops_missed_and_invented_are_told_apart() {
    let (header, frames) = time_base();
    let mut result = frames.clone();
    let shown = |index| Some(artifact::Shown { index, time_s: None, doubled: false });
    result[30].shows.insert("m2".into(), shown(30));
    result[80].shows.insert("m3".into(), shown(80));
    result[50].shows.insert("m1".into(), None);
    result[51].shows.insert("m1".into(), Some(artifact::Shown { doubled: true, ..shown(51).unwrap() }));
    result.pop();
    let metrics = score::sync((&header, &frames), (&header, &result)).unwrap();
    assert_eq!(value(&metrics, "drops_missed"), 2.0);
    assert_eq!(value(&metrics, "drops_invented"), 2.0);
    assert_eq!(value(&metrics, "missing"), 5.0);
}

/// The camera m1, whose image 40 stands twice in the footage: the second copy is image 41, which no frame shows.
#[test]
fn sync_a_repeated_image_is_missed_by_who_takes_it_for_a_new_one() {
    let (header, mut frames) = time_base();
    let number = |frame: &mut artifact::SyncFrame, index: i64| {
        frame.shows.insert("m1".into(), Some(artifact::Shown { index, time_s: None, doubled: false }));
    };
    let by_order = frames.clone();
    frames.iter_mut().enumerate().skip(41).for_each(|(at, frame)| number(frame, at as i64 + 1));
    let judge = |result: &[artifact::SyncFrame]| {
        let metrics = score::sync((&header, &frames), (&header, result)).unwrap();
        let drops = metric(&metrics, "drops_missed").context["drops"].clone();
        assert_eq!(drops, 3, "one lost, one marked as doubled, one repeated");
        ["drops_missed", "drops_invented", "wrong_images"].map(|name| value(&metrics, name))
    };
    assert_eq!(judge(&frames), [0.0, 0.0, 0.0]);
    assert_eq!(judge(&by_order), [1.0, 0.0, 159.0]);
    let mut second_copy = frames.clone();
    number(&mut second_copy[40], 41);
    assert_eq!(judge(&second_copy), [1.0, 0.0, 1.0]);
    let mut lost_too = by_order;
    lost_too[41].shows.insert("m1".into(), None);
    assert_eq!(judge(&lost_too), [0.0, 1.0, 158.0], "the repeated image is noticed, the one after it is not");
}

#[test]
fn a_sample_that_no_camera_shows_lies_somewhere() {
    // A marker out of every image may not be called a swap for being far from itself.
    let (header, seen) = tracks();
    let mut truth = seen.clone();
    truth.iter_mut().for_each(|frame| frame.cameras[0].as_mut().unwrap()[9] = None);
    let mut result = seen.clone();
    result.iter_mut().for_each(|frame| {
        frame.cameras[0].as_mut().unwrap()[9].as_mut().unwrap().at = Point2::new(3.0, 3.0);
    });
    let metrics = score::tracks_2d((&header, &truth), (&header, &result)).unwrap();
    assert_eq!((value(&metrics, "swaps"), value(&metrics, "false_positives")), (0.0, 40.0));
}
