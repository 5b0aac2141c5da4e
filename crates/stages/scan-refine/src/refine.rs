//! The solve for positions.

use crate::bias::Averages;
use crate::surface::Surface;
use crate::{Error, Measured, Params};
use mesh::Mesh;
use nalgebra::{Point3, Vector3};
use operators::{CsMat, Factor, Ordering};
use serde::Serialize;
use sprs::TriMat;
use std::f64::consts::TAU;

/// A refined scan.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined {
    /// #V positions, mm.
    pub positions: Vec<Point3<f64>>,
    /// What was done.
    pub report: Report,
}

/// What a refinement did, in numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Share of the vertices with a measured normal.
    pub coverage: f64,
    /// Mean angle by which the normals were turned at large, degrees.
    pub bias_degrees: f64,
    /// Mean angle between measured (and turned) normals and those of the scan, degrees.
    pub before_degrees: f64,
    /// The same of the refined surface.
    pub after_degrees: f64,
    /// Root mean square of how far vertices moved, mm.
    pub moved_rms_mm: f64,
    /// The farthest, mm.
    pub moved_max_mm: f64,
    /// Triangles that face away from the measured normals of all their corners: the scan's noise along the surface has folded
    /// them.
    pub folded_triangles: usize,
}

/// Normals that are off by more in the mean belong to another mesh, degrees.
const STRANGE_DEGREES: f64 = 60.0;

/// Positions that agree best with a scan's positions at large and with measured normals in the small [Nehab2005].
///
/// Minimises `Σ A_i (s_i / ℓ)² + Σ_ij w_ij ((n_i + n_j)/2 · (x_j − x_i))²` over the vertices' ways s along their normals,
/// `x_i = p_i + s_i n_i`: A the vertices' areas, w the edges' cotangent weights times the lesser trust of their ends, and
/// `ℓ = Λ/2π` of [`Params::crossover_mm`]. With `λ = 1 / (1 + ℓ²)` this is `λ E_p + (1 − λ) E_n` of the paper. Two deviations:
/// a chord against the *mean* of its ends' normals is right on spheres of any size, against one of them only where the surface is
/// flat; and vertices do not slide, since normals say nothing about that: one unknown each instead of three.
///
/// Before it, normals are turned at large, see [`Params::bias_mm`]. Vertices without a normal keep their place, unless their
/// neighbours carry them along.
///
/// # Errors
/// [`Error`]: a parameter, another number of normals, normals of another mesh, a surface that is not a manifold.
pub fn refine(mesh: &Mesh, measured: &Measured, params: &Params) -> Result<Refined, Error> {
    params.check()?;
    let (count, vertex_count) = (measured.normals.len(), mesh.positions.len());
    if count != vertex_count {
        return Err(Error::Count { what: "normals", count, vertex_count });
    }
    let surface = Surface::of(mesh)?;
    let degrees = measured.mean_degrees(&mesh::vertex_normals(&mesh.positions, &surface.triangles));
    if degrees > STRANGE_DEGREES {
        return Err(Error::Disagree { degrees });
    }
    let averages = match params.bias_mm > 0.0 {
        true => Some(Averages::over(&mesh.positions, &surface, &measured.confidence, params.bias_mm)?),
        false => None,
    };
    let mut solver =
        Solver { scan: &mesh.positions, surface: &surface, confidence: &measured.confidence, ordering: None };
    let mut points = mesh.positions.clone();
    let mut turned = (measured.normals.clone(), 0.0);
    for _ in 0..params.iterations {
        let normals = mesh::vertex_normals(&points, &surface.triangles);
        if let Some(averages) = &averages {
            turned = averages.correct(&measured.normals, &points, &surface);
        }
        let directions = filled(&turned.0, &normals);
        points = solver.step(&points, &directions, params.crossover_mm / TAU)?;
    }
    let turned_measured = Measured { normals: turned.0, confidence: measured.confidence.clone() };
    let report = report(mesh, &points, &surface, &turned_measured, turned.1);
    Ok(Refined { positions: points, report })
}

/// A field of normals with the gaps filled from another.
fn filled(normals: &[Vector3<f64>], others: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let choose = |(normal, other): (&Vector3<f64>, &Vector3<f64>)| match normal.norm_squared() > 0.0 {
        true => *normal,
        false => *other,
    };
    normals.iter().zip(others).map(choose).collect()
}

struct Solver<'a> {
    /// Where the scanner saw the vertices, mm.
    scan: &'a [Point3<f64>],
    surface: &'a Surface,
    confidence: &'a [f64],
    ordering: Option<Ordering>,
}

impl Solver<'_> {
    /// One solve from `points` along `directions`; `length`: ℓ, mm.
    fn step(
        &mut self,
        points: &[Point3<f64>],
        directions: &[Vector3<f64>],
        length: f64,
    ) -> Result<Vec<Point3<f64>>, Error> {
        let count = points.len();
        let mut entries = TriMat::with_capacity((count, count), 4 * self.surface.edges.len() + count);
        let mut right = vec![0.0; count];
        for (vertex, &area) in self.surface.mass.iter().enumerate() {
            let pull = area / (length * length);
            entries.add_triplet(vertex, vertex, pull);
            right[vertex] -= pull * directions[vertex].dot(&(points[vertex] - self.scan[vertex]));
        }
        for &([i, j], weight) in &self.surface.edges {
            let (i, j) = (i as usize, j as usize);
            let weight = weight * self.confidence[i].min(self.confidence[j]);
            let normal = 0.5 * (directions[i] + directions[j]);
            let (a, b) = (-normal.dot(&directions[i]), normal.dot(&directions[j]));
            let off = normal.dot(&(points[j] - points[i]));
            entries.add_triplet(i, i, weight * a * a);
            entries.add_triplet(j, j, weight * b * b);
            entries.add_triplet(i, j, weight * a * b);
            entries.add_triplet(j, i, weight * a * b);
            right[i] -= weight * a * off;
            right[j] -= weight * b * off;
        }
        let way = self.solve(&entries.to_csr(), &right)?;
        Ok(points
            .iter()
            .zip(directions)
            .zip(way)
            .map(|((point, direction), way)| point + way * direction)
            .collect())
    }

    fn solve(&mut self, matrix: &CsMat<f64>, right: &[f64]) -> Result<Vec<f64>, Error> {
        let scan = self.scan;
        let ordering = self.ordering.get_or_insert_with(|| Ordering::nested_dissection(matrix, scan));
        let factor = Factor::new(matrix, ordering.vertices())?;
        let mut column: Vec<f64> = factor.order().iter().map(|&vertex| right[vertex as usize]).collect();
        factor.solve_in_place(&mut column, 1);
        let mut way = vec![0.0; right.len()];
        factor.order().iter().zip(&column).for_each(|(&vertex, &value)| way[vertex as usize] = value);
        Ok(way)
    }
}

fn report(
    mesh: &Mesh,
    points: &[Point3<f64>],
    surface: &Surface,
    measured: &Measured,
    bias_degrees: f64,
) -> Report {
    let squares: Vec<f64> = points.iter().zip(&mesh.positions).map(|(a, b)| (a - b).norm_squared()).collect();
    let degrees =
        |points: &[Point3<f64>]| measured.mean_degrees(&mesh::vertex_normals(points, &surface.triangles));
    Report {
        coverage: measured.coverage(),
        bias_degrees,
        before_degrees: degrees(&mesh.positions),
        after_degrees: degrees(points),
        moved_rms_mm: (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt(),
        moved_max_mm: squares.iter().copied().fold(0.0, f64::max).sqrt(),
        folded_triangles: folded(points, &surface.triangles, &measured.normals),
    }
}

fn folded(points: &[Point3<f64>], triangles: &[[u32; 3]], normals: &[Vector3<f64>]) -> usize {
    let is_folded = |triangle: &&[u32; 3]| {
        let [a, b, c] = triangle.map(|vertex| points[vertex as usize]);
        let facing = (b - a).cross(&(c - a));
        triangle.iter().all(|&vertex| facing.dot(&normals[vertex as usize]) < 0.0)
    };
    triangles.iter().filter(is_folded).count()
}
