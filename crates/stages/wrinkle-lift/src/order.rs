//! The same wrinkle over time: one direction, one count of millimetres along it.

use crate::ground::{Ground, Spot};
use crate::line::{Line, arcs};
use artifact::{ValleyPoint, ValleysFrame};
use nalgebra::{Point3, Vector3};
use std::collections::BTreeSet;

/// Gives each wrinkle one direction in all frames, and lets `x_mm` say the same place in all of them: where a frame's part begins along the
/// longest part that any frame saw. `rest`: #V, mm.
///
/// Returns how far the places of open valleys lie off the valley of the frame before, on the rest mesh, mm: skin that does not keep to its
/// valley, and what each image got wrong.
pub fn arrange(frames: &mut [ValleysFrame], ground: &Ground, rest: &[Point3<f64>]) -> Vec<f64> {
    let ids: BTreeSet<String> = frames.iter().flat_map(|frame| frame.valleys.keys().cloned()).collect();
    let mut drift = Vec::new();
    for id in ids {
        let lines =
            frames.iter().filter_map(|frame| frame.valleys.get(&id)).map(|points| line(points, ground, rest));
        let Some(longest) = lines.reduce(|a, b| if b.length() > a.length() { b } else { a }) else {
            continue;
        };
        let mut before: Option<Line> = None;
        for points in frames.iter_mut().filter_map(|frame| frame.valleys.get_mut(&id)) {
            place(points, &longest, ground, rest);
            let now = line(points, ground, rest);
            drift.extend(before.iter().flat_map(|before| off(points, &now, before, ground, rest)));
            before = points.iter().any(|point| point.d_mm > 0.0).then_some(now);
        }
    }
    drift
}

fn rest_points(points: &[ValleyPoint], ground: &Ground, rest: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let spot = |point: &ValleyPoint| Spot { face: point.face, barycentric: point.barycentric };
    points.iter().map(|point| ground.at(&spot(point), rest)).collect()
}

fn line(points: &[ValleyPoint], ground: &Ground, rest: &[Point3<f64>]) -> Line {
    Line::new(rest_points(points, ground, rest))
}

fn place(points: &mut [ValleyPoint], longest: &Line, ground: &Ground, rest: &[Point3<f64>]) {
    if points.is_empty() {
        return;
    }
    let along = |points: &[ValleyPoint]| -> Vec<f64> {
        let places = rest_points(points, ground, rest);
        places.iter().map(|point| longest.locate(point).map_or(0.0, |place| place.arc)).collect()
    };
    let mut known = along(points);
    if known.last() < known.first() {
        turn(points);
        known.reverse();
    }
    let own = arcs(&rest_points(points, ground, rest));
    let mut offsets: Vec<f64> = known.iter().zip(&own).map(|(place, arc)| place - arc).collect();
    let middle = offsets.len() / 2;
    let offset = *offsets.select_nth_unstable_by(middle, f64::total_cmp).1;
    points.iter_mut().zip(own).for_each(|(point, arc)| point.x_mm = arc + offset);
}

/// Left and right change places.
fn turn(points: &mut [ValleyPoint]) {
    points.reverse();
    for point in points {
        point.across = (-Vector3::from(point.across)).into();
        point.kappa = 0.0 - point.kappa;
    }
}

fn off(points: &[ValleyPoint], now: &Line, before: &Line, ground: &Ground, rest: &[Point3<f64>]) -> Vec<f64> {
    let places = rest_points(points, ground, rest);
    let open = places.iter().zip(points).filter(|(_, point)| point.d_mm > 0.0 && now.length() > 0.0);
    let inside = |arc: f64| (0.0..=before.length()).contains(&arc);
    open.filter_map(|(place, _)| {
        before.locate(place).filter(|place| inside(place.arc)).map(|place| place.distance)
    })
    .collect()
}
