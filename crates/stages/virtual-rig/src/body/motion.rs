//! Sums of displacement fields and turns, evaluated vertex by vertex.

use nalgebra::{Point3, Unit, Vector3};
use rayon::prelude::*;
use std::ops::Range;

/// Vertices that one thread moves at a time: small enough to stay in the cache through all fields.
const BLOCK: usize = 4096;

/// A displacement field of one shape: only the vertices that it moves, rising.
#[derive(Debug, Clone, Default)]
pub(super) struct Offsets {
    vertices: Vec<u32>,
    by: Vec<Vector3<f64>>,
}

impl Offsets {
    /// Keeps what is longer than `least`, mm.
    pub(super) fn of(all: &[Vector3<f64>], least: f64) -> Self {
        let moved = all.iter().enumerate().filter(|(_, by)| by.norm() > least);
        let (vertices, by) = moved.map(|(vertex, by)| (vertex as u32, *by)).unzip();
        Self { vertices, by }
    }

    fn add_to(&self, block: &mut [Point3<f64>], first: usize, weight: f64) {
        let range = within(&self.vertices, first, block.len());
        for (vertex, by) in self.vertices[range.clone()].iter().zip(&self.by[range]) {
            block[*vertex as usize - first] += by * weight;
        }
    }
}

/// A turn about an axis in which vertices take part more or less.
#[derive(Debug, Clone)]
pub(super) struct Turn {
    center: Point3<f64>,
    axis: Unit<Vector3<f64>>,
    vertices: Vec<u32>,
    /// Angle at full weight, rad.
    angles: Vec<f64>,
}

impl Turn {
    /// Keeps the vertices whose angle is larger than `least`, rad.
    pub(super) fn of(center: Point3<f64>, axis: Unit<Vector3<f64>>, angles: &[f64], least: f64) -> Self {
        let turned = angles.iter().enumerate().filter(|(_, angle)| angle.abs() > least);
        let (vertices, angles) = turned.map(|(vertex, angle)| (vertex as u32, *angle)).unzip();
        Self { center, axis, vertices, angles }
    }

    fn apply_to(&self, block: &mut [Point3<f64>], first: usize, weight: f64) {
        let range = within(&self.vertices, first, block.len());
        for (vertex, angle) in self.vertices[range.clone()].iter().zip(&self.angles[range]) {
            let point = &mut block[*vertex as usize - first];
            let arm = *point - self.center;
            let along = self.axis.into_inner() * self.axis.dot(&arm);
            let (sin, cos) = (angle * weight).sin_cos();
            *point = self.center + along + (arm - along) * cos + self.axis.cross(&arm) * sin;
        }
    }
}

/// Which entries of a rising list lie in a block of vertices.
fn within(vertices: &[u32], first: usize, count: usize) -> Range<usize> {
    let below = |end: usize| vertices.partition_point(|&vertex| (vertex as usize) < end);
    below(first)..below(first + count)
}

/// Moves `rest` by the offsets, all at once, then by the turns, one after the other.
pub(super) fn pose(
    rest: &[Point3<f64>],
    offsets: &[(&Offsets, f64)],
    turns: &[(&Turn, f64)],
) -> Vec<Point3<f64>> {
    let mut posed = rest.to_vec();
    posed.par_chunks_mut(BLOCK).enumerate().for_each(|(index, block)| {
        let first = index * BLOCK;
        offsets.iter().for_each(|(field, weight)| field.add_to(block, first, *weight));
        turns.iter().for_each(|(turn, weight)| turn.apply_to(block, first, *weight));
    });
    posed
}
