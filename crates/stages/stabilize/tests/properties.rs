//! Laws of the stage.
#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

mod scene;

use artifact::{SampleStatus, Trajectories};
use nalgebra::{Isometry3, Vector3};
use proptest::prelude::*;
use scene::{HEAD_COUNT, about_neck, hide, largest_difference, moved, named, nodding, rest, talking};
use stabilize::{Error, JumpLimit, Params, Stabilized, Swaps, stabilize};

/// Where a pose puts the face, against where it should, mm.
fn pose_error(stable: &Stabilized, truth: impl Fn(usize) -> Isometry3<f64>) -> Vec<f64> {
    let reference = stable.pose_header.reference_frame;
    let at = stable.poses.iter().position(|pose| pose.frame == reference).unwrap();
    let known = stable.poses.iter().enumerate().filter_map(|(f, pose)| Some((f, pose.world_from_head?)));
    known
        .map(|(f, found)| {
            let planted = truth(f) * truth(at).inverse();
            rest().iter().map(|p| (found * p - planted * p).norm()).fold(0.0, f64::max)
        })
        .collect()
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

fn motion() -> impl Strategy<Value = Vec<Isometry3<f64>>> {
    let pose = (prop::array::uniform3(-0.3..0.3f64), prop::array::uniform3(-40.0..40.0f64));
    prop::collection::vec(pose.prop_map(|(angles, shift)| about_neck(angles.into(), shift.into())), 60)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Any motion, even one that leaps from frame to frame, changes nothing in head space.
    #[test]
    fn head_space_does_not_see_rigid_motion(motion in motion(), seed in 0u64..1000) {
        let mut take = talking(60, 0.05, seed);
        hide(&mut take, 2, 20..24);
        hide(&mut take, 12, 30..36);
        (0..HEAD_COUNT).for_each(|m| hide(&mut take, m, 40..44));
        let still = stabilize(&take, &named()).unwrap();
        let shaken = stabilize(&moved(&take, |f| motion[f]), &named()).unwrap();
        prop_assert_eq!(still.pose_header.reference_frame, shaken.pose_header.reference_frame);
        let at = (still.pose_header.reference_frame - 1001) as usize;
        prop_assert!(largest_difference(&shaken.head, &still.head, &motion[at]) < 1e-7);
    }

    #[test]
    fn a_planted_motion_is_recovered(motion in motion()) {
        let take = moved(&talking(60, 0.0, 1), |f| motion[f]);
        let stable = stabilize(&take, &Params { smooth_ms: 0.0, ..named() }).unwrap();
        prop_assert!(pose_error(&stable, |f| motion[f]).into_iter().all(|error| error < 1e-6));
    }

    #[test]
    fn frame_numbers_may_start_anywhere(offset in -100_000i64..100_000) {
        let take = talking(40, 0.05, 3);
        let mut shifted = take.clone();
        shifted.frames.iter_mut().for_each(|frame| frame.frame += offset);
        let (here, there) = (stabilize(&take, &named()).unwrap(), stabilize(&shifted, &named()).unwrap());
        prop_assert_eq!(here.pose_header.reference_frame + offset, there.pose_header.reference_frame);
        prop_assert_eq!(largest_difference(&here.head, &there.head, &Isometry3::identity()), 0.0);
    }
}

#[test]
fn world_is_pose_times_head() {
    let take = moved(&talking(80, 0.05, 4), nodding);
    let stable = stabilize(&take, &Params { keep_head_markers: true, ..named() }).unwrap();
    for ((world, head), pose) in take.frames.iter().zip(&stable.head.frames).zip(&stable.poses) {
        for (world, head) in world.points.iter().zip(&head.points) {
            assert!((pose.world_from_head.unwrap() * head.unwrap() - world.unwrap()).norm() < 1e-9);
        }
    }
    let reference =
        stable.poses.iter().find(|pose| pose.frame == stable.pose_header.reference_frame).unwrap();
    assert_eq!(reference.world_from_head, Some(Isometry3::identity()));
}

/// Error of the face's places through the poses, one constant rigid motion apart (head space is only known up to the
/// noise of its reference frame), rms mm.
fn steadiness_error(stable: &Stabilized, truth: impl Fn(usize) -> Isometry3<f64>) -> f64 {
    let poses =
        stable.poses.iter().enumerate().map(|(f, pose)| pose.world_from_head.unwrap().inverse() * truth(f));
    let head_from_still: Vec<_> = poses.collect();
    let (found, still): (Vec<_>, Vec<_>) =
        head_from_still.iter().flat_map(|pose| rest().into_iter().map(move |p| (pose * p, p))).unzip();
    let constant = camera::fit_rigid(&found, &still, None).unwrap();
    rms(&found.iter().zip(&still).map(|(found, still)| (constant * found - still).norm()).collect::<Vec<_>>())
}

#[test]
fn jitter_leaves_the_pose_but_the_head_keeps_its_nods() {
    for seed in 1..4 {
        let take = moved(&talking(300, 0.05, seed), nodding);
        let error = |smooth_ms| {
            steadiness_error(&stabilize(&take, &Params { smooth_ms, ..named() }).unwrap(), nodding)
        };
        let (fitted, steady) = (error(0.0), error(60.0));
        assert!(steady < 0.6 * fitted, "seed {seed}: {steady} of {fitted} mm");
    }
}

#[test]
fn a_still_head_has_still_poses() {
    let stable = stabilize(&talking(200, 0.05, 5), &named()).unwrap();
    let worst = pose_error(&stable, |_| Isometry3::identity()).into_iter().fold(0.0, f64::max);
    assert!(worst < 0.25, "{worst} mm of 0.05 mm noise");
}

#[test]
fn missing_frames_and_samples_stay_missing() {
    let mut take = talking(120, 0.05, 6);
    hide(&mut take, 10, 40..70);
    hide(&mut take, 11, 0..3);
    take.frames.drain(80..90);
    let stable = stabilize(&take, &named()).unwrap();
    let numbers = |t: &Trajectories| t.frames.iter().map(|frame| frame.frame).collect::<Vec<_>>();
    assert_eq!(numbers(&stable.head), numbers(&take));
    let hidden: Vec<usize> =
        (0..110).filter(|&f| stable.head.frames[f].points[10 - HEAD_COUNT].is_none()).collect();
    assert_eq!(hidden, (40..70).collect::<Vec<_>>());
    assert!(
        (0..3).all(|f| stable.head.frames[f].points[11 - HEAD_COUNT].is_none()),
        "nothing is extrapolated"
    );
}

#[test]
fn short_gaps_are_filled_from_the_neighbours() {
    let mut truth = talking(100, 0.0, 7);
    let marker = HEAD_COUNT + 22;
    // It also wanders by itself, which no neighbour knows: the filled path must meet both its ends.
    for (f, frame) in truth.frames.iter_mut().enumerate() {
        frame.points[marker].as_mut().unwrap().x += 0.1 * f as f64;
    }
    let mut take = truth.clone();
    hide(&mut take, marker, 50..58);
    let stable = stabilize(&take, &named()).unwrap();
    assert_eq!(stable.report.filled_samples, 8);
    for f in 50..58 {
        let frame = &stable.head.frames[f];
        let off = (frame.points[22].unwrap() - truth.frames[f].points[marker].unwrap()).norm();
        assert!(off < 0.15, "{off} mm at {f}");
        assert_eq!(frame.status[22], SampleStatus::NeighborFilled);
    }
    let unfilled = stabilize(&take, &Params { fill_ms: 0.0, ..named() }).unwrap();
    assert_eq!(unfilled.report.gaps["face-22"].left, 8);
}

#[test]
fn a_marker_without_neighbours_is_interpolated() {
    let mut take = talking(60, 0.0, 8);
    for (m, f) in (HEAD_COUNT..36).flat_map(|m| (28..34).map(move |f| (m, f))) {
        take.frames[f].points[m] = None;
    }
    (0..3).for_each(|m| hide(&mut take, m, 28..34));
    let stable = stabilize(&take, &named()).unwrap();
    assert_eq!(stable.head.frames[30].status[0], SampleStatus::Interpolated);
}

#[test]
fn short_pose_gaps_are_bridged_and_long_ones_are_not() {
    let mut take = moved(&talking(200, 0.0, 9), nodding);
    (0..4).for_each(|m| hide(&mut take, m, 50..58));
    (0..4).for_each(|m| hide(&mut take, m, 100..120));
    let stable = stabilize(&take, &named()).unwrap();
    for (f, pose) in stable.poses.iter().enumerate() {
        let expected = match f {
            50..58 => (true, 0),
            100..120 => (false, 0),
            _ => (true, 6),
        };
        assert_eq!((pose.world_from_head.is_some(), pose.markers_used), expected, "frame {f}");
        assert_eq!(pose.residual_mm.is_some(), expected.1 > 0);
    }
    assert!(stable.head.frames[110].points.iter().all(Option::is_none));
    assert_eq!((stable.report.pose_gap_frames, stable.report.pose_bridged_frames), (20, 8));
    let worst = pose_error(&stable, nodding).into_iter().fold(0.0, f64::max);
    assert!(worst < 1.0, "{worst} mm, though the head nods by 15°: the face carries the pose");
}

#[test]
fn a_slipped_head_marker_is_left_out_and_named() {
    let mut take = moved(&talking(150, 0.05, 10), nodding);
    for frame in &mut take.frames[60..90] {
        frame.points[3].as_mut().unwrap().y += 25.0;
    }
    let stable = stabilize(&take, &named()).unwrap();
    assert_eq!(stable.report.head_marker_rejected.get("head-3"), Some(&30));
    assert_eq!(stable.report.head_marker_rejected.len(), 1);
    assert!(stable.poses[60..90].iter().all(|pose| pose.markers_used == 5));
    let worst = pose_error(&stable, nodding).into_iter().fold(0.0, f64::max);
    assert!(worst < 0.4, "{worst} mm");
}

/// Skin slips: every head marker wanders by half a millimetre. When one is hidden for a moment, the pose must not step
/// by what it had to say.
#[test]
fn a_hidden_head_marker_makes_no_step() {
    let mut take = talking(150, 0.0, 11);
    for (f, frame) in take.frames.iter_mut().enumerate() {
        for (m, point) in frame.points.iter_mut().take(HEAD_COUNT).enumerate() {
            let phase = 0.02 * f as f64 + 2.0 * m as f64;
            *point.as_mut().unwrap() += 0.5 * Vector3::new(phase.sin(), (1.3 * phase).cos(), phase.cos());
        }
    }
    let params = Params { smooth_ms: 0.0, reference_frame: Some(1001), ..named() };
    let whole = stabilize(&take, &params).unwrap();
    hide(&mut take, 0, 30..40);
    let hidden = stabilize(&take, &params).unwrap();
    let relative: Vec<_> = whole
        .poses
        .iter()
        .zip(&hidden.poses)
        .map(|(a, b)| a.world_from_head.unwrap().inverse() * b.world_from_head.unwrap())
        .collect();
    for f in 20..50 {
        let (a, b) = (relative[f], relative[f + 1]);
        let step = rest().iter().map(|p| (a * p - b * p).norm()).fold(0.0, f64::max);
        assert!(step < 0.03, "{step} mm at {f}");
    }
}

#[test]
fn a_jump_is_named_and_taken_out() {
    let mut take = moved(&talking(150, 0.05, 12), nodding);
    let marker = HEAD_COUNT + 8;
    for frame in &mut take.frames[70..95] {
        *frame.points[marker].as_mut().unwrap() += Vector3::new(15.0, -12.0, 8.0);
    }
    let stable = stabilize(&take, &named()).unwrap();
    let [jump] = &stable.report.jumps[..] else { panic!("{:?}", stable.report.jumps) };
    assert_eq!((jump.marker.as_str(), jump.frames, jump.removed), ("face-8", [1071, 1095], true));
    assert!((jump.step_mm - 20.8).abs() < 0.5, "{}", jump.step_mm);
    assert!((70..95).all(|f| stable.head.frames[f].points[8].is_none()));
    let off = stabilize(&take, &Params { jump: JumpLimit::Off, ..named() }).unwrap();
    assert!(off.report.jumps.is_empty() && off.head.frames[80].points[8].is_some());
}

/// Labels exchanged for a while: mended to the truth, or taken out if only reported.
#[test]
fn a_swap_is_mended() {
    let truth = talking(150, 0.02, 13);
    let mut take = truth.clone();
    let (a, b) = (HEAD_COUNT + 6, HEAD_COUNT + 18);
    take.frames[60..100].iter_mut().for_each(|frame| frame.points.swap(a, b));
    let take = moved(&take, nodding);
    let smooth_ms = 0.0;
    let mended = stabilize(&take, &Params { smooth_ms, ..named() }).unwrap();
    assert_eq!(mended.report.mended_samples, 80);
    let clean = stabilize(&moved(&truth, nodding), &Params { smooth_ms, ..named() }).unwrap();
    assert!(largest_difference(&mended.head, &clean.head, &Isometry3::identity()) < 1e-9);
    let reported = stabilize(&take, &Params { swaps: Swaps::Report, ..named() }).unwrap();
    assert_eq!((reported.report.mended_samples, reported.report.removed_samples), (0, 80));
    let jump = &reported.report.jumps[0];
    assert_eq!((jump.marker.as_str(), jump.at_place_of[0].marker.as_str()), ("face-6", "face-18"));
    assert_eq!(
        (jump.frames, jump.at_place_of[0].frames, jump.at_place_of[0].mended),
        ([1061, 1100], [1061, 1100], false)
    );
}

/// Labels exchanged to the end of the take: the side that holds the reference frame is right.
#[test]
fn the_reference_frame_decides_which_side_of_an_exchange_is_right() {
    let truth = talking(150, 0.02, 13);
    let (a, b) = (HEAD_COUNT + 6, HEAD_COUNT + 18);
    let clean = stabilize(&moved(&truth, nodding), &Params { smooth_ms: 0.0, ..named() }).unwrap();
    for from in [60, 66, 100] {
        let mut take = truth.clone();
        take.frames[from..].iter_mut().for_each(|frame| frame.points.swap(a, b));
        let mended = stabilize(&moved(&take, nodding), &Params { smooth_ms: 0.0, ..named() }).unwrap();
        assert_eq!((mended.report.reference_frame, mended.report.mended_samples), (1001, 2 * (150 - from)));
        assert!(largest_difference(&mended.head, &clean.head, &Isometry3::identity()) < 1e-9, "{from}");
        let frames = [1001 + from as i64, 1150];
        assert!(mended.report.jumps.iter().all(|jump| jump.frames == frames), "{from}");
    }
}

#[test]
fn fast_speech_is_no_jump() {
    for rate in [24, 30, 60, 120] {
        let mut take = talking(300, 0.05, 14);
        take.header.rate = Some(artifact::Rate::per_second(rate));
        take.frames = take.frames.into_iter().step_by((100 / rate).max(1) as usize).collect();
        take.frames.iter_mut().zip(1..).for_each(|(frame, number)| frame.frame = number);
        assert_eq!(stabilize(&take, &named()).unwrap().report.jumps, []);
    }
}

#[test]
fn the_head_is_found_without_names() {
    let take = moved(&talking(200, 0.05, 15), nodding);
    let stable = stabilize(&take, &Params::default()).unwrap();
    assert!(stable.report.head_markers_chosen && stable.report.head_markers.len() >= 10);
    // Nothing above y = −5 mm moves in this face: that is the head, face-0 to face-9, and the head markers.
    for id in &stable.report.head_markers {
        let place = rest()[take.marker(id).unwrap()];
        assert!(place.y > -15.0, "{id} moves");
    }
    let worst = pose_error(&stable, nodding).into_iter().fold(0.0, f64::max);
    assert!(worst < 0.3, "{worst} mm");
    assert_eq!(stable.head.header.markers, take.header.markers, "found markers are face markers: they stay");
}

#[test]
fn a_marker_that_is_never_seen_is_reported() {
    let mut take = talking(40, 0.05, 16);
    hide(&mut take, HEAD_COUNT + 3, 0..40);
    hide(&mut take, 1, 0..40);
    let stable = stabilize(&take, &named()).unwrap();
    assert_eq!(stable.report.never_seen, ["head-1", "face-3"]);
    assert!(stable.report.warnings().iter().any(|warning| warning.contains("face-3")));
    assert!(stable.report.head_marker_rejected.is_empty());
}

#[test]
fn what_cannot_be_done_is_refused() {
    let take = talking(40, 0.0, 17);
    let refused = |take: &Trajectories, params: Params| stabilize(take, &params).unwrap_err();
    let head = |ids: &[&str]| Params {
        head_markers: ids.iter().map(|id| (*id).to_string()).collect(),
        ..Default::default()
    };

    assert_eq!(
        refused(&take, head(&["head-0", "haed-1"])),
        Error::UnknownMarker { wanted: "haed-1".into(), close: vec!["head-1".into()] }
    );
    assert_eq!(
        refused(&take, head(&["head-0", "head-1"])),
        Error::TooFewHeadMarkers(vec!["head-0".into(), "head-1".into()])
    );
    let mut line = take.clone();
    line.frames.iter_mut().for_each(|frame| {
        frame.points[2] = frame.points[0].zip(frame.points[1]).map(|(a, b)| nalgebra::center(&a, &b))
    });
    assert!(
        matches!(refused(&line, head(&["head-0", "head-1", "head-2"])), Error::Collinear(ids) if ids.len() == 3)
    );

    let mut unseen = take.clone();
    (0..4).for_each(|m| hide(&mut unseen, m, 7..8));
    let at = |frame| Params { reference_frame: Some(frame), ..named() };
    assert_eq!(refused(&unseen, at(1008)), Error::ReferenceUnseen { frame: 1008, seen: 2, of: 6 });
    assert_eq!(refused(&take, at(7)), Error::NoReferenceFrame { frame: 7, first: 1001, last: 1040 });

    (0..4).for_each(|m| hide(&mut unseen, m, 0..40));
    assert!(matches!(refused(&unseen, named()), Error::NeverSeen(_)));
    let mut timeless = take.clone();
    timeless.header.rate = None;
    assert_eq!(refused(&timeless, named()), Error::NoRate);
    let timeless_params = Params { smooth_ms: 0.0, fill_ms: 0.0, jump: JumpLimit::Mm(10.0), ..named() };
    assert!(stabilize(&timeless, &timeless_params).is_ok());
    assert_eq!(refused(&Trajectories { frames: vec![], ..take.clone() }, named()), Error::NoFrames);
    assert!(matches!(
        refused(&take, Params { fill_ms: f64::NAN, ..named() }),
        Error::Parameter { name: "fill-ms", .. }
    ));
}

#[test]
fn the_same_take_gives_the_same_numbers() {
    let take = moved(&talking(80, 0.05, 18), nodding);
    let (one, two) =
        (stabilize(&take, &Params::default()).unwrap(), stabilize(&take, &Params::default()).unwrap());
    assert_eq!(one.head, two.head);
    assert_eq!(one.poses, two.poses);
}
