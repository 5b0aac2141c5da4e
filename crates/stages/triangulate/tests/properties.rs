//! Laws of triangulation, of the filter, of filling.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod scene;

use artifact::{Clock, Rate, SampleStatus, SyncCamera, SyncHeader, SyncSource};
use nalgebra::{Isometry3, Point3, Vector3};
use scene::{header, hide, moved, rest, rig, rms, still, tracks};
use triangulate::{Error, Filter, Params, triangulate};

const RAW: Params =
    Params { noise_px: None, outlier_px: None, filter: Filter::Off, smooth_ms: 60.0, fill_ms: 200.0 };

#[test]
fn to_project_then_to_triangulate_is_the_identity() {
    let truth = still(2);
    let (_, outcome) = triangulate(&rig(), &header(), tracks(&rig(), &truth, 0.0, 1), None, &RAW).unwrap();
    assert!(rms(&outcome.frames, &truth) < 1e-9, "{}", rms(&outcome.frames, &truth));
    assert!(outcome.frames.iter().flat_map(|f| &f.accuracy).all(|a| a.as_ref().unwrap().views.len() == 6));
}

#[test]
fn a_rigid_motion_of_the_rig_moves_the_points_rigidly() {
    let motion = Isometry3::new(Vector3::new(30., -200., 90.), Vector3::new(0.3, 1.2, -0.4));
    let seen = tracks(&rig(), &still(12), 0.1, 2);
    let params = Params::default();
    let (_, here) = triangulate(&rig(), &header(), seen.clone(), None, &params).unwrap();
    let (_, there) = triangulate(&moved(&rig(), &motion), &header(), seen, None, &params).unwrap();
    let carried: Vec<Vec<Point3<f64>>> =
        here.frames.iter().map(|f| f.markers.points.iter().map(|p| motion * p.unwrap()).collect()).collect();
    assert!(rms(&there.frames, &carried) < 1e-7, "{}", rms(&there.frames, &carried));
}

#[test]
fn parallel_rays_give_none() {
    let mut rig = rig();
    let one = rig.cameras["m1"].clone();
    rig.cameras.values_mut().for_each(|camera| *camera = one.clone());
    let seen = tracks(&rig, &still(2), 0.1, 3);
    let error = triangulate(&rig, &header(), seen, None, &RAW).map(|_| ()).unwrap_err();
    assert_eq!(error, Error::NothingAgrees(2 * scene::MARKERS));
}

/// The covariance says how far off points are: the mean of squared errors over their variance is 3.
#[test]
fn covariances_are_honest() {
    let truth = still(40);
    let (_, outcome) = triangulate(&rig(), &header(), tracks(&rig(), &truth, 0.1, 4), None, &RAW).unwrap();
    let (mut sum, mut count) = (0.0, 0.0);
    for (frame, truth) in outcome.frames.iter().zip(&truth) {
        for ((point, accuracy), truth) in frame.markers.points.iter().zip(&frame.accuracy).zip(truth) {
            let [xx, xy, xz, yy, yz, zz] = accuracy.as_ref().unwrap().covariance_mm2;
            let covariance = nalgebra::Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
            let off = point.unwrap() - truth;
            sum += off.dot(&(covariance.try_inverse().unwrap() * off));
            count += 1.0;
        }
    }
    assert!((sum / count - 3.0).abs() < 0.25, "{}", sum / count);
}

#[test]
fn a_view_that_is_off_is_left_out() {
    let truth = still(3);
    let mut seen = tracks(&rig(), &truth, 0.05, 5);
    seen[1].cameras[2].as_mut().unwrap()[7].as_mut().unwrap().at.x += 9.0;
    let (_, outcome) = triangulate(&rig(), &header(), seen, None, &RAW).unwrap();
    assert_eq!(outcome.frames[1].accuracy[7].as_ref().unwrap().views, ["m1", "m2", "m4", "m5", "m6"]);
    assert_eq!((outcome.report.cameras["m3"].outliers, outcome.report.disagreed), (1, 0));
    assert!((outcome.report.cameras["m3"].worst_px - 9.0).abs() < 0.5);
    assert!((outcome.frames[1].markers.points[7].unwrap() - truth[1][7]).norm() < 0.2);
}

#[test]
fn still_markers_keep_half_of_their_noise_at_most() {
    let truth = still(80);
    let seen = tracks(&rig(), &truth, 0.1, 6);
    let raw = triangulate(&rig(), &header(), seen.clone(), None, &RAW).unwrap().1;
    for (filter, most) in [(Filter::Affine, 0.45), (Filter::Paper, 0.8)] {
        let params = Params { filter, ..RAW };
        let smooth = triangulate(&rig(), &header(), seen.clone(), None, &params).unwrap().1;
        let ratio = rms(&smooth.frames, &truth) / rms(&raw.frames, &truth);
        assert!(ratio < most, "{filter:?}: {ratio}");
    }
}

/// The face turns by 15° at 1 Hz: that is common motion, and the noise still falls. On this sheet more than half of the markers
/// stand at a rim, where the common motion is extrapolated; a whole face keeps less.
#[test]
fn a_turning_head_is_filtered_too() {
    let turn = |f: usize| {
        let phase = std::f64::consts::TAU * f as f64 / 50.0;
        Isometry3::new(Vector3::new(20.0 * phase.sin(), 0., 0.), Vector3::y() * 0.26 * phase.sin())
    };
    let truth: Vec<Vec<Point3<f64>>> =
        (0..60).map(|f| rest().iter().map(|p| turn(f) * p).collect()).collect();
    let seen = tracks(&rig(), &truth, 0.1, 7);
    let raw = triangulate(&rig(), &header(), seen.clone(), None, &RAW).unwrap().1;
    let smooth = triangulate(&rig(), &header(), seen, None, &Params::default()).unwrap().1;
    let ratio = rms(&smooth.frames, &truth) / rms(&raw.frames, &truth);
    assert!(ratio < 0.7, "{ratio}");
}

/// One marker goes down and up again within 60 ms.
#[test]
fn the_peak_of_a_blink_stays() {
    for depth in [0.5, 2.0, 8.0] {
        let mut truth = still(60);
        for (frame, share) in [(29, 0.25), (30, 1.0), (31, 0.25)] {
            truth[frame][17].y -= depth * share;
        }
        let seen = tracks(&rig(), &truth, 0.1, 8);
        let raw = triangulate(&rig(), &header(), seen.clone(), None, &RAW).unwrap().1;
        let smooth = triangulate(&rig(), &header(), seen, None, &Params::default()).unwrap().1;
        let peak =
            |frames: &[artifact::MeasuredFrame]| rest()[17].y - frames[30].markers.points[17].unwrap().y;
        assert!(peak(&smooth.frames) > 0.95 * peak(&raw.frames), "{depth}: {}", peak(&smooth.frames));
    }
}

/// Sideways at 1 Hz; one camera is 0.4 frames late.
#[test]
fn late_cameras_are_interpolated_to_the_time_of_the_frame() {
    let at = |time: f64| -> Vec<Point3<f64>> {
        let shift = 25.0 * (std::f64::consts::TAU * time / 50.0).sin();
        rest().iter().map(|p| p + Vector3::new(shift, 0.0, 0.0)).collect()
    };
    let truth: Vec<_> = (0..40).map(|f| at(f64::from(f))).collect();
    // One camera lags, another one's clock runs so slowly that its lag grows past half a frame: then the next image is nearer.
    let clock = |offset_frames, drift_ppm| SyncCamera {
        rate: Rate::per_second(50),
        every: 1,
        phase: 1001,
        offset_frames,
        drift_ppm,
        source: SyncSource::Correlation,
    };
    let clock_of = |camera: usize| match camera {
        1 => clock(0.4, 0.0),
        4 => clock(0.0, 30_000.0),
        _ => clock(0.0, 0.0),
    };
    let mut seen = tracks(&rig(), &truth, 0.0, 9);
    for camera in [1, 4] {
        let times = (0..40).map(|f| f as f64 + clock_of(camera).lag_frames(1001 + f));
        let shown: Vec<_> = times.map(at).collect();
        for (frame, shown) in seen.iter_mut().zip(tracks(&rig(), &shown, 0.0, 9)) {
            frame.cameras[camera] = shown.cameras[camera].clone();
        }
    }
    let cameras = (0..6).map(|camera| (format!("m{}", camera + 1), clock_of(camera))).collect();
    let sync = SyncHeader { rate: Rate::per_second(50), clock: Clock::Mocap, cameras, take: None };
    let wide = Params { outlier_px: Some(50.0), ..RAW };
    let without = triangulate(&rig(), &header(), seen.clone(), None, &wide).unwrap().1;
    let with = triangulate(&rig(), &header(), seen, Some(&sync), &wide).unwrap().1;
    let errors = [&without, &with].map(|outcome| rms(&outcome.frames[2..38], &truth[2..38]));
    assert!(errors[0] > 0.1 && errors[1] < 0.01, "{errors:?}");
}

#[test]
fn gaps_are_filled_and_say_from_what() {
    let turn =
        |f: usize| Isometry3::new(Vector3::new(0.5 * f as f64, 0., 0.), Vector3::y() * 0.01 * f as f64);
    let truth: Vec<Vec<Point3<f64>>> =
        (0..40).map(|f| rest().iter().map(|p| turn(f) * p).collect()).collect();
    let mut seen = tracks(&rig(), &truth, 0.0, 10);
    for frame in 10..16 {
        (0..6).for_each(|camera| hide(&mut seen, frame, camera, 16));
        (0..5).for_each(|camera| hide(&mut seen, frame, camera, 30));
    }
    (15..35).for_each(|frame| (0..6).for_each(|camera| hide(&mut seen, frame, camera, 3)));
    let outcome = triangulate(&rig(), &header(), seen, None, &RAW).unwrap().1;
    let frame = &outcome.frames[12].markers;
    assert_eq!(frame.status[16], SampleStatus::NeighborFilled);
    assert_eq!(frame.status[30], SampleStatus::SingleCamera);
    for marker in [16, 30] {
        let off = (frame.points[marker].unwrap() - truth[12][marker]).norm();
        assert!(off < 0.05, "marker {marker}: {off}");
    }
    assert!(outcome.frames[20].markers.points[3].is_none(), "longer gaps stay");
    let report = &outcome.report.coverage["p3"];
    assert_eq!((report.gaps, report.longest_gap, report.missing), (1, 20, 20));
}

#[test]
fn exchanged_labels_are_reported_with_their_frames() {
    let truth = still(40);
    let mut seen = tracks(&rig(), &truth, 0.1, 11);
    for frame in &mut seen[12..=20] {
        frame.cameras.iter_mut().flatten().for_each(|samples| samples.swap(16, 17));
    }
    let swaps = triangulate(&rig(), &header(), seen, None, &RAW).unwrap().1.report.swaps;
    assert_eq!(swaps.len(), 1, "{swaps:?}");
    assert_eq!((swaps[0].first, swaps[0].last), (1013, 1021));
    assert_eq!(swaps[0].markers, ["p16", "p17"]);
}

#[test]
fn labels_exchanged_in_one_camera_are_reported_with_the_camera() {
    let truth = still(40);
    let mut seen = tracks(&rig(), &truth, 0.1, 13);
    for frame in &mut seen[12..=20] {
        frame.cameras[3].as_mut().unwrap().swap(16, 17);
    }
    let outcome = triangulate(&rig(), &header(), seen, None, &RAW).unwrap().1;
    let [swap] = &outcome.report.swaps[..] else { panic!("{:?}", outcome.report.swaps) };
    assert_eq!((swap.camera.as_deref(), swap.first, swap.last), (Some("m4"), 1013, 1021));
    assert_eq!(swap.markers, ["p16", "p17"]);
    assert!(rms(&outcome.frames, &truth) < 0.15, "the camera is left out");
}

/// A marker that one camera sees, and that two never saw: the sheet is curved, a plane through its neighbours would lie 2 mm
/// behind it.
#[test]
fn a_lone_ray_meets_the_surface_of_the_neighbours() {
    let truth = still(3);
    let mut seen = tracks(&rig(), &truth, 0.05, 14);
    for (frame, camera) in (0..3).flat_map(|frame| (0..5).map(move |camera| (frame, camera))) {
        hide(&mut seen, frame, camera + usize::from(camera > 1), 24);
    }
    let outcome = triangulate(&rig(), &header(), seen, None, &RAW).unwrap().1;
    let frame = &outcome.frames[1].markers;
    assert_eq!(frame.status[24], SampleStatus::SingleCamera);
    let off = (frame.points[24].unwrap() - truth[1][24]).norm();
    assert!(off < 0.3, "{off}");
}

/// Cameras that stand where the calibration says that others do.
#[test]
fn cameras_that_contradict_each_other_are_refused() {
    let seen = tracks(&rig(), &still(12), 0.1, 15);
    let mut other = rig();
    let poses: Vec<_> = other.cameras.values().map(|camera| camera.camera.cam_from_world).collect();
    for (camera, pose) in other.cameras.values_mut().zip(poses.iter().cycle().skip(3)) {
        camera.camera.cam_from_world = *pose;
    }
    let error = triangulate(&other, &header(), seen, None, &RAW).map(|_| ()).unwrap_err();
    assert!(matches!(error, Error::Contradiction { .. } | Error::NothingAgrees(_)), "{error}");
}

#[test]
fn what_cannot_be_triangulated_is_said() {
    let seen = tracks(&rig(), &still(3), 0.1, 12);
    let mut alone = seen.clone();
    alone.iter_mut().for_each(|frame| frame.cameras[1..].iter_mut().for_each(|camera| *camera = None));
    let refusal = |tracks, rig| triangulate(&rig, &header(), tracks, None, &RAW).map(|_| ()).unwrap_err();
    assert_eq!(refusal(alone, rig()), Error::NothingSeenTwice);
    assert_eq!(refusal(Vec::new(), rig()), Error::NoFrames);
    let mut fewer = rig();
    fewer.cameras.remove("m4");
    assert!(matches!(refusal(seen.clone(), fewer), Error::UnknownCamera { camera, .. } if camera == "m4"));
    let mut small = rig();
    small.cameras.values_mut().for_each(|camera| camera.camera.image_size = [320, 240]);
    assert!(matches!(refusal(seen, small), Error::OutsideImage { frame: 1001, width: 320, .. }));
}
