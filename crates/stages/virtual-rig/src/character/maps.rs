//! Wrinkle maps: the person's lines as grooves of a known form.

use crate::wrinkle::{Group, Style, WrinkleLine, lines};
use nalgebra::{Point2, Vector2, Vector3};

/// A tangent-space normal map, green up: red, green, blue of each texel in 8 bits, row after row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Map {
    /// Width and height, px.
    pub size: usize,
    /// The codes.
    pub rgb: Vec<u8>,
}

/// Millimetres of the unrolled face over the map, and where its middle is; as the face's texture coordinates have it.
const SPAN: f64 = 215.0;
const MIDDLE_T: f64 = 11.0;
/// Depth over width: as deep as the wrinkles of a strong expression.
const DEPTH: f64 = 0.45;
/// Depth and length of pores, mm.
const PORES: [f64; 2] = [0.03, 1.1];

/// The map of a reference pose: flat but for the lines that the pose folds. Other names have no lines.
#[must_use]
pub fn wrinkle_map(seed: u64, pose: &str, size: usize) -> Map {
    let lines = lines_of(seed, pose);
    map(size, |at| {
        let slope = lines.iter().map(|line| groove(line, at)).sum::<Vector2<f64>>();
        Vector3::new(-slope.x, -slope.y, 1.0)
    })
}

/// The map of the skin without expression: pores.
#[must_use]
pub fn neutral_map(size: usize) -> Map {
    let [depth, length] = PORES;
    let wave = 2.0 * std::f64::consts::PI / length;
    map(size, |at| {
        // Two crossed waves whose phase wanders.
        let (s, t) = (at.x + 0.6 * (0.7 * at.y).sin(), at.y + 0.6 * (0.9 * at.x).sin());
        let slope = Vector2::new((wave * s).cos() * (wave * t).sin(), (wave * s).sin() * (wave * t).cos());
        Vector3::new(-depth * wave * slope.x, -depth * wave * slope.y, 1.0)
    })
}

fn lines_of(seed: u64, pose: &str) -> Vec<WrinkleLine> {
    let wanted: &[Group] = match pose {
        "brows-up" => &[Group::Forehead],
        "frown" => &[Group::Glabella],
        "smile" => &[Group::CrowsFeet, Group::Nasolabial],
        "snarl" => return across_the_nose(),
        _ => &[],
    };
    lines(seed, &Style::default()).into_iter().filter(|line| wanted.contains(&line.group)).collect()
}

/// Three short lines across the bridge of the nose.
fn across_the_nose() -> Vec<WrinkleLine> {
    let line = |number: usize| {
        let t = 27.0 + 4.5 * number as f64;
        let at = |i: usize| {
            let s = (i as f64 / 20.0 - 0.5) * (20.0 - 2.0 * number as f64);
            Point2::new(s, t - 0.02 * s * s)
        };
        WrinkleLine::new(&format!("nose_{}", number + 1), (0..=20).map(at).collect(), 1.4)
    };
    (0..3).map(line).collect()
}

/// The slope of a groove at a place: height `−d (1 − |p|/w) e^(−|p|/w)` over the distance p from the line, which runs out at its
/// ends; rounded at the bottom.
fn groove(line: &WrinkleLine, at: Point2<f64>) -> Vector2<f64> {
    let Some((away, along)) = nearest(&line.path, at) else { return Vector2::zeros() };
    let (width, distance) = (line.width_mm, away.norm());
    if distance > 8.0 * width || distance == 0.0 {
        return Vector2::zeros();
    }
    let fade = (4.0 * along * (1.0 - along)).clamp(0.0, 1.0).sqrt();
    let q = (distance / width).hypot(0.25);
    // d/dq of (q − 1) e^(−q) is (2 − q) e^(−q).
    let rise = DEPTH * (2.0 - q) * (-q).exp() * (distance / width / q);
    away / distance * (rise * fade)
}

/// From the nearest place of a polyline to here, and how far along the line that place is, 0 to 1.
fn nearest(path: &[Point2<f64>], at: Point2<f64>) -> Option<(Vector2<f64>, f64)> {
    let steps = path.len().checked_sub(1).filter(|steps| *steps > 0)? as f64;
    let of_segment = |(number, pair): (usize, &[Point2<f64>])| {
        let way = pair[1] - pair[0];
        let share = ((at - pair[0]).dot(&way) / way.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        (at - (pair[0] + way * share), (number as f64 + share) / steps)
    };
    let all = path.windows(2).enumerate().map(of_segment);
    all.min_by(|a, b| a.0.norm_squared().total_cmp(&b.0.norm_squared()))
}

fn map(size: usize, normal: impl Fn(Point2<f64>) -> Vector3<f64> + Sync) -> Map {
    use rayon::prelude::*;
    let row = |y: usize| {
        (0..size)
            .flat_map(|x| {
                let [u, v] = [x, y].map(|at| (at as f64 + 0.5) / size as f64 - 0.5);
                let normal = normal(Point2::new(u * SPAN, -v * SPAN + MIDDLE_T)).normalize();
                <[f64; 3]>::from(normal).map(|part| ((0.5 * part + 0.5) * 255.0).round() as u8)
            })
            .collect::<Vec<u8>>()
    };
    let rows: Vec<Vec<u8>> = (0..size).into_par_iter().map(row).collect();
    Map { size, rgb: rows.concat() }
}
