//! Colours for values: maps whose equal steps look equal.

use serde::Serialize;

/// A colour map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ColorMap {
    /// Dark violet over green to yellow (viridis by van der Walt and Smith, CC0).
    Viridis,
    /// Clay over orange to dark red: small values leave the surface as it is, large ones glow.
    Ember,
}

/// Viridis at tenths from 0 to 1, sRGB; between them straight lines, which stay within 1 % of the map.
const VIRIDIS: [[u8; 3]; 11] = [
    [68, 1, 84],
    [72, 36, 117],
    [65, 68, 135],
    [53, 95, 141],
    [42, 120, 142],
    [33, 145, 140],
    [34, 168, 132],
    [68, 191, 112],
    [122, 209, 81],
    [189, 223, 38],
    [253, 231, 37],
];

/// Clay to dark red at fifths: CIELAB lightness falls in five equal steps from 88 to 33, neighbours are 24–26 units of
/// colour difference apart.
const EMBER: [[u8; 3]; 6] =
    [[225, 220, 213], [218, 185, 142], [216, 145, 78], [212, 98, 42], [192, 52, 46], [150, 26, 59]];

impl ColorMap {
    /// The colour at `place` (0–1), sRGB 0–255, not rounded.
    #[must_use]
    pub fn at(self, place: f64) -> [f64; 3] {
        let table: &[[u8; 3]] = match self {
            Self::Viridis => &VIRIDIS,
            Self::Ember => &EMBER,
        };
        let along = place.clamp(0.0, 1.0) * (table.len() - 1) as f64;
        let first = (along as usize).min(table.len() - 2);
        let rest = along - first as f64;
        std::array::from_fn(|i| {
            let (a, b) = (f64::from(table[first][i]), f64::from(table[first + 1][i]));
            a + (b - a) * rest
        })
    }
}

/// A colour value 0–255 in sRGB as linear light 0–1 (IEC 61966-2-1).
pub(crate) fn to_linear(encoded: f64) -> f32 {
    let value = encoded / 255.0;
    match value <= 0.04045 {
        true => (value / 12.92) as f32,
        false => ((value + 0.055) / 1.055).powf(2.4) as f32,
    }
}

/// Linear light as a colour value in sRGB.
pub(crate) fn to_srgb(linear: f32) -> u8 {
    let value = linear.clamp(0.0, 1.0);
    let encoded = match value <= 0.003_130_8 {
        true => value * 12.92,
        false => 1.055 * value.powf(1.0 / 2.4) - 0.055,
    };
    (encoded * 255.0).round() as u8
}
