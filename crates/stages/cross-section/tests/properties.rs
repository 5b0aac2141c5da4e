//! Laws that the stage keeps, on grooves drawn by brute force.

#![allow(clippy::unwrap_used, reason = "tests may")]

mod scene;

use artifact::{Section, SectionState, Transfer};
use cross_section::{Ground, Model, Painted, Params, Picture, measure, painted};
use scene::{SIZE, Scene};

fn sections(scene: &Scene, params: &Params) -> Vec<Section> {
    let rgb = scene.picture(7);
    let picture = Picture::new(SIZE[0], SIZE[1], &rgb).unwrap();
    let paint = painted(&picture, &Transfer::Srgb.light_of_codes(), &scene.curve(), params).unwrap();
    measure(&paint, params, 0.0).sections
}

/// Sections well inside the paint.
fn inner(scene: &Scene, params: &Params) -> Vec<Section> {
    let all = sections(scene, params);
    let measured = all.into_iter().filter(|section| (30.0..130.0).contains(&section.at[0]));
    measured.collect()
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn ratio_and_width(sections: &[Section]) -> [f64; 2] {
    assert!(sections.iter().all(|section| section.state == SectionState::Measured));
    [median(sections.iter().map(|s| s.d_px / s.w_px)), median(sections.iter().map(|s| s.w_px))]
}

fn assert_near(found: [f64; 2], scene: &Scene, shares: [f64; 2]) {
    for (found, (wanted, share)) in found.into_iter().zip([scene.ratio, scene.w].into_iter().zip(shares)) {
        assert!((found / wanted - 1.0).abs() < share, "{found} instead of {wanted}: {scene:?}");
    }
}

#[test]
fn fitting_its_own_profiles_returns_their_parameters() {
    let scenes = [
        Scene::default(),
        Scene { epsilon: 0.3, kappa: 0.15, w: 6.0, ..Scene::default() },
        Scene { epsilon: 0.3, tilt: 0.4, ratio: 0.3, w: 10.0, paint: [25.0, 22.0], ..Scene::default() },
        Scene { epsilon: 0.2, skew: 0.08, ratio: 0.6, ..Scene::default() },
    ];
    for scene in scenes {
        assert_near(ratio_and_width(&inner(&scene, &Params::default())), &scene, [0.08, 0.15]);
    }
}

#[test]
fn a_known_tilt_is_taken_as_it_is() {
    let scene =
        Scene { epsilon: 0.3, tilt: 0.5, ratio: 0.3, w: 10.0, paint: [25.0, 22.0], ..Scene::default() };
    let params = Params { tilt_deg: Some(0.5f64.atan().to_degrees()), ..Params::default() };
    let found = inner(&scene, &params);
    assert_near(ratio_and_width(&found), &scene, [0.08, 0.15]);
    assert!(found.iter().all(|section| (section.tilt_rad.unwrap() - 0.5f64.atan()).abs() < 1e-9));
}

#[test]
fn a_longer_exposure_changes_nothing() {
    let params = Params::default();
    let [bright, dark] = [1.3, 0.8].map(|exposure| {
        let scene = Scene { exposure, noise: 0.003, epsilon: 0.25, ..Scene::default() };
        ratio_and_width(&inner(&scene, &params))
    });
    for (k, share) in [(0, 0.03), (1, 0.12)] {
        assert!((bright[k] / dark[k] - 1.0).abs() < share, "{bright:?} {dark:?}");
    }
}

#[test]
fn the_crease_is_found_from_a_curve_beside_it() {
    for (off, epsilon) in [(1.8, 0.0), (-1.8, 0.3), (2.5, 0.35)] {
        let scene = Scene { off, epsilon, ..Scene::default() };
        for section in inner(&scene, &Params::default()) {
            let [x, y] = section.at;
            let crease = 48.0 + 3.0 * (x / 40.0).sin();
            assert!((y - crease).abs() < 0.35, "{off} {epsilon}: {y} instead of {crease} at {x}");
        }
    }
}

#[test]
fn flat_paint_has_no_depth_at_all() {
    for skew in [0.0, 0.1] {
        let scene = Scene { ratio: 0.0, skew, ..Scene::default() };
        for section in sections(&scene, &Params::default()) {
            assert_eq!(section.d_px, 0.0);
            assert_ne!(section.state, SectionState::Measured);
        }
    }
}

#[test]
fn uneven_paint_is_no_valley() {
    let params = Params::default();
    let mut flat = 0;
    for seed in 1..=30 {
        let scene = Scene { ratio: 0.0, texture: 0.01, ..Scene::default() };
        let rgb = scene.picture(seed);
        let picture = Picture::new(SIZE[0], SIZE[1], &rgb).unwrap();
        let paint = painted(&picture, &Transfer::Srgb.light_of_codes(), &scene.curve(), &params).unwrap();
        let found = measure(&paint, &params, 0.0).sections;
        flat += usize::from(found.iter().all(|section| section.d_px == 0.0));
    }
    assert!(flat >= 29, "{flat} of 30");
}

#[test]
fn known_ground_tells_a_hollow_from_a_valley() {
    let scene = Scene { ratio: 0.3, epsilon: 0.3, bend: 0.008, tilt: 0.3, ..Scene::default() };
    let rgb = scene.picture(7);
    let picture = Picture::new(SIZE[0], SIZE[1], &rgb).unwrap();
    let params = Params::default();
    let guessed = painted(&picture, &Transfer::Srgb.light_of_codes(), &scene.curve(), &params).unwrap();
    let ground = Ground::strip(0.3f64.atan(), 0.008);
    let known = Painted { ground: vec![Some(ground); 14], ..guessed.clone() };
    let inner = |paint: &Painted| -> Vec<Section> {
        let all = measure(paint, &params, 0.0).sections;
        all.into_iter().filter(|section| (30.0..130.0).contains(&section.at[0])).collect()
    };
    let found = inner(&known);
    assert_near(ratio_and_width(&found), &scene, [0.08, 0.2]);
    assert!(found.iter().all(|section| (section.tilt_rad.unwrap() - 0.3f64.atan()).abs() < 0.12));
    let off = |sections: &[Section]| (ratio_and_width(sections)[1] / scene.w - 1.0).abs();
    assert!(off(&found) < off(&inner(&guessed)), "{} {}", off(&found), off(&inner(&guessed)));
}

#[test]
fn a_shallow_valley_is_kept() {
    let scene = Scene { ratio: 0.1, ..Scene::default() };
    let found = inner(&scene, &Params::default());
    assert!(found.iter().filter(|section| section.d_px > 0.0).count() * 2 > found.len());
}

#[test]
fn a_mirrored_valley_is_lopsided_the_other_way() {
    let scene = Scene { epsilon: 0.3, kappa: 0.25, ..Scene::default() };
    let mirrored = Scene { kappa: -0.25, paint: [18.0, 20.0], ..scene };
    let [one, other] =
        [scene, mirrored].map(|scene| median(inner(&scene, &Params::default()).iter().map(|s| s.kappa)));
    assert!(one > 0.05 && (one + other).abs() < 0.1, "{one} {other}");
}

#[test]
fn the_papers_model_measures_what_it_assumes() {
    // Wide, so that the lens's blur, of which the paper's model does not know, does little.
    let scene = Scene { w: 16.0, ratio: 0.3, paint: [36.0, 36.0], ..Scene::default() };
    let params = Params { model: Model::Paper, ..Params::default() };
    let found = inner(&scene, &params);
    assert!(found.iter().all(|section| section.epsilon == 0.0 && section.kappa == 0.0));
    assert_near(ratio_and_width(&found), &scene, [0.2, 0.5]);
}

#[test]
fn what_has_no_paint_has_failed() {
    let scene = Scene { paint: [2.0, 2.0], ..Scene::default() };
    let rgb = scene.picture(7);
    let picture = Picture::new(SIZE[0], SIZE[1], &rgb).unwrap();
    let light = Transfer::Srgb.light_of_codes();
    let params = Params::default();
    let found = painted(&picture, &light, &scene.curve(), &params)
        .map(|paint| measure(&paint, &params, 0.0).sections);
    assert!(
        found
            .into_iter()
            .flatten()
            .all(|section| section.state == SectionState::Failed && section.d_px == 0.0)
    );
}

#[test]
fn skin_beside_narrow_paint_tells_more_of_a_valley() {
    let params = Params::default();
    let light = Transfer::Srgb.light_of_codes();
    let mut off = [0.0; 2];
    for (seed, ratio) in [(1, 0.3), (2, 0.5), (3, 0.4)] {
        let scene = Scene { ratio, epsilon: 0.25, paint: [5.5, 5.5], texture: 0.01, ..Scene::default() };
        let rgb = scene.picture(seed);
        let picture = Picture::new(SIZE[0], SIZE[1], &rgb).unwrap();
        let mut paint = painted(&picture, &light, &scene.curve(), &params).unwrap();
        assert!(!paint.band.skin.is_empty());
        for sum in &mut off {
            let sections = measure(&paint, &params, 0.0).sections;
            let inner = sections.iter().filter(|section| (30.0..130.0).contains(&section.at[0]));
            *sum += (median(inner.map(|section| section.w_px)) / scene.w).ln().abs();
            paint.band.skin.clear();
        }
    }
    assert!(off[0] < off[1], "{off:?}");
}

#[test]
fn wide_paint_needs_no_skin() {
    let scene = Scene::default();
    let rgb = scene.picture(7);
    let picture = Picture::new(SIZE[0], SIZE[1], &rgb).unwrap();
    let light = Transfer::Srgb.light_of_codes();
    let paint = painted(&picture, &light, &scene.curve(), &Params::default()).unwrap();
    assert!(paint.band.skin.is_empty());
}
