//! Where the markers sit.

use crate::body::face::expression::lid_point;
use crate::body::face::outline::{Contour, eye_center, mouth_line};
use crate::body::face::person::Person;
use crate::body::face::surface;
use nalgebra::{Point2, Point3, Vector3};
use std::collections::BTreeMap;

/// A marker on a vertex of the face.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Marker {
    /// Its id, e.g. `brow_l_1` (l: the subject's left, m: the middle).
    pub name: String,
    /// The vertex that it sits on.
    pub vertex: u32,
}

const COUNT: usize = 85;
/// No marker sits closer to the rim, mm.
const RIM_MARGIN: f64 = 9.0;
/// Height of the headband over the skin, mm.
const BAND_HEIGHT: f64 = 6.0;

pub(crate) fn place(person: &Person, domain: &[Point2<f64>], positions: &[Point3<f64>]) -> Vec<Marker> {
    let nearest = |at: Point2<f64>| {
        let distance = |vertex: &usize| (domain[*vertex] - at).norm();
        (0..domain.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0) as u32
    };
    let mut markers: Vec<Marker> = named_places(person)
        .into_iter()
        .map(|(name, at)| Marker { name: name.to_string(), vertex: nearest(at) })
        .collect();
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for vertex in spread(person, domain, positions, &markers) {
        let zone = zone(domain[vertex as usize]);
        let count = counts.entry(zone.clone()).or_default();
        *count += 1;
        markers.push(Marker { name: format!("{zone}_{count}"), vertex });
    }
    markers
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
fn spread(person: &Person, domain: &[Point2<f64>], positions: &[Point3<f64>], first: &[Marker]) -> Vec<u32> {
    let rim: Vec<Point2<f64>> = (0..360).map(|i| Contour::Rim.at(person, f64::from(i) / 360.0)).collect();
    let in_nostrils = |at: &Point2<f64>| at.x.abs() < 18.0 && (-9.0..1.0).contains(&at.y);
    let allowed =
        |at: &Point2<f64>| !in_nostrils(at) && rim.iter().all(|edge| (edge - at).norm() > RIM_MARGIN);
    let pull: Vec<f64> =
        domain.iter().map(|at| if allowed(at) { attraction(person, *at) } else { 0.0 }).collect();
    let mut reach = vec![f64::INFINITY; positions.len()];
    let mut cover = |from: u32| -> u32 {
        for (vertex, reach) in reach.iter_mut().enumerate() {
            *reach = reach.min((positions[vertex] - positions[from as usize]).norm() * pull[vertex]);
        }
        (0..reach.len()).max_by(|&a, &b| reach[a].total_cmp(&reach[b])).unwrap_or(0) as u32
    };
    let mut next = first.iter().map(|marker| cover(marker.vertex)).last().unwrap_or(0);
    let mut chosen = Vec::new();
    while first.len() + chosen.len() < COUNT {
        chosen.push(next);
        next = cover(next);
    }
    chosen
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

pub(crate) fn headband(person: &Person) -> Vec<(String, Point3<f64>)> {
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
