//! Where the markers sit.

use crate::body::face::outline::{Contour, EYE_HALF_WIDTH, eye_center, lid_edges, mouth_line};
use crate::body::face::person::Person;
use crate::body::face::sampling::contains;
use crate::body::face::surface;
use nalgebra::{Point2, Point3, Vector3};
use std::collections::BTreeMap;

/// A marker on the face.
#[derive(Debug, Clone, PartialEq)]
pub struct MarkerPlace {
    /// Its id, e.g. `brow_l_1` (l: the subject's left, m: the middle).
    pub name: String,
    /// Its place on the unrolled face, mm; the same for any mesh of a person.
    pub at: Point2<f64>,
    /// The vertex nearest to it.
    pub vertex: u32,
}

const COUNT: usize = 85;
/// No marker sits closer to the rim, mm.
const RIM_MARGIN: f64 = 9.0;
/// Height of the headband over the skin, mm.
const BAND_HEIGHT: f64 = 6.0;
/// A marker farther from the next vertex has no place on that mesh, mm.
const FARTHEST: f64 = 5.0;
/// Vertices that are this much farther than the nearest may be on the skin over it, mm.
const NEARLY: f64 = 1.5;
/// Sheets over each other are farther apart than this, mm.
const SHEETS: f64 = 5.0;
/// Step of the places that markers are chosen from, mm.
const STEP: f64 = 2.0;

/// `outwards`: per vertex how far out it lies, mm: of sheets over each other, e.g. skin and the pocket behind the lips, the
/// outermost is the skin.
pub(in crate::body) fn markers(
    person: &Person,
    domain: &[Point2<f64>],
    outwards: impl Fn(usize, Point2<f64>) -> f64,
) -> Vec<MarkerPlace> {
    let nearest = |at: Point2<f64>| {
        let distance = |vertex: &usize| (domain[*vertex] - at).norm();
        let least = (0..domain.len()).map(|vertex| distance(&vertex)).fold(f64::INFINITY, f64::min);
        let near: Vec<usize> =
            (0..domain.len()).filter(|vertex| distance(vertex) <= least + NEARLY).collect();
        let out = near.iter().map(|&vertex| outwards(vertex, at)).fold(f64::NEG_INFINITY, f64::max);
        let skin = near.into_iter().filter(|&vertex| outwards(vertex, at) >= out - SHEETS);
        skin.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    };
    let placed = |(name, at): (String, Point2<f64>)| MarkerPlace { name, at, vertex: nearest(at) as u32 };
    let covered = |marker: &MarkerPlace| (domain[marker.vertex as usize] - marker.at).norm() < FARTHEST;
    places(person).into_iter().map(placed).filter(covered).collect()
}

/// Names and places of all markers.
fn places(person: &Person) -> Vec<(String, Point2<f64>)> {
    let mut places: Vec<(String, Point2<f64>)> =
        named_places(person).into_iter().map(|(name, at)| (name.to_string(), at)).collect();
    let first: Vec<Point2<f64>> = places.iter().map(|place| place.1).collect();
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for at in spread(person, &first) {
        let zone = zone(at);
        let count = counts.entry(zone.clone()).or_default();
        *count += 1;
        places.push((format!("{zone}_{count}"), at));
    }
    places
}

/// Where the marker of a lid sits.
fn lid_point(person: &Person, side: f64, upper: bool) -> Point2<f64> {
    let s = eye_center(person, side).x + 0.05 * EYE_HALF_WIDTH;
    let (low, high) = lid_edges(person, side, s).unwrap_or((0.0, 0.0));
    Point2::new(s, if upper { high + 2.5 } else { low - 3.0 })
}

/// Lips and lids.
fn named_places(person: &Person) -> Vec<(&'static str, Point2<f64>)> {
    let half = person.mouth_half_width;
    let lip = |s: f64, above: f64| Point2::new(s, mouth_line(s) + above);
    vec![
        ("lip_corner_l", lip(half + 2.5, 0.0)),
        ("lip_corner_r", lip(-half - 2.5, 0.0)),
        ("lip_upper_1", lip(0.5 * half, 4.5)),
        ("lip_upper_2", lip(0.0, 4.5)),
        ("lip_upper_3", lip(-0.5 * half, 4.5)),
        ("lip_lower_1", lip(0.5 * half, -5.0)),
        ("lip_lower_2", lip(0.0, -5.5)),
        ("lip_lower_3", lip(-0.5 * half, -5.0)),
        ("lid_upper_l", lid_point(person, 1.0, true)),
        ("lid_upper_r", lid_point(person, -1.0, true)),
        ("lid_lower_l", lid_point(person, 1.0, false)),
        ("lid_lower_r", lid_point(person, -1.0, false)),
    ]
}

/// Farthest points, one after the other; distances near mouth and eyes count more.
fn spread(person: &Person, first: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let candidates = candidates(person);
    let points: Vec<Point3<f64>> = candidates.iter().map(|&at| surface::point(person, at)).collect();
    let pull: Vec<f64> = candidates.iter().map(|&at| attraction(person, at)).collect();
    let mut reach = vec![f64::INFINITY; points.len()];
    let mut cover = |from: Point2<f64>| -> Point2<f64> {
        let from = surface::point(person, from);
        for (candidate, reach) in reach.iter_mut().enumerate() {
            *reach = reach.min((points[candidate] - from).norm() * pull[candidate]);
        }
        candidates[(0..reach.len()).max_by(|&a, &b| reach[a].total_cmp(&reach[b])).unwrap_or(0)]
    };
    let mut next = first.iter().map(|&at| cover(at)).last().unwrap_or_default();
    let mut chosen = Vec::new();
    while first.len() + chosen.len() < COUNT {
        chosen.push(next);
        next = cover(next);
    }
    chosen
}

/// A grid of places on the skin, off the rim, the openings and the nostrils.
fn candidates(person: &Person) -> Vec<Point2<f64>> {
    let [rim, holes @ ..] = Contour::ALL.map(|contour| -> Vec<Point2<f64>> {
        (0..360).map(|i| contour.at(person, f64::from(i) / 360.0)).collect()
    });
    let in_nostrils = |at: &Point2<f64>| at.x.abs() < 18.0 && (-9.0..1.0).contains(&at.y);
    let on_skin = |at: &Point2<f64>| {
        contains(&rim, *at)
            && rim.iter().all(|edge| (edge - at).norm() > RIM_MARGIN)
            && !holes.iter().any(|hole| contains(hole, *at))
            && !in_nostrils(at)
    };
    let row = |i: i32| (-50..=50).map(move |j| Point2::new(STEP * f64::from(j), STEP * f64::from(i)));
    (-50..=60).flat_map(row).filter(on_skin).collect()
}

fn attraction(person: &Person, at: Point2<f64>) -> f64 {
    let eye = (at - eye_center(person, at.x.signum())).norm();
    let mouth = at.x.hypot(at.y - mouth_line(at.x));
    1.0 + 0.8 * (-(eye.min(mouth) / 28.0).powi(2)).exp()
}

/// The part of the face with its side, e.g. `cheek_l`.
fn zone(at: Point2<f64>) -> String {
    let (s, t) = (at.x, at.y);
    let part = match (t, s.abs()) {
        (62.0.., _) => "forehead",
        (47.0.., ..52.0) => "brow",
        (24.0.., 52.0..) => "temple",
        (24.0.., 14.0..) => "orbit",
        (24.0.., _) | (-8.0.., ..20.0) => "nose",
        (-8.0.., _) => "cheek",
        (-42.0.., ..34.0) => "mouth",
        (-42.0.., _) => "cheek",
        (_, ..26.0) => "chin",
        _ => "jaw",
    };
    let side = if s > 6.0 {
        'l'
    } else if s < -6.0 {
        'r'
    } else {
        'm'
    };
    format!("{part}_{side}")
}

pub(in crate::body) fn headband(person: &Person) -> Vec<(String, Point3<f64>)> {
    let places = [
        ("head_1", 72.0, 78.0),
        ("head_2", 40.0, 101.0),
        ("head_3", 4.0, 107.0),
        ("head_4", -37.0, 103.0),
        ("head_5", -70.0, 76.0),
    ];
    let lifted = |s: f64, t: f64| {
        let out = Vector3::new((s / 72.0).sin(), 0.3, (s / 72.0).cos()).normalize();
        surface::point(person, Point2::new(s, t)) + out * BAND_HEIGHT
    };
    places.into_iter().map(|(name, s, t)| (name.to_string(), lifted(s, t))).collect()
}
