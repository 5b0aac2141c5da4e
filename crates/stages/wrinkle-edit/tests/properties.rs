//! Laws of edits.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests may")]

mod scene;

use artifact::{CurveState, Section, SectionState, Wrinkle};
use proptest::prelude::*;
use scene::{FRAMES, curve, done, edited, head, moments, of};
use wrinkle_edit::{Editor, Edits, Head, Moment, Params};

fn all_sections(moments: &[Moment]) -> Vec<Section> {
    let cameras = moments.iter().filter_map(|moment| moment.sections.as_ref()).flat_map(|all| all.values());
    cameras.flat_map(|wrinkles| wrinkles.values()).flatten().copied().collect()
}

/// The same states, and numbers that are the same but for rounding.
fn alike(one: &[Moment], other: &[Moment]) -> bool {
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-12 * a.abs().max(1.0);
    let (one, other) = (all_sections(one), all_sections(other));
    one.len() == other.len()
        && one
            .iter()
            .zip(&other)
            .all(|(a, b)| a.state == b.state && near(a.w_px, b.w_px) && near(a.d_px, b.d_px) && a.at == b.at)
}

proptest! {
    #[test]
    fn scaling_twice_is_scaling_by_the_product(a in 0.0..4.0f64, b in 0.0..4.0f64, width in 0.1..4.0f64) {
        let twice = format!("scale depth {a}\nscale width {width}\nscale depth {b}\nscale width 2");
        let once = format!("scale depth {}\nscale width {}", a * b, 2.0 * width);
        prop_assert!(alike(&done(&twice), &done(&once)));
    }

    #[test]
    fn edits_in_disjoint_frames_commute(a in 0.1..4.0f64, depth in 0.1..9.0f64, cut in 1002i64..1017) {
        let (one, other) = (
            format!("scale depth {a} frames 1001-{} ease 0,1 smooth", cut - 1),
            format!("set depth {depth} of brow_* frames {cut}-1017 ease 1,0"),
        );
        let third = format!("swap brow_1 brow_2 frames {cut}-1017");
        let order = [format!("{one}\n{other}\n{third}"), format!("{other}\n{third}\n{one}")];
        prop_assert_eq!(done(&order[0]), done(&order[1]));
    }

    #[test]
    fn an_edit_leaves_other_wrinkles_cameras_and_frames_alone(frame in 0usize..5, a in 0.1..4.0f64) {
        let frame = FRAMES[frame];
        let after = done(&format!("scale depth {a} of brow_2 in w2 frames {frame}"));
        let mut before = moments();
        for (moment, other) in before.iter_mut().zip(&after).filter(|(moment, _)| moment.frame == frame) {
            let edited = other.sections.as_ref().unwrap()["w2"]["brow_2"].clone();
            prop_assert!(edited.iter().any(|section| section.state == SectionState::Edited));
            moment.sections.as_mut().unwrap().get_mut("w2").unwrap().insert("brow_2".into(), edited);
        }
        prop_assert_eq!(before, after);
    }

    /// What is drawn at a frame and follows a wrinkle keeps its place beside it, however the two move.
    #[test]
    fn what_follows_keeps_its_place(x in 0.0..80.0f64, y in 100.0..160.0f64) {
        let places = format!("through {x},{y} {},{} {},{y}", x + 20.0, y + 5.0, x + 50.0);
        let after = done(&format!("draw new in w1 at 1009 {places} width 4 depth 2 follow brow_1"));
        let still = of(&after, 1009, "w1", "new").unwrap();
        for frame in FRAMES {
            let by = (frame - 1009) as f64;
            for (section, other) in of(&after, frame, "w1", "new").unwrap().iter().zip(still) {
                prop_assert!((section.at[0] - other.at[0] - by).abs() < 1e-9);
                prop_assert!((section.at[1] - other.at[1] - 2.0 * by).abs() < 1e-9);
            }
        }
    }

    /// Following is equivariant: a rigid motion of what is followed moves what follows rigidly.
    #[test]
    fn what_follows_turns_with_the_skin(angle in -0.8..0.8f64, x in -20.0..20.0f64, y in -20.0..20.0f64) {
        let turn = |[a, b]: [f64; 2]| {
            let (sin, cos) = angle.sin_cos();
            [cos * a - sin * b + x, sin * a + cos * b + y]
        };
        let list = "wrinkle-edits/1\ndraw new in w1 at 1001 through 5,60 30,66 70,60 width 4 depth 2 follow brow_1,smile";
        let edits = Edits::parse(list, &head()).unwrap();
        let mut frames = moments()[..2].to_vec();
        let still = frames[0].sections.clone();
        frames[1].sections = still;
        for section in frames[1].sections.iter_mut().flat_map(|all| all.values_mut()).flat_map(|all| all.values_mut()).flatten() {
            section.at = turn(section.at);
        }
        Editor::new(&edits, &Params::default()).unwrap().apply(&mut frames).unwrap();
        let drawn = |frame| of(&frames, frame, "w1", "new").unwrap();
        for (one, other) in drawn(1001).iter().zip(drawn(1005)) {
            let at = turn(one.at);
            prop_assert!((at[0] - other.at[0]).abs() < 1e-9 && (at[1] - other.at[1]).abs() < 1e-9);
        }
    }
}

#[test]
fn an_empty_list_changes_nothing() {
    for text in ["", "\n# nothing\n", "wrinkle-edits/1\n", "wrinkle-edits/1 # yet\n\n"] {
        let edits = Edits::parse(text, &head()).unwrap();
        assert!(edits.count() == 0 && edits.edited(&head()) == head());
        let mut frames = moments();
        Editor::new(&edits, &Params::default()).unwrap().apply(&mut frames).unwrap();
        assert_eq!(frames, moments());
    }
}

#[test]
fn a_depth_of_nothing_is_flat() {
    for list in ["scale depth 0", "set depth 0", "set ratio 0", "scale depth 0\nscale depth 3"] {
        let after = all_sections(&done(list));
        assert!(
            after.iter().all(|section| section.d_px == 0.0 && section.state == SectionState::Flat),
            "{list}"
        );
    }
}

#[test]
fn renaming_there_and_back_changes_nothing() {
    for list in ["rename smile grin\nrename grin smile", "swap brow_1 smile\nswap smile brow_1"] {
        assert_eq!(done(list), moments(), "{list}");
        let edits = Edits::parse(&format!("wrinkle-edits/1\n{list}"), &head()).unwrap();
        assert_eq!(edits.edited(&head()), head());
    }
    let swapped = done("swap brow_1 smile in w1 frames 1005-");
    let before = moments();
    assert_eq!(of(&swapped, 1005, "w1", "brow_1"), of(&before, 1005, "w1", "smile"));
    assert_eq!(of(&swapped, 1005, "w1", "smile"), of(&before, 1005, "w1", "brow_1"));
    assert!(of(&swapped, 1009, "w1", "brow_1").is_none(), "smile was not to be seen");
    let once = Edits::parse("wrinkle-edits/1\nrename smile grin", &head()).unwrap().edited(&head());
    let ids: Vec<String> = once.wrinkles.into_iter().map(|wrinkle| wrinkle.id).collect();
    assert_eq!(ids, ["brow_1", "brow_2", "grin"]);
}

#[test]
fn frames_one_by_one_are_as_all_together() {
    let list = "wrinkle-edits/1\nscale depth 2 ease 3,2 frames 1001-1017\nrename smile grin\ndraw new in w1 at 1005 through 5,5 40,9 \
                width 4 depth 1,2\nkey new in w1 at 1013 through 15,5 50,9 depth 4\ndelete brow_1 in w2 frames 1005-1010";
    let edits = Edits::parse(list, &head()).unwrap();
    assert_eq!(edits.linked(), None);
    let (mut one, mut other) = (moments(), moments());
    Editor::new(&edits, &Params::default()).unwrap().apply(&mut one).unwrap();
    let mut editor = Editor::new(&edits, &Params::default()).unwrap();
    other.chunks_mut(1).for_each(|frame| editor.apply(frame).unwrap());
    assert_eq!(one, other);
    assert_eq!(editor.finish().unwrap(), Vec::<String>::new());
}

#[test]
fn an_ease_goes_from_the_measured_to_the_wanted() {
    let after = done("set depth 8 of brow_1 in w1 frames 1005-1017 ease 8,0");
    let depth = |frame| of(&after, frame, "w1", "brow_1").unwrap()[4].d_px;
    let was = |frame: i64| 2.8 + 0.01 * (frame - 1001) as f64;
    assert!((depth(1001) - was(1001)).abs() < 1e-12);
    for (frame, strength) in [(1005, 1.0 / 9.0), (1009, 5.0 / 9.0), (1013, 1.0), (1017, 1.0)] {
        assert!((depth(frame) - (was(frame) + strength * (8.0 - was(frame)))).abs() < 1e-12, "{frame}");
    }
}

#[test]
fn a_drawn_wrinkle_grows_and_fades() {
    let after = done("draw new in w1 at 1009 through 5,60 70,60 width 4 depth 3 frames 1005-1017 ease 4");
    for (frame, strength) in [(1005, 0.2), (1009, 1.0), (1013, 1.0), (1017, 0.2)] {
        let sections = of(&after, frame, "w1", "new").unwrap();
        assert!(sections.iter().all(|section| (section.d_px - 3.0 * strength).abs() < 1e-12), "{frame}");
    }
}

#[test]
fn a_set_depth_finds_a_width_where_none_was_measured() {
    let after = done("set depth 3 of smile");
    let sections = of(&after, 1001, "w1", "smile").unwrap();
    assert!(sections.iter().all(|section| section.state == SectionState::Edited && section.d_px == 3.0));
    assert_eq!(sections[9].w_px, sections[8].w_px);
    let ratio = done("set ratio 0.5 of smile");
    let sections = of(&ratio, 1001, "w1", "smile").unwrap();
    assert!(sections.iter().all(|section| section.d_px == 0.5 * section.w_px));
}

#[test]
fn drawn_sections_lie_as_measured_ones_do() {
    let after = done(
        "draw new in w2 at 1005 through 10,100 40,90 80,100 width 4,6 depth 0,3,0 frames 1005-1009 epsilon 0.1",
    );
    assert!(of(&after, 1001, "w2", "new").is_none() && of(&after, 1005, "w1", "new").is_none());
    let sections = of(&after, 1009, "w2", "new").unwrap();
    let steps: Vec<f64> = sections
        .windows(2)
        .map(|pair| (pair[1].at[0] - pair[0].at[0]).hypot(pair[1].at[1] - pair[0].at[1]))
        .collect();
    assert!(
        steps.iter().all(|step| (step - steps[0]).abs() < 0.01 && (2.0..2.1).contains(step)),
        "{steps:?}"
    );
    let (first, last) = (sections[0], sections[sections.len() - 1]);
    assert!((first.at[0] - 10.0).abs() < 1e-9 && (last.at[0] - 80.0).abs() < 1e-6);
    assert_eq!((first.w_px, first.state, last.state), (4.0, SectionState::Flat, SectionState::Flat));
    // Going right, the right side is below.
    assert!(sections.iter().all(|section| section.normal[1] > 0.8));
    let deepest = sections.iter().map(|section| section.d_px).fold(0.0, f64::max);
    assert!((2.9..=3.0).contains(&deepest) && sections[5].epsilon == 0.1);
    let moment = after.iter().find(|moment| moment.frame == 1009).unwrap();
    let curve = &moment.curves.as_ref().unwrap()["w2"]["new"];
    assert!(
        curve.state == CurveState::Edited && sections.iter().all(|section| curve.at(section.u) == section.at)
    );
}

#[test]
fn between_keys_a_drawn_wrinkle_goes_straight() {
    let list = "draw new in w1 at 1001 through 0,100 50,100 width 4 depth 2\nkey new in w1 at 1009 through 8,116 58,116 width 8";
    let after = done(list);
    for (frame, at, width) in
        [(1001, [0.0, 100.0], 4.0), (1005, [4.0, 108.0], 6.0), (1017, [8.0, 116.0], 8.0)]
    {
        let section = of(&after, frame, "w1", "new").unwrap()[0];
        assert!((section.at[0] - at[0]).abs() < 1e-9 && (section.at[1] - at[1]).abs() < 1e-9, "{frame}");
        assert!((section.w_px - width).abs() < 1e-12 && section.d_px == 2.0);
    }
    // Keys that say what following does anyway change nothing.
    let followed = done(&list.replace("depth 2", "depth 2 follow brow_1").replace(" width 8", ""));
    let alone = done("draw new in w1 at 1001 through 0,100 50,100 width 4 depth 2 follow brow_1");
    for frame in FRAMES {
        let [one, other] = [&followed, &alone].map(|moments| of(moments, frame, "w1", "new").unwrap()[7]);
        assert!((one.at[0] - other.at[0]).abs() < 1e-9 && (one.at[1] - other.at[1]).abs() < 1e-9);
    }
}

#[test]
fn a_copy_brings_profiles_and_what_was_hidden() {
    let (after, warnings) = edited("copy smile from 1005 in w1 frames 1009-1013 follow brow_1").unwrap();
    assert!(warnings.is_empty(), "{warnings:?}");
    let [source, hidden, seen] = [1005, 1009, 1013].map(|frame| of(&after, frame, "w1", "smile").unwrap());
    for ((a, b), c) in source.iter().zip(hidden).zip(seen) {
        assert!(a.d_px == b.d_px && (a.d_px - c.d_px).abs() < 1e-12 && a.w_px == b.w_px);
        // Four frames on, the skin has moved by 4 and 8 px.
        assert!((b.at[0] - a.at[0] - 4.0).abs() < 1e-9 && (b.at[1] - a.at[1] - 8.0).abs() < 1e-9);
        // Where it is to be seen its place stays that of the image.
        assert!((c.at[0] - a.at[0] - 8.0).abs() < 1e-9);
    }
    let moment = after.iter().find(|moment| moment.frame == 1009).unwrap();
    let carried = &moment.curves.as_ref().unwrap()["w1"]["smile"];
    assert!((carried.controls[2][0] - curve(2, 1009).controls[2][0]).abs() < 1e-9);
    assert_eq!(carried.state, CurveState::Edited);
}

#[test]
fn a_part_of_a_track_can_be_given_another_name() {
    let list = "rename smile grin in w1 frames 1013-1017";
    let after = done(list);
    assert!(of(&after, 1005, "w1", "smile").is_some() && of(&after, 1005, "w1", "grin").is_none());
    assert!(of(&after, 1013, "w1", "smile").is_none() && of(&after, 1013, "w1", "grin").is_some());
    let edits = Edits::parse(&format!("wrinkle-edits/1\n{list}"), &head()).unwrap();
    let added = Wrinkle { id: "grin".into(), paint: Some("green".into()) };
    assert_eq!(edits.edited(&head()), Head { wrinkles: [head().wrinkles, vec![added]].concat(), ..head() });
}
