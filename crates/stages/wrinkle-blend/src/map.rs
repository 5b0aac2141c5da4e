//! Normal maps, and their sum [DutreveMeyer2011, Eq. 7–8].

use crate::atlas::Atlas;
use crate::{Error, NormalMap};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

/// Texels that are blended together: their intermediate values stay near the processor.
const RUN: usize = 256;
/// A component this near 0 is 0: no 8-bit code says 0, and what flat maps say instead would add up.
pub const SNAP: f32 = 1.0 / 255.0 + 1e-6;
/// No weighted normal is flatter than this: a product of zeros has no direction.
pub const LEAST_Z: f32 = 0.05;

/// Blended code values: red, green, blue of each texel, row after row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Blended {
    /// 8 bits each.
    Bits8(Vec<u8>),
    /// 16 bits each.
    Bits16(Vec<u16>),
}

/// A neutral map and the wrinkle maps of the poses, ready to be blended.
#[derive(Debug, Clone)]
pub struct MapBlender {
    neutral: NormalMap,
    /// The neutral map normalised, in codes of the output.
    plain: [Vec<u16>; 3],
    maps: Vec<NormalMap>,
    bits: u8,
}

impl MapBlender {
    /// Blends `maps` (one per pose) over `neutral`, into codes of `bits` (8 or 16).
    ///
    /// # Errors
    /// [`Error::MapSize`] if a map has another size.
    pub fn new(neutral: NormalMap, maps: Vec<NormalMap>, bits: u8) -> Result<Self, Error> {
        for map in &maps {
            if [map.width, map.height] != [neutral.width, neutral.height] {
                return Err(Error::MapSize {
                    map: map.name.clone(),
                    width: map.width,
                    height: map.height,
                    neutral_width: neutral.width,
                    neutral_height: neutral.height,
                });
            }
        }
        let plain = neutral.normalised_codes(bits);
        Ok(Self { neutral, plain, maps, bits })
    }

    /// Width, height, px.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [self.neutral.width, self.neutral.height]
    }

    /// The blended map. `weights`: per pose #V weights of vertices, pose after pose. Where all are 0, exactly the normalised
    /// neutral map.
    ///
    /// # Panics
    /// If the atlas has another size than the maps, or a weight is missing.
    #[must_use]
    pub fn blend(&self, atlas: &Atlas, weights: &[f32]) -> Blended {
        assert_eq!(atlas.size, self.size(), "the atlas is laid out for other maps");
        match self.bits {
            8 => Blended::Bits8(self.rows(atlas, weights, |code| code as u8)),
            _ => Blended::Bits16(self.rows(atlas, weights, |code| code as u16)),
        }
    }

    fn rows<T: Copy + Default + Send>(
        &self,
        atlas: &Atlas,
        weights: &[f32],
        code: impl Fn(u32) -> T + Copy + Sync,
    ) -> Vec<T> {
        let [width, height] = self.size();
        let vertex_count = weights.len() / self.maps.len().max(1);
        let mut texels = vec![T::default(); 3 * width * height];
        texels.par_chunks_mut(3 * width * BAND).enumerate().for_each(|(band, texels)| {
            let mut row = Row::new(self.maps.len(), width);
            for (line, texels) in texels.chunks_exact_mut(3 * width).enumerate() {
                let y = BAND * band + line;
                for (pose, own) in row.poses.iter_mut().enumerate() {
                    let weights = &weights[pose * vertex_count..(pose + 1) * vertex_count];
                    atlas.row(y, weights, &mut own.weights, RUN, &mut own.active);
                }
                Arch::new().dispatch(Kernel { maps: self, row: &row, y, texels, code });
            }
        });
        texels
    }
}

/// Rows that one thread does in a row.
const BAND: usize = 16;

/// The weights of a row.
struct Row {
    poses: Vec<RowWeights>,
}

struct RowWeights {
    weights: Vec<f32>,
    /// Per run whether any weight is not 0.
    active: Vec<bool>,
}

impl Row {
    fn new(pose_count: usize, width: usize) -> Self {
        let weights = || RowWeights { weights: vec![0.0; width], active: vec![false; width.div_ceil(RUN)] };
        Self { poses: std::iter::repeat_with(weights).take(pose_count).collect() }
    }
}

/// One row, in the widest instructions that the machine has. Sums keep their order, so that all machines agree.
struct Kernel<'a, T, F> {
    maps: &'a MapBlender,
    row: &'a Row,
    y: usize,
    texels: &'a mut [T],
    code: F,
}

impl<T: Copy, F: Fn(u32) -> T + Copy> NullaryFnOnce for Kernel<'_, T, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let width = self.maps.neutral.width;
        for (run, texels) in self.texels.chunks_mut(3 * RUN).enumerate() {
            let (x, count) = (run * RUN, texels.len() / 3);
            let range = self.y * width + x..self.y * width + x + count;
            let plain = self.maps.plain.each_ref().map(|plane| &plane[range.clone()]);
            let mut codes = Codes([[0; RUN]; 3]);
            if self.row.poses.iter().any(|pose| pose.active[run]) {
                let mut sum = Sum::start(self.maps.neutral.run(range.clone()), count);
                for (pose, map) in self.row.poses.iter().zip(&self.maps.maps) {
                    if pose.active[run] {
                        sum.add(map.run(range.clone()), &pose.weights[x..x + count]);
                    }
                }
                sum.encode(plain, f32::from(u16::MAX >> (16 - self.maps.bits)), &mut codes);
            } else {
                codes.copy(plain);
            }
            codes.interleave(texels, self.code);
        }
    }
}

/// A run of normals in the making, and the sum of their weights.
struct Sum {
    x: [f32; RUN],
    y: [f32; RUN],
    z: [f32; RUN],
    weight: [f32; RUN],
}

impl Sum {
    #[inline(always)]
    fn start([x, y, z]: [&[u16]; 3], count: usize) -> Self {
        let mut sum = Self { x: [0.0; RUN], y: [0.0; RUN], z: [1.0; RUN], weight: [0.0; RUN] };
        for i in 0..count.min(RUN).min(x.len()).min(y.len()).min(z.len()) {
            (sum.x[i], sum.y[i], sum.z[i]) = (decode(x[i]), decode(y[i]), decode(z[i]));
        }
        sum
    }

    /// η = (0, 0, 1) + w (n − (0, 0, 1)); x and y are added, z multiplied.
    #[inline(always)]
    fn add(&mut self, [x, y, z]: [&[u16]; 3], weights: &[f32]) {
        for i in 0..RUN.min(weights.len()).min(x.len()).min(y.len()).min(z.len()) {
            let w = weights[i];
            self.x[i] += w * snapped(decode(x[i]));
            self.y[i] += w * snapped(decode(y[i]));
            self.z[i] *= (1.0 + w * (decode(z[i]) - 1.0)).max(LEAST_Z);
            self.weight[i] += w;
        }
    }

    #[inline(always)]
    fn encode(&self, plain: [&[u16]; 3], full: f32, codes: &mut Codes) {
        let [plain_x, plain_y, plain_z] = plain;
        for i in 0..RUN.min(plain_x.len()).min(plain_y.len()).min(plain_z.len()) {
            let [x, y, z] = [self.x[i], self.y[i], self.z[i]];
            let scale = 0.5 * full / (x * x + y * y + z * z).sqrt();
            let code = |part: f32| rounded(part * scale + 0.5 * full);
            let is_plain = self.weight[i] == 0.0;
            codes.0[0][i] = if is_plain { u32::from(plain_x[i]) } else { code(x) };
            codes.0[1][i] = if is_plain { u32::from(plain_y[i]) } else { code(y) };
            codes.0[2][i] = if is_plain { u32::from(plain_z[i]) } else { code(z) };
        }
    }
}

/// The component that a code of 16 bits says.
#[inline(always)]
fn decode(code: u16) -> f32 {
    f32::from(code) * (2.0 / 65535.0) - 1.0
}

#[inline(always)]
fn snapped(part: f32) -> f32 {
    if part.abs() <= SNAP { 0.0 } else { part }
}

/// The nearest whole number of a number from 0 to 65535, ties to even: where the last bit of a float is worth 1, adding rounds.
#[inline(always)]
fn rounded(number: f32) -> u32 {
    (number + 8_388_608.0).to_bits() & 0x000f_ffff
}

/// Red, green and blue of a run.
struct Codes([[u32; RUN]; 3]);

impl Codes {
    #[inline(always)]
    fn copy(&mut self, planes: [&[u16]; 3]) {
        for (codes, plane) in self.0.iter_mut().zip(planes) {
            codes.iter_mut().zip(plane).for_each(|(code, plain)| *code = u32::from(*plain));
        }
    }

    #[inline(always)]
    fn interleave<T: Copy>(&self, texels: &mut [T], code: impl Fn(u32) -> T) {
        let [red, green, blue] = &self.0;
        for (texel, ((red, green), blue)) in texels.chunks_exact_mut(3).zip(red.iter().zip(green).zip(blue)) {
            (texel[0], texel[1], texel[2]) = (code(*red), code(*green), code(*blue));
        }
    }
}
