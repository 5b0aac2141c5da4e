//! What the valleys of a frame ask of the vertices: where they hold them, and which they let go.

use crate::Params;
use crate::crease::Creases;
use crate::curve::{Curve, Foot, nearest_from};
use crate::moment::Moment;
use crate::profile::{between, distance_of_arc, smooth_step};
use crate::reach::Beside;
use crate::surface::{NONE, Surface};
use artifact::ProfileShape;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Over this last share of its reach a valley's influence fades.
const FADE_SHARE: f64 = 0.35;
/// Normals are averaged over about this radius, mm.
const NORMAL_RADIUS_MM: f64 = 1.0;
/// Rounds of averaging, at most.
const MOST_ROUNDS: usize = 40;
/// Sides of a fold that touch keep so far, mm, from the plane between them; less where they are nearer at rest.
const CONTACT_GAP_MM: f64 = 0.05;
/// Skin as far as this from the crease, in widths of the valley, may close it.
const CONTACT_WIDTHS: f64 = 3.0;

/// What the valleys ask of one vertex.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Claim {
    pub(crate) vertex: u32,
    /// How firmly a valley holds it, 0 to 1.
    pub(crate) hold: f64,
    /// Where it is held.
    pub(crate) target: Point3<f64>,
    /// How far it is let go, 0 to 1.
    pub(crate) freedom: f64,
    /// The crease that lets it go farthest.
    pub(crate) crease: u32,
    /// What keeps it from going through the other side of the fold.
    pub(crate) opposite: Option<Opposite>,
}

/// A plane between both sides of a fold.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Opposite {
    pub(crate) point: Point3<f64>,
    /// Points to the vertex' own side.
    pub(crate) normal: Vector3<f64>,
    distance: f64,
}

/// A crease that is open in a frame.
pub(crate) struct Open<'a> {
    pub(crate) crease: u32,
    pub(crate) curve: &'a Curve,
    pub(crate) reach: &'a [Beside],
    pub(crate) sections: Vec<ProfileShape>,
}

impl<'a> Open<'a> {
    /// Crease number `crease` at a moment, if it is open.
    pub(crate) fn at(
        creases: &Creases,
        crease: usize,
        moment: &Moment,
        curve: &'a Curve,
        reach: &'a [Beside],
    ) -> Option<Self> {
        let sections = creases.all[crease].sections(moment)?;
        Some(Self { crease: crease as u32, curve, reach, sections })
    }
}

/// How far a crease reaches, mm.
pub(crate) fn reach_mm(widest_mm: f64, params: &Params) -> f64 {
    (params.influence_widths * widest_mm).min(params.influence_mm)
}

/// The claims of all open valleys on a frame, by rising vertex. `large`: #V, mm, the frame without wrinkles.
pub(crate) fn claims(surface: &Surface, large: &[Point3<f64>], open: &[Open], params: &Params) -> Vec<Claim> {
    let normals = smoothed_normals(surface, large, open);
    let mut place = vec![NONE; surface.rest.len()];
    let mut claims: Vec<Claim> = Vec::new();
    for valley in open {
        let line = valley.curve.on(surface, large);
        let wall = Wall { valley, line: &line, large, normals: &normals, params };
        let asked: Vec<Claim> = valley.reach.par_iter().map(|beside| wall.claim(beside)).collect();
        for (beside, claim) in valley.reach.iter().zip(asked) {
            if claim.hold <= 0.0 && claim.freedom <= 0.0 {
                continue;
            }
            match &mut place[beside.vertex as usize] {
                at if *at == NONE => {
                    *at = claims.len() as u32;
                    claims.push(claim);
                }
                at => merge(
                    &mut claims[*at as usize],
                    &claim,
                    &large[beside.vertex as usize],
                    &normals[beside.vertex as usize],
                ),
            }
        }
    }
    claims.sort_unstable_by_key(|claim| claim.vertex);
    claims
}

/// Of two valleys the deeper one decides where a vertex is held.
fn merge(first: &mut Claim, second: &Claim, large: &Point3<f64>, normal: &Vector3<f64>) {
    let height = |claim: &Claim| claim.hold * (claim.target - large).dot(normal);
    if height(second) < height(first) || first.hold == 0.0 {
        first.target = second.target;
    }
    first.hold = first.hold.max(second.hold);
    if second.freedom > first.freedom {
        (first.freedom, first.crease) = (second.freedom, second.crease);
    }
    let nearer = |second: &Opposite| first.opposite.is_none_or(|first| second.distance < first.distance);
    first.opposite = second.opposite.filter(nearer).or(first.opposite);
}

/// A valley in a frame.
struct Wall<'a> {
    valley: &'a Open<'a>,
    line: &'a [Point3<f64>],
    large: &'a [Point3<f64>],
    normals: &'a [Vector3<f64>],
    params: &'a Params,
}

impl Wall<'_> {
    fn claim(&self, beside: &Beside) -> Claim {
        let at = self.large[beside.vertex as usize];
        let foot = nearest_from(self.line, beside.foot.segment, &at);
        let section = foot.between(&self.valley.sections, between);
        let depth = smooth_step(section.d / self.params.fade_depth_mm);
        let edge = (1.0 - beside.foot.distance / reach_mm(section.w, self.params)) / FADE_SHARE;
        let mut claim = Claim {
            vertex: beside.vertex,
            hold: 0.0,
            target: at,
            freedom: depth * smooth_step(edge),
            crease: self.valley.crease,
            opposite: None,
        };
        if section.d <= 0.0 {
            return claim;
        }
        let side = 1f64.copysign(beside.across_mm);
        if self.params.self_contact && beside.foot.distance < CONTACT_WIDTHS * section.w {
            claim.opposite = self.opposite(beside, &foot, side);
        }
        // An arc is longer than its span by no more than it goes up and down: up the wall, over the bulge (at ũ = 2) and down.
        // Most vertices are farther out than that, and need no integral.
        let bulge = (section.epsilon - 2.0).exp() / (1.0 - section.epsilon);
        let least = beside.foot.distance - section.d * (1.0 + 2.0 * bulge);
        if foot.distance + self.params.slide * (least - foot.distance) >= section.side(side) {
            return claim;
        }
        let inextensible = distance_of_arc(&section, beside.foot.distance, side);
        let distance = foot.distance + self.params.slide * (inextensible - foot.distance);
        let rim = distance / section.side(side);
        if rim >= 1.0 {
            return claim;
        }
        let loose =
            ((rim - 1.0 + self.params.rim_share) / self.params.rim_share.max(f64::MIN_POSITIVE)).max(0.0);
        claim.hold = depth * (1.0 - smooth_step(loose));
        let normal = self.normals[beside.vertex as usize];
        let outwards = at - foot.point(self.line);
        let outwards = outwards - normal * normal.dot(&outwards);
        let slide =
            outwards.try_normalize(1e-9).map_or(Vector3::zeros(), |unit| unit * (distance - foot.distance));
        claim.target = at + slide + normal * section.at(side * distance).0;
        claim
    }
}

impl Wall<'_> {
    /// The plane through the crease that stands on the skin. Around the ends of a crease there is none.
    fn opposite(&self, beside: &Beside, foot: &Foot, side: f64) -> Option<Opposite> {
        let last = self.line.len() - 2;
        let around_an_end =
            (foot.segment == 0 && foot.share <= 0.0) || (foot.segment as usize == last && foot.share >= 1.0);
        let along = self.line[foot.segment as usize + 1] - self.line[foot.segment as usize];
        let normal = self.normals[beside.vertex as usize];
        let across = along.cross(&normal).try_normalize(1e-9).filter(|_| !around_an_end)? * side;
        let gap = CONTACT_GAP_MM.min(0.5 * beside.foot.distance);
        Some(Opposite {
            point: foot.point(self.line) + across * gap,
            normal: across,
            distance: beside.foot.distance,
        })
    }
}

/// Unit normals of the frame around the valleys, averaged over about a millimetre; zero elsewhere. #V.
fn smoothed_normals(surface: &Surface, large: &[Point3<f64>], open: &[Open]) -> Vec<Vector3<f64>> {
    let mut near = vec![false; large.len()];
    for valley in open {
        let widest = valley.sections.iter().map(|section| section.w).fold(0.0, f64::max);
        let close =
            valley.reach.iter().filter(|beside| beside.foot.distance < 2.0 * widest + 2.0 * NORMAL_RADIUS_MM);
        close.for_each(|beside| near[beside.vertex as usize] = true);
    }
    let band: Vec<u32> = (0..large.len() as u32).filter(|&vertex| near[vertex as usize]).collect();
    let mut normals = vec![Vector3::zeros(); large.len()];
    let mut area = 0.0;
    for &vertex in &band {
        for &triangle in surface.around(vertex) {
            let [a, b, c] = surface.triangles[triangle as usize].map(|corner| large[corner as usize]);
            normals[vertex as usize] += (b - a).cross(&(c - a));
        }
        area += surface.vertex_areas[vertex as usize];
    }
    let unit = |normal: &Vector3<f64>| normal.try_normalize(0.0).unwrap_or_else(Vector3::zeros);
    band.iter().for_each(|&vertex| normals[vertex as usize] = unit(&normals[vertex as usize]));
    // A round spreads a value over about 0.43 of the squared edge length, and an edge's square is 1.15 vertex areas.
    let spread = 0.5 * area / band.len().max(1) as f64;
    let rounds = ((NORMAL_RADIUS_MM * NORMAL_RADIUS_MM / spread).ceil() as usize).clamp(1, MOST_ROUNDS);
    for _ in 0..rounds {
        let averaged: Vec<Vector3<f64>> = band
            .iter()
            .map(|&vertex| {
                // Inner neighbours come twice; so does the vertex itself.
                let mut sum = 2.0 * normals[vertex as usize];
                surface.for_neighbors(vertex, |other| sum += normals[other as usize]);
                unit(&sum)
            })
            .collect();
        band.iter().zip(averaged).for_each(|(&vertex, normal)| normals[vertex as usize] = normal);
    }
    normals
}
