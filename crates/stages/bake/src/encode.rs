//! From numbers to code values.

use artifact::GreenAxis;

/// Bits of a code value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Bits {
    /// 0–255
    Eight,
    /// 0–65535
    Sixteen,
}

/// Code values of normals, `n = 2 c − 1`; `green` says which way it points. Plain data: never sRGB.
#[must_use]
pub fn normal_codes(normals: &[[f32; 3]], bits: Bits, green: GreenAxis) -> Vec<u16> {
    let white = if bits == Bits::Eight { 255.0 } else { 65535.0 };
    let code = |x: f32| ((0.5 * f64::from(x) + 0.5) * white).round().clamp(0.0, white) as u16;
    let up = green.sign() as f32;
    normals.iter().flat_map(|&[x, y, z]| [x, up * y, z]).map(code).collect()
}

/// What black and white of a displacement map mean, mm: symmetric, so that no displacement is mid-grey, and of a round number.
#[must_use]
pub fn displacement_range([least, greatest]: [f64; 2]) -> [f64; 2] {
    let most = (least.abs().max(greatest.abs()) * 10.0).ceil().max(1.0) / 10.0;
    [-most, most]
}

/// Code values of 16 bits between black and white.
#[must_use]
pub fn displacement_codes(values_mm: &[f32], [black, white]: [f64; 2]) -> Vec<u16> {
    let code =
        |&x: &f32| ((f64::from(x) - black) / (white - black) * 65535.0).round().clamp(0.0, 65535.0) as u16;
    values_mm.iter().map(code).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_the_numbers_again() {
        let normals = [[0.0, 0.0, 1.0], [0.28, -0.96, 0.0], [-1.0, 1.0, 0.0]];
        assert_eq!(
            normal_codes(&normals, Bits::Eight, GreenAxis::Opengl),
            [128, 128, 255, 163, 5, 128, 0, 255, 128]
        );
        assert_eq!(normal_codes(&normals[1..2], Bits::Eight, GreenAxis::Directx), [163, 250, 128]);
        assert_eq!(normal_codes(&normals[..1], Bits::Sixteen, GreenAxis::Opengl), [32768, 32768, 65535]);
        let range = displacement_range([-0.83, 0.2]);
        assert_eq!(range, [-0.9, 0.9]);
        for (code, value) in displacement_codes(&[-0.83, 0.0, 0.2], range).into_iter().zip([-0.83, 0.0, 0.2])
        {
            assert!((range[0] + f64::from(code) / 65535.0 * (range[1] - range[0]) - value).abs() < 2e-5);
        }
        assert_eq!(displacement_range([0.0, 0.0]), [-0.1, 0.1]);
    }
}
