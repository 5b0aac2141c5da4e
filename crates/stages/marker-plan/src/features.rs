//! Markers on the lips and at the lids.

use crate::face::Rims;
use crate::geodesic;
use crate::skin::Skin;
use crate::{Frame, Params};
use nalgebra::{Point3, Vector3};

/// How far from a rim its hidden skin (the inside of lips and lids) may reach, mm.
const INSIDE_MM: f64 = 30.0;

/// A marker that stands where an edge of lips or lids says.
pub(crate) struct Feature {
    pub(crate) name: String,
    pub(crate) vertex: u32,
    /// Whether it stands in the middle and has no partner.
    pub(crate) middle: bool,
}

/// Everything that is needed to find features.
pub(crate) struct Scene<'a> {
    pub(crate) points: &'a [Point3<f64>],
    pub(crate) triangles: &'a [[u32; 3]],
    pub(crate) neighbors: &'a dyn Fn(u32) -> &'a [u32],
    pub(crate) frame: &'a Frame,
    pub(crate) skin: &'a Skin,
}

/// The features of the face's own left half and of its middle, by name without side.
pub(crate) fn left_half<'a>(scene: &'a Scene<'a>, rims: &Rims, params: &Params) -> Vec<Feature> {
    let offset = 0.5 * params.least_distance_mm;
    let mut features: Vec<Feature> = Vec::new();
    let mut add = |edge: &Edge<'_>, (upper, share): (bool, f64), name: &str| {
        let rim = edge.at(upper, share);
        // Its own mirror image must not merge with it, either.
        let room = |vertex: u32| {
            let place = scene.frame.place(&scene.points[vertex as usize]);
            let clear = |feature: &Feature| {
                let other = scene.frame.place(&scene.points[feature.vertex as usize]);
                let image = Vector3::new(-other.x, other.y, other.z);
                (place - other).norm().min((place - image).norm()) >= params.least_distance_mm
            };
            features.iter().all(clear)
        };
        let vertex = edge.beside(rim, room);
        features.push(Feature {
            name: name.to_string(),
            vertex,
            middle: share == 0.5 && name.starts_with("lip"),
        });
    };
    if params.lip_points > 0 {
        let lips = Edge::new(scene, &rims.mouth, offset);
        add(&lips, (true, 0.0), "lip_corner");
        for (upper, name) in [(true, "lip_upper"), (false, "lip_lower")] {
            if params.lip_points >= 4 {
                add(&lips, (upper, 0.5), &format!("{name}_middle"));
            }
            if params.lip_points >= 8 {
                add(&lips, (upper, 0.25), name);
            }
        }
    }
    if params.lid_points > 0 {
        let lids = Edge::new(scene, &rims.eyes[0], offset);
        add(&lids, (true, 0.5), "lid_upper");
        add(&lids, (false, 0.5), "lid_lower");
        if params.lid_points == 8 {
            add(&lids, (true, 0.22), "lid_upper_outer");
            add(&lids, (true, 0.78), "lid_upper_inner");
        }
    }
    features
}

/// The rim of an opening, in two halves from the corner on the face's left to the one on its right.
struct Edge<'a> {
    scene: &'a Scene<'a>,
    halves: [Vec<u32>; 2],
    /// Skin beside the rim that can be painted on: far enough from all that is hidden inside it.
    ring: Vec<u32>,
}

impl<'a> Edge<'a> {
    fn new(scene: &'a Scene<'a>, rim: &[u32], offset_mm: f64) -> Self {
        let x = |vertex: u32| scene.frame.place(&scene.points[vertex as usize]).x;
        let count = rim.len();
        let extreme = |sign: f64| {
            (0..count).max_by(|&a, &b| (sign * x(rim[a])).total_cmp(&(sign * x(rim[b])))).unwrap_or(0)
        };
        let (left, right) = (extreme(1.0), extreme(-1.0));
        let walk = |from: usize, to: usize| -> Vec<u32> {
            (0..=(to + count - from) % count).map(|step| rim[(from + step) % count]).collect()
        };
        // A rim runs in the direction of its triangles: clockwise around the opening as seen from outside, so from the face's
        // left corner along the lower edge. Heights would not tell where a lid overlaps the other.
        let (lower, mut upper) = (walk(left, right), walk(right, left));
        upper.reverse();
        let halves = [upper, lower];
        let inside = hidden_inside(scene, rim);
        let from_inside = geodesic::distances(scene.points, scene.triangles, &inside);
        let ring = (0..scene.points.len() as u32)
            .filter(|&vertex| {
                scene.skin.frontal[vertex as usize] && from_inside[vertex as usize] >= offset_mm
            })
            .filter(|&vertex| from_inside[vertex as usize] <= INSIDE_MM)
            .collect();
        Self { scene, halves, ring }
    }

    /// The rim's vertex after a share of the way from the left corner to the right one.
    fn at(&self, upper: bool, share: f64) -> u32 {
        let half = &self.halves[usize::from(!upper)];
        let at = |vertex: u32| self.scene.points[vertex as usize];
        let mut walked = vec![0.0];
        for pair in half.windows(2) {
            walked.push(walked[walked.len() - 1] + (at(pair[1]) - at(pair[0])).norm());
        }
        let goal = share * walked[walked.len() - 1];
        let near = |&a: &usize, &b: &usize| (walked[a] - goal).abs().total_cmp(&(walked[b] - goal).abs());
        (0..half.len()).min_by(near).map_or(half[0], |at| half[at])
    }

    /// The place for a dot nearest to a vertex of the rim along the surface, so on its own side of the opening.
    fn beside(&self, rim: u32, room: impl Fn(u32) -> bool) -> u32 {
        let distance = geodesic::distances(self.scene.points, self.scene.triangles, &[rim]);
        let nearer =
            |a: &u32, b: &u32| distance[*a as usize].total_cmp(&distance[*b as usize]).then(a.cmp(b));
        self.ring.iter().copied().filter(|&vertex| room(vertex)).min_by(nearer).unwrap_or(rim)
    }
}

/// The rim, and the skin next to it that is not seen from the front: the inside of lips and lids.
fn hidden_inside(scene: &Scene<'_>, rim: &[u32]) -> Vec<u32> {
    let mut inside = rim.to_vec();
    let mut seen: std::collections::HashSet<u32> = rim.iter().copied().collect();
    let from_rim = geodesic::distances(scene.points, scene.triangles, rim);
    let mut at = 0;
    while at < inside.len() {
        for &next in (scene.neighbors)(inside[at]) {
            let hidden = !scene.skin.frontal[next as usize] && from_rim[next as usize] < INSIDE_MM;
            if hidden && seen.insert(next) {
                inside.push(next);
            }
        }
        at += 1;
    }
    inside
}
