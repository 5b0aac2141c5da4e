//! The bones: where they stand, and what hangs on them.

use super::displacements;
use crate::body::{Body, MUSCLES};
use artifact::gltf::Placement;
use nalgebra::{Point2, Point3};

/// As many as the character of [DutreveMeyer2011, Sec. 5] has.
pub const BONE_COUNT: usize = 21;

/// What all others hang on.
pub(super) const HEAD: usize = 0;
/// What turns with the lower teeth.
pub(super) const JAW: usize = 1;

/// Where in the face a bone may hold skin.
#[derive(Clone, Copy, PartialEq)]
enum Region {
    /// What the jaw does not carry.
    Upper,
    /// What the jaw carries.
    Lower,
    /// What a blink of this muscle moves.
    Lid(&'static str),
}

/// Bones on the skin: name, place on the unrolled face, reach, mm.
const ON_SKIN: [(&str, [f64; 2], f64, Region); BONE_COUNT - 2] = [
    ("brow_inner_l", [12.0, 56.0], 9.0, Region::Upper),
    ("brow_inner_r", [-12.0, 56.0], 9.0, Region::Upper),
    ("brow_mid_l", [34.0, 60.0], 11.0, Region::Upper),
    ("brow_mid_r", [-34.0, 60.0], 11.0, Region::Upper),
    ("forehead_l", [24.0, 80.0], 15.0, Region::Upper),
    ("forehead_r", [-24.0, 80.0], 15.0, Region::Upper),
    ("lid_l", [33.0, 42.0], 9.0, Region::Lid("blink_l")),
    ("lid_r", [-33.0, 42.0], 9.0, Region::Lid("blink_r")),
    ("crow_l", [54.0, 36.0], 10.0, Region::Upper),
    ("crow_r", [-54.0, 36.0], 10.0, Region::Upper),
    ("cheek_l", [40.0, 14.0], 13.0, Region::Upper),
    ("cheek_r", [-40.0, 14.0], 13.0, Region::Upper),
    ("nose_bridge", [0.0, 30.0], 9.0, Region::Upper),
    ("nose_wing_l", [17.0, 2.0], 7.0, Region::Upper),
    ("nose_wing_r", [-17.0, 2.0], 7.0, Region::Upper),
    ("mouth_corner_l", [27.0, -26.0], 10.0, Region::Upper),
    ("mouth_corner_r", [-27.0, -26.0], 10.0, Region::Upper),
    ("lip_upper", [0.0, -20.0], 9.0, Region::Upper),
    ("lip_lower", [0.0, -36.0], 10.0, Region::Lower),
];

/// The head's pull on skin between the others.
const HEAD_PULL: f64 = 0.12;
/// Bones per vertex, as most engines allow.
const MOST: usize = 4;
/// Smaller weights are none.
const LEAST: f64 = 0.01;

pub(super) struct Bones {
    places: Vec<Point3<f64>>,
    /// Per vertex its bones and weights.
    pub(super) influences: Vec<Vec<(usize, f64)>>,
}

impl Bones {
    pub(super) fn of(body: &Body) -> Self {
        let nearest = |at: Point2<f64>| {
            let distance = |vertex: &usize| (body.domain[*vertex] - at).norm();
            let best = (0..body.domain.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            best.map_or_else(Point3::origin, |vertex| body.mesh.positions[vertex])
        };
        let head = Point3::new(0.0, 20.0, -60.0);
        let jaw = Point3::new(0.0, 18.0, -5.0);
        let on_skin = ON_SKIN.iter().map(|(_, [s, t], ..)| nearest(Point2::new(*s, *t)));
        let places = [head, jaw].into_iter().chain(on_skin).collect();
        Self { places, influences: influences(body) }
    }

    pub(super) fn names(&self) -> impl Iterator<Item = String> {
        ["head", "jaw"].into_iter().chain(ON_SKIN.iter().map(|bone| bone.0)).map(String::from)
    }

    /// Where a bone rests, mm.
    pub(super) fn place(&self, bone: usize) -> Point3<f64> {
        self.places[bone]
    }

    /// Where a bone rests in its parent.
    pub(super) fn rest(&self, bone: usize, scale: f64) -> Placement {
        let parent = if bone == HEAD { Point3::origin() } else { self.places[HEAD] };
        Placement { translation: (self.places[bone] - parent) * scale, ..Placement::default() }
    }
}

/// Per vertex how far a muscle moves it, as a share of the farthest one.
fn carried(body: &Body, muscle: &str) -> Vec<f64> {
    let weights: Vec<f64> = MUSCLES.iter().map(|name| f64::from(u8::from(*name == muscle))).collect();
    let lengths: Vec<f64> =
        displacements(body, &body.large_scale(&weights)).iter().map(|way| way.norm()).collect();
    let most = lengths.iter().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    lengths.into_iter().map(|length| length / most).collect()
}

fn influences(body: &Body) -> Vec<Vec<(usize, f64)>> {
    let jaw = carried(body, "jaw_open");
    let lids: Vec<(&str, Vec<f64>)> =
        ["blink_l", "blink_r"].into_iter().map(|muscle| (muscle, carried(body, muscle))).collect();
    let vertex = |vertex: usize| {
        let at = body.domain[vertex];
        let hold = |region: Region| match region {
            Region::Upper => 1.0 - jaw[vertex],
            Region::Lower => jaw[vertex],
            Region::Lid(muscle) => lids.iter().find(|lid| lid.0 == muscle).map_or(0.0, |lid| lid.1[vertex]),
        };
        let mut pulls = vec![(HEAD, HEAD_PULL * (1.0 - jaw[vertex])), (JAW, 0.6 * jaw[vertex])];
        for (number, (_, [s, t], reach, region)) in ON_SKIN.iter().enumerate() {
            let distance = (at - Point2::new(*s, *t)).norm() / reach;
            pulls.push((number + 2, hold(*region) * (-0.5 * distance * distance).exp()));
        }
        strongest(pulls)
    };
    (0..body.domain.len()).map(vertex).collect()
}

/// The strongest pulls as weights of sum 1, by rising bone.
fn strongest(mut pulls: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    let all: f64 = pulls.iter().map(|pull| pull.1).sum();
    pulls.retain(|pull| pull.1 > LEAST * all);
    pulls.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    pulls.truncate(MOST);
    let sum: f64 = pulls.iter().map(|pull| pull.1).sum();
    pulls.iter_mut().for_each(|pull| pull.1 /= sum);
    pulls.sort_by_key(|pull| pull.0);
    pulls
}
