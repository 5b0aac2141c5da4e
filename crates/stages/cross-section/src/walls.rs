//! What the rest of the face hides of the sky.
//!
//! In an azimuth φ off the across direction a groove's horizon of slope h stands at slope `h cos φ`; the face's own stands at a slope w(φ). The
//! sky begins at the higher of the two. What that takes from the light of a point on ground of slope m towards that side is
//! `cos θ (A(h) − m B(h))`, with `A = (1/π) ∫ ½ (sin² e₁ − sin² e₀) dφ` and
//! `B = (1/π) ∫ ½ cos φ (e₁ − e₀ + ½ (sin 2e₁ − sin 2e₀)) dφ`, e₀ = atan(h cos φ), e₁ = max(e₀, atan w): tables by h.

use crate::relief::Relief;
use std::f64::consts::PI;

/// Azimuths to each side.
pub(crate) const SECTORS: usize = 8;
/// Entries of a table, even in h / (1 + h).
const ENTRIES: usize = 40;

/// Slopes of the horizon by azimuth, left and right of a groove; in each from one end of the groove to the other.
pub(crate) type Skyline = [[f64; SECTORS]; 2];

/// What lies around a groove, as far as it is known.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Around {
    pub(crate) walls: Option<Walls>,
    pub(crate) relief: Option<Relief>,
}

/// A skyline's tables.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Walls {
    tables: [[[f64; 2]; ENTRIES + 1]; 2],
}

/// What a wall takes on one side: A and B, and their derivatives by the groove's horizon.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Loss {
    pub(crate) value: [f64; 2],
    pub(crate) growth: [f64; 2],
}

impl Walls {
    /// None where nothing stands in the way.
    pub(crate) fn of(skyline: &Skyline) -> Option<Self> {
        let is_open = skyline.iter().flatten().all(|slope| *slope <= 0.0);
        let side = |side: usize| std::array::from_fn(|entry| taken(&skyline[side], entry));
        (!is_open).then(|| Self { tables: [side(0), side(1)] })
    }

    /// What lies on side 0 (left) or 1 takes from a point whose own horizon there has a slope.
    pub(crate) fn loss(&self, side: usize, horizon: f64) -> Loss {
        let rest = 1.0 / (1.0 + horizon);
        let along = (horizon * rest * ENTRIES as f64).min(ENTRIES as f64 - 1e-9);
        let entry = along as usize;
        let share = along - entry as f64;
        let [from, to] = [self.tables[side][entry], self.tables[side][entry + 1]];
        let growth = ENTRIES as f64 * rest * rest;
        Loss {
            value: [0, 1].map(|k| from[k] + share * (to[k] - from[k])),
            growth: [0, 1].map(|k| growth * (to[k] - from[k])),
        }
    }

    /// The light of level ground between the walls.
    pub(crate) fn open(&self) -> f64 {
        1.0 - self.tables[0][0][0] - self.tables[1][0][0]
    }
}

/// A and B of one side at an entry of the table.
fn taken(slopes: &[f64; SECTORS], entry: usize) -> [f64; 2] {
    let share = (entry as f64 / ENTRIES as f64).min(1.0 - 1e-9);
    let horizon = share / (1.0 - share);
    let mut sums = [0.0; 2];
    for (sector, wall) in slopes.iter().enumerate() {
        let cosine = azimuth(sector).cos();
        let [low, high] = [horizon * cosine, wall.max(horizon * cosine)].map(f64::atan);
        let square = |e: f64| e.sin().powi(2);
        sums[0] += 0.5 * (square(high) - square(low));
        sums[1] += 0.5 * cosine * (high - low + 0.5 * ((2.0 * high).sin() - (2.0 * low).sin()));
    }
    // (1/π) of π / SECTORS each.
    sums.map(|sum| sum / SECTORS as f64)
}

/// The middle of a sector, off the across direction.
pub(crate) fn azimuth(sector: usize) -> f64 {
    PI * ((sector as f64 + 0.5) / SECTORS as f64 - 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The light of a point between horizons of a groove and of the face, by brute force.
    fn summed(skyline: &Skyline, [left, right]: [f64; 2], slope: f64) -> f64 {
        let along = 1.0 / (1.0 + slope * slope).sqrt();
        let steps = 4000;
        let sum = |side: usize, sector: usize| -> f64 {
            let cosine = azimuth(sector).cos();
            let own = [left, right][side] * cosine;
            let lean = if side == 1 { -slope } else { slope };
            (0..steps)
                .map(|k| 0.5 * PI * (f64::from(k) + 0.5) / f64::from(steps))
                .filter(|e| e.tan() > own.max(skyline[side][sector]))
                .map(|e| along * (e.sin() + lean * cosine * e.cos()) * e.cos())
                .sum()
        };
        let all: f64 = (0..2).flat_map(|side| (0..SECTORS).map(move |sector| sum(side, sector))).sum();
        all * 0.5 * PI / f64::from(steps) / SECTORS as f64
    }

    #[test]
    fn walls_take_what_the_sum_over_the_sky_says() {
        let skyline: Skyline =
            [[0.0, 0.2, 0.1, 0.0, 0.3, 0.9, 1.4, 0.5], [0.4, 0.4, 0.2, 0.1, 0.0, 0.0, 0.6, 0.2]];
        let walls = Walls::of(&skyline).unwrap();
        for ([left, right], slope) in [([0.0, 0.0], 0.0), ([0.1, 0.6], 0.5), ([0.9, 0.3], -0.7)] {
            let [left_loss, right_loss] =
                [walls.loss(0, left), walls.loss(1, right)].map(|loss: Loss| loss.value);
            let along = 1.0 / f64::hypot(1.0, slope);
            let taken = along * (left_loss[0] + slope * left_loss[1] + right_loss[0] - slope * right_loss[1]);
            let wanted =
                summed(&Skyline::default(), [left, right], slope) - summed(&skyline, [left, right], slope);
            assert!((taken - wanted).abs() < 2e-3, "{left} {right} {slope}: {taken} {wanted}");
        }
        let open = summed(&skyline, [0.0; 2], 0.0);
        assert!((walls.open() - open).abs() < 1e-3);
    }

    #[test]
    fn an_open_sky_has_no_walls() {
        assert!(Walls::of(&Skyline::default()).is_none());
    }
}
