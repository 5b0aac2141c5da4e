//! Laws that the stage keeps, on scenes of which all is known.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

mod scene;

use artifact::{CurveState, LearntPaint, PaintModel};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use scene::{Look, SIZE, Stroke, mask, picture, strokes};
use wrinkle_track::{
    Classifier, Error, FLOOR, Follower, MarkedPaint, MarkedWrinkle, NamedPlace, Picture, Place, Region,
    Sample, Svm, SvmParams, TrackParams, TrainParams, View, choose, labels, learn, marked_paints,
    marked_wrinkles, ratios, valley,
};

fn learnt(picture: &Picture, marked: &artifact::picture::Marked) -> (PaintModel, Vec<MarkedPaint>) {
    let paints = marked_paints(std::slice::from_ref(marked), &[]).unwrap();
    let labels = labels(marked, &paints);
    let views = [View { picture, labels: &labels }];
    let learn_one = |(index, paint): (usize, &MarkedPaint)| {
        let chosen = choose(&views, index as u8 + 1, FLOOR, 1500).unwrap();
        let found = learn(&paint.name, &chosen, &TrainParams::default()).unwrap();
        let support = found.machine.support().to_vec();
        let (id, mark, bias) = (paint.name.clone(), paint.mark, found.machine.bias());
        LearntPaint { id, mark, gamma: found.gamma, c: found.c, score: found.score, bias, support }
    };
    let learnt = paints.iter().enumerate().map(learn_one).collect();
    (PaintModel { take: None, floor: FLOOR, paints: learnt }, paints)
}

fn wrinkles_of(strokes: &[Stroke], paints: &[MarkedPaint], names: &[NamedPlace]) -> Vec<MarkedWrinkle> {
    let names_of_paints: Vec<String> = paints.iter().map(|paint| paint.name.clone()).collect();
    let labels = labels(&mask(strokes), paints);
    marked_wrinkles(SIZE, &labels, &names_of_paints, names, "", &TrackParams::default()).wrinkles
}

/// A follower of the strokes as they are marked, with their ids.
struct Stage {
    classifier: Classifier,
    follower: Follower,
    ids: Vec<String>,
}

impl Stage {
    fn new(start: &[Stroke], names: &[NamedPlace]) -> Self {
        let (model, paints) = learnt(&picture(&strokes(), Look::default()), &mask(&strokes()));
        let wrinkles = wrinkles_of(start, &paints, names);
        let ids: Vec<String> = wrinkles.iter().map(|wrinkle| wrinkle.id.clone()).collect();
        let follower = Follower::new(&ids, &wrinkles, TrackParams::default());
        Self { classifier: Classifier::new(&model).unwrap(), follower, ids }
    }

    fn step(&mut self, strokes: &[Stroke], look: Look) -> Vec<Option<artifact::Curve2d>> {
        let picture = picture(strokes, look);
        let classified = self.classifier.classify(&picture);
        self.follower.step(&picture, &classified, &[])
    }

    fn curve(&self, curves: &[Option<artifact::Curve2d>], id: &str) -> Option<artifact::Curve2d> {
        curves[self.ids.iter().position(|known| known == id).unwrap()].clone()
    }
}

/// Points of a curve by its definition.
fn points(curve: &artifact::Curve2d) -> Vec<Place> {
    let controls = &curve.controls;
    let at = |i: usize| {
        let u = (controls.len() - 3) as f64 * i as f64 / 40.0;
        let k = (u as usize).min(controls.len() - 4);
        let v = u - k as f64;
        let shares = [
            (1.0 - v).powi(3),
            3.0 * v.powi(3) - 6.0 * v * v + 4.0,
            -3.0 * v.powi(3) + 3.0 * v * v + 3.0 * v + 1.0,
            v.powi(3),
        ];
        (0..4).map(|j| Place::from(controls[k + j]) * shares[j] / 6.0).sum()
    };
    (0..=40).map(at).collect()
}

/// The largest distance from a stroke's line, but for the ends, which reach beyond it into the round ends of the paint.
fn farthest(points: &[Place], stroke: &Stroke) -> f64 {
    points[4..points.len() - 4].iter().map(|at| stroke.distance([at.x, at.y])).fold(0.0, f64::max)
}

/// The optimum by active sets: a system of linear equations for each set, and the conditions of optimality checked.
fn exact(samples: &[Sample], params: SvmParams) -> impl Fn([f64; 2]) -> f64 {
    let kernel = move |a: [f64; 2], b: [f64; 2]| {
        (-params.gamma * ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2))).exp()
    };
    let sign = |sample: &Sample| if sample.paint { 1.0 } else { -1.0 };
    let samples = samples.to_vec();
    let mut active: Vec<usize> = (0..samples.len()).collect();
    for _ in 0..1000 {
        let n = active.len();
        let system = DMatrix::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
            (true, true) => {
                let same = if i == j { 1.0 / params.c } else { 0.0 };
                kernel(samples[active[i]].ratios, samples[active[j]].ratios) + same
            }
            (false, false) => 0.0,
            _ => 1.0,
        });
        let right = DVector::from_fn(n + 1, |i, _| if i < n { sign(&samples[active[i]]) } else { 0.0 });
        let solved = system.lu().solve(&right).unwrap();
        let worst = (0..n)
            .map(|i| (i, solved[i] * sign(&samples[active[i]])))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap();
        if worst.1 < 0.0 {
            active.remove(worst.0);
            continue;
        }
        let support: Vec<([f64; 2], f64)> =
            active.iter().enumerate().map(|(i, s)| (samples[*s].ratios, solved[i])).collect();
        let decide = move |at: [f64; 2]| {
            support.iter().map(|(place, share)| share * kernel(at, *place)).sum::<f64>() + solved[n]
        };
        let margin = |index: &usize| sign(&samples[*index]) * decide(samples[*index].ratios);
        let left: Vec<usize> = (0..samples.len()).filter(|i| !active.contains(i)).collect();
        match left.into_iter().min_by(|a, b| margin(a).total_cmp(&margin(b))) {
            Some(index) if margin(&index) < 1.0 - 1e-10 => active.push(index),
            _ => return decide,
        }
    }
    panic!("the active sets do not settle");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn machines_are_the_exact_optimum(
        places in prop::collection::vec(([-3.0..3.0, -3.0..3.0], any::<bool>()), 12..60),
        c in prop::sample::select(vec![0.5, 10.0, 1000.0]),
        gamma in prop::sample::select(vec![0.25, 1.0, 4.0]),
    ) {
        let mut samples: Vec<Sample> = places.iter().map(|(ratios, paint)| Sample { ratios: *ratios, paint: *paint }).collect();
        (samples[0].paint, samples[1].paint) = (true, false);
        let params = SvmParams { c, gamma, tolerance: 1e-9 };
        let (machine, exact) = (Svm::train(&samples, params).unwrap(), exact(&samples, params));
        for i in 0..400 {
            let at = [(i % 20) as f64 / 3.0 - 3.5, (i / 20) as f64 / 3.0 - 3.5];
            prop_assert!((machine.decide(at) - exact(at)).abs() <= 1e-6, "{at:?}: {} {}", machine.decide(at), exact(at));
        }
    }
}

proptest! {
    #[test]
    fn no_decision_leaves_its_bounds(
        support in prop::collection::vec(([-3.0..3.0, -3.0..3.0], -50.0..50.0), 1..30),
        center in [-4.0..4.0, -4.0..4.0],
        radius in 0.0..1.0,
        turn in 0.0..std::f64::consts::TAU,
        share in 0.0..1.0,
    ) {
        let support = support.iter().map(|(ratios, coefficient)| artifact::SupportPixel { ratios: *ratios, coefficient: *coefficient });
        let machine = Svm::new(1.5, -0.25, support.collect());
        let [low, high] = machine.bounds(center, radius);
        let at = [center[0] + share * radius * turn.cos(), center[1] + share * radius * turn.sin()];
        prop_assert!((low - 1e-9..=high + 1e-9).contains(&machine.decide(at)));
    }
}

#[test]
fn tables_say_what_the_decisions_say() {
    let (model, _) = learnt(&picture(&strokes(), Look::default()), &mask(&strokes()));
    let mut classifier = Classifier::new(&model).unwrap();
    // All colours of a coarse grid, and those of a noisy image, twice: the second time they are looked up.
    let grid: Vec<u8> = (0..32 * 32 * 32u32)
        .flat_map(|i| [i % 32, i / 32 % 32, i / 1024].map(|c| (c * 8 + 3) as u8))
        .collect();
    let grid =
        artifact::picture::Rgb { width: 256, height: 128, codes: artifact::picture::Codes::Bits8(grid) };
    let grid = Picture::new(&grid, artifact::Transfer::Srgb, FLOOR).unwrap();
    let noisy = picture(&strokes(), Look { noise: 12.0, light: 0.6, ..Look::default() });
    let mut seen = [0usize; 3];
    for picture in [&grid, &noisy, &grid, &noisy] {
        let found = classifier.classify(picture);
        let logs = picture.logs(FLOOR);
        for (levels, paint) in picture.levels.iter().zip(&found.paints) {
            assert_eq!(*paint, classifier.paint_at(ratios(&logs, *levels)), "{levels:?}");
            seen[usize::from(*paint)] += 1;
        }
    }
    assert!(seen.iter().all(|count| *count > 500), "{seen:?}");
}

#[test]
fn darker_light_changes_no_paint() {
    let (model, paints) = learnt(&picture(&strokes(), Look::default()), &mask(&strokes()));
    let truth = labels(&mask(&strokes()), &paints);
    for light in [1.0, 0.5, 0.25] {
        let dark = picture(&strokes(), Look { light, noise: 1.0, seed: 5, ..Look::default() });
        let found = Classifier::new(&model).unwrap().classify(&dark);
        let wrong = found.paints.iter().zip(&truth).filter(|(a, b)| a != b).count();
        let painted = truth.iter().filter(|label| **label > 0).count();
        assert!(wrong as f64 <= 0.03 * painted as f64, "{light}: {wrong} of {painted}");
    }
}

#[test]
fn paint_of_the_colour_of_skin_is_refused_with_its_score() {
    // Something is marked where nothing is painted.
    let bare = picture(&[], Look::default());
    let marked = mask(&strokes()[..1]);
    let paints = marked_paints(std::slice::from_ref(&marked), &[]).unwrap();
    let labels = labels(&marked, &paints);
    let chosen = choose(&[View { picture: &bare, labels: &labels }], 1, FLOOR, 1500).unwrap();
    match learn("green", &chosen, &TrainParams::default()) {
        Err(Error::Indistinct { score, .. }) => assert!((0.3..0.7).contains(&score), "{score}"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn curves_follow_the_valley_rather_than_the_paint() {
    let mut stroke = Stroke::new(&[[30.0, 60.0], [200.0, 60.0]], 0);
    (stroke.half, stroke.dark, stroke.off) = (8.0, 0.5, 3.0);
    let region = Region::new(
        (0..SIZE[0] * SIZE[1])
            .map(|i| [i % SIZE[0], i / SIZE[0]])
            .filter(|[x, y]| stroke.distance([*x as f64, *y as f64]) < stroke.half)
            .collect(),
    );
    let picture = picture(&[stroke], Look { noise: 0.0, ..Look::default() });
    let gray: Vec<f64> = region.pixels.iter().map(|[x, y]| picture.luminance(y * SIZE[0] + x)).collect();
    let middle = |gray: &[f64]| {
        let found = valley(&region, gray, None, &TrackParams::default()).unwrap();
        found.controls.iter().map(|control| control.y).sum::<f64>() / found.controls.len() as f64
    };
    let (flat, dark) = (middle(&vec![1.0; gray.len()]), middle(&gray));
    assert!((flat - 60.0).abs() < 0.1, "without light the middle of the paint: {flat}");
    assert!(dark > 60.4 && dark < 63.2, "the valley lies at 63: {dark}");
}

#[test]
fn curves_move_with_their_pixels_and_keep_their_direction() {
    let pixels: Vec<[usize; 2]> = (20..90).flat_map(|x| (0..9).map(move |y| [x, 30 + y + x / 8])).collect();
    let gray: Vec<f64> =
        pixels.iter().map(|[x, y]| 0.5 + 0.3 * ((x * 7 + y * 13) % 10) as f64 / 10.0).collect();
    let params = TrackParams::default();
    let first = valley(&Region::new(pixels.clone()), &gray, None, &params).unwrap();
    let moved: Vec<[usize; 2]> = pixels.iter().map(|[x, y]| [x + 11, y + 5]).collect();
    let second = valley(&Region::new(moved), &gray, Some(&first.controls), &params).unwrap();
    for (a, b) in first.controls.iter().zip(&second.controls) {
        assert!((b - a - Place::new(11.0, 5.0)).norm() < 1e-6, "{a} {b}");
    }
    // From the other end it is the same set of points.
    let turned: Vec<Place> = first.controls.iter().rev().copied().collect();
    let third = valley(&Region::new(pixels), &gray, Some(&turned), &params).unwrap();
    assert_eq!(third.controls, turned);
    let width = |valley: &wrinkle_track::Valley| (valley.paint[5].left_px, valley.paint[5].right_px);
    let last = third.paint.len() - 6;
    assert!((width(&first).0 - third.paint[last].right_px).abs() < 1e-6);
}

#[test]
fn a_wrinkle_that_bends_back_follows_its_skeleton() {
    let turn = |i: usize| std::f64::consts::PI * (0.5 + 1.2 * i as f64 / 60.0);
    let line: Vec<[f64; 2]> =
        (0..=60).map(|i| [110.0 + 50.0 * turn(i).cos(), 90.0 + 50.0 * turn(i).sin()]).collect();
    let stroke = Stroke::new(&line, 0);
    let pixels = (0..SIZE[0] * SIZE[1]).map(|i| [i % SIZE[0], i / SIZE[0]]);
    let region =
        Region::new(pixels.filter(|[x, y]| stroke.distance([*x as f64, *y as f64]) < stroke.half).collect());
    let found = valley(&region, &vec![1.0; region.area()], None, &TrackParams::default()).unwrap();
    assert!(found.is_bent && found.on_paint == 1.0);
    let curve = artifact::Curve2d {
        controls: found.controls.iter().map(|c| [c.x, c.y]).collect(),
        state: CurveState::Seen,
        confidence: 1.0,
        paint: Vec::new(),
    };
    assert!(farthest(&points(&curve), &stroke) < 2.0, "{}", farthest(&points(&curve), &stroke));
    // A gentle arc is none.
    let line: Vec<[f64; 2]> =
        (0..=20).map(|i| [40.0 + 8.0 * i as f64, 60.0 + 20.0 * (i as f64 / 10.0 - 1.0).powi(2)]).collect();
    let gentle = Stroke::new(&line, 0);
    let pixels = (0..SIZE[0] * SIZE[1]).map(|i| [i % SIZE[0], i / SIZE[0]]);
    let region =
        Region::new(pixels.filter(|[x, y]| gentle.distance([*x as f64, *y as f64]) < gentle.half).collect());
    assert!(!valley(&region, &vec![1.0; region.area()], None, &TrackParams::default()).unwrap().is_bent);
}

#[test]
fn a_still_face_gives_no_drift() {
    let mut stage = Stage::new(&strokes(), &[]);
    let first = stage.step(&strokes(), Look::default());
    for _ in 0..5 {
        let again = stage.step(&strokes(), Look::default());
        for (a, b) in first.iter().flatten().zip(again.iter().flatten()) {
            assert_eq!((&a.controls, &a.paint), (&b.controls, &b.paint));
        }
    }
}

#[test]
fn wrinkles_keep_their_ids_while_all_moves() {
    let mut stage = Stage::new(&strokes(), &[]);
    assert_eq!(stage.ids, ["green_1", "green_2", "violet_1"]);
    for step in 0..6 {
        // The forehead goes up faster than the rest, by 14 px an image.
        let now: Vec<Stroke> = strokes()
            .iter()
            .enumerate()
            .map(|(i, stroke)| {
                stroke.moved([5.0 * step as f64, if i == 2 { 4.0 } else { -2.0 } * step as f64])
            })
            .collect();
        let curves = stage.step(&now, Look { seed: step, ..Look::default() });
        for (id, stroke) in [("green_1", 0), ("violet_1", 1), ("green_2", 2)] {
            let curve = stage.curve(&curves, id).unwrap();
            assert!(farthest(&points(&curve), &now[stroke]) < 3.0 && curve.confidence > 0.8, "{step} {id}");
            let middle = &curve.paint[curve.paint.len() / 2];
            assert!((middle.left_px + middle.right_px - 12.0).abs() < 1.5, "{middle:?}");
        }
    }
    assert_eq!(stage.follower.strays(), 0);
}

#[test]
fn broken_and_merged_patches_keep_their_ids() {
    let mut stage = Stage::new(&strokes(), &[]);
    stage.step(&strokes(), Look::default());
    // A dot of the other paint lies across the first wrinkle.
    let mut broken = strokes();
    broken.push(Stroke::new(&[[110.0, 20.0], [110.0, 52.0]], 1));
    let curves = stage.step(&broken, Look::default());
    let curve = stage.curve(&curves, "green_1").unwrap();
    let points_now = points(&curve);
    assert!(points_now[0].x < 50.0 && points_now[40].x > 180.0, "both pieces");
    // The third one runs into the first, so that they share a patch, and comes off again.
    let near = |line: &[[f64; 2]]| vec![strokes()[0].clone(), Stroke::new(line, 0)];
    let apart = near(&[[60.0, 62.0], [110.0, 74.0], [170.0, 80.0]]);
    for line in [[[60.0, 88.0], [110.0, 108.0], [170.0, 118.0]], [[60.0, 70.0], [110.0, 90.0], [170.0, 98.0]]]
    {
        stage.step(&near(&line), Look::default());
    }
    stage.step(&apart, Look::default());
    let touching = near(&[[60.0, 48.0], [110.0, 62.0], [170.0, 66.0]]);
    for (step, now) in [&touching, &touching, &apart].into_iter().enumerate() {
        let curves = stage.step(now, Look::default());
        for (id, stroke) in [("green_1", 0), ("green_2", 1)] {
            let curve = stage.curve(&curves, id).unwrap();
            let off = farthest(&points(&curve), &now[stroke]);
            assert!(curve.state == CurveState::Seen && off < 6.0, "{step} {id}: {off} {:?}", curve.controls);
        }
    }
}

#[test]
fn a_hidden_wrinkle_is_held_then_gone_and_comes_back() {
    let mut stage = Stage::new(&strokes(), &[]);
    stage.step(&strokes(), Look::default());
    let hidden = &strokes()[..2];
    let states: Vec<Option<CurveState>> = (0..5)
        .map(|_| {
            let curves = stage.step(hidden, Look::default());
            stage.curve(&curves, "green_2").map(|curve| curve.state)
        })
        .collect();
    let held = Some(CurveState::Held);
    assert_eq!(states, [held, held, held, None, None]);
    let curves = stage.step(&strokes(), Look::default());
    let curve = stage.curve(&curves, "green_2").unwrap();
    assert!(curve.state == CurveState::Seen && farthest(&points(&curve), &strokes()[2]) < 3.0);
}

#[test]
fn a_wrinkle_that_leaves_the_image_is_gone() {
    let mut stage = Stage::new(&strokes(), &[]);
    for step in 0..16 {
        let now: Vec<Stroke> =
            strokes().iter().map(|stroke| stroke.moved([0.0, -6.0 * step as f64])).collect();
        let curves = stage.step(&now, Look { seed: step, ..Look::default() });
        let forehead = stage.curve(&curves, "green_1");
        match step {
            // All of it is in the image, then a part of it.
            0..=4 => assert_eq!(forehead.unwrap().state, CurveState::Seen, "{step}"),
            12.. => assert_eq!(forehead, None, "{step}"),
            _ => {}
        }
        assert_eq!(stage.curve(&curves, "green_2").unwrap().state, CurveState::Seen, "{step}");
    }
}

#[test]
fn names_lie_on_the_nearest_paint_and_pieces_join_them() {
    let (_, paints) = learnt(&picture(&strokes(), Look::default()), &mask(&strokes()));
    let mut all = strokes();
    // A gap of about 4 px in the first wrinkle.
    all[0] = Stroke::new(&[[40.0, 40.0], [100.0, 37.0]], 0);
    all.push(Stroke::new(&[[116.0, 37.0], [190.0, 44.0]], 0));
    let name = |wrinkle: &str, x, y| NamedPlace { wrinkle: wrinkle.into(), at: Place::new(x, y) };
    let names = [name("brow", 60.0, 39.0), name("cheek", 110.0, 130.0), name("lid", 110.0, 79.5)];
    let found = wrinkles_of(&all, &paints, &names);
    let ids: Vec<(&str, bool)> =
        found.iter().map(|wrinkle| (wrinkle.id.as_str(), wrinkle.region.area() > 1400)).collect();
    assert_eq!(ids, [("brow", true), ("cheek", true), ("lid", true)]);
    let nowhere = [name("brow", 10.0, 170.0)];
    let names_of_paints: Vec<String> = paints.iter().map(|paint| paint.name.clone()).collect();
    let lost = marked_wrinkles(
        SIZE,
        &labels(&mask(&all), &paints),
        &names_of_paints,
        &nowhere,
        "",
        &TrackParams::default(),
    );
    assert_eq!((lost.misplaced.len(), lost.unnamed.len(), lost.wrinkles.len()), (1, 4, 0));
}

#[test]
fn subsampled_colours_are_noticed() {
    let of = |look| {
        let picture = picture(&strokes(), look);
        artifact::picture::is_subsampled(picture.width, picture.levels.as_flattened())
    };
    assert_eq!(of(Look::default()), Some(false));
    assert_eq!(of(Look { subsampled: true, ..Look::default() }), Some(true));
    assert_eq!(of(Look { noise: 0.0, ..Look::default() }), None, "nothing to tell by");
}
