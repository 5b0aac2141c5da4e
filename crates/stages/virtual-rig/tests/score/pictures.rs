//! masks and normals.

use crate::perturb::*;
use artifact::picture::Gray;
use nalgebra::{Rotation3, Vector3};
use virtual_rig::score::{self, MaskPair, ScoreError};

/// A disc's coverage, each pixel by 16 × 16 samples.
fn disc(radius: f64) -> Gray {
    let inside = |x: f64, y: f64| (x - 80.3).hypot(y - 79.6) < radius;
    let coverage = |pixel: usize| {
        let (x, y) = ((pixel % 160) as f64, (pixel / 160) as f64);
        let sample = |i: usize| {
            inside(x - 0.5 + (0.5 + (i % 16) as f64) / 16.0, y - 0.5 + (0.5 + (i / 16) as f64) / 16.0)
        };
        (0..256).filter(|&i| sample(i)).count() as f64 / 256.0
    };
    Gray { width: 160, height: 160, pixels: (0..160 * 160).map(coverage).collect() }
}

fn binary(coverage: &Gray) -> Gray {
    Gray {
        pixels: coverage.pixels.iter().map(|&c| f64::from(u8::from(c >= 0.5))).collect(),
        ..coverage.clone()
    }
}

fn score_masks(pairs: Vec<(Gray, Option<Gray>)>) -> Result<Vec<score::Metric>, ScoreError> {
    let pair = |(truth, result)| Ok(MaskPair { place: "w1, frame 1001".into(), truth, result });
    score::masks(pairs.into_iter().map(pair))
}

#[test]
fn masks_truth_fed_back_is_perfect() {
    assert_perfect(&score_masks(vec![(disc(50.0), Some(disc(50.0)))]).unwrap(), &["none"]);
    let metrics = score_masks(vec![(disc(50.0), Some(binary(&disc(50.0))))]).unwrap();
    assert_eq!(value(&metrics, "pixel_f1"), 1.0);
    assert!(value(&metrics, "edge_bias_px") < 0.005);
}

#[test]
fn masks_that_spread_or_shrink_are_biased_by_as_much() {
    for offset in [0.8, -0.8] {
        let metrics = score_masks(vec![(disc(60.0), Some(binary(&disc(60.0 + offset))))]).unwrap();
        // The ring of an outer and an inner circle is longer than the true edge by half the offset over the radius.
        let planted = offset * (1.0 + 0.5 * offset / 60.0);
        let found = metric(&metrics, "edge_bias_px").context["bias_px"].as_f64().unwrap();
        assert!((found - planted).abs() < 0.01 * planted.abs(), "{found}, planted {planted}");
    }
}

#[test]
fn masks_f1_counts_sure_pixels_only() {
    let truth = disc(50.0);
    let painted = truth.pixels.iter().filter(|&&c| c > 0.9).count();
    let mut result = binary(&truth);
    let mut lost = 0;
    for (code, _) in result.pixels.iter_mut().zip(&truth.pixels).filter(|(_, c)| **c > 0.9).step_by(10) {
        *code = 0.0;
        lost += 1;
    }
    let mut wrong = 0;
    for (code, _) in result.pixels.iter_mut().zip(&truth.pixels).filter(|(_, c)| **c < 0.1).step_by(100) {
        *code = 1.0;
        wrong += 1;
    }
    for (code, _) in result.pixels.iter_mut().zip(&truth.pixels).filter(|(_, c)| (0.1..=0.9).contains(*c)) {
        *code = 1.0 - *code;
    }
    let metrics = score_masks(vec![(truth, Some(result))]).unwrap();
    let hits = (painted - lost) as f64;
    assert_eq!(
        value(&metrics, "pixel_f1"),
        2.0 * hits / (2.0 * hits + f64::from(lost as u32) + f64::from(wrong))
    );
}

#[test]
fn masks_that_are_missing_count_as_unpainted() {
    let truth = disc(50.0);
    let metrics = score_masks(vec![(truth.clone(), Some(binary(&truth))), (truth, None)]).unwrap();
    assert_eq!(value(&metrics, "missing"), 1.0);
    assert_recovered(&metrics, "pixel_f1", 2.0 / 3.0);
}

#[test]
fn masks_of_another_size_are_refused() {
    let small = Gray { width: 2, height: 1, pixels: vec![0.0, 1.0] };
    let message = score_masks(vec![(disc(50.0), Some(small))]).unwrap_err().to_string();
    assert!(message.contains("w1, frame 1001") && message.contains("160 × 160"), "{message}");
}

#[test]
fn normals_turned_by_a_known_angle_are_recovered() {
    let mut random = random(5);
    let truth: Vec<Vector3<f64>> =
        (0..500).map(|_| Vector3::new(normal(&mut random), normal(&mut random), 3.0)).collect();
    assert_perfect(&score::normals(&truth, &truth, None).unwrap(), &[]);

    let mut result: Vec<Vector3<f64>> = truth
        .iter()
        .map(|n| {
            Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(n.cross(&Vector3::x())), 0.02) * n * 3.0
        })
        .collect();
    for n in &mut result[..5] {
        *n = Vector3::zeros();
    }
    let metrics = score::normals(&truth, &result, None).unwrap();
    for name in ["mean_deg", "median_deg", "p90_deg", "rms_deg"] {
        assert_recovered(&metrics, name, 0.02f64.to_degrees());
    }
    assert_eq!(value(&metrics, "missing"), 5.0);
    let region: Vec<bool> = (0..500).map(|i| i < 5).collect();
    assert_eq!(metric(&score::normals(&truth, &result, Some(&region)).unwrap(), "mean_deg").value, None);
    assert!(score::normals(&truth, &result[1..], None).is_err());
}
