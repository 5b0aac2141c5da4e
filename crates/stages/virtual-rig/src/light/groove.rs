//! A long straight groove, whose light at the bottom is known: the outside check of the ray tracing.
//!
//! The profile is S(p) = d (|p|/w − 1) e^(−|p|/w). At its bottom each wall's own horizon is its tangent, and the other
//! wall's horizon is that wall's tangent, so that by symmetry the light on either wall tends to the same value there. The
//! smooth normal of the crease would give another, larger one: its root.
//!
//! Largest error of the traced light at d/w from 0.1 to 1: with 512 rays 0.6 % along x, 1.5 % over grooves turned in
//! space (at d/w = 1, where a fifth of the sky is left); with 8192 rays 0.25 % whichever way the groove runs.

use super::{Ambient, Plan, Scene, Surface, shade};
use mesh::vertex_normals;
use nalgebra::Point3;

/// A groove of w = 1 mm along x, on a mesh that is finest around the origin, where its bottom is.
#[derive(Debug, Clone)]
pub struct Groove {
    /// Vertices, mm; y lies across, z up.
    pub positions: Vec<Point3<f64>>,
    /// Triangles that look up.
    pub triangles: Vec<[u32; 3]>,
    /// The vertex on the crease, half-way along.
    pub bottom: u32,
}

/// Steps from the middle outwards: across, along.
const STEPS: [usize; 2] = [140, 40];
/// The same as lengths, mm. A groove seen from the inside over a length L lacks (d/L)² of its walls.
const REACH: [f64; 2] = [12.0, 200.0];
/// First step as a part of the reach. The crease's slope comes out too small by ¾ of the first step across, in mm.
const FIRST: [f64; 2] = [2e-5, 2e-4];

impl Groove {
    /// The groove of depth d/w = `ratio`.
    #[must_use]
    pub fn new(ratio: f64) -> Self {
        let [across, along] = [0, 1].map(|axis| graded(STEPS[axis], REACH[axis], FIRST[axis]));
        let profile = |p: f64| ratio * (p.abs() - 1.0) * (-p.abs()).exp();
        let positions =
            along.iter().flat_map(|&x| across.iter().map(move |&p| Point3::new(x, p, profile(p)))).collect();
        let width = across.len() as u32;
        let corner = |row: u32, column: u32| row * width + column;
        let triangles = (0..along.len() as u32 - 1)
            .flat_map(|row| (0..width - 1).map(move |column| (row, column)))
            .flat_map(|(row, column)| {
                let [a, b] = [corner(row, column), corner(row + 1, column)];
                [[a, b, b + 1], [a, b + 1, a + 1]]
            })
            .collect();
        Self { positions, triangles, bottom: corner(STEPS[1] as u32, STEPS[0] as u32) }
    }

    /// The light at the bottom, over π, as [`shade`] traces it.
    #[must_use]
    pub fn bottom_light(&self, rays: u32) -> f64 {
        let normals = vertex_normals(&self.positions, &self.triangles);
        let surface = Surface { positions: &self.positions, normals: &normals, triangles: &self.triangles };
        let scene = Scene::build(&self.positions, &self.triangles, &[]);
        let full: Vec<bool> = (0..self.positions.len() as u32).map(|vertex| vertex == self.bottom).collect();
        let plan = Plan::new(&full, &self.triangles).with_baked(vec![[0.0; 3]; full.len()]);
        // The bottom lies in the middle of the scene, where single precision is far finer than elsewhere.
        let ambient = Ambient { rays, epsilon_mm: 1e-7, crease_deg: 2.0, ..Ambient::default() };
        f64::from(shade(&scene, &surface, &plan, &[], &ambient)[self.bottom as usize][0])
    }
}

/// Per depth d/w, the light at the groove's bottom, over π, traced with `rays` over the hemisphere.
#[must_use]
pub fn groove_table(ratios: &[f64], rays: u32) -> Vec<(f64, f64)> {
    ratios.iter().map(|&ratio| (ratio, Groove::new(ratio).bottom_light(rays))).collect()
}

/// Places from −`reach` to `reach`, `steps` on each side, growing from `first` · `reach` outwards by a fixed factor.
fn graded(steps: usize, reach: f64, first: f64) -> Vec<f64> {
    let total = |factor: f64| (factor.powi(steps as i32) - 1.0) / (factor - 1.0);
    let (mut low, mut high) = (1.0 + 1e-9, 4.0);
    for _ in 0..200 {
        let middle = (low + high) / 2.0;
        if total(middle) * first > 1.0 { high = middle } else { low = middle }
    }
    let side: Vec<f64> = (1..=steps)
        .map(|step| reach * (low.powi(step as i32) - 1.0) / (low.powi(steps as i32) - 1.0))
        .collect();
    side.iter().rev().map(|place| -place).chain([0.0]).chain(side.iter().copied()).collect()
}
