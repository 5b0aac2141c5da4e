//! wrinkles-2d, sections, valleys.

use crate::perturb::*;
use artifact::{
    Curve2d, CurveState, PerCamera, Profile, Section, SectionState, SectionsFrame, SectionsHeader, Space,
    ValleyPoint, ValleysFrame, ValleysHeader, Wrinkle, Wrinkles2dFrame, Wrinkles2dHeader,
};
use nalgebra::Vector2;
use virtual_rig::score;

const IDS: [&str; 4] = ["brow", "eye", "flat", "shallow"];

fn wrinkles() -> Vec<Wrinkle> {
    IDS.map(|id| Wrinkle { id: id.into(), paint: Some("red".into()) }).into()
}

/// The controls of a gently bent curve in the image; wrinkles lie 60 px apart.
fn curve(wrinkle: usize, frame: i64) -> Curve2d {
    let control = |i: usize| {
        let x = 100.0 + 45.0 * i as f64;
        [x, 200.0 + 60.0 * wrinkle as f64 + 6.0 * (0.02 * x + 0.3 * frame as f64).sin()]
    };
    Curve2d {
        controls: (0..7).map(control).collect(),
        state: CurveState::Seen,
        confidence: 1.0,
        paint: Vec::new(),
    }
}

/// The curve's place at u, by de Boor's corner cutting rather than by shares.
fn place(curve: &Curve2d, u: f64) -> Vector2<f64> {
    let span = (u as usize).min(curve.controls.len() - 4);
    let mut points: Vec<Vector2<f64>> = curve.controls[span..span + 4].iter().map(|&p| p.into()).collect();
    let v = u - span as f64;
    for degree in (1..=3).rev() {
        for i in 0..degree {
            let share = (v + (degree - 1 - i) as f64) / degree as f64;
            points[i] = points[i] * (1.0 - share) + points[i + 1] * share;
        }
    }
    points[0]
}

fn section(curve: &Curve2d, u: f64, ratio: f64) -> Section {
    let along = place(curve, (u + 1e-4).min(4.0)) - place(curve, (u - 1e-4).max(0.0));
    let along = along.normalize();
    let width = 5.0 + u;
    Section {
        u,
        at: place(curve, u).into(),
        normal: [-along.y, along.x],
        w_px: width,
        d_px: ratio * width,
        epsilon: if ratio > 0.0 { 0.15 } else { 0.0 },
        kappa: if ratio > 0.0 { 0.2 } else { 0.0 },
        tilt_rad: None,
        deviation: None,
        residual: None,
        state: if ratio > 0.0 { SectionState::Measured } else { SectionState::Flat },
    }
}

/// Two deep wrinkles, a flat one and a shallow one, in two cameras, 4 frames at every fourth mocap frame.
fn truth() -> (SectionsHeader, Vec<SectionsFrame>) {
    let header = SectionsHeader {
        cameras: vec!["w1".into(), "w2".into()],
        wrinkles: wrinkles(),
        profile: Profile::Rounded,
        rate: None,
        take: Some(take("t1")),
    };
    let ratio =
        |wrinkle: usize, u: f64| [0.35 + 0.05 * u, 0.4, 0.0, if u < 0.2 { 0.0 } else { 0.1 }][wrinkle];
    let sections = |wrinkle: usize, frame: i64| {
        let curve = curve(wrinkle, frame);
        (0..=32).map(|i| f64::from(i) / 8.0).map(|u| section(&curve, u, ratio(wrinkle, u))).collect()
    };
    let wrinkles =
        |frame| IDS.iter().enumerate().map(|(i, id)| (id.to_string(), sections(i, frame))).collect();
    let frame = |i: i64| SectionsFrame {
        frame: FIRST + 4 * i,
        sections: header.cameras.iter().map(|camera| (camera.clone(), wrinkles(i))).collect(),
    };
    let frames = (0..4).map(frame).collect();
    (header, frames)
}

fn curves() -> (Wrinkles2dHeader, Vec<Wrinkles2dFrame>) {
    let header = Wrinkles2dHeader {
        cameras: vec!["w1".into(), "w2".into()],
        wrinkles: wrinkles(),
        rate: None,
        take: Some(take("t1")),
    };
    let curves = |frame| IDS.iter().enumerate().map(|(i, id)| (id.to_string(), curve(i, frame))).collect();
    let frame = |i: i64| Wrinkles2dFrame {
        frame: FIRST + 4 * i,
        curves: header.cameras.iter().map(|camera| (camera.clone(), curves(i))).collect(),
    };
    let frames = (0..4).map(frame).collect();
    (header, frames)
}

fn score_curves(change: impl FnOnce(&mut Vec<Wrinkles2dFrame>)) -> Vec<score::Metric> {
    let (true_header, truth) = truth();
    let (header, mut frames) = curves();
    change(&mut frames);
    score::wrinkles_2d((&true_header, &truth), (&header, &frames)).unwrap()
}

fn all_curves(frames: &mut [Wrinkles2dFrame]) -> impl Iterator<Item = (&String, &mut Curve2d)> {
    frames.iter_mut().flat_map(|frame| frame.curves.values_mut().flatten())
}

#[test]
fn curves_that_made_the_truth_are_perfect() {
    let metrics = score_curves(|_| ());
    assert!(value(&metrics, "curve_p90_px") < 1e-9, "{}", value(&metrics, "curve_p90_px"));
    assert_eq!(value(&metrics, "coverage"), 1.0);
    for name in ["id_errors", "missing", "false_curves"] {
        assert_eq!(value(&metrics, name), 0.0);
    }
}

#[test]
fn curves_shifted_across_are_recovered() {
    let metrics = score_curves(|frames| {
        for (_, curve) in all_curves(frames) {
            let reference = curve.clone();
            // Controls moved along the normals of the curve near them: an offset curve, nearly.
            for (i, control) in curve.controls.iter_mut().enumerate() {
                let u = (i as f64 - 1.0).clamp(0.001, 3.999);
                let along = (place(&reference, u + 1e-3) - place(&reference, u - 1e-3)).normalize();
                control[0] -= 0.3 * along.y;
                control[1] += 0.3 * along.x;
            }
        }
    });
    assert_recovered(&metrics, "curve_px", 0.3);
    assert_recovered(&metrics, "curve_p90_px", 0.3);
}

#[test]
fn swapped_ids_lost_and_held_and_false_curves_are_counted() {
    let metrics = score_curves(|frames| {
        for frame in &mut frames[..3] {
            let w1 = frame.curves.get_mut("w1").unwrap();
            let (a, b) = (w1["brow"].clone(), w1["eye"].clone());
            w1.insert("brow".into(), b);
            w1.insert("eye".into(), a);
        }
    });
    assert_eq!(value(&metrics, "id_errors"), 6.0);

    let metrics = score_curves(|frames| {
        frames[0].curves.get_mut("w2").unwrap().remove("brow");
        frames[1].curves.get_mut("w2").unwrap().get_mut("eye").unwrap().state = CurveState::Held;
        frames.remove(3);
    });
    assert_eq!(value(&metrics, "missing"), 2.0 + 8.0);
    assert_recovered(&metrics, "coverage", 22.0 / 32.0);

    let (true_header, mut truth) = truth();
    truth[0].sections.get_mut("w1").unwrap().remove("eye");
    let (header, frames) = curves();
    let metrics = score::wrinkles_2d((&true_header, &truth), (&header, &frames)).unwrap();
    assert_eq!(value(&metrics, "false_curves"), 1.0);
}

#[test]
fn a_curve_cut_short_costs_coverage_not_distance() {
    let metrics = score_curves(|frames| {
        for (_, curve) in all_curves(frames) {
            curve.controls.truncate(5);
        }
    });
    assert!(value(&metrics, "curve_p90_px") < 1e-9);
    assert!((value(&metrics, "coverage") - 17.0 / 33.0).abs() < 1e-9, "{}", value(&metrics, "coverage"));
}

fn score_sections(change: impl FnOnce(&mut Vec<SectionsFrame>)) -> Vec<score::Metric> {
    let (header, truth) = truth();
    let mut frames = truth.clone();
    change(&mut frames);
    score::sections((&header, &truth), (&header, &frames)).unwrap()
}

fn all_sections(frames: &mut [SectionsFrame]) -> impl Iterator<Item = &mut Section> {
    frames
        .iter_mut()
        .flat_map(|frame| frame.sections.values_mut().flat_map(|camera| camera.values_mut().flatten()))
}

#[test]
fn sections_truth_fed_back_is_perfect() {
    let metrics = score_sections(|_| ());
    assert_perfect(&metrics, &[]);
    assert_eq!(metric(&metrics, "ratio_rel").context["sections"], 2 * 4 * 2 * 33);
}

#[test]
fn sections_scaled_depths_and_widths_are_recovered() {
    let metrics = score_sections(|frames| all_sections(frames).for_each(|section| section.d_px *= 1.1));
    for name in ["ratio_rel", "ratio_p90", "depth_rel", "depth_p90", "rim_depth_rel"] {
        assert_recovered(&metrics, name, 0.1);
    }
    assert_eq!(value(&metrics, "width_rel"), 0.0);

    let metrics = score_sections(|frames| all_sections(frames).for_each(|section| section.w_px *= 0.8));
    assert_recovered(&metrics, "width_rel", 0.2);
    assert_recovered(&metrics, "ratio_rel", 0.25);
    assert_eq!(value(&metrics, "depth_rel"), 0.0);
    assert!(value(&metrics, "rim_depth_rel") > 0.01);
}

#[test]
fn sections_ninety_percent_is_that_of_the_worst_tenth() {
    let metrics = score_sections(|frames| {
        let mut i = 0;
        all_sections(frames).for_each(|section| {
            i += 1;
            section.d_px *= if i % 5 == 0 { 1.3 } else { 1.05 };
        });
    });
    assert_recovered(&metrics, "depth_rel", 0.05);
    assert_recovered(&metrics, "depth_p90", 0.3);
}

#[test]
fn sections_creases_shifted_across_are_recovered() {
    let metrics = score_sections(|frames| {
        all_sections(frames).for_each(|section| {
            section.at[0] += 0.3 * section.normal[0];
            section.at[1] += 0.3 * section.normal[1];
        });
    });
    assert_recovered(&metrics, "crease_px", 0.3);
    assert_recovered(&metrics, "crease_p90_px", 0.3);
}

#[test]
fn sections_out_of_range_do_not_count() {
    let (header, mut truth) = truth();
    let mut result = truth.clone();
    all_sections(&mut truth).for_each(|section| {
        section.w_px *= 0.5;
        section.d_px *= 0.5;
    });
    all_sections(&mut result).for_each(|section| {
        section.w_px *= 0.5;
        section.d_px *= if section.w_px < 3.5 { 5.0 } else { 0.5 };
    });
    let metrics = score::sections((&header, &truth), (&header, &result)).unwrap();
    assert_eq!(value(&metrics, "depth_rel"), 0.0);
    assert!(value(&metrics, "depth_p90") < 1e-12);
    assert_eq!(value(&metrics, "coverage"), 1.0);
}

#[test]
fn sections_gate_is_counted_by_wrinkle_image() {
    let metrics = score_sections(|frames| {
        let flat = |frame: &mut SectionsFrame, id: &str| {
            for section in frame.sections.get_mut("w1").unwrap().get_mut(id).unwrap() {
                section.d_px = 0.0;
                section.state = SectionState::Flat;
            }
        };
        flat(&mut frames[0], "shallow");
        flat(&mut frames[1], "shallow");
        // One section with a false depth is a flat wrinkle not rejected.
        frames[2].sections.get_mut("w2").unwrap().get_mut("flat").unwrap()[7].d_px = 0.01;
        frames[3].sections.get_mut("w2").unwrap().remove("flat");
    });
    assert_eq!(value(&metrics, "shallow_kept"), 0.75);
    assert_eq!(value(&metrics, "flat_rejected"), 0.75);
    assert_eq!(value(&metrics, "missing"), 1.0);
}

#[test]
fn sections_failed_or_missing_cost_coverage() {
    let metrics = score_sections(|frames| {
        frames.remove(0);
        for section in frames[0].sections.get_mut("w1").unwrap().get_mut("brow").unwrap() {
            section.state = SectionState::Failed;
        }
    });
    assert_recovered(&metrics, "coverage", 11.0 / 16.0);
    assert_eq!(value(&metrics, "depth_rel"), 0.0);
}

#[test]
fn sections_of_no_use_leave_metrics_without_value() {
    let (header, mut truth) = truth();
    all_sections(&mut truth).for_each(|section| section.w_px = 2.0);
    let metrics = score::sections((&header, &truth), (&header, &truth)).unwrap();
    assert_eq!(metric(&metrics, "width_rel").value, None);
    assert!(metric(&metrics, "width_rel").reason.as_ref().unwrap().contains("3.5 px"));
}

fn valleys() -> (ValleysHeader, Vec<ValleysFrame>) {
    let header = ValleysHeader {
        mesh: mesh_ref(100),
        wrinkles: wrinkles()[..2].to_vec(),
        rate: None,
        take: Some(take("t1")),
        space: Space::Face,
    };
    let point = |wrinkle: usize, frame: i64, i: usize| {
        let x = i as f64 * 0.7;
        ValleyPoint {
            x_mm: x,
            face: 0,
            barycentric: [1.0, 0.0, 0.0],
            at_mm: [x, 20.0 * wrinkle as f64, (0.05 * x).cos()],
            normal: [0.0, 0.0, 1.0],
            across: [0.0, -1.0, 0.0],
            w_mm: 1.2,
            d_mm: 0.4 + 0.01 * frame as f64,
            epsilon: 0.0,
            kappa: 0.0,
        }
    };
    let frame = |frame: i64| ValleysFrame {
        frame: FIRST + frame,
        valleys: (0..2)
            .map(|w| (IDS[w].to_string(), (0..40).map(|i| point(w, frame, i)).collect()))
            .collect(),
    };
    (header, (0..5).map(frame).collect())
}

#[test]
fn valleys_errors_are_recovered() {
    let (header, truth) = valleys();
    assert_perfect(&score::valleys((&header, &truth), (&header, &truth)).unwrap(), &[]);

    let mut result = truth.clone();
    for point in result.iter_mut().flat_map(|frame| frame.valleys.values_mut().flatten()) {
        point.at_mm[1] += 0.2;
        point.d_mm *= 1.1;
        point.w_mm *= 0.9;
    }
    result[4].valleys.remove("eye");
    let metrics = score::valleys((&header, &truth), (&header, &result)).unwrap();
    for (name, planted) in
        [("position_mm", 0.2), ("position_p90_mm", 0.2), ("depth_rel", 0.1), ("width_rel", 0.1)]
    {
        assert_recovered(&metrics, name, planted);
    }
    assert_eq!(value(&metrics, "missing"), 1.0);
    assert_recovered(&metrics, "coverage", 0.9);
    let metrics = score::valleys((&header, &result), (&header, &truth)).unwrap();
    assert_eq!(value(&metrics, "false_valleys"), 1.0);
}

#[test]
fn wrinkles_unknown_to_the_take_are_refused() {
    let (true_header, truth) = truth();
    let (mut header, frames) = curves();
    header.wrinkles.push(Wrinkle { id: "chin".into(), paint: None });
    let message = score::wrinkles_2d((&true_header, &truth), (&header, &frames)).unwrap_err().to_string();
    assert!(message.contains("wrinkle chin") && message.contains("brow"), "{message}");
    let stranger = SectionsHeader { take: Some(take("t2")), ..true_header.clone() };
    assert!(score::sections((&true_header, &truth), (&stranger, &truth)).is_err());
    let empty = SectionsFrame { frame: 5, sections: PerCamera::new() };
    let message = score::sections((&true_header, &truth), (&true_header, &[empty])).unwrap_err().to_string();
    assert!(message.contains("(5–5)"), "{message}");
}
