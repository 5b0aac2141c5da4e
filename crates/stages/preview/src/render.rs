//! From a surface and a camera to a picture.

use crate::colormap::{to_linear, to_srgb};
use crate::occlusion::{Depth, openness};
use crate::raster::{BAND_ROWS, GridTriangle, NOTHING, Projected};
use crate::shade::{CLAY, shade};
use crate::{Look, Surface, dots};
use camera::Pinhole;
use image::{Rgb, RgbImage};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Half the width of a polygon edge, as a share of the picture's smaller side, and its least value in pixels.
const LINE_SHARE: f32 = 0.0005;
const LINE_PX: f32 = 0.35;
/// Colour of polygon edges, linear light, and how much they cover.
const LINE_COLOR: [f32; 3] = [0.035, 0.04, 0.05];
const LINE_COVER: f32 = 0.6;

/// Draws a surface: picture of `size` pixels (width, height), row after row from the top.
///
/// A z-buffer over a turned grid of samples finds what is seen; each pixel is the mean of its samples in linear light.
/// Normals are interpolated; a surface seen from inside is dark. Triangles with a corner behind the camera are left
/// out. The same arguments give the same bytes for any number of threads.
///
/// # Panics
/// If `surface` has values or normals, but not one per vertex, or `look` does not pass its check.
#[must_use]
pub fn render(surface: &Surface, camera: &Pinhole, size: [u32; 2], look: &Look) -> RgbImage {
    assert!(look.check().is_ok(), "the look must pass its check");
    assert_eq!(surface.normals.len(), surface.positions.len(), "one normal per vertex");
    assert!(
        surface.values.is_empty() || surface.values.len() == surface.positions.len(),
        "one value per vertex"
    );
    let [width, height] = size.map(|side| side as usize);
    let projected = Projected::new(surface, camera, look.supersampling);
    let painter = Painter::new(&projected, look, size);
    let bands = projected.bands(height);
    let pixels: Vec<Pixel> = bands
        .par_iter()
        .enumerate()
        .flat_map_iter(|(band, triangles)| {
            let rows = band * BAND_ROWS..((band + 1) * BAND_ROWS).min(height);
            let seen = projected.visible(triangles, width, rows.clone());
            painter.pixels(&seen, width, rows)
        })
        .collect();
    let depth: Vec<Depth> = pixels.iter().map(|pixel| pixel.depth).collect();
    let open = openness(&depth, size, camera, look.occlusion);
    let mut picture = resolve(&pixels, &open, size, look);
    dots::draw(&mut picture, &projected, &depth, camera);
    picture
}

/// What the samples of a pixel add up to.
#[derive(Clone, Copy)]
struct Pixel {
    /// Mean light of the samples that see the surface, times their share.
    light: [f32; 3],
    /// Share of the samples that see the surface.
    cover: f32,
    depth: Depth,
}

fn resolve(pixels: &[Pixel], open: &[f32], size: [u32; 2], look: &Look) -> RgbImage {
    let backdrop = look.backdrop.color().map(|value| to_linear(f64::from(value)));
    let mut picture = RgbImage::new(size[0], size[1]);
    for ((target, pixel), open) in picture.pixels_mut().zip(pixels).zip(open) {
        let light = |i: usize| pixel.light[i] * open + backdrop[i] * (1.0 - pixel.cover);
        *target = Rgb(std::array::from_fn(|i| to_srgb(light(i))));
    }
    picture
}

struct Painter<'a> {
    projected: &'a Projected<'a>,
    /// Linear light at even steps along the colour map.
    colors: Vec<[f32; 3]>,
    look: &'a Look,
    /// Half the width of a polygon edge, grid steps.
    line: f32,
}

/// Steps of the colour table: finer than 8 bits can show.
const COLOR_STEPS: usize = 1024;

/// What a sample sees.
struct Hit {
    light: [f32; 3],
    depth: Depth,
}

impl<'a> Painter<'a> {
    fn new(projected: &'a Projected<'a>, look: &'a Look, size: [u32; 2]) -> Self {
        let color = |step: usize| look.map.at(step as f64 / COLOR_STEPS as f64).map(to_linear);
        let line = (LINE_SHARE * size[0].min(size[1]) as f32).max(LINE_PX);
        Self {
            projected,
            colors: (0..=COLOR_STEPS).map(color).collect(),
            look,
            line: line * projected.pattern.pixel as f32,
        }
    }

    fn pixels(&self, seen: &[u32], width: usize, rows: std::ops::Range<usize>) -> Vec<Pixel> {
        let per_pixel = self.projected.pattern.offsets.len();
        let first = rows.start * width;
        seen.chunks_exact(per_pixel)
            .enumerate()
            .map(|(at, samples)| self.pixel(samples, (first + at) % width, (first + at) / width))
            .collect()
    }

    fn pixel(&self, samples: &[u32], column: usize, row: usize) -> Pixel {
        let nothing = Depth { z: 0.0, normal: Vector3::zeros() };
        let mut pixel = Pixel { light: [0.0; 3], cover: 0.0, depth: nothing };
        let pattern = &self.projected.pattern;
        let corner = [column as i64 * pattern.pixel, row as i64 * pattern.pixel];
        for (&triangle, offset) in samples.iter().zip(&pattern.offsets) {
            if triangle == NOTHING {
                continue;
            }
            let Some(grid) = self.projected.on_grid(triangle) else { continue };
            let hit =
                self.hit(triangle, &grid, grid.edges_at([corner[0] + offset[0], corner[1] + offset[1]]));
            (0..3).for_each(|i| pixel.light[i] += hit.light[i]);
            pixel.cover += 1.0;
            if pixel.depth.z == 0.0 || hit.depth.z < pixel.depth.z {
                pixel.depth = hit.depth;
            }
        }
        let share = 1.0 / samples.len() as f32;
        pixel.light = pixel.light.map(|light| light * share);
        pixel.cover *= share;
        pixel
    }

    fn hit(&self, triangle: u32, grid: &GridTriangle, edges: [i64; 3]) -> Hit {
        let corners = self.projected.surface.triangles[triangle as usize].map(|vertex| vertex as usize);
        let points = corners.map(|vertex| self.projected.points[vertex].coords.cast::<f32>());
        // Shares that are linear in the picture, made linear in space.
        let flat = grid.weights(edges);
        let near: [f32; 3] = std::array::from_fn(|i| flat[i] / points[i].z);
        let z = 1.0 / (near[0] + near[1] + near[2]);
        let share = near.map(|near| near * z);
        let point = points[0] * share[0] + points[1] * share[1] + points[2] * share[2];
        let normals = corners.map(|vertex| self.projected.normals[vertex]);
        let mut normal = normals[0] * share[0] + normals[1] * share[1] + normals[2] * share[2];
        if !grid.is_front {
            normal = -normal;
        }
        let toward_camera = -point.normalize();
        let normal = normal.try_normalize(1e-6).unwrap_or(toward_camera);
        // Values colour the outside only: what shows through a hole is not part of the picture's statement.
        let albedo = if grid.is_front { self.albedo(corners, share) } else { CLAY };
        let coloured = !self.projected.surface.values.is_empty();
        let mut light = shade(normal, toward_camera, albedo, grid.is_front, coloured);
        if self.look.wireframe && self.is_line(triangle, grid, edges) {
            light = std::array::from_fn(|i| light[i] + (LINE_COLOR[i] - light[i]) * LINE_COVER);
        }
        Hit { light, depth: Depth { z, normal } }
    }

    fn albedo(&self, corners: [usize; 3], share: [f32; 3]) -> [f32; 3] {
        let values = &self.projected.surface.values;
        if values.is_empty() {
            return CLAY;
        }
        let value: f64 = (0..3).map(|i| values[corners[i]] * f64::from(share[i])).sum();
        self.colors[(self.look.range.place(value) * COLOR_STEPS as f64).round() as usize]
    }

    fn is_line(&self, triangle: u32, grid: &GridTriangle, edges: [i64; 3]) -> bool {
        let sides = self.projected.surface.polygon_sides.get(triangle as usize).copied().unwrap_or([true; 3]);
        (0..3).any(|side| sides[side] && grid.distance_to_side(edges, side) < self.line)
    }
}
