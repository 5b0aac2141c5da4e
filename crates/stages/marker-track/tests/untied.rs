//! What bears a sample of a second pass out: other cameras, its neighbours over time.

#![allow(clippy::unwrap_used, clippy::panic, clippy::disallowed_methods, reason = "tests may")]

use artifact::{Accuracy, MarkerFrame, MeasuredFrame, Sample2d, SampleStatus, TrackState, Tracks2dFrame};
use camera::{BrownConrady, Camera, Lens};
use marker_track::{bears_out, drop_untied};
use nalgebra::{Isometry3, Point2, Point3, Vector2};

/// A marker in the sheet's midst.
const MARKER: usize = 19;

/// What 3D markers say of a sample, with the covariance of a standard deviation along each axis.
fn measured(status: SampleStatus, views: &[&str], deviation_mm: f64) -> MeasuredFrame {
    let variance = deviation_mm.powi(2);
    let covariance_mm2 = [variance, 0.0, 0.0, variance / 4.0, 0.0, variance / 4.0];
    let views = views.iter().map(ToString::to_string).collect();
    let points = vec![Some(Point3::new(3.0, -2.0, 500.0))];
    MeasuredFrame {
        markers: MarkerFrame { frame: 1, points, status: vec![status] },
        accuracy: vec![Some(Accuracy { covariance_mm2, views })],
    }
}

#[test]
fn a_guide_that_rests_on_the_camera_itself_bears_nothing_out() {
    let lens = Lens {
        focal_px: Vector2::repeat(1000.0),
        center_px: Vector2::new(327.5, 244.5),
        distortion: BrownConrady::default(),
    };
    // 2 px per mm.
    let camera = Camera { image_size: [656, 490], lens, cam_from_world: Isometry3::identity() };
    let says = |frame: &MeasuredFrame| bears_out(frame, "m1", &camera, 2.0)[0];
    let sure = |views: &[&str]| says(&measured(SampleStatus::Measured, views, 0.1));
    assert!(sure(&["m2", "m3"]) && sure(&["m1", "m2", "m3"]));
    assert!(!sure(&["m1", "m2"]), "one other camera agrees with much that is wrong");
    for status in [SampleStatus::SingleCamera, SampleStatus::NeighborFilled, SampleStatus::Interpolated] {
        assert!(!says(&measured(status, &["m2", "m3"], 0.1)), "{status:?}");
    }
    let views = ["m1", "m2", "m3"];
    assert!(says(&measured(SampleStatus::Measured, &views, 0.49)));
    assert!(!says(&measured(SampleStatus::Measured, &views, 0.51)), "its views disagree");
    let mut silent = measured(SampleStatus::Measured, &[], 0.1);
    assert!(says(&silent), "nothing is said of the views");
    silent.accuracy = vec![None];
    assert!(says(&silent), "nothing is said at all");
    silent.markers.status = vec![SampleStatus::SingleCamera];
    assert!(!says(&silent));
    silent.markers.points = vec![None];
    assert!(!says(&silent), "nothing is there");
}

/// A sheet of 40 markers over 20 frames in one camera: it slides by more than the gate from image to image, and stretches.
fn sheet() -> Vec<Tracks2dFrame> {
    let at = |frame: usize, marker: usize| {
        let (t, x, y) = (frame as f64, 30.0 * (marker % 8) as f64, 30.0 * (marker / 8) as f64);
        Point2::new(60.0 + x + 5.0 * t + 0.01 * t * y, 200.0 + y - 3.0 * t - 0.006 * t * x)
    };
    let samples = |frame: usize| (0..40).map(|marker| Some(Sample2d::seen(at(frame, marker)))).collect();
    (0..20).map(|frame| Tracks2dFrame { frame: frame as i64, cameras: vec![Some(samples(frame))] }).collect()
}

/// The sheet, with one marker on another's dot, 9 px off, in some frames, hidden in others; and where it is borne out. Returns the
/// frames in which it is still seen.
fn untied(
    wrong: std::ops::Range<usize>,
    hidden: impl Fn(usize) -> bool,
    is_borne_out: impl Fn(usize) -> bool,
    labelled: usize,
) -> Vec<usize> {
    let mut frames = sheet();
    for (index, frame) in frames.iter_mut().enumerate() {
        let sample = frame.cameras[0].as_mut().unwrap()[MARKER].as_mut().unwrap();
        if wrong.contains(&index) {
            sample.at += Vector2::new(9.0, -2.0);
        }
        if hidden(index) {
            sample.state = TrackState::Predicted;
        }
    }
    let others = |index: usize| vec![(0..40).map(|marker| marker != MARKER || is_borne_out(index)).collect()];
    let borne_out: Vec<Vec<Vec<bool>>> = (0..20).map(others).collect();
    let before = frames.clone();
    let dropped = drop_untied(&mut frames, &borne_out, labelled, 2.0);
    let is_seen = |frame: &Tracks2dFrame, marker: usize| {
        frame.cameras[0].as_ref().unwrap()[marker].unwrap().state == TrackState::Seen
    };
    let count = |frames: &[Tracks2dFrame]| frames.iter().filter(|frame| is_seen(frame, MARKER)).count();
    assert_eq!(dropped, count(&before) - count(&frames));
    assert!(frames.iter().all(|frame| (0..40).all(|marker| marker == MARKER || is_seen(frame, marker))));
    (0..20).filter(|&index| is_seen(&frames[index], MARKER)).collect()
}

#[test]
fn a_sample_that_only_its_own_camera_bears_out_is_taken_back_where_it_jumped() {
    let never = |_: usize| false;
    // Borne out before and after; between it jumps away and back.
    let sure = |index: usize| index == 3 || index == 15;
    let expected: Vec<usize> = (0..20).filter(|index| !(8..11).contains(index)).collect();
    assert_eq!(untied(8..11, never, sure, 99), expected);
    // Where other cameras bear the far place out, it is the marker's.
    assert_eq!(untied(8..11, never, |index| sure(index) || index == 9, 99).len(), 20);
    // The labelled image was seen by a person.
    assert_eq!(untied(8..11, never, |index| index == 15, 9), (8..20).collect::<Vec<_>>());
}

#[test]
fn what_shows_for_long_bears_itself_out_and_what_shows_shortly_does_not() {
    let never = |_: usize| false;
    assert_eq!(untied(0..0, never, never, 99).len(), 20);
    let shows = |frames: std::ops::Range<usize>| move |index: usize| !frames.contains(&index);
    assert_eq!(untied(0..0, shows(4..14), never, 99), (4..14).collect::<Vec<_>>());
    assert!(untied(0..0, shows(4..13), never, 99).is_empty());
    assert_eq!(untied(0..0, shows(4..13), |index| index == 12, 99), (4..13).collect::<Vec<_>>());
}
