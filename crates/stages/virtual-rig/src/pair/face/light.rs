//! The light on a face: sky, a flash, and what skin throws onto skin.

use super::params::FaceScenario;
use crate::light::{self, Ambient, Plan, Scene, Surface};
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// A skin to be lit.
pub(super) struct Lit<'a> {
    pub(super) positions: &'a [Point3<f64>],
    pub(super) normals: &'a [Vector3<f64>],
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) albedo: &'a [[f32; 3]],
    /// Per vertex whether it lies near a line: only there does skin face skin closely.
    pub(super) close: &'a [bool],
}

/// Directions in which a place looks for other skin.
const LOOKS: usize = 96;
/// Rays start this far above the skin, mm.
const LIFT_MM: f64 = 1e-3;

impl Lit<'_> {
    /// Linear RGB that arrives at each vertex; 1 on free skin that faces the camera. The camera looks along −z.
    pub(super) fn light(&self, scenario: &FaceScenario) -> Vec<[f32; 3]> {
        let scene = Scene::build(self.positions, self.triangles, &[]);
        let direct = self.direct(&scene, scenario);
        let mut light: Vec<[f32; 3]> = direct.iter().map(|light| [*light; 3]).collect();
        let seen = self.seen(&scene);
        for _ in 0..scenario.bounces {
            let next: Vec<[f32; 3]> = seen.par_iter().map(|seen| self.thrown(seen, &light)).collect();
            for (vertex, (light, thrown)) in light.iter_mut().zip(next).enumerate() {
                *light = thrown.map(|thrown| direct[vertex] + thrown);
            }
        }
        light
    }

    /// Light from the sky and the flash.
    fn direct(&self, scene: &Scene, scenario: &FaceScenario) -> Vec<f32> {
        let share = scenario.flash_share;
        let sky = (share < 1.0).then(|| self.sky(scene, scenario));
        let [x, y] = scenario.flash_tilt;
        let towards = Vector3::new(x, y, 1.0);
        let flash = |(point, normal): (&Point3<f64>, &Vector3<f64>)| {
            let cosine = normal.dot(&towards).max(0.0);
            let hidden = cosine > 0.0 && scene.occluded(&(point + normal * LIFT_MM), &towards, f64::INFINITY);
            if hidden { 0.0 } else { cosine }
        };
        let flash = |vertex: usize| match share > 0.0 {
            true => share * flash((&self.positions[vertex], &self.normals[vertex])),
            false => 0.0,
        };
        let all = |vertex: usize| {
            let sky = sky.as_ref().map_or(0.0, |sky| f64::from(sky[vertex][0]));
            ((1.0 - share) * sky + flash(vertex)) as f32
        };
        (0..self.positions.len()).into_par_iter().map(all).collect()
    }

    fn sky(&self, scene: &Scene, scenario: &FaceScenario) -> Vec<[f32; 3]> {
        let surface = Surface { positions: self.positions, normals: self.normals, triangles: self.triangles };
        let ambient =
            Ambient { rays: scenario.rays, cheap_rays: (scenario.rays / 8).max(16), ..Ambient::default() };
        light::shade(scene, &surface, &Plan::new(self.close, self.triangles), self.albedo, &ambient)
    }

    /// Per vertex near a line the triangles that it sees, and their shares.
    fn seen(&self, scene: &Scene) -> Vec<Vec<(u32, f32)>> {
        let directions = sphere(2 * LOOKS);
        let look = |vertex: usize| {
            if !self.close[vertex] {
                return Vec::new();
            }
            let normal = &self.normals[vertex];
            let from = self.positions[vertex] + normal * LIFT_MM;
            let ahead = directions.iter().map(|way| (way, way.dot(normal))).filter(|pair| pair.1 > 0.0);
            let total: f64 = ahead.clone().map(|pair| pair.1).sum();
            ahead
                .filter_map(|(way, cosine)| {
                    let hit = scene.hit(&from, way)?;
                    Some((hit.triangle, (cosine / total) as f32))
                })
                .collect()
        };
        (0..self.positions.len()).into_par_iter().map(look).collect()
    }

    /// What the skin that a place sees sends there.
    fn thrown(&self, seen: &[(u32, f32)], light: &[[f32; 3]]) -> [f32; 3] {
        let mut sum = [0.0f32; 3];
        for (triangle, share) in seen {
            for vertex in self.triangles[*triangle as usize] {
                let (albedo, light) = (self.albedo[vertex as usize], light[vertex as usize]);
                (0..3).for_each(|channel| sum[channel] += share / 3.0 * albedo[channel] * light[channel]);
            }
        }
        sum
    }
}

/// Even directions over the sphere, on a spiral.
fn sphere(count: usize) -> Vec<Vector3<f64>> {
    const GOLDEN: f64 = 2.399_963_229_728_653;
    let direction = |index: usize| {
        let z = 1.0 - (2.0 * index as f64 + 1.0) / count as f64;
        let (s, c) = (GOLDEN * index as f64).sin_cos();
        let across = (1.0 - z * z).sqrt();
        Vector3::new(across * c, across * s, z)
    };
    (0..count).map(direction).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A valley with walls of a slope, 40 mm wide, along y.
    fn valley(slope: f64) -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
        let at = |i: u32, j: u32| {
            let x = f64::from(i) - 20.0;
            Point3::new(x, 20.0 * f64::from(j) - 200.0, slope * x.abs())
        };
        let points = (0..21).flat_map(|j| (0..41).map(move |i| at(i, j))).collect();
        let quad = |i: u32, j: u32| {
            let a = j * 41 + i;
            [[a, a + 1, a + 42], [a, a + 42, a + 41]]
        };
        (points, (0..20).flat_map(|j| (0..40).flat_map(move |i| quad(i, j))).collect())
    }

    fn light(slope: f64, flash_share: f64, bounces: u32) -> Vec<[f32; 3]> {
        let (positions, triangles) = valley(slope);
        let normals = mesh::vertex_normals(&positions, &triangles);
        let albedo = vec![[0.5, 0.25, 0.0]; positions.len()];
        let close = vec![true; positions.len()];
        let lit = Lit {
            positions: &positions,
            normals: &normals,
            triangles: &triangles,
            albedo: &albedo,
            close: &close,
        };
        lit.light(&FaceScenario { flash_share, bounces, rays: 512, ..FaceScenario::default() })
    }

    #[test]
    fn flat_skin_has_the_light_of_any_mixture() {
        for share in [0.0, 0.4, 1.0] {
            let light = light(0.0, share, 2);
            assert!(light.iter().flatten().all(|light| (light - 1.0).abs() < 2e-3), "{share}");
        }
    }

    #[test]
    fn walls_are_dimmer_and_throw_light_in_their_colour() {
        // Half-way up a wall of 45° under a flash: the cosine; the other wall fills half the view at most.
        let at = 10 * 41 + 30;
        let bare = light(1.0, 1.0, 0)[at];
        assert!((f64::from(bare[0]) - 0.5f64.sqrt()).abs() < 1e-3, "{bare:?}");
        let thrown = light(1.0, 1.0, 1)[at];
        let by = [0, 1, 2].map(|channel| thrown[channel] - bare[channel]);
        assert!(by[0] > 0.02 && by[0] < 0.2 && (by[1] - 0.5 * by[0]).abs() < 1e-4 && by[2] == 0.0, "{by:?}");
        // Under open sky the bottom sees half of it: E = ½ (1 + cos 90°).
        let sky = light(1.0, 0.0, 0)[10 * 41 + 21];
        assert!((sky[0] - 0.5).abs() < 0.2, "{sky:?}");
    }
}
