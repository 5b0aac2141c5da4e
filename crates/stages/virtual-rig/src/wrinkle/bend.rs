//! One section at one pose: how deep it folds, and where its skin goes.

use crate::wrinkle::arc::{self, Length};
use crate::wrinkle::params::Params;
use crate::wrinkle::profile::Profile;
use crate::wrinkle::section::{self, Station, arc_lengths, fair, interpolate, locate};
use crate::wrinkle::smooth::smooth_step;
use nalgebra::{Point3, Vector3};

/// A section on the large-scale surface.
pub(super) struct Pose {
    /// Samples without fine relief.
    pub(super) points: Vec<Vector3<f64>>,
    /// Their normals; to be evened out along the line.
    pub(super) normals: Vec<Vector3<f64>>,
    /// Distances from the line along the large-scale surface, mm.
    q: Vec<f64>,
    /// How much skin was pressed together between the line and each sample, mm; stretching does not count.
    pressed: Vec<f64>,
    pub(super) budget: Budget,
}

/// What a fold has to take up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Budget {
    /// Length at rest less present length of the band, mm; negative where it is stretched.
    pub(super) lost: f64,
    /// Skin pressed together on side p < 0 and on side p > 0, mm.
    pub(super) pressed: [f64; 2],
}

/// A little pressure everywhere, so that shares of it are defined.
const LEAST_PRESSURE: f64 = 1e-4;
/// A profile with too little room fades from this share of it on.
const EARLIEST_FADE: f64 = 0.5;
/// About what a fold takes up, over the square of d/w and the width.
const CAPACITY: f64 = 1.1;
/// Less than this is rounding, mm.
const LEAST_WANTED: f64 = 1e-10;
/// A profile ends at this share of the room that it has, which leaves room for sides of different length.
const ROOM: f64 = 0.97;

impl Pose {
    pub(super) fn of(station: &Station, large_scale: &[Point3<f64>], step: f64) -> Self {
        let points = fair(&station.spots, large_scale, step);
        let normals = station.spots.iter().map(|spot| spot.normal(large_scale)).collect();
        let q = arc_lengths(&points, station.zero);
        let pressed = pressures(&station.p, &q, station.zero);
        let side = |sign: f64, side: usize| {
            let p = sign * station.sides[side].demand;
            (p.abs() - interpolate(&station.p, &q, p).abs(), interpolate(&station.p, &pressed, p).abs())
        };
        let (left, right) = (side(-1.0, 0), side(1.0, 1));
        let budget = Budget { lost: left.0 + right.0, pressed: [left.1, right.1] };
        Self { points, normals, q, pressed, budget }
    }
}

fn pressures(p: &[f64], q: &[f64], zero: usize) -> Vec<f64> {
    let between = |i: usize| {
        let rest = p[i + 1] - p[i];
        (rest - (q[i + 1] - q[i])).max(0.0) + LEAST_PRESSURE * rest
    };
    let mut sums = vec![0.0; p.len()];
    for i in zero + 1..p.len() {
        sums[i] = sums[i - 1] + between(i - 1);
    }
    for i in (0..zero).rev() {
        sums[i] = sums[i + 1] - between(i);
    }
    sums
}

/// A folded section.
pub(super) struct Bend {
    pub(super) pose: Pose,
    pub(super) profile: Profile,
    /// Band length at the pose over that at rest.
    pub(super) compression: f64,
    /// Length that the fold took up over what was to be taken up; 1 if there was nothing.
    pub(super) uptake: f64,
    fold: Option<Fold>,
}

/// Where the skin of a folded section goes.
struct Fold {
    /// How far the bottom has slid along the large-scale surface, mm.
    shift: f64,
    /// Arc length of the fold's sides.
    arcs: [arc::Side; 2],
    /// Skin that slides into each side, mm.
    gathered: [f64; 2],
    /// Pressed skin of each side at this station, mm.
    pressed: [f64; 2],
}

impl Bend {
    /// `budget`: the pose's, evened out along the line.
    pub(super) fn new(station: &Station, pose: Pose, budget: Budget, params: &Params) -> Self {
        let compression = 1.0 - budget.lost / station.band();
        let flat = Profile { shape: station.shape, w_mm: station.width, d_mm: 0.0, fade_mm: [[0.0, 1.0]; 2] };
        let mut bend = Self { pose, profile: flat, compression, uptake: 1.0, fold: None };
        match params.fixed {
            Some(fixed) => bend.press(station, fixed.d_over_w, params),
            None if budget.lost > 0.0 => bend.fold(station, budget, params),
            None => {}
        }
        bend
    }

    /// A given depth; the skin stays where it is along the surface.
    fn press(&mut self, station: &Station, d_over_w: f64, params: &Params) {
        self.set_width(station.width, self.ends(station, 0.0, 1.0), params);
        self.profile.d_mm = d_over_w * station.uptake * station.width;
    }

    fn fold(&mut self, station: &Station, budget: Budget, params: &Params) {
        let set_in = match params.onset > 0.0 {
            true => smooth_step((1.0 - self.compression) / params.onset),
            false => 1.0,
        };
        let left_share = budget.pressed[0] / (budget.pressed[0] + budget.pressed[1]);
        let lost = set_in * budget.lost;
        let capacity = CAPACITY * params.d_over_w_max.powi(2) * params.growth_max * station.width;
        let ends = self.ends(station, station.uptake * lost.min(capacity) * (left_share - 0.5), ROOM);
        let growth = 1.0 + (params.growth_max - 1.0) * smooth_step(lost / capacity);
        self.set_width(growth * station.width, ends, params);
        let Some((ratio, arcs)) = self.deepen(station, lost, params) else { return };
        self.profile.d_mm = ratio * self.profile.w_mm;
        let excess = [arcs[0].excess(), arcs[1].excess()];
        let taken: f64 = excess.iter().sum();
        self.uptake = taken / budget.lost;
        let [left, right] = self.rooms(station);
        let (low, high) = (ends[0] - left, right - ends[1]);
        let shift = (taken * left_share - excess[0]).min(high).max(low);
        let gathered = [excess[0] + shift, excess[1] - shift];
        self.fold = Some(Fold { shift, arcs, gathered, pressed: self.pressed(station) });
    }

    /// Depth in widths and arc lengths of a fold that takes up `lost` mm or as much as it can, and less towards the
    /// ends of its line; `None` for nothing.
    fn deepen(&mut self, station: &Station, lost: f64, params: &Params) -> Option<(f64, [arc::Side; 2])> {
        let length = Length::of(&station.outline, &self.profile);
        let most = length.excess(params.d_over_w_max).0;
        // Tapers even where there is more to take up than the fold can.
        let wanted = station.uptake * lost.min(most);
        (wanted > LEAST_WANTED).then(|| {
            let ratio = length.ratio(wanted, params.d_over_w_max);
            (ratio, length.tables(ratio))
        })
    }

    /// Sets width and fading of a profile that ends at `ends`. With the room it asks for, it fades over the
    /// last widths before its reach; with less, from nearer to the bottom, so that it does not end in a step.
    fn set_width(&mut self, width: f64, ends: [f64; 2], params: &Params) {
        let fading = |end: f64| {
            let missing = (params.reach * width - end).max(0.0);
            let from = (params.fade_from * width - 2.0 * missing).max(EARLIEST_FADE * end);
            [from.min(params.fade_from / params.reach * end), end]
        };
        self.profile.w_mm = width;
        self.profile.fade_mm = ends.map(fading);
    }

    /// Where the ends of a profile at rest lie on the large-scale surface, mm.
    fn rooms(&self, station: &Station) -> [f64; 2] {
        let room =
            |sign: f64, side: &section::Side| interpolate(&station.p, &self.pose.q, sign * side.end).abs();
        [room(-1.0, &station.sides[0]), room(1.0, &station.sides[1])]
    }

    /// Where a profile ends that stays within the band even when the bottom slides by `shift`.
    fn ends(&self, station: &Station, shift: f64, share: f64) -> [f64; 2] {
        let [left, right] = self.rooms(station);
        [(left + shift, station.sides[0]), (right - shift, station.sides[1])]
            .map(|(room, side)| side.end.min(share * room).max(0.05 * side.end))
    }

    fn pressed(&self, station: &Station) -> [f64; 2] {
        [(-1.0, 0), (1.0, 1)].map(|(sign, side)| {
            interpolate(&station.p, &self.pose.pressed, sign * station.sides[side].demand).abs()
        })
    }

    /// Whether nothing moves.
    pub(super) fn is_still(&self) -> bool {
        self.profile.d_mm == 0.0
    }

    /// Where the skin at p goes, relative to its place on the large-scale surface, mm; exactly zero beyond the band.
    pub(super) fn displacement(&self, station: &Station, p: f64) -> Vector3<f64> {
        let side = usize::from(p >= 0.0);
        let is_beyond = p.abs() >= station.sides[side].still_from();
        if self.is_still() || is_beyond || p < station.p[0] || p > station.p[station.p.len() - 1] {
            return Vector3::zeros();
        }
        let (k, share) = locate(&station.p, p);
        let mix = |values: &[f64]| values[k] + share * (values[k + 1] - values[k]);
        let q = mix(&self.pose.q);
        let Some(fold) = &self.fold else {
            return at(&self.pose.normals, k, share).normalize() * self.profile.height(q);
        };
        let demand = station.sides[side].demand;
        let pressed = if p.abs() < demand { mix(&self.pose.pressed).abs() } else { fold.pressed[side] };
        let arc = q.abs() + fold.gathered[side] * pressed / fold.pressed[side];
        let from_bottom = fold.arcs[side].distance(arc).copysign(p);
        let (j, part) = locate(&self.pose.q, from_bottom + fold.shift);
        at(&self.pose.points, j, part) - at(&self.pose.points, k, share)
            + at(&self.pose.normals, j, part).normalize() * self.profile.height(from_bottom)
    }

    /// The bottom's foot on the large-scale surface relative to the line's point there, and the normal at it.
    pub(super) fn foot(&self, station: &Station) -> (Vector3<f64>, Vector3<f64>) {
        let (j, part) = locate(&self.pose.q, self.fold.as_ref().map_or(0.0, |fold| fold.shift));
        let slid = at(&self.pose.points, j, part) - self.pose.points[station.zero];
        (slid, at(&self.pose.normals, j, part).normalize())
    }
}

fn at(values: &[Vector3<f64>], k: usize, share: f64) -> Vector3<f64> {
    match values.get(k + 1) {
        Some(next) => values[k] + (next - values[k]) * share,
        None => values[k],
    }
}
