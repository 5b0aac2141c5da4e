//! The light that an image receives.

use super::bins::{Bins, Chunk, TILE, Tiling, chunks};
use super::params::Film;
use super::projection::{Corners, Projection};
use super::scene::Scene;
use super::shade::{Palette, Shader};
use super::tile::Tile;
use crate::Error;
use camera::Camera;
use nalgebra::{Point3, Vector2};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

/// How much of a pixel one layer of paint covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cover {
    /// Number of the pixel, row by row.
    pub pixel: u32,
    /// Number of the layer in [`crate::paint::Layers`].
    pub layer: u32,
    /// Visible share of the pixel's footprint, 0 to 1.
    pub share: f32,
    /// Mean place of the samples with this paint, from the pixel's centre, px. Pixel + offset, weighted by share, is the
    /// centroid of the paint; without the offset, small dots seem up to some hundredths of a pixel off.
    pub offset_px: [f32; 2],
}

/// An image in linear light, and what it shows.
#[derive(Debug, Clone, PartialEq)]
pub struct Exposure {
    /// Width, height, px.
    pub size: [u32; 2],
    /// Linear RGB per pixel, row by row; 1 is a white matte surface under full ambient light.
    pub radiance: Vec<[f32; 3]>,
    /// Depth along the optical axis of the nearest of the samples about the pixel's centre, mm; infinite where they see
    /// nothing.
    pub depth_mm: Vec<f32>,
    /// Layers of paint per pixel, in the order of pixels, then layers; pixels without paint have none.
    pub covers: Vec<Cover>,
}

/// Exposes an image of a scene.
///
/// The bytes are the same for any number of threads.
///
/// # Errors
/// [`Error::Parameter`] if the film's parameters make no sense.
///
/// # Panics
/// If the lengths of a solid's lists differ.
pub fn expose(camera: &Camera, scene: &Scene<'_>, film: &Film) -> Result<Exposure, Error> {
    film.check()?;
    scene.check();
    Ok(match (Projection::of(scene, camera), film.samples_per_side) {
        (Projection::Still(corners), 4) => with::<1>(camera, scene, film, &corners),
        (Projection::Still(corners), _) => with::<4>(camera, scene, film, &corners),
        (Projection::Moving(corners), 4) => with::<1>(camera, scene, film, &corners),
        (Projection::Moving(corners), _) => with::<4>(camera, scene, film, &corners),
    })
}

fn with<const PARTS: usize>(
    camera: &Camera,
    scene: &Scene<'_>,
    film: &Film,
    corners: &impl Corners,
) -> Exposure {
    let tiling = Tiling::of(camera.image_size);
    let chunks = chunks(scene);
    let bins = Bins::of(&chunks, corners, &tiling);
    let palette = Palette::of(scene, camera, film);
    let arch = Arch::new();
    let parts: Vec<Part> = (0..tiling.count())
        .into_par_iter()
        .map_init(
            || Tile::<PARTS>::new(scene.moves()),
            |tile, number| {
                arch.dispatch(Job {
                    tile,
                    number,
                    chunks: &chunks,
                    bins: &bins,
                    corners,
                    palette: &palette,
                    tiling: &tiling,
                })
            },
        )
        .collect();
    Exposure::assemble(camera.image_size, &tiling, &parts)
}

/// Draws and shades a tile with the widest vectors that the processor has; they change no bit.
struct Job<'a, C, const PARTS: usize> {
    tile: &'a mut Tile<PARTS>,
    number: usize,
    chunks: &'a [Chunk<'a>],
    bins: &'a [Bins],
    corners: &'a C,
    palette: &'a Palette<'a>,
    tiling: &'a Tiling,
}

impl<C: Corners, const PARTS: usize> NullaryFnOnce for Job<'_, C, PARTS> {
    type Output = Part;

    #[inline(always)]
    fn call(self) -> Part {
        self.tile.draw(self.number, self.tiling.pixels(self.number), self.chunks, self.bins, self.corners);
        Part::shade(self.tile, self.palette, self.tiling, self.number)
    }
}

/// One tile of an exposure.
struct Part {
    radiance: Vec<[f32; 3]>,
    depth_mm: Vec<f32>,
    covers: Vec<Cover>,
}

impl Part {
    #[inline(always)]
    fn shade<const PARTS: usize>(
        tile: &Tile<PARTS>,
        palette: &Palette<'_>,
        tiling: &Tiling,
        number: usize,
    ) -> Self {
        let ([left, top], [columns, rows]) = tiling.pixels(number);
        let count = columns * rows;
        let (mut radiance, mut depth_mm) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut covers = Vec::new();
        let mut shader = Shader::new(palette, tile);
        for row in 0..rows {
            for column in 0..columns {
                let light = shader.pixel(row * TILE + column, Tile::<PARTS>::position(column, row));
                radiance.push(light.radiance);
                depth_mm.push(light.depth_mm);
                let pixel = ((top + row) * tiling.size[0] + left + column) as u32;
                shader.covers(pixel, &mut covers);
            }
        }
        Self { radiance, depth_mm, covers }
    }
}

impl Exposure {
    /// An image of light alone, which shows neither depth nor paint.
    #[must_use]
    pub fn of_radiance(size: [u32; 2], radiance: Vec<[f32; 3]>) -> Self {
        let depth_mm = vec![f32::INFINITY; radiance.len()];
        Self { size, radiance, depth_mm, covers: Vec::new() }
    }

    fn assemble(size: [u32; 2], tiling: &Tiling, parts: &[Part]) -> Self {
        let count = tiling.size[0] * tiling.size[1];
        let (mut radiance, mut depth_mm) = (vec![[0.0; 3]; count], vec![0.0; count]);
        for (number, part) in parts.iter().enumerate() {
            let ([left, top], [columns, rows]) = tiling.pixels(number);
            for row in 0..rows {
                let from = row * columns..(row + 1) * columns;
                let first = (top + row) * tiling.size[0] + left;
                radiance[first..first + columns].copy_from_slice(&part.radiance[from.clone()]);
                depth_mm[first..first + columns].copy_from_slice(&part.depth_mm[from]);
            }
        }
        let mut covers: Vec<Cover> = parts.iter().flat_map(|part| &part.covers).copied().collect();
        covers.sort_by_key(|cover| (cover.pixel, cover.layer));
        Self { size, radiance, depth_mm, covers }
    }

    /// Whether nothing in the image hides a point in the world: the pixel that it lands on shows nothing that is nearer by
    /// more than a tolerance and what the depth changes within the pixel. Good to half a pixel; for
    /// [`crate::paint::DotSamples::view`].
    pub fn sees(&self, camera: &Camera, tolerance_mm: f64) -> impl Fn(&Point3<f64>, Vector2<f64>) -> bool {
        let [width, height] = self.size.map(|side| i64::from(side) - 1);
        let shown = move |column: i64, row: i64| {
            let pixel = row.clamp(0, height) * (width + 1) + column.clamp(0, width);
            f64::from(self.depth_mm[pixel as usize])
        };
        move |point, pixel| {
            let depth = (camera.cam_from_world * point).z;
            let (column, row) = (pixel.x.round() as i64, pixel.y.round() as i64);
            let here = shown(column, row);
            // Of two neighbours the one that lies on the same surface.
            let slope = |[x, y]: [i64; 2]| {
                let [before, after] =
                    [-1, 1].map(|step| (shown(column + step * x, row + step * y) - here).abs());
                before.min(after)
            };
            // Half a pixel to either side, and the nearest of the samples about its middle.
            let within_pixel = 0.8 * (slope([1, 0]) + slope([0, 1]));
            depth <= here + tolerance_mm + within_pixel
        }
    }
}
