//! Laws: known sub-pixel motion is recovered; a constant gain changes nothing; time runs both ways.

#![allow(clippy::unwrap_used, clippy::panic, clippy::disallowed_methods, reason = "tests may")]

mod scene;

use artifact::{Sample2d, TrackState};
use marker_track::{Error, Hint, Params, Picture, Tracker, detect};
use scene::{Dot, Look, SIZE, draw, grid, labels, names};

fn picture(rgb: &[u8]) -> Picture<'_> {
    Picture::new(SIZE[0], SIZE[1], rgb).unwrap()
}

fn start(dots: &[Dot], look: Look) -> Tracker {
    let image = draw(dots, look);
    Tracker::start(&picture(&image), "srgb", &names(dots), &labels(dots), &Params::default()).unwrap()
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
        Tracker::start(&picture(&image), "srgb", &names(&dots), &known, &Params::default()).unwrap();
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
        Tracker::start(&picture(&image), "srgb", &names(&dots), &known, &Params::default())
    };
    assert!(matches!(attempt([500.0, 3.0]), Err(Error::Outside { marker, .. }) if marker == "d07"));
    match attempt([dots[7].at[0] - 14.0, dots[7].at[1]]) {
        Err(Error::NoBlob { marker, nearest: Some(nearest), .. }) => {
            assert_eq!(marker, "d07");
            assert!((nearest[0] - dots[7].at[0]).abs() < 1.0, "{nearest:?}");
        }
        other => panic!("{other:?}"),
    }
    let blank = draw(&[], Look::default());
    let nothing = Tracker::start(&picture(&blank), "srgb", &names(&dots), &labels(&dots), &Params::default());
    assert_eq!(nothing.err(), Some(Error::NoContrast));
    let small = vec![0; 3 * 20 * 20];
    let wrong = start(&dots, Look::default()).step(&Picture::new(20, 20, &small).unwrap(), 1.0, None);
    assert!(matches!(wrong, Err(Error::ImageSize { .. })));
    assert!(Picture::new(20, 21, &small).is_err());
}
