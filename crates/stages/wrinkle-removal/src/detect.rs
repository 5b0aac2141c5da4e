//! Wrinkles found by their curvature.

use crate::calculus::{System, with_diagonal};
use crate::patch::distances;
use crate::{DEFAULT_REACH, Error};
use mesh::{Connectivity, Mesh};
use nalgebra::{Matrix3, Point3, Vector3};
use operators::{Ordering, cotan_stiffness, lumped_mass};
use serde::Serialize;
use std::f64::consts::TAU;

/// What counts as a wrinkle.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Detection {
    /// Width w of the wrinkles, mm; curvature is looked at on the surface smoothed at the wavelength 2 w.
    pub width_mm: f64,
    /// Least curvature across a valley, 1/mm, at its strongest place …
    pub curvature_per_mm: f64,
    /// … and the share of it with which a wrinkle goes on.
    pub hysteresis: f64,
    /// Shorter finds are no wrinkles, mm.
    pub length_mm: f64,
    /// How far the region reaches to both sides, in widths.
    pub reach: f64,
}

impl Default for Detection {
    fn default() -> Self {
        Self { width_mm: 1.5, curvature_per_mm: 0.12, hysteresis: 0.5, length_mm: 8.0, reach: DEFAULT_REACH }
    }
}

impl Detection {
    fn check(&self) -> Result<(), Error> {
        let rows = [
            ("width in mm", self.width_mm),
            ("curvature in 1/mm", self.curvature_per_mm),
            ("share of hysteresis", self.hysteresis),
            ("length in mm", self.length_mm),
            ("reach in widths", self.reach),
        ];
        match rows.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
            Some((name, value)) => Err(Error::Parameter { name, value, range: "a positive number" }),
            None => Ok(()),
        }
    }
}

/// Weights of a detected region, 1 in it and 0 outside, among the vertices with `within` > 0 (none: all).
///
/// A valley bends inwards across, and hardly along: its strength is −κ₁ − |κ₂| of the surface smoothed at the scale of wrinkles,
/// with the principal curvatures of the gradient of its normals [Rusinkiewicz2004]. Strong places grow along weaker ones
/// (hysteresis [Canny1986]), short finds go, and the region reaches over their sides. Lids, lips and the wings of the nose are
/// valleys as well: look at the result, and say where to look.
///
/// # Errors
/// [`Error::Parameter`]; [`Error::EmptyRegion`] where nothing is found; [`Error::Factor`].
pub fn detect(mesh: &Mesh, within: Option<&[f64]>, detection: &Detection) -> Result<Vec<f64>, Error> {
    detection.check()?;
    let triangles = mesh.triangles();
    let strength = valley_strength(&mesh.positions, &triangles, detection.width_mm)?;
    let low = detection.hysteresis * detection.curvature_per_mm;
    let allowed = |vertex: u32| within.is_none_or(|weights| weights[vertex as usize] > 0.0);
    let weak = |vertex: u32| strength[vertex as usize] > low && allowed(vertex);
    let linked: Vec<[u32; 3]> = triangles.iter().filter(|t| t.iter().all(|&v| weak(v))).copied().collect();
    let (part, part_count) = Connectivity::of(mesh.positions.len(), &linked).components();
    let mut strongest = vec![0.0f64; part_count];
    let mut members: Vec<Vec<Point3<f64>>> = vec![Vec::new(); part_count];
    let used: Vec<bool> = {
        let mut used = vec![false; mesh.positions.len()];
        linked.iter().flatten().for_each(|&vertex| used[vertex as usize] = true);
        used
    };
    for vertex in (0..used.len()).filter(|&vertex| used[vertex]) {
        let part = part[vertex] as usize;
        strongest[part] = strongest[part].max(strength[vertex]);
        members[part].push(mesh.positions[vertex]);
    }
    let is_wrinkle = |part: usize| {
        let (low, high) = mesh::bounding_box(&members[part]);
        strongest[part] >= detection.curvature_per_mm && (high - low).norm() >= detection.length_mm
    };
    let start = (0..used.len()).map(|vertex| match used[vertex] && is_wrinkle(part[vertex] as usize) {
        true => 0.0,
        false => f64::INFINITY,
    });
    let reach = detection.reach * detection.width_mm;
    let reached = distances(&mesh.positions, &triangles, start.collect(), reach);
    let weights: Vec<f64> = (0..used.len() as u32)
        .map(|vertex| f64::from(u8::from(reached[vertex as usize] < reach && allowed(vertex))))
        .collect();
    match weights.iter().any(|&weight| weight > 0.0) {
        true => Ok(weights),
        false => Err(Error::EmptyRegion {
            why: "no valley is bent that much over that length; lower the curvature, or give the width of the wrinkles",
        }),
    }
}

/// Per vertex how much of a valley the surface is at a width, 1/mm.
fn valley_strength(points: &[Point3<f64>], triangles: &[[u32; 3]], width: f64) -> Result<Vec<f64>, Error> {
    let (stiffness, _) = cotan_stiffness(points, triangles, 1e4);
    let mass = lumped_mass(points, triangles);
    let system = with_diagonal(&stiffness, (2.0 * width / TAU).powi(2), &mass);
    let system = System::whole(&system, &Ordering::nested_dissection(&stiffness, points))?;
    let smooth: Vec<Point3<f64>> = system
        .solve(|vertex| (mass[vertex] * points[vertex].coords).into())
        .into_iter()
        .map(Point3::from)
        .collect();
    let normals = mesh::vertex_normals(&smooth, triangles);
    let mut operators = vec![Matrix3::zeros(); points.len()];
    let mut areas = vec![0.0; points.len()];
    for &triangle in triangles {
        let Some((gradient, area)) = normal_gradient(&smooth, &normals, triangle) else { continue };
        for vertex in triangle {
            operators[vertex as usize] += area * gradient;
            areas[vertex as usize] += area;
        }
    }
    let strength = |((operator, area), normal): ((Matrix3<f64>, f64), &Vector3<f64>)| match area > 0.0 {
        true => valley(&(operator / area), normal),
        false => 0.0,
    };
    Ok(operators.into_iter().zip(areas).zip(&normals).map(strength).collect())
}

/// The symmetric gradient of the normals over a triangle, 1/mm, positive where the surface is convex; and the triangle's area.
fn normal_gradient(
    points: &[Point3<f64>],
    normals: &[Vector3<f64>],
    triangle: [u32; 3],
) -> Option<(Matrix3<f64>, f64)> {
    let p = triangle.map(|vertex| points[vertex as usize]);
    let double = (p[1] - p[0]).cross(&(p[2] - p[0]));
    let square = double.norm_squared();
    if square <= 0.0 {
        return None;
    }
    let hat = |i: usize| double.cross(&(p[(i + 2) % 3] - p[(i + 1) % 3])) / square;
    let gradient: Matrix3<f64> = (0..3).map(|i| normals[triangle[i] as usize] * hat(i).transpose()).sum();
    Some((0.5 * (gradient + gradient.transpose()), 0.5 * square.sqrt()))
}

/// −κ₁ − |κ₂| of a shape operator in the tangent plane.
fn valley(operator: &Matrix3<f64>, normal: &Vector3<f64>) -> f64 {
    let one = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
    let other = normal.cross(&one);
    let (a, b, c) =
        (one.dot(&(operator * one)), one.dot(&(operator * other)), other.dot(&(operator * other)));
    let (middle, spread) = (0.5 * (a + c), (0.25 * (a - c).powi(2) + b * b).sqrt());
    -(middle - spread) - (middle + spread).abs()
}
