//! The light that the samples of a pixel receive.

use super::exposure::Cover;
use super::lanes::{LANES, WIDE};
use super::params::{Film, Gloss};
use super::pattern::Pattern;
use super::scene::{Scene, Solid};
use super::tile::{Facet, NOTHING, Tile};
use crate::paint::{Layers, Spot};
use camera::Camera;
use nalgebra::{Unit, Vector3};
use rayon::prelude::*;

/// Backs of surfaces show this share of their light.
const BACK: f32 = 0.03;

/// Light from each vertex towards the camera, those of the face first.
pub(super) struct Palette<'a> {
    radiance: Vec<[f32; 3]>,
    /// Of the face's vertices: what paint on them reflects.
    irradiance: &'a [[f32; 3]],
    layers: &'a Layers,
    background: [f32; 3],
}

impl<'a> Palette<'a> {
    pub(super) fn of(scene: &Scene<'a>, camera: &Camera, film: &Film) -> Self {
        let mut radiance: Vec<[f32; 3]> =
            Vec::with_capacity(scene.solids().map(|solid| solid.moment.open.len()).sum());
        for solid in scene.solids() {
            let lights = solid.moment.irradiance.par_iter().with_min_len(8192);
            radiance.par_extend(
                lights.zip(solid.skin.albedo).map(|(light, albedo)| [0, 1, 2].map(|c| albedo[c] * light[c])),
            );
        }
        if let Some(gloss) = &film.gloss {
            add_gloss(gloss, &scene.face, camera, &mut radiance);
        }
        let irradiance = scene.face.moment.irradiance;
        Self { radiance, irradiance, layers: scene.layers, background: film.background }
    }
}

/// Adds what the skin mirrors, at the moment when the shutter opens.
fn add_gloss(gloss: &Gloss, face: &Solid<'_>, camera: &Camera, radiance: &mut [[f32; 3]]) {
    let eye = camera.eye_in_world();
    let key = Unit::new_normalize(Vector3::from(gloss.toward_key));
    let moment = &face.moment;
    let places = moment.open.par_iter().zip(moment.normals).zip(moment.irradiance);
    radiance.par_iter_mut().zip(places).with_min_len(4096).for_each(
        |(radiance, ((point, normal), light))| {
            let view = (eye - point).normalize();
            let half_way = (view + *key).normalize();
            let lobe = (normal.dot(&half_way).max(0.0) as f32).powf(gloss.exponent);
            let rim = (1.0 - normal.dot(&view).clamp(0.0, 1.0) as f32).powi(5);
            let shine = gloss.strength * lobe + gloss.rim * rim;
            add(radiance, *light, shine);
        },
    );
}

/// What a pixel received.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Light {
    pub(super) radiance: [f32; 3],
    /// Depth of the nearest of its central samples, mm.
    pub(super) depth_mm: f32,
}

/// A layer's share of a sample, and the sample's place in the pixel.
#[derive(Debug, Clone, Copy)]
struct Dab {
    layer: u32,
    share: f32,
    place: [f32; 2],
}

/// Shades the pixels of one tile.
pub(super) struct Shader<'a, const PARTS: usize> {
    palette: &'a Palette<'a>,
    tile: &'a Tile<PARTS>,
    /// Paint in the samples of the pixel.
    dabs: Vec<Dab>,
    /// Per layer: sum of the shares, and of shares times places, while they are added up; zero in between.
    sums: Vec<[f32; 3]>,
}

impl<'a, const PARTS: usize> Shader<'a, PARTS> {
    const SAMPLES: usize = WIDE * PARTS;

    pub(super) fn new(palette: &'a Palette<'a>, tile: &'a Tile<PARTS>) -> Self {
        Self { palette, tile, dabs: Vec::new(), sums: vec![[0.0; 3]; palette.layers.len()] }
    }

    /// The light of a pixel; `position` is its centre, px from the tile's middle.
    #[inline(always)]
    pub(super) fn pixel(&mut self, pixel: usize, position: [f32; 2]) -> Light {
        self.dabs.clear();
        let seen = &self.tile.seen[pixel];
        let nearness = &self.tile.nearness[pixel];
        let central = self.tile.pattern().central;
        let nearest = (0..LANES).fold(0.0f32, |nearest, time| {
            let sample = central[time];
            nearest.max(nearness[sample / WIDE][sample % WIDE])
        });
        let mut sum = [0.0; 3];
        let mut left = u64::MAX >> (64 - Self::SAMPLES);
        while left != 0 {
            let first = left.trailing_zeros() as usize;
            let number = seen[first / WIDE][first % WIDE];
            let group = same(seen, number);
            left &= !group;
            if number == NOTHING {
                add(&mut sum, self.palette.background, group.count_ones() as f32);
                continue;
            }
            self.group(&self.tile.facets[number as usize], group, position, &mut sum);
        }
        let share = 1.0 / Self::SAMPLES as f32;
        Light { radiance: sum.map(|x| x * share), depth_mm: 1.0 / nearest }
    }

    /// The layers on the pixel last shaded, lowest first; `pixel` is its number in the image.
    pub(super) fn covers(&mut self, pixel: u32, covers: &mut Vec<Cover>) {
        for dab in &self.dabs {
            add(&mut self.sums[dab.layer as usize], [1.0, dab.place[0], dab.place[1]], dab.share);
        }
        self.dabs.sort_unstable_by_key(|dab| dab.layer);
        self.dabs.dedup_by_key(|dab| dab.layer);
        for dab in self.dabs.drain(..) {
            let [sum, x, y] = std::mem::take(&mut self.sums[dab.layer as usize]);
            if sum > 0.0 {
                let share = sum / Self::SAMPLES as f32;
                covers.push(Cover { pixel, layer: dab.layer, share, offset_px: [x / sum, y / sum] });
            }
        }
    }

    /// Adds the light of the samples that see one triangle.
    #[inline(always)]
    fn group(&mut self, facet: &Facet, group: u64, position: [f32; 2], sum: &mut [f32; 3]) {
        let layers = self.palette.layers;
        if facet.of_face == NOTHING || layers.touching(facet.of_face).is_empty() {
            self.plain(facet, group, position, sum);
        } else {
            self.painted(facet, group, position, sum);
        }
    }

    /// Light without paint: what the surface gives in the samples' mean place.
    #[inline(always)]
    fn plain(&self, facet: &Facet, group: u64, position: [f32; 2], sum: &mut [f32; 3]) {
        let mut q = [0.0; 3];
        let mut light = 0.0;
        for (t, [count, x, y]) in gather(self.tile.pattern(), group).into_iter().enumerate() {
            let at = [count * (position[0] - facet.x[t]) + x, count * (position[1] - facet.y[t]) + y];
            let [second, third] = facet
                .slopes
                .map(|slope| if count > 0.0 { slope[0][t] * at[0] + slope[1][t] * at[1] } else { 0.0 });
            q[0] += (count - second - third) * facet.nearness[0][t];
            q[1] += second * facet.nearness[1][t];
            q[2] += third * facet.nearness[2][t];
            light += count * if facet.front[t] { 1.0 } else { BACK };
        }
        let scale = light / (q[0] + q[1] + q[2]);
        for (vertex, q) in facet.vertices.into_iter().zip(q) {
            add(sum, self.palette.radiance[vertex as usize], q * scale);
        }
    }

    /// Light with paint: sample by sample. How coordinates change per pixel is the first sample's: within a pixel, they
    /// change evenly.
    fn painted(&mut self, facet: &Facet, group: u64, position: [f32; 2], sum: &mut [f32; 3]) {
        let pattern = self.tile.pattern();
        let weights =
            |sample: usize| Weights::of(facet, shifted(position, pattern.place(sample)), sample % LANES);
        let first = group.trailing_zeros() as usize;
        let per_px = weights(first).per_px(facet, first % LANES);
        let mut left = group;
        while left != 0 {
            let sample = left.trailing_zeros() as usize;
            left &= left - 1;
            let light = self.paint(facet, &weights(sample), &per_px, pattern.place(sample));
            add(sum, light, if facet.front[sample % LANES] { 1.0 } else { BACK });
        }
    }

    /// The light of one painted sample; notes the layers' shares.
    fn paint(
        &mut self,
        facet: &Facet,
        weights: &Weights,
        per_px: &[[f32; 3]; 2],
        place: [f32; 2],
    ) -> [f32; 3] {
        let mut light = [0.0; 3];
        let mut irradiance = [0.0; 3];
        for (vertex, weight) in facet.vertices.into_iter().zip(weights.at) {
            add(&mut light, self.palette.radiance[vertex as usize], weight);
            add(&mut irradiance, self.palette.irradiance[vertex as usize], weight);
        }
        let ramp_px = self.tile.pattern().ramp_px;
        let first = self.dabs.len();
        for touch in self.palette.layers.touching(facet.of_face) {
            let spot = weights.spot(per_px, &touch.corners);
            let share = self.palette.layers.share(touch.layer, &spot, ramp_px) as f32;
            if share == 0.0 {
                continue;
            }
            let paint = self.palette.layers.paint_at(touch.layer, spot.at);
            light = std::array::from_fn(|c| light[c] + share * (paint[c] * irradiance[c] - light[c]));
            self.dabs[first..].iter_mut().for_each(|below| below.share *= 1.0 - share);
            self.dabs.push(Dab { layer: touch.layer, share, place });
        }
        light
    }
}

/// The samples that see a triangle, as bits.
#[inline(always)]
fn same<const PARTS: usize>(seen: &[[u32; WIDE]; PARTS], number: u32) -> u64 {
    let mut group = 0;
    for (part, lanes) in seen.iter().enumerate() {
        for (lane, seen) in lanes.iter().enumerate() {
            group |= u64::from(*seen == number) << (WIDE * part + lane);
        }
    }
    group
}

/// Per time: how many samples of a group, and the sum of their places in the pixel.
#[inline(always)]
fn gather<const PARTS: usize>(pattern: &Pattern<PARTS>, group: u64) -> [[f32; 3]; LANES] {
    let mut sums = [[0.0; 3]; LANES];
    for sample in 0..WIDE * PARTS {
        let held = (group >> sample & 1) as f32;
        let [x, y] = pattern.place(sample);
        let sum = &mut sums[sample % LANES];
        sum[0] += held;
        sum[1] += held * x;
        sum[2] += held * y;
    }
    sums
}

#[inline(always)]
fn shifted(position: [f32; 2], by: [f32; 2]) -> [f32; 2] {
    [position[0] + by[0], position[1] + by[1]]
}

#[inline(always)]
fn add(sum: &mut [f32; 3], light: [f32; 3], weight: f32) {
    for channel in 0..3 {
        sum[channel] += weight * light[channel];
    }
}

/// Weights of a triangle's corners on the surface (perspective undone) at a place of the image.
struct Weights {
    at: [f32; 3],
    /// Perspective: what the weights are multiplied by at last.
    total: f32,
}

impl Weights {
    #[inline(always)]
    fn of(facet: &Facet, place: [f32; 2], t: usize) -> Self {
        let (x, y) = (place[0] - facet.x[t], place[1] - facet.y[t]);
        let slopes = facet.slopes.map(|slope| [slope[0][t], slope[1][t]]);
        let [second, third] = slopes.map(|slope| slope[0] * x + slope[1] * y);
        let nearness = facet.nearness.map(|lanes| lanes[t]);
        let q = [(1.0 - second - third) * nearness[0], second * nearness[1], third * nearness[2]];
        let total = 1.0 / (q[0] + q[1] + q[2]);
        Self { at: q.map(|q| q * total), total }
    }

    /// Their change per pixel along each axis.
    fn per_px(&self, facet: &Facet, t: usize) -> [[f32; 3]; 2] {
        let nearness = facet.nearness.map(|lanes| lanes[t]);
        [0, 1].map(|axis| {
            let [second, third] = facet.slopes.map(|slope| slope[axis][t]);
            let change = [-(second + third) * nearness[0], second * nearness[1], third * nearness[2]];
            let drift = change[0] + change[1] + change[2];
            std::array::from_fn(|corner| (change[corner] - self.at[corner] * drift) * self.total)
        })
    }

    /// The same place in a layer's coordinates.
    #[inline(always)]
    fn spot(&self, per_px: &[[f32; 3]; 2], corners: &[[f64; 2]; 3]) -> Spot {
        let mix = |weights: &[f32; 3]| {
            [0, 1].map(|axis| (0..3).map(|corner| f64::from(weights[corner]) * corners[corner][axis]).sum())
        };
        Spot { at: mix(&self.at), per_px: [mix(&per_px[0]), mix(&per_px[1])] }
    }
}
