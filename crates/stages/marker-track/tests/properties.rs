//! Laws: known sub-pixel motion is recovered; a constant gain changes nothing; time runs both ways.

#![allow(clippy::unwrap_used, clippy::panic, clippy::disallowed_methods, reason = "tests may")]

mod scene;

use artifact::{Sample2d, TrackState, Tracks2dFrame, Transfer};
use marker_track::{Error, Hint, Params, Picture, Tracker, detect, drop_misfits, drop_passing, name_strays};
use nalgebra::Point2;
use scene::{Dot, Look, PAINT, SIZE, SKIN, draw, draw_on, grid, labels, names};

fn picture(rgb: &[u8]) -> Picture<'_> {
    Picture::new(SIZE[0], SIZE[1], rgb).unwrap()
}

fn start(dots: &[Dot], look: Look) -> Tracker {
    let image = draw(dots, look);
    Tracker::start(&picture(&image), Transfer::Srgb, &names(dots), &labels(dots), &Params::default()).unwrap()
}

fn off(sample: &Option<Sample2d>, dot: &Dot) -> f64 {
    let at = sample.as_ref().unwrap().at;
    (at.x - dot.at[0]).hypot(at.y - dot.at[1])
}

fn rms(samples: &[Option<Sample2d>], dots: &[Dot]) -> f64 {
    let squares: Vec<f64> = samples.iter().zip(dots).map(|(s, dot)| off(s, dot).powi(2)).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

fn moved(dots: &[Dot], by: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<Dot> {
    dots.iter().map(|dot| Dot { at: by(dot.at), ..*dot }).collect()
}

#[test]
fn known_motion_is_recovered_to_a_few_hundredths_of_a_pixel() {
    let dots = grid();
    let mut tracker = start(&dots, Look::default());
    assert!(rms(&tracker.samples(), &dots) < 0.05, "{}", rms(&tracker.samples(), &dots));
    for step in 1..8u64 {
        let s = step as f64;
        let now = moved(&dots, |[x, y]| [x + 1.37 * s - 0.01 * s * (y - 60.0), y + 0.71 * s]);
        let image = draw(&now, Look { seed: step, ..Look::default() });
        let samples = tracker.step(&picture(&image), 1.0, None).unwrap();
        assert!(rms(&samples, &now) < 0.05, "step {step}: {}", rms(&samples, &now));
        assert!(samples.iter().flatten().all(|s| s.state == TrackState::Seen && s.confidence > 0.8));
    }
}

#[test]
fn shading_does_not_shift_a_dot() {
    let dots = grid();
    let look = Look { gradient: 0.006, noise: 0.0, ..Look::default() };
    let error = rms(&start(&dots, look).samples(), &dots);
    assert!(error < 0.03, "{error}");
}

#[test]
fn what_a_dot_lies_on_does_not_shift_it() {
    // A stroke of another paint along the upper half of the first dots, and dark hair left of the others.
    let (violet, hair) = ([0.14, 0.035, 0.18], [0.01, 0.01, 0.011]);
    let ground = |x: usize, y: usize| match (x, y) {
        (_, 8..=22) => violet,
        (0..=20, 40..) => hair,
        _ => SKIN,
    };
    let dots = grid();
    let image = draw_on(&dots, Look::default(), ground);
    let tracker =
        Tracker::start(&picture(&image), Transfer::Srgb, &names(&dots), &labels(&dots), &Params::default())
            .unwrap();
    for (sample, dot) in tracker.samples().iter().zip(&dots) {
        assert!(off(sample, dot) < 0.12, "{dot:?} {}", off(sample, dot));
    }
}

#[test]
fn a_dot_between_strokes_of_two_other_paints_is_seen_whole() {
    // Skin, green and violet hold the dot's colour, at another light, between them.
    let (green, violet) = ([0.04, 0.26, 0.075], [0.22, 0.05, 0.28]);
    let dots = grid();
    for edge in [22, 24] {
        let ground = |_: usize, y: usize| match y {
            y if y < edge - 6 => violet,
            y if y >= edge && y < edge + 9 => green,
            _ => SKIN,
        };
        let image = draw_on(&dots, Look::default(), ground);
        let tracker = Tracker::start(
            &picture(&image),
            Transfer::Srgb,
            &names(&dots),
            &labels(&dots),
            &Params::default(),
        )
        .unwrap();
        for (sample, dot) in tracker.samples().iter().zip(&dots) {
            assert_eq!(sample.unwrap().state, TrackState::Seen, "{dot:?}, green from row {edge}");
            assert!(off(sample, dot) < 0.3, "{dot:?} {}", off(sample, dot));
        }
    }
}

#[test]
fn a_marker_that_jumps_and_comes_back_is_found_where_it_belongs() {
    let dots = grid();
    let mut tracker = start(&dots, Look::default());
    for step in 1..9u64 {
        let mut now = moved(&dots, |[x, y]| [x + 0.5 * step as f64, y]);
        if (3..5).contains(&step) {
            now[5].at[1] += 14.0;
        }
        let image = draw(&now, Look { seed: step, ..Look::default() });
        let samples = tracker.step(&picture(&image), 1.0, None).unwrap();
        if step > 5 {
            assert_eq!(samples[5].unwrap().state, TrackState::Seen, "step {step}");
            assert!(rms(&samples, &now) < 0.05, "step {step}: {}", rms(&samples, &now));
        }
    }
}

#[test]
fn a_dot_without_a_label_is_nobodys() {
    let dots = grid();
    let image = draw(&dots, Look::default());
    let mut few = labels(&dots);
    few.remove("d06");
    let mut tracker =
        Tracker::start(&picture(&image), Transfer::Srgb, &names(&dots), &few, &Params::default()).unwrap();
    assert_eq!(tracker.strays().len(), 1);
    for step in 1..6u64 {
        let mut shown = dots.clone();
        // The marker beside it hides, and another runs towards it.
        shown[2].at[1] += 4.0 * step as f64;
        shown.remove(5);
        let image = draw(&shown, Look { seed: step, ..Look::default() });
        let samples = tracker.step(&picture(&image), 1.0, None).unwrap();
        assert_eq!(samples[5].unwrap().state, TrackState::Predicted);
        let stray = tracker.strays();
        assert!(stray.len() == 1 && (stray[0][0] - dots[6].at[0]).hypot(stray[0][1] - dots[6].at[1]) < 0.1);
    }
}

/// A marker of a deep, moving cloud, as one of several cameras sees it in perspective.
fn in_cloud(camera: usize, frame: usize, marker: usize) -> [f64; 2] {
    let (t, m) = (frame as f64, marker as f64);
    let point = [60.0 * (1.7 * m).sin() + t, 60.0 * (2.9 * m).cos(), 40.0 * (0.9 * m + 0.1 * t).sin()];
    let (sin, cos) = (0.5 * (camera as f64 - 1.0)).sin_cos();
    let [x, z] = [cos * point[0] + sin * point[2], 720.0 - sin * point[0] + cos * point[2]];
    [320.0 + 1450.0 * x / z, 240.0 + 1450.0 * point[1] / z]
}

fn cloud(cameras: usize) -> Vec<Tracks2dFrame> {
    let sample = |at: [f64; 2]| Some(Sample2d::seen(Point2::from(at)));
    let frame = |frame: usize| Tracks2dFrame {
        frame: frame as i64,
        cameras: (0..cameras)
            .map(|camera| Some((0..40).map(|marker| sample(in_cloud(camera, frame, marker))).collect()))
            .collect(),
    };
    (0..20).map(frame).collect()
}

#[test]
fn a_dot_without_a_label_gets_its_name_from_two_other_cameras() {
    let mut frames = cloud(3);
    let mut strays = vec![vec![Vec::new(); 3]; 20];
    for (index, frame) in frames.iter_mut().enumerate() {
        frame.cameras[2].as_mut().unwrap()[7] = None;
        frame.cameras[2].as_mut().unwrap()[9] = None;
        // The one is a dot without a name; of the other nothing is seen, but something lies 8 px from it.
        let [x, y] = in_cloud(2, index, 9);
        strays[index][2] = vec![in_cloud(2, index, 7), [x + 8.0, y]];
        // A dot of another marker comes by.
        if (6..9).contains(&index) {
            strays[index][2][1] = [x + 0.3, y];
        }
    }
    assert_eq!(name_strays(&mut frames, &strays), 20);
    for (index, frame) in frames.iter().enumerate() {
        let samples = frame.cameras[2].as_ref().unwrap();
        assert_eq!(samples[7].unwrap().at, Point2::from(in_cloud(2, index, 7)));
        assert!(samples[9].is_none());
    }
}

#[test]
fn a_marker_that_no_other_cameras_agree_with_is_taken_back() {
    for (cameras, taken) in [(4, 3), (3, 0)] {
        let mut frames = cloud(cameras);
        let clean = frames.clone();
        for index in 5..8 {
            let [x, y] = in_cloud(2, index, 7);
            let wrong = Some(Sample2d::seen(Point2::new(x + 9.0, y - 2.0)));
            frames[index].cameras[2].as_mut().unwrap()[7] = wrong;
        }
        // Of three cameras, nobody knows which errs.
        assert_eq!(drop_misfits(&mut frames), taken, "{cameras} cameras");
        for (index, (frame, clean)) in frames.iter().zip(&clean).enumerate() {
            for (camera, marker) in (0..cameras).flat_map(|c| (0..40).map(move |m| (c, m))) {
                let sample = |frame: &Tracks2dFrame| frame.cameras[camera].as_ref().unwrap()[marker].unwrap();
                if (camera, marker, (5..8).contains(&index)) != (2, 7, true) {
                    assert_eq!(sample(frame), sample(clean));
                } else if taken > 0 {
                    assert_eq!(sample(frame).state, TrackState::Predicted);
                    assert!((sample(frame).at - sample(clean).at).norm() < 1.0);
                }
            }
        }
    }
}

#[test]
fn a_marker_that_shows_for_a_moment_was_another_one() {
    let mut frames = cloud(1);
    for (index, frame) in frames.iter_mut().enumerate().filter(|(index, _)| ![3, 4, 9].contains(index)) {
        let samples = frame.cameras[0].as_mut().unwrap();
        samples[7].as_mut().unwrap().state = TrackState::Predicted;
        if !(10..15).contains(&index) {
            samples[8].as_mut().unwrap().state = TrackState::Predicted;
        }
    }
    assert_eq!(drop_passing(&mut frames), 3 + 2);
    for (index, frame) in frames.iter().enumerate() {
        let samples = frame.cameras[0].as_ref().unwrap();
        assert_eq!(samples[7].unwrap().state, TrackState::Predicted);
        assert_eq!(samples[8].unwrap().state == TrackState::Seen, (9..15).contains(&index), "{index}");
        assert_eq!(samples[0].unwrap().state, TrackState::Seen);
    }
}

#[test]
fn a_constant_gain_changes_nothing() {
    let dots = grid();
    let samples = |gain| start(&dots, Look { gain, noise: 0.0, ..Look::default() }).samples();
    for (a, b) in samples(1.0).iter().zip(&samples(0.6)) {
        let (a, b) = (a.unwrap(), b.unwrap());
        // Only the rounding of the codes is another one.
        assert!((a.at - b.at).norm() < 0.03, "{a:?} {b:?}");
    }
}

#[test]
fn a_gain_that_drifts_leaves_the_tracks_alone() {
    let dots = grid();
    let mut tracker = start(&dots, Look::default());
    for step in 1..6u64 {
        let image = draw(&dots, Look { gain: 1.0 - 0.06 * step as f64, seed: step, ..Look::default() });
        let samples = tracker.step(&picture(&image), 1.0, None).unwrap();
        assert!(rms(&samples, &dots) < 0.05);
    }
}

#[test]
fn a_hidden_marker_goes_with_its_neighbours_and_comes_back() {
    let dots = grid();
    let mut tracker = start(&dots, Look::default());
    for step in 1..10u64 {
        let now = moved(&dots, |[x, y]| [x + 0.8 * step as f64, y]);
        let mut shown = now.clone();
        if (3..7).contains(&step) {
            shown.remove(5);
        }
        let image = draw(&shown, Look { seed: step, ..Look::default() });
        let samples = tracker.step(&picture(&image), 1.0, None).unwrap();
        let sample = samples[5].unwrap();
        match (3..7).contains(&step) {
            true => {
                assert_eq!(sample.state, TrackState::Predicted, "step {step}");
                assert!(off(&samples[5], &now[5]) < 0.5 && sample.confidence < 0.5);
            }
            false => {
                assert_eq!(sample.state, TrackState::Seen, "step {step}");
                assert!(off(&samples[5], &now[5]) < 0.15);
            }
        }
    }
}

#[test]
fn a_pale_patch_is_no_hidden_marker() {
    let dots = grid();
    let mut tracker = start(&dots, Look::default());
    let hidden = dots[5];
    let pale: [f64; 3] = std::array::from_fn(|c| 0.45 * SKIN[c] + 0.55 * PAINT[c]);
    let ground = |x: usize, y: usize| {
        let beside = (x as f64 - hidden.at[0] - 2.0).hypot(y as f64 - hidden.at[1]);
        if beside <= hidden.radius + 0.5 { pale } else { SKIN }
    };
    let shown: Vec<Dot> = dots.iter().enumerate().filter(|(i, _)| *i != 5).map(|(_, dot)| *dot).collect();
    for step in 1..4u64 {
        let look = Look { seed: step, ..Look::default() };
        let image = if step == 1 { draw(&shown, look) } else { draw_on(&shown, look, ground) };
        let samples = tracker.step(&picture(&image), 1.0, None).unwrap();
        assert_eq!(samples[5].unwrap().state, TrackState::Predicted, "step {step}");
    }
    let samples = tracker.step(&picture(&draw(&dots, Look::default())), 1.0, None).unwrap();
    assert_eq!(samples[5].unwrap().state, TrackState::Seen, "the dot itself comes back");
}

#[test]
fn two_dots_that_touch_and_part_keep_their_names() {
    let pair = |gap: f64| {
        let mut dots = grid();
        let middle = dots[5].at;
        dots[5] = Dot { at: [middle[0], middle[1] - gap / 2.0], radius: 2.4 };
        dots.push(Dot { at: [middle[0], middle[1] + gap / 2.0], radius: 3.0 });
        dots
    };
    let mut tracker = start(&pair(14.0), Look::default());
    let gaps = [12.0, 10.0, 8.0, 6.5, 5.6, 5.2, 5.6, 6.5, 8.0, 10.0, 12.0];
    for (step, gap) in gaps.into_iter().enumerate() {
        let dots = pair(gap);
        let image = draw(&dots, Look { seed: step as u64, ..Look::default() });
        let samples = tracker.step(&picture(&image), 1.0, None).unwrap();
        for marker in [5, 12] {
            assert_eq!(samples[marker].unwrap().state, TrackState::Seen, "gap {gap}");
            assert!(
                off(&samples[marker], &dots[marker]) < 0.5,
                "gap {gap}: {}",
                off(&samples[marker], &dots[marker])
            );
        }
    }
}

#[test]
fn the_guide_names_a_marker_that_was_never_labelled() {
    let dots = grid();
    let image = draw(&dots, Look::default());
    let mut known = labels(&dots);
    known.remove("d03");
    let mut tracker =
        Tracker::start(&picture(&image), Transfer::Srgb, &names(&dots), &known, &Params::default()).unwrap();
    assert!(tracker.samples()[3].is_none());
    assert!(tracker.step(&picture(&image), 1.0, None).unwrap()[3].is_none());
    let near = [dots[3].at[0] + 1.0, dots[3].at[1] - 0.5];
    for (facing, state) in [(false, TrackState::Predicted), (true, TrackState::Seen)] {
        let mut hints = vec![None; dots.len()];
        hints[3] = Some(Hint { at: near, facing });
        let samples = tracker.step(&picture(&image), 1.0, Some(&hints)).unwrap();
        assert_eq!(samples[3].unwrap().state, state);
    }
    assert!(off(&tracker.samples()[3], &dots[3]) < 0.1);
}

/// The grid, whose sixth marker hides and passes behind the seventh, guided.
fn passes_behind(frames: std::ops::Range<u64>, mut check: impl FnMut(u64, &[Option<Sample2d>])) {
    let dots = grid();
    let mut tracker = start(&dots, Look::default());
    for step in frames {
        let mut now = dots.clone();
        // By its guide it comes as near as 0.7 px, and is hidden but in the last image.
        let away = if step == 0 { 5.0 } else { 0.7 + 0.1 * step as f64 };
        now[5].at = if step < 8 { [now[6].at[0] - away, now[6].at[1]] } else { dots[5].at };
        let hints: Vec<Option<Hint>> = now
            .iter()
            .enumerate()
            .map(|(i, dot)| Some(Hint { at: dot.at, facing: i != 6 && i != 5 }))
            .collect();
        let mut shown = now.clone();
        if step < 8 {
            shown.remove(5);
        }
        // In the middle images the one in front is not found where its guide says.
        if (3..6).contains(&step) {
            shown[5].at[0] -= 1.0;
        }
        let image = draw(&shown, Look { seed: step, ..Look::default() });
        check(step, &tracker.step(&picture(&image), 1.0, Some(&hints)).unwrap());
    }
}

#[test]
fn a_hidden_marker_does_not_take_the_dot_of_the_one_in_front() {
    passes_behind(0..8, |step, samples| {
        assert_eq!(samples[5].unwrap().state, TrackState::Predicted, "step {step}");
        assert_eq!(samples[6].unwrap().state, TrackState::Seen, "step {step}");
    });
}

#[test]
fn a_labelled_marker_comes_back_though_the_guide_says_that_it_faces_away() {
    passes_behind(0..9, |step, samples| {
        let state = if step < 8 { TrackState::Predicted } else { TrackState::Seen };
        assert_eq!(samples[5].unwrap().state, state, "step {step}");
    });
}

#[test]
fn where_others_are_guided_a_marker_without_label_and_guide_is_not_looked_for() {
    let dots = grid();
    let image = draw(&dots, Look::default());
    let mut known = labels(&dots);
    known.remove("d05");
    let mut tracker =
        Tracker::start(&picture(&image), Transfer::Srgb, &names(&dots), &known, &Params::default()).unwrap();
    let mut hints: Vec<Option<Hint>> =
        dots.iter().map(|dot| Some(Hint { at: dot.at, facing: true })).collect();
    // The guide errs by more than its gate, and then knows nothing.
    hints[5] = Some(Hint { at: [dots[5].at[0] + 3.0, dots[5].at[1]], facing: true });
    for hint in [hints[5], None, None] {
        hints[5] = hint;
        let samples = tracker.step(&picture(&image), 1.0, Some(&hints)).unwrap();
        assert_eq!(samples[5].unwrap().state, TrackState::Predicted);
    }
}

#[test]
fn all_dots_are_detected() {
    let dots = grid();
    let image = draw(&dots, Look::default());
    let tracker = start(&dots, Look::default());
    let found = detect(&picture(&image), tracker.paint());
    assert_eq!(found.len(), dots.len());
    for dot in &dots {
        let nearest = found.iter().min_by(|a, b| {
            let far = |f: &marker_track::Found| (f.at[0] - dot.at[0]).hypot(f.at[1] - dot.at[1]);
            far(a).total_cmp(&far(b))
        });
        let area = std::f64::consts::PI * dot.radius * dot.radius;
        assert!((nearest.unwrap().area / area - 1.0).abs() < 0.1, "{} {area}", nearest.unwrap().area);
    }
}

#[test]
fn bad_labels_are_refused_by_name() {
    let dots = grid();
    let image = draw(&dots, Look::default());
    let attempt = |at: [f64; 2]| {
        let mut known = labels(&dots);
        known.insert("d07".into(), at);
        Tracker::start(&picture(&image), Transfer::Srgb, &names(&dots), &known, &Params::default())
    };
    let fault = |at: [f64; 2]| match attempt(at).unwrap().label_faults() {
        [fault] => fault.clone(),
        other => panic!("{other:?}"),
    };
    assert!(matches!(fault([500.0, 3.0]), Error::Outside { marker, .. } if marker == "d07"));
    match fault([dots[7].at[0] - 14.0, dots[7].at[1]]) {
        Error::NoBlob { marker, nearest: Some(nearest), .. } => {
            assert_eq!(marker, "d07");
            assert!((nearest[0] - dots[7].at[0]).abs() < 1.0, "{nearest:?}");
        }
        other => panic!("{other:?}"),
    }
    match fault([dots[6].at[0] + 1.5, dots[6].at[1]]) {
        Error::SameDot { marker, other, .. } => assert_eq!((marker.as_str(), other.as_str()), ("d07", "d06")),
        other => panic!("{other:?}"),
    }
    let blank = draw(&[], Look::default());
    let nothing =
        Tracker::start(&picture(&blank), Transfer::Srgb, &names(&dots), &labels(&dots), &Params::default());
    assert_eq!(nothing.err(), Some(Error::NoContrast));
    let small = vec![0; 3 * 20 * 20];
    let wrong = start(&dots, Look::default()).step(&Picture::new(20, 20, &small).unwrap(), 1.0, None);
    assert!(matches!(wrong, Err(Error::ImageSize { .. })));
    assert!(Picture::new(20, 21, &small).is_err());
}
