//! Landmarks on the rig's face: its markers, and lines around what is no skin.

use crate::body::Body;
use mesh::Connectivity;
use nalgebra::Point2;
use std::collections::BTreeMap;

/// Points around each eye, and around the opening of the mouth.
const AROUND_EYE: usize = 16;
const AROUND_MOUTH: usize = 20;
/// Lower edge, upper edge of the right half of a brow's place on the unrolled face, mm, from its inner end.
const BROW: [[f64; 3]; 4] = [[10.0, 46.5, 61.0], [24.0, 48.5, 64.0], [38.0, 50.5, 65.0], [52.0, 46.0, 61.0]];
/// The lips' border on the unrolled face, mm: half-width over that of the mouth, height over and under its line.
const LIPS: [f64; 3] = [1.12, 9.0, 11.5];
/// Around both nostrils on the unrolled face, mm.
const NOSTRILS: [[f64; 2]; 8] = [
    [-19.0, -3.0],
    [-14.0, 3.5],
    [0.0, 0.5],
    [14.0, 3.5],
    [19.0, -3.0],
    [12.0, -9.0],
    [0.0, -8.5],
    [-12.0, -9.0],
];

/// Vertices by the landmark's id: `eye_l_01` … (l: the subject's left), `mouth_in_01` … around the opening, `lips_01` … around
/// the red, `brow_l_01` …, `nostrils_01` …; then the markers by their own names.
pub(super) fn marks(body: &Body) -> BTreeMap<String, u32> {
    let mut marks: BTreeMap<String, u32> =
        body.markers().into_iter().map(|marker| (marker.name, marker.vertex)).collect();
    let mut put = |name: &str, vertices: Vec<u32>| {
        for (number, vertex) in vertices.into_iter().enumerate() {
            marks.insert(format!("{name}_{:02}", number + 1), vertex);
        }
    };
    let mut mouth_half = 25.0;
    for (middle, vertices) in openings(body) {
        let spread = |count| spread(&vertices, count);
        match (middle.y > 20.0, middle.x > 0.0) {
            (true, true) => put("eye_l", spread(AROUND_EYE)),
            (true, false) => put("eye_r", spread(AROUND_EYE)),
            _ => {
                mouth_half = vertices.iter().map(|v| body.domain[*v as usize].x.abs()).fold(0.0, f64::max);
                put("mouth_in", spread(AROUND_MOUTH));
            }
        }
    }
    let near = |places: Vec<[f64; 2]>| places.into_iter().map(|at| nearest(body, Point2::from(at))).collect();
    put("lips", near(lips(body, mouth_half)));
    for (name, side) in [("brow_edge_l", 1.0), ("brow_edge_r", -1.0)] {
        let lower = BROW.iter().map(|[s, low, _]| [side * s, *low]);
        let upper = BROW.iter().rev().map(|[s, _, high]| [side * s, *high]);
        put(name, near(lower.chain(upper).collect()));
    }
    put("nostrils", near(NOSTRILS.to_vec()));
    distinct(marks)
}

/// Openings of the mask but its rim: where they lie on the unrolled face, and their vertices in order.
fn openings(body: &Body) -> Vec<(Point2<f64>, Vec<u32>)> {
    let around = Connectivity::of(body.mesh.positions.len(), &body.triangles);
    let mut loops = around.boundary_loops();
    loops.sort_by_key(|vertices| std::cmp::Reverse(vertices.len()));
    let middle = |vertices: &[u32]| {
        let sum =
            vertices.iter().fold(nalgebra::Vector2::zeros(), |sum, v| sum + body.domain[*v as usize].coords);
        Point2::from(sum / vertices.len() as f64)
    };
    loops.into_iter().skip(1).take(3).map(|vertices| (middle(&vertices), vertices)).collect()
}

fn spread(vertices: &[u32], count: usize) -> Vec<u32> {
    (0..count).map(|number| vertices[number * vertices.len() / count]).collect()
}

fn lips(body: &Body, mouth_half: f64) -> Vec<[f64; 2]> {
    let [wide, over, under] = LIPS;
    let edge: Vec<Point2<f64>> = openings(body)
        .into_iter()
        .filter(|opening| opening.0.y < 20.0)
        .flat_map(|opening| spread(&opening.1, AROUND_MOUTH))
        .map(|vertex| body.domain[vertex as usize])
        .collect();
    let middle = edge.iter().map(|at| at.y).sum::<f64>() / edge.len().max(1) as f64;
    let turn = |number: usize| {
        let (s, c) = (std::f64::consts::TAU * number as f64 / 16.0).sin_cos();
        [wide * mouth_half * c, middle + if s > 0.0 { over * s } else { under * s }]
    };
    (0..16).map(turn).collect()
}

fn nearest(body: &Body, at: Point2<f64>) -> u32 {
    let distance = |vertex: &u32| (body.domain[*vertex as usize] - at).norm_squared();
    let all = 0..body.domain.len() as u32;
    all.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

/// One landmark a vertex.
fn distinct(marks: BTreeMap<String, u32>) -> BTreeMap<String, u32> {
    let mut taken = std::collections::BTreeSet::new();
    marks.into_iter().filter(|(_, vertex)| taken.insert(*vertex)).collect()
}
