//! Light on every vertex of a frame: close looks where wrinkles are painted, glances elsewhere.

use super::ambient::under_sky;
use super::interreflection;
use super::sweep::Receiver;
use super::{Ambient, Scene};
use mesh::Connectivity;
use nalgebra::{Point3, Vector3};

/// The surface that light falls on. One normal (smooth, unit length) per position (mm).
#[derive(Debug, Clone, Copy)]
pub struct Surface<'a> {
    /// Where vertices are, mm.
    pub positions: &'a [Point3<f64>],
    /// Their smooth normals.
    pub normals: &'a [Vector3<f64>],
    /// The triangles, the first of the scene's.
    pub triangles: &'a [[u32; 3]],
}

/// Which vertices are looked at closely, and what is known of the others.
#[derive(Debug, Clone)]
pub struct Plan {
    full: Vec<u32>,
    /// The others, unless they are baked.
    cheap: Vec<u32>,
    baked: Option<Vec<[f32; 3]>>,
    /// Per vertex its triangles: those in `fans[starts[v]..starts[v + 1]]`.
    starts: Vec<u32>,
    fans: Vec<u32>,
    rings: (Vec<usize>, Vec<u32>),
}

impl Plan {
    /// A close look at the vertices of `full` (one flag per vertex), a glance at the others in every frame.
    #[must_use]
    pub fn new(full: &[bool], triangles: &[[u32; 3]]) -> Self {
        let (starts, fans) = fans(full.len(), triangles);
        let vertices =
            |wanted: bool| (0..full.len() as u32).filter(|&v| full[v as usize] == wanted).collect();
        let rings = Connectivity::of(full.len(), triangles).one_rings();
        Self { full: vertices(true), cheap: vertices(false), baked: None, starts, fans, rings }
    }

    /// The same, but with the light of the other vertices taken from `baked` (one value per vertex: what [`shade`] made
    /// of them once, at rest), so that a frame casts rays from the vertices of the close look only.
    #[must_use]
    pub fn with_baked(mut self, baked: Vec<[f32; 3]>) -> Self {
        self.cheap.clear();
        self.baked = Some(baked);
        self
    }

    /// Light from the sky and from the surroundings; what is baked holds both.
    pub(super) fn sum(&self, sky: &[[f32; 3]], thrown: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let mut light = sky.to_vec();
        for &vertex in self.full.iter().chain(&self.cheap) {
            let (light, thrown) = (&mut light[vertex as usize], &thrown[vertex as usize]);
            *light = [0, 1, 2].map(|channel| light[channel] + thrown[channel]);
        }
        light
    }
}

/// The light on every vertex, over π, linear RGB: [`super::irradiance`], and what the surface throws onto itself if
/// [`Ambient::interreflection`] asks for it. `albedo`: linear RGB reflectance, one per vertex; not looked at without
/// interreflection.
///
/// Vertices of the close look get [`Ambient::rays`]. Where the triangles around one differ by more than
/// [`Ambient::crease_deg`] it lies on a crease and has no normal: its light is the mean over its sides (weighted by their
/// angle), each with its own normal, which is what the light on each side tends to towards a symmetric crease. The smooth
/// normal would look straight out of a valley and see far more sky than either wall. Other vertices get
/// [`Ambient::cheap_rays`] and are smoothed, or are baked. Without [`Ambient::shadows`] the light is 1 everywhere.
#[must_use]
pub fn shade(
    scene: &Scene,
    surface: &Surface<'_>,
    plan: &Plan,
    albedo: &[[f32; 3]],
    ambient: &Ambient,
) -> Vec<[f32; 3]> {
    if !ambient.shadows {
        return vec![[1.0; 3]; surface.positions.len()];
    }
    let places = Places::new(scene, surface, plan, ambient);
    let direct = places.light(plan, ambient, |receivers, rays| {
        let light = under_sky(scene, receivers, ambient, rays);
        light.into_iter().map(|light| [light; 3]).collect()
    });
    match &ambient.interreflection {
        Some(light) => {
            interreflection::bounce(scene, surface, plan, &places, direct, albedo, ambient, light.bounces)
        }
        None => direct,
    }
}

/// Where a frame's rays start.
pub(super) struct Places {
    close: Vec<Receiver>,
    /// Per vertex of the close look, its share of receivers: their number, and each one's weight.
    sides: Vec<usize>,
    weights: Vec<f32>,
    glances: Vec<Receiver>,
}

impl Places {
    fn new(scene: &Scene, surface: &Surface<'_>, plan: &Plan, ambient: &Ambient) -> Self {
        let limit = ambient.crease_deg.to_radians().cos();
        let mut places = Self { close: vec![], sides: vec![], weights: vec![], glances: vec![] };
        let receiver = |vertex: u32, normal: &Vector3<f64>| {
            let lift = surface.normals[vertex as usize] * ambient.epsilon_mm;
            Receiver::new(scene, &surface.positions[vertex as usize], &lift, normal)
        };
        for &vertex in &plan.full {
            let sides = sides(surface, plan, vertex, limit);
            places.sides.push(sides.len());
            for (normal, weight) in sides {
                places.close.push(receiver(vertex, &normal));
                places.weights.push(weight as f32);
            }
        }
        places.glances = plan.cheap.iter().map(|&v| receiver(v, &surface.normals[v as usize])).collect();
        places
    }

    /// One value per vertex from one per receiver, as `cast` finds them with a number of rays.
    pub(super) fn light(
        &self,
        plan: &Plan,
        ambient: &Ambient,
        cast: impl Fn(&[Receiver], u32) -> Vec<[f32; 3]>,
    ) -> Vec<[f32; 3]> {
        let mut light = plan.baked.clone().unwrap_or_else(|| vec![[0.0; 3]; plan.starts.len() - 1]);
        let values = cast(&self.close, ambient.rays);
        let mut at = 0;
        for (&vertex, &sides) in plan.full.iter().zip(&self.sides) {
            let own = at..at + sides;
            at += sides;
            light[vertex as usize] = mean(own.map(|side| (values[side], self.weights[side])));
        }
        for (&vertex, value) in plan.cheap.iter().zip(cast(&self.glances, ambient.cheap_rays)) {
            light[vertex as usize] = value;
        }
        for _ in 0..ambient.smoothing {
            smooth(&mut light, plan);
        }
        light
    }
}

/// The cheap vertices' values averaged over their one-rings, themselves included.
fn smooth(light: &mut [[f32; 3]], plan: &Plan) {
    let (starts, neighbors) = &plan.rings;
    let smoothed: Vec<[f32; 3]> = plan
        .cheap
        .iter()
        .map(|&vertex| {
            let ring = &neighbors[starts[vertex as usize]..starts[vertex as usize + 1]];
            mean(ring.iter().chain([&vertex]).map(|&v| (light[v as usize], 1.0)))
        })
        .collect();
    for (&vertex, value) in plan.cheap.iter().zip(smoothed) {
        light[vertex as usize] = value;
    }
}

fn mean(values: impl Iterator<Item = ([f32; 3], f32)>) -> [f32; 3] {
    let (mut sum, mut all) = ([0.0; 3], 0.0);
    for (value, weight) in values {
        sum = std::array::from_fn(|channel| sum[channel] + weight * value[channel]);
        all += weight;
    }
    sum.map(|sum| if all > 0.0 { sum / all } else { 0.0 })
}

/// Normals that a vertex is lit with, and their weights: one, or one per side of a crease. `limit` is the cosine of the
/// angle between triangles from which on they are different sides.
fn sides(surface: &Surface<'_>, plan: &Plan, vertex: u32, limit: f64) -> Vec<(Vector3<f64>, f64)> {
    let fan = &plan.fans[plan.starts[vertex as usize] as usize..plan.starts[vertex as usize + 1] as usize];
    let mut facets: Vec<(Vector3<f64>, f64)> = Vec::with_capacity(fan.len());
    for &triangle in fan {
        let corners = surface.triangles[triangle as usize];
        let [a, b, c] = turned(corners, vertex).map(|v| surface.positions[v as usize]);
        if let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) {
            facets.push((normal, (b - a).angle(&(c - a))));
        }
    }
    let smooth = facets.iter().all(|(a, _)| facets.iter().all(|(b, _)| a.dot(b) >= limit));
    if smooth {
        return vec![(surface.normals[vertex as usize], 1.0)];
    }
    gathered(&facets, (limit.acos() / 2.0).cos())
}

/// Facets that lie within an angle (given by its cosine) of the first of their side, as one: mean normal, sum of angles.
fn gathered(facets: &[(Vector3<f64>, f64)], near: f64) -> Vec<(Vector3<f64>, f64)> {
    let mut sides: Vec<(Vector3<f64>, Vector3<f64>, f64)> = vec![];
    for &(normal, angle) in facets {
        match sides.iter_mut().find(|(first, ..)| first.dot(&normal) >= near) {
            Some((_, sum, all)) => {
                *sum += normal * angle;
                *all += angle;
            }
            None => sides.push((normal, normal * angle, angle)),
        }
    }
    sides.into_iter().map(|(_, sum, all)| (sum.normalize(), all)).collect()
}

/// A triangle's corners in their order, from `vertex` on.
fn turned([a, b, c]: [u32; 3], vertex: u32) -> [u32; 3] {
    match vertex {
        v if v == a => [a, b, c],
        v if v == b => [b, c, a],
        _ => [c, a, b],
    }
}

/// Per vertex its triangles: starts, and a list.
fn fans(vertex_count: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, Vec<u32>) {
    let mut starts = vec![0u32; vertex_count + 1];
    triangles.iter().flatten().for_each(|&vertex| starts[vertex as usize + 1] += 1);
    for vertex in 0..vertex_count {
        starts[vertex + 1] += starts[vertex];
    }
    let mut fill = starts.clone();
    let mut fans = vec![0u32; triangles.len() * 3];
    for (triangle, corners) in triangles.iter().enumerate() {
        for &vertex in corners {
            fans[fill[vertex as usize] as usize] = triangle as u32;
            fill[vertex as usize] += 1;
        }
    }
    (starts, fans)
}
