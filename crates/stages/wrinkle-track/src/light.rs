//! From stored values to log ratios of linear light.

use crate::Error;
use crate::svm::Ratios;
use artifact::Transfer;
use artifact::picture::{Codes, Rgb};

/// What is added to linear light (white is 1) before its logarithm: below it, ratios are noise.
pub const FLOOR: f64 = 0.004;

/// An image whose values have 256 levels.
///
/// Values of 8 bits are their own levels. Deeper ones are sorted into 256 levels of equal ratio of light, `ln(light + floor)`
/// in steps of 2.2 %: about what 8 bits of sRGB resolve at mid grey, whatever the transfer function.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Levels of red, green and blue of each pixel, row after row.
    pub levels: Vec<[u8; 3]>,
    /// Linear light of each level.
    pub light: [f64; 256],
    /// Whether a level is the darkest or the brightest that the camera stores.
    clipped: [bool; 256],
}

impl Picture {
    /// The levels of stored values.
    ///
    /// # Errors
    /// [`Error::Pixels`] if the values make no picture.
    pub fn new(picture: &Rgb, transfer: Transfer, floor: f64) -> Result<Self, Error> {
        let size = [picture.width, picture.height];
        let values = match &picture.codes {
            Codes::Bits8(codes) => codes.len(),
            Codes::Bits16(codes) => codes.len(),
        };
        let fits = size[0].checked_mul(size[1]).and_then(|pixels| pixels.checked_mul(3));
        if values == 0 || fits != Some(values) {
            return Err(Error::Pixels { size, values });
        }
        let (levels, light) = match &picture.codes {
            Codes::Bits8(codes) => (triples(codes.iter().copied()), transfer.light_of_codes()),
            Codes::Bits16(codes) => {
                let level = Levels { floor };
                let table: Vec<u8> = (0..=u16::MAX)
                    .map(|code| level.of(transfer.light(f64::from(code) / f64::from(u16::MAX))))
                    .collect();
                let levels = triples(codes.iter().map(|code| table[usize::from(*code)]));
                (levels, std::array::from_fn(|code| level.light(code as u8)))
            }
        };
        let mut clipped = [false; 256];
        (clipped[0], clipped[255]) = (true, true);
        Ok(Self { width: size[0], height: size[1], levels, light, clipped })
    }

    /// The logarithm of each level's light.
    #[must_use]
    pub fn logs(&self, floor: f64) -> [f64; 256] {
        self.light.map(|light| (light + floor).ln())
    }

    /// Luminance of a pixel, linear (Rec. ITU-R BT.709).
    #[must_use]
    pub fn luminance(&self, pixel: usize) -> f64 {
        let [r, g, b] = self.levels[pixel].map(|level| self.light[usize::from(level)]);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }

    /// Whether a channel of a pixel is black or saturated, so that ratios mean little.
    #[must_use]
    pub fn is_clipped(&self, pixel: usize) -> bool {
        self.levels[pixel].iter().any(|level| self.clipped[usize::from(*level)])
    }
}

fn triples(values: impl Iterator<Item = u8>) -> Vec<[u8; 3]> {
    let mut values = values;
    std::iter::from_fn(|| Some([values.next()?, values.next()?, values.next()?])).collect()
}

/// 256 levels of equal ratio.
struct Levels {
    floor: f64,
}

impl Levels {
    fn step(&self) -> f64 {
        ((1.0 + self.floor) / self.floor).ln() / 255.0
    }

    fn of(&self, light: f64) -> u8 {
        (((light + self.floor) / self.floor).ln() / self.step()).round().clamp(0.0, 255.0) as u8
    }

    fn light(&self, level: u8) -> f64 {
        self.floor * ((f64::from(level) * self.step()).exp() - 1.0)
    }
}

/// The features of a pixel, by the logarithms of its levels.
#[must_use]
pub fn ratios(logs: &[f64; 256], [r, g, b]: [u8; 3]) -> Ratios {
    let [r, g, b] = [r, g, b].map(|level| logs[usize::from(level)]);
    [g - r, b - g]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(codes: Codes, transfer: Transfer) -> Picture {
        Picture::new(&Rgb { width: 1, height: 1, codes }, transfer, FLOOR).unwrap()
    }

    #[test]
    fn deeper_values_keep_their_ratios() {
        for transfer in [Transfer::Linear, Transfer::Srgb] {
            for stored in [[0.9, 0.3, 0.1], [0.3, 0.1, 0.03]] {
                let codes = stored.map(|value: f64| (value * 65535.0).round() as u16);
                let deep = picture(Codes::Bits16(codes.to_vec()), transfer);
                let found = ratios(&deep.logs(FLOOR), deep.levels[0]);
                let [r, g, b] = stored.map(|value| (transfer.light(value) + FLOOR).ln());
                assert!(
                    (found[0] - (g - r)).abs() < 0.023 && (found[1] - (b - g)).abs() < 0.023,
                    "{found:?}"
                );
            }
        }
    }

    #[test]
    fn eight_bits_are_their_own_levels() {
        let plain = picture(Codes::Bits8(vec![0, 128, 255]), Transfer::Srgb);
        assert_eq!(plain.levels, [[0, 128, 255]]);
        assert!(plain.is_clipped(0) && (plain.light[128] - 0.215_861).abs() < 1e-6);
    }

    #[test]
    fn values_that_make_no_picture_are_refused() {
        let wrong = Rgb { width: 2, height: 1, codes: Codes::Bits8(vec![0; 3]) };
        let refused = Picture::new(&wrong, Transfer::Srgb, FLOOR);
        assert_eq!(refused, Err(Error::Pixels { size: [2, 1], values: 3 }));
    }
}
