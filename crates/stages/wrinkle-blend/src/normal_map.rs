//! Tangent-space normal maps.

use crate::Error;

/// A tangent-space normal map, `n = 2c − 1`, green up in the space of texture coordinates.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NormalMap {
    /// Where it comes from, for messages.
    pub name: String,
    /// Width, px.
    pub width: usize,
    /// Height, px.
    pub height: usize,
    /// Codes of 16 bits per component, row after row; one of 8 bits is 257 times itself, which says the same share of white.
    planes: [Vec<u16>; 3],
}

impl NormalMap {
    /// A map of codes of 16 bits: red, green, blue of each texel, row after row.
    ///
    /// # Errors
    /// [`Error::NoMap`] if the values make none of that size.
    pub fn from_16_bits(name: &str, width: usize, height: usize, rgb: &[u16]) -> Result<Self, Error> {
        if width == 0 || height == 0 || width.checked_mul(height).is_none_or(|texels| 3 * texels != rgb.len())
        {
            return Err(Error::NoMap { map: name.to_string(), values: rgb.len(), width, height });
        }
        let plane = |channel: usize| rgb.iter().skip(channel).step_by(3).copied().collect();
        Ok(Self { name: name.to_string(), width, height, planes: [plane(0), plane(1), plane(2)] })
    }

    /// The same of codes of 8 bits.
    ///
    /// # Errors
    /// As [`Self::from_16_bits`].
    pub fn from_8_bits(name: &str, width: usize, height: usize, rgb: &[u8]) -> Result<Self, Error> {
        let wide: Vec<u16> = rgb.iter().map(|code| 257 * u16::from(*code)).collect();
        Self::from_16_bits(name, width, height, &wide)
    }

    /// A flat map.
    #[must_use]
    pub fn flat(name: &str, width: usize, height: usize) -> Self {
        let plane = |code: u16| vec![code; width * height];
        Self { name: name.to_string(), width, height, planes: [plane(FLAT), plane(FLAT), plane(u16::MAX)] }
    }

    /// Turns a map whose green points down (Direct3D) into one whose green points up, and back.
    pub fn flip_green(&mut self) {
        self.planes[1].iter_mut().for_each(|code| *code = u16::MAX - *code);
    }

    /// Share of the texels that are no unit vectors turned outwards: large in pictures that are no such map.
    #[must_use]
    pub fn doubtful(&self) -> f64 {
        let texels = self.width * self.height;
        let bad = (0..texels).filter(|&texel| {
            let [x, y, z] = self.normal(texel);
            let length = (x * x + y * y + z * z).sqrt();
            z <= 0.0 || (length - 1.0).abs() > DOUBTFUL_LENGTH
        });
        bad.count() as f64 / texels.max(1) as f64
    }

    /// Codes of 8 bits, rounded to the nearest: red, green, blue of each texel, row after row.
    #[must_use]
    pub fn to_8_bits(&self) -> Vec<u8> {
        let code = |wide: u16| ((u32::from(wide) + 128) / 257) as u8;
        (0..self.width * self.height)
            .flat_map(|texel| self.planes.each_ref().map(|plane| code(plane[texel])))
            .collect()
    }

    /// The vector of a texel, as it stands there.
    #[must_use]
    pub fn normal(&self, texel: usize) -> [f64; 3] {
        self.planes.each_ref().map(|plane| f64::from(plane[texel]) / f64::from(u16::MAX) * 2.0 - 1.0)
    }

    /// Codes of some texels.
    #[inline(always)]
    pub(crate) fn run(&self, range: std::ops::Range<usize>) -> [&[u16]; 3] {
        self.planes.each_ref().map(|plane| &plane[range.clone()])
    }

    /// The unit vectors in codes of `bits`; where there is none, the outward one.
    pub(crate) fn normalised_codes(&self, bits: u8) -> [Vec<u16>; 3] {
        let full = f64::from(u16::MAX >> (16 - bits));
        let mut planes = [0; 3].map(|_| Vec::with_capacity(self.width * self.height));
        for texel in 0..self.width * self.height {
            let [x, y, z] = self.normal(texel);
            let length = (x * x + y * y + z * z).sqrt();
            let unit = if length > 0.0 { [x / length, y / length, z / length] } else { [0.0, 0.0, 1.0] };
            for (plane, part) in planes.iter_mut().zip(unit) {
                plane.push(((0.5 * part + 0.5) * full).round_ties_even() as u16);
            }
        }
        planes
    }
}

/// The code nearest to 0; the other one is as near.
const FLAT: u16 = 32768;
/// Lengths farther from 1 are more than filtering does.
const DOUBTFUL_LENGTH: f64 = 0.25;
