//! The maps: for each sample of a texel the relief over it.

use crate::high::High;
use crate::low::{Corner, Low};
use crate::padding::grow;
use crate::raster::{Flat, Under, under};
use crate::tangent::frame;
use crate::{Error, Params};
use nalgebra::{Point3, Vector2, Vector3};
use rayon::prelude::*;

/// The maps of a UDIM tile; row 0 is the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Tile {
    /// 1001 + whole part of u + 10 × whole part of v.
    pub number: u32,
    /// Texels in a row, and rows.
    pub size: usize,
    /// Unit normals in tangent space, z outwards; (0, 0, 1) where nothing is unwrapped.
    pub normals: Vec<[f32; 3]>,
    /// How far the wrinkled surface lies along the interpolated normal, mm; 0 where nothing is unwrapped.
    pub displacement_mm: Vec<f32>,
}

/// What was found on the way.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Report {
    /// Samples on the low-resolution mesh.
    pub samples: usize,
    /// … of which so many found no wrinkled surface.
    pub missed: usize,
    /// … of which so many lie under two triangles: the first one counts.
    pub doubled: usize,
    /// … of which so many saw a normal that leans beyond the low-resolution mesh's horizon.
    pub beyond_horizon: usize,
    /// Share of the texels that are unwrapped.
    pub coverage: f64,
    /// Least and greatest displacement, mm.
    pub displacement_mm: [f64; 2],
}

/// Rows of texels that are worked on at a time.
const BAND: usize = 16;
/// Missing more than this share of the samples, the two meshes do not belong together.
const MOST_MISSED: f64 = 0.5;
/// No normal leans farther than this from that of the low-resolution mesh, as its z.
const HORIZON: f64 = 0.02;

/// Bakes the relief of one mesh into maps of another, whose surface lies near it in the same pose. `step` is called after each band of
/// rows; there are [`steps`] of them.
///
/// # Errors
/// If a parameter is out of range, or the meshes do not lie on each other.
pub fn bake(
    low: &Low,
    high: &High,
    params: &Params,
    step: impl Fn() + Sync,
) -> Result<(Vec<Tile>, Report), Error> {
    params.check()?;
    let numbers = low.tile_numbers();
    let mut report = Report { displacement_mm: [f64::INFINITY, f64::NEG_INFINITY], ..Report::default() };
    let tiles: Vec<Tile> = numbers
        .iter()
        .map(|&number| Sheet::new(low, high, params, number).bake(&mut report, &step))
        .collect();
    if report.missed as f64 > MOST_MISSED * report.samples as f64 {
        let Report { missed, samples, .. } = report;
        return Err(Error::Apart { missed, samples, reach_mm: params.reach_mm });
    }
    report.coverage /= (numbers.len() * params.size * params.size) as f64;
    if report.displacement_mm[0] > report.displacement_mm[1] {
        report.displacement_mm = [0.0; 2];
    }
    Ok((tiles, report))
}

/// How often [`bake`] says that it got on.
#[must_use]
pub fn steps(low: &Low, params: &Params) -> usize {
    low.tile_numbers().len() * params.size.div_ceil(BAND)
}

/// One tile being baked.
struct Sheet<'a> {
    low: &'a Low,
    high: &'a High,
    params: &'a Params,
    number: u32,
    /// Samples in a row.
    count: usize,
    flats: Vec<(u32, Flat)>,
}

/// A texel's mean of its samples.
#[derive(Clone, Copy, Default)]
struct Texel {
    normal: Vector3<f64>,
    height_mm: f64,
    found: usize,
}

impl<'a> Sheet<'a> {
    fn new(low: &'a Low, high: &'a High, params: &'a Params, number: u32) -> Self {
        let count = params.size * params.samples;
        let origin = Vector2::new(f64::from((number - 1001) % 10), f64::from((number - 1001) / 10));
        let place = |corner: &Corner| {
            let uv = corner.uv - origin;
            Vector2::new(uv.x, 1.0 - uv.y) * count as f64 - Vector2::new(0.5, 0.5)
        };
        let flats = (0u32..)
            .zip(low.triangles.iter().zip(&low.tiles))
            .filter(|(_, (_, tile))| **tile == number)
            .map(|(at, (corners, _))| (at, Flat::new([0, 1, 2].map(|k| place(&corners[k])))))
            .collect();
        Self { low, high, params, number, count, flats }
    }

    fn bake(&self, report: &mut Report, step: &(impl Fn() + Sync)) -> Tile {
        let size = self.params.size;
        let bands: Vec<(Vec<Texel>, Report)> = (0..size.div_ceil(BAND))
            .into_par_iter()
            .map(|band| {
                let rows = band * BAND..((band + 1) * BAND).min(size);
                let done = self.band(rows);
                step();
                done
            })
            .collect();
        let mut texels = Vec::with_capacity(size * size);
        for (band, found) in bands {
            texels.extend(band);
            report.add(&found);
        }
        let is_set: Vec<bool> = texels.iter().map(|texel| texel.found > 0).collect();
        report.coverage += is_set.iter().filter(|set| **set).count() as f64;
        let mut values: Vec<[f64; 4]> = texels.iter().map(Texel::values).collect();
        grow(&mut values, is_set, size, self.params.padding);
        let unit = |value: &[f64; 4]| {
            let normal = Vector3::new(value[0], value[1], value[2]);
            let normal = normal.try_normalize(1e-6).unwrap_or(Vector3::z());
            normal.map(|x| x as f32).into()
        };
        Tile {
            number: self.number,
            size,
            normals: values.iter().map(unit).collect(),
            displacement_mm: values.iter().map(|value| value[3] as f32).collect(),
        }
    }

    /// Rows of texels.
    fn band(&self, rows: std::ops::Range<usize>) -> (Vec<Texel>, Report) {
        let (size, samples) = (self.params.size, self.params.samples);
        let (found, doubled) = under(&self.flats, rows.start * samples..rows.end * samples, self.count);
        let mut texels = vec![Texel::default(); rows.len() * size];
        let mut report =
            Report { doubled, displacement_mm: [f64::INFINITY, f64::NEG_INFINITY], ..Report::default() };
        for (at, under) in found.iter().enumerate() {
            let Some(under) = under else { continue };
            let texel = &mut texels[at / self.count / samples * size + at % self.count / samples];
            self.sample(under, texel, &mut report);
        }
        (texels, report)
    }

    fn sample(&self, under: &Under, texel: &mut Texel, report: &mut Report) {
        let corners = &self.low.triangles[under.triangle as usize];
        let place: Vector3<f64> =
            corners.iter().zip(under.shares).map(|(corner, share)| corner.point.coords * share).sum();
        let tangent_space = frame(corners, &under.shares);
        report.samples += 1;
        let relief = || {
            let outwards = tangent_space.column(2).try_normalize(1e-12)?;
            let relief = self.high.over(&Point3::from(place), &outwards, self.params.reach_mm)?;
            let normal = (tangent_space.try_inverse()? * relief.normal).try_normalize(1e-12)?;
            Some((normal, relief.height_mm))
        };
        let Some((mut normal, height_mm)) = relief() else {
            report.missed += 1;
            return;
        };
        if normal.z < HORIZON {
            report.beyond_horizon += 1;
            normal.z = HORIZON;
        }
        let [least, greatest] = report.displacement_mm;
        report.displacement_mm = [least.min(height_mm), greatest.max(height_mm)];
        texel.normal += normal.normalize();
        texel.height_mm += height_mm;
        texel.found += 1;
    }
}

impl Texel {
    /// Normal and height.
    fn values(&self) -> [f64; 4] {
        let count = self.found.max(1) as f64;
        let normal = self.normal.try_normalize(1e-6).unwrap_or(Vector3::z());
        [normal.x, normal.y, normal.z, self.height_mm / count]
    }
}

impl Report {
    fn add(&mut self, other: &Self) {
        self.samples += other.samples;
        self.missed += other.missed;
        self.doubled += other.doubled;
        self.beyond_horizon += other.beyond_horizon;
        let ([least, greatest], [low, high]) = (self.displacement_mm, other.displacement_mm);
        self.displacement_mm = [least.min(low), greatest.max(high)];
    }
}
