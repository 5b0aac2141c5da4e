//! The shell with soft openings: third order, solved on a proxy, prolonged to the scan.

use crate::prolongation::Prolongation;
use crate::{Basis, Completion, Constraints, Error, Proxy, Surface};
use mesh::distance_to_loops;
use nalgebra::{Point3, Vector3};
use operators::{Factor, Keep, Ordering, Variation};
use rayon::prelude::*;

/// Columns that are solved together; a fixed number, so that results do not depend on the threads.
const BLOCK: usize = 8;
/// Solves per column: the first, and refinements of it. The second of them changes nothing any more on sound meshes.
const SOLVES: usize = 3;

/// A shell that bends evenly and gives way around mouth and eyes.
///
/// The energy is `k_s dᵀ L d + k_t (M⁻¹ L d)ᵀ L_κ (M⁻¹ L d)`: instead of bending, its variation is penalised
/// [BotschKobbelt2004], and less so near the openings, `κ = 1 − s exp(−(δ/w)²)` at the distance δ from the nearest of them. Lips
/// and lids, which turn in much while little more than their rims is known, may then curl; skin far from them moves more evenly
/// than under bending. The figures behind the defaults stand in the README.
///
/// A third-order solve is exact enough only where edges are not much shorter than a millimetre
/// ([`operators::Variation`]), so a finer scan is solved for on a [`Proxy`]; all else is continued smoothly.
pub struct SoftShell {
    vertex_count: usize,
    /// Handles as vertices of the proxy, in their order.
    handles: Vec<u32>,
    energy: Variation,
    factor: Factor,
    proxy: Proxy,
    prolongation: Option<Prolongation>,
}

impl SoftShell {
    /// Builds and factors the shell. `ordering` is the surface's ([`Surface::ordering`]).
    ///
    /// # Errors
    /// [`Error::Factor`] where the constraints do not determine the surface, or memory is short.
    pub fn factor(surface: &Surface, constraints: &Constraints, ordering: &Ordering) -> Result<Self, Error> {
        let still: Vec<u32> = constraints.held.iter().chain(&surface.still).copied().collect();
        let keep = Keep { vertices: &constraints.handles, still: &still };
        let params = &surface.params;
        let spacing = spacing(surface, &constraints.handles);
        let proxy = Proxy::of(&surface.points, &surface.triangles, params.proxy_vertices, &spacing, keep);
        let points: Vec<Point3<f64>> =
            proxy.vertices.iter().map(|&vertex| surface.points[vertex as usize]).collect();
        let energy = energy(surface, &proxy, &points);
        let on_proxy = |vertices: &[u32]| -> Vec<u32> {
            let place = |vertex: &u32| proxy.vertices.binary_search(vertex).ok().map(|at| at as u32);
            vertices.iter().filter_map(place).collect()
        };
        let handles = on_proxy(&constraints.handles);
        let mut free = vec![true; points.len()];
        handles.iter().chain(&on_proxy(&still)).for_each(|&vertex| free[vertex as usize] = false);
        let matrix = energy.matrix();
        let order = Ordering::nested_dissection(&matrix, &points);
        let order: Vec<u32> =
            order.vertices().iter().copied().filter(|&vertex| free[vertex as usize]).collect();
        let factor = Factor::new(&matrix, &order)?;
        let whole = proxy.vertices.len() == surface.points.len();
        let prolongation = match whole {
            true => None,
            false => Some(Prolongation::new(surface, &proxy, &still, ordering)?),
        };
        Ok(Self { vertex_count: surface.points.len(), handles, energy, factor, proxy, prolongation })
    }

    /// Displacement of every vertex, mm, from those of all handles, mm.
    ///
    /// # Panics
    /// If there is not one displacement per handle.
    #[must_use]
    pub fn solve(&self, handles: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        assert_eq!(handles.len(), self.handles.len(), "one displacement per handle");
        let column = |axis: usize| handles.iter().map(|displacement| displacement[axis]).collect();
        let solved = self.on_scan(&self.on_proxy(&[column(0), column(1), column(2)]).fields);
        let (x, y, z) = (&solved[0], &solved[1], &solved[2]);
        x.iter().zip(y).zip(z).map(|((&x, &y), &z)| Vector3::new(x, y, z)).collect()
    }

    /// The responses of the surface to every handle, what completes frames with missing handles, and the largest change that
    /// the last refinement made to a response (1 at its handle): how far the solve can be trusted.
    #[must_use]
    pub fn basis(&self) -> (Basis, Completion, f64) {
        let count = self.handles.len();
        let mut values = vec![0f32; self.vertex_count * count];
        let keep = |start: usize, fields: &[Vec<f64>]| {
            for (column, field) in self.on_scan(fields).into_iter().enumerate() {
                let cells = values.iter_mut().skip(start + column).step_by(count);
                cells.zip(field).for_each(|(cell, value)| *cell = value as f32);
            }
        };
        let (completion, change) = self.responses(keep);
        (Basis::new(values, count), completion, change)
    }

    /// Only what completes frames with missing handles.
    #[must_use]
    pub fn completion(&self) -> Completion {
        self.responses(|_, _| {}).0
    }

    /// Stored entries of the factors, padding included; 8 bytes each.
    #[must_use]
    pub fn factor_entry_count(&self) -> usize {
        self.factor.stored_count() + self.prolongation.as_ref().map_or(0, Prolongation::stored_count)
    }

    /// Vertices that are solved for at third order.
    #[must_use]
    pub fn proxy(&self) -> &Proxy {
        &self.proxy
    }

    /// Solves for each handle alone, block after block, and hands the proxy's fields over with their first handle.
    fn responses(&self, mut keep: impl FnMut(usize, &[Vec<f64>])) -> (Completion, f64) {
        let count = self.handles.len();
        let starts: Vec<usize> = (0..count).step_by(BLOCK).collect();
        let solve = |&start: &usize| {
            let unit = |handle: usize| (0..count).map(|other| f64::from(u8::from(other == handle))).collect();
            let columns: Vec<Vec<f64>> = (start..(start + BLOCK).min(count)).map(unit).collect();
            let solved = self.on_proxy(&columns);
            let pull = |field: &Vec<f64>| -> Vec<f64> {
                let force = self.energy.apply(field);
                self.handles.iter().map(|&vertex| force[vertex as usize]).collect()
            };
            let schur: Vec<Vec<f64>> = solved.fields.iter().map(pull).collect();
            (solved, schur)
        };
        let mut schur = Vec::with_capacity(count);
        let mut change = 0f64;
        // A few blocks at a time: the f64 columns of all of them would not fit.
        for group in starts.chunks(rayon::current_num_threads()) {
            let blocks: Vec<_> = group.par_iter().map(solve).collect();
            for (&start, (solved, rows)) in group.iter().zip(blocks) {
                keep(start, &solved.fields);
                change = change.max(solved.change);
                schur.extend(rows);
            }
        }
        let mean = |row: usize, column: usize| 0.5 * (schur[row][column] + schur[column][row]);
        let symmetric: Vec<Vec<f64>> =
            (0..count).map(|row| (0..count).map(|column| mean(row, column)).collect()).collect();
        (Completion::new(&symmetric), change)
    }

    /// Minimises the energy on the proxy; per column n handle values.
    fn on_proxy(&self, prescribed: &[Vec<f64>]) -> Solved {
        let order = self.factor.order();
        let start = |values: &Vec<f64>| {
            let mut field = vec![0.0; self.proxy.vertices.len()];
            self.handles.iter().zip(values).for_each(|(&vertex, &value)| field[vertex as usize] = value);
            field
        };
        let mut fields: Vec<Vec<f64>> = prescribed.iter().map(start).collect();
        let mut change = 0f64;
        for _ in 0..SOLVES {
            let mut columns = Vec::with_capacity(order.len() * fields.len());
            for field in &fields {
                let force = self.energy.apply(field);
                columns.extend(order.iter().map(|&vertex| -force[vertex as usize]));
            }
            self.factor.solve_in_place(&mut columns, fields.len());
            change = columns.iter().fold(0.0, |largest: f64, step| largest.max(step.abs()));
            for (field, steps) in fields.iter_mut().zip(columns.chunks_exact(order.len())) {
                order.iter().zip(steps).for_each(|(&vertex, step)| field[vertex as usize] += step);
            }
        }
        Solved { fields, change }
    }

    fn on_scan(&self, coarse: &[Vec<f64>]) -> Vec<Vec<f64>> {
        match &self.prolongation {
            Some(prolongation) => prolongation.prolong(coarse),
            None => coarse.to_vec(),
        }
    }
}

/// Fields of the proxy.
struct Solved {
    fields: Vec<Vec<f64>>,
    /// Largest change in the last refinement.
    change: f64,
}

/// Distance from the nearest handle from which on the proxy becomes coarser, mm, …
const NEAR_MM: f64 = 25.0;
/// … in proportion, up to this multiple.
const COARSEST: f64 = 4.0;
/// At the rim of an opening, where the field turns most sharply, its edges are this share as long.
const FINEST: f64 = 0.5;

/// How long the proxy's edges should be at each vertex of the scan, in relation to the others.
fn spacing(surface: &Surface, handles: &[u32]) -> Vec<f64> {
    let handles: Vec<Point3<f64>> = handles.iter().map(|&vertex| surface.points[vertex as usize]).collect();
    let loops = surface.opening_points();
    let width = surface.params.softening_width_mm;
    let at = |point: &Point3<f64>| {
        let to_handle = handles.iter().map(|handle| (handle - point).norm()).fold(f64::INFINITY, f64::min);
        let to_rim = (distance_to_loops(&loops, point) / width).min(1.0);
        (to_handle / NEAR_MM).clamp(1.0, COARSEST) * (FINEST + (1.0 - FINEST) * to_rim)
    };
    surface.points.par_iter().map(at).collect()
}

/// The energy on the proxy, softened around the scan's openings.
fn energy(surface: &Surface, proxy: &Proxy, points: &[Point3<f64>]) -> Variation {
    let params = &surface.params;
    let loops = surface.opening_points();
    let stiffness: Vec<f64> = points
        .par_iter()
        .map(|point| {
            let share = distance_to_loops(&loops, point) / params.softening_width_mm;
            1.0 - params.softening * (-share * share).exp()
        })
        .collect();
    let mean =
        |corners: &[u32; 3]| corners.iter().map(|&vertex| stiffness[vertex as usize]).sum::<f64>() / 3.0;
    let weights: Vec<f64> = proxy.triangles.iter().map(mean).collect();
    let stiffnesses = [params.stretching, params.variation_mm4];
    Variation::new(points, &proxy.triangles, &weights, stiffnesses, params.cotangent_limit)
}
