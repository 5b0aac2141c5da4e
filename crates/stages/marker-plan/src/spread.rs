//! The rest of the markers: as even as the metric allows.

use crate::geodesic::Marching;
use crate::skin::Skin;
use crate::symmetry::{mirrored, nearest};
use crate::{Frame, Params};
use nalgebra::{Point3, Vector3};

/// Rounds of evening out.
const ROUNDS: usize = 10;
/// A marker nearer to the mirror plane than this share of the local spacing stands on it, …
const MIDDLE_SHARE: f64 = 0.35;
/// … if the line is there at least this share as far from all others.
const FREE_SHARE: f64 = 0.7;

/// A marker that is not yet named.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Spot {
    pub(crate) vertex: u32,
    /// Index of its mirror image; its own in the middle; none where the face is not symmetric.
    pub(crate) mirror: Option<usize>,
    /// Whether it stays where it is.
    pub(crate) fixed: bool,
}

/// Places markers on open skin.
pub(crate) struct Spread<'a> {
    pub(crate) points: &'a [Point3<f64>],
    pub(crate) triangles: &'a [[u32; 3]],
    /// Length of a millimetre in the metric, per vertex.
    pub(crate) density: &'a [f64],
    /// Area per vertex, mm².
    pub(crate) areas: &'a [f64],
    pub(crate) frame: &'a Frame,
    pub(crate) skin: &'a Skin,
    pub(crate) params: &'a Params,
    /// Open vertices next to the mirror plane.
    pub(crate) middle: Vec<u32>,
}

impl Spread<'_> {
    /// Adds farthest points to `spots`, in mirrored pairs, until there are `count` or no room is left [EldarLindenbaum1997], then
    /// evens them out by Lloyd's iteration.
    pub(crate) fn fill(&self, spots: &mut Vec<Spot>, count: usize) {
        let marching = Marching::new(self.points, self.triangles, self.density);
        let mut distance = vec![f64::INFINITY; self.points.len()];
        let mut owner = vec![0; self.points.len()];
        let sources: Vec<(u32, u32)> = spots.iter().map(|spot| (spot.vertex, 0)).collect();
        match sources.is_empty() {
            true => self.begin(&mut distance),
            false => marching.spread(&sources, &mut distance, &mut owner),
        }
        while spots.len() < count {
            let Some(next) = self.farthest(spots, &distance, count) else { break };
            let added = self.with_mirror(next, &distance, spots.len(), count);
            let sources: Vec<(u32, u32)> = added.iter().map(|spot| (spot.vertex, 0)).collect();
            marching.spread(&sources, &mut distance, &mut owner);
            spots.extend(added);
        }
        for _ in 0..ROUNDS {
            self.relax(&marching, spots);
        }
    }

    /// Without any feature, the first marker goes next to the middle of the face.
    fn begin(&self, distance: &mut [f64]) {
        for &vertex in &self.skin.open {
            distance[vertex as usize] = 1e6 - self.frame.place(&self.points[vertex as usize]).norm();
        }
    }

    /// The open vertex that is farthest from all spots, and far enough; for the very last one, on the middle line if the face is
    /// symmetric.
    fn farthest(&self, spots: &[Spot], distance: &[f64], count: usize) -> Option<u32> {
        let free = |vertex: &&u32| self.has_room(**vertex, spots.iter().map(|spot| spot.vertex));
        let finite = |vertex: &&u32| distance[**vertex as usize].is_finite();
        let best = |among: &[u32]| -> Option<u32> {
            let mut order: Vec<u32> = among.iter().filter(finite).copied().collect();
            order.sort_by(|&a, &b| distance[b as usize].total_cmp(&distance[a as usize]).then(a.cmp(&b)));
            order.iter().find(free).copied()
        };
        let on_middle = if spots.len() + 1 == count { best(&self.middle) } else { None };
        on_middle.or_else(|| best(&self.skin.open))
    }

    fn has_room(&self, vertex: u32, mut others: impl Iterator<Item = u32>) -> bool {
        let at = |vertex: u32| self.points[vertex as usize];
        others.all(|other| (at(other) - at(vertex)).norm() >= self.params.least_distance_mm)
    }

    fn place(&self, vertex: u32) -> Vector3<f64> {
        self.frame.place(&self.points[vertex as usize])
    }

    /// A spot and its mirror image, or one on the middle line.
    fn with_mirror(&self, vertex: u32, distance: &[f64], first: usize, count: usize) -> Vec<Spot> {
        let place = self.place(vertex);
        let spacing = distance[vertex as usize] / self.density[vertex as usize];
        let on_plane = Vector3::new(0.0, place.y, place.z);
        let middle = nearest(self.points, &self.middle, self.frame, on_plane).map(|(middle, _)| middle);
        // A place on the line must itself be far from all others, or one after the other would crowd there.
        let is_free = |middle: &u32| distance[*middle as usize] >= FREE_SHARE * distance[vertex as usize];
        if let Some(middle) = middle.filter(is_free)
            && place.x.abs() < MIDDLE_SHARE * spacing.min(1e3)
        {
            return vec![Spot { vertex: middle, mirror: Some(first), fixed: false }];
        }
        match self.partner(vertex) {
            Some(partner) if first + 2 <= count && self.has_room(partner, std::iter::once(vertex)) => vec![
                Spot { vertex, mirror: Some(first + 1), fixed: false },
                Spot { vertex: partner, mirror: Some(first), fixed: false },
            ],
            _ => vec![Spot { vertex, mirror: None, fixed: false }],
        }
    }

    /// The open vertex at the mirror image, if the face is symmetric there.
    pub(crate) fn partner(&self, vertex: u32) -> Option<u32> {
        let image = mirrored(self.place(vertex));
        let (partner, apart) = nearest(self.points, &self.skin.open, self.frame, image)?;
        (apart <= self.params.asymmetry_mm && partner != vertex).then_some(partner)
    }

    /// Moves every free spot to the middle of the skin that is nearest to it.
    fn relax(&self, marching: &Marching<'_>, spots: &mut [Spot]) {
        let mut distance = vec![f64::INFINITY; self.points.len()];
        let mut owner = vec![u32::MAX; self.points.len()];
        let sources: Vec<(u32, u32)> =
            spots.iter().enumerate().map(|(i, spot)| (spot.vertex, i as u32)).collect();
        marching.spread(&sources, &mut distance, &mut owner);
        let mut sums = vec![(Vector3::zeros(), 0.0); spots.len()];
        for &vertex in &self.skin.open {
            let at = vertex as usize;
            if let Some((sum, weight)) = sums.get_mut(owner[at] as usize) {
                let mass = self.areas[at] * self.density[at].powi(2);
                *sum += mass * self.place(vertex);
                *weight += mass;
            }
        }
        let middles: Vec<Option<Vector3<f64>>> =
            sums.into_iter().map(|(sum, weight)| (weight > 0.0).then(|| sum / weight)).collect();
        for i in 0..spots.len() {
            if let (false, Some(middle)) = (spots[i].fixed, middles[i]) {
                self.settle(spots, i, middle, &middles);
            }
        }
    }

    /// Moves a spot, and its partner with it, next to a place, if there is room.
    fn settle(
        &self,
        spots: &mut [Spot],
        spot: usize,
        middle: Vector3<f64>,
        middles: &[Option<Vector3<f64>>],
    ) {
        let move_to = |spots: &mut [Spot], which: usize, vertex: u32| {
            let others =
                spots.iter().enumerate().filter(|(other, _)| *other != which).map(|(_, spot)| spot.vertex);
            let room = self.has_room(vertex, others);
            if room {
                spots[which].vertex = vertex;
            }
            room
        };
        match spots[spot].mirror {
            Some(own) if own == spot => {
                let on_plane = Vector3::new(0.0, middle.y, middle.z);
                if let Some((vertex, _)) = nearest(self.points, &self.middle, self.frame, on_plane) {
                    move_to(spots, spot, vertex);
                }
            }
            Some(partner) if partner < spot => {}
            Some(partner) => {
                let both = middles[partner].map_or(middle, |other| 0.5 * (middle + mirrored(other)));
                let before = spots[spot].vertex;
                if let Some((vertex, _)) = nearest(self.points, &self.skin.open, self.frame, both)
                    && let Some(image) = self.partner(vertex)
                    && move_to(spots, spot, vertex)
                    && !move_to(spots, partner, image)
                {
                    spots[spot].vertex = before;
                }
            }
            None => {
                if let Some((vertex, _)) = nearest(self.points, &self.skin.open, self.frame, middle) {
                    move_to(spots, spot, vertex);
                }
            }
        }
    }
}
