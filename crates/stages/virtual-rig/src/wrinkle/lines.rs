//! Where wrinkles form: lines on the unrolled face.

use crate::wrinkle::params::Style;
use crate::wrinkle::smooth::smooth_step;
use crate::wrinkle::wave::Wave;
use nalgebra::{Point2, Vector2};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What kind of wrinkle a line is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Group {
    /// Across the forehead.
    Forehead,
    /// Upright between the brows.
    Glabella,
    /// Beside an eye.
    CrowsFeet,
    /// Beside nose and mouth.
    Nasolabial,
    /// Drawn by hand.
    Other,
}

/// A line along which the skin folds.
#[derive(Debug, Clone, PartialEq)]
pub struct WrinkleLine {
    /// Its id, e.g. `forehead_1` (from below), `crows_feet_l_2` (l: the subject's left).
    pub id: String,
    /// Its kind.
    pub group: Group,
    /// The colour that it is painted in.
    pub paint: String,
    /// A smooth polyline on the unrolled average face, mm: s to the subject's left, t up, 0 under the nose.
    pub path: Vec<Point2<f64>>,
    /// Mean distance from the bottom to where the section crosses the large-scale surface, mm.
    pub width_mm: f64,
    /// How much width and form vary along the line: 0 not at all, 1 as on skin.
    pub variation: f64,
    /// Decides how they vary.
    pub seed: u64,
}

impl WrinkleLine {
    /// A line drawn by hand, without variation.
    #[must_use]
    pub fn new(id: &str, path: Vec<Point2<f64>>, width_mm: f64) -> Self {
        let paint = "green".to_string();
        Self { id: id.to_string(), group: Group::Other, paint, path, width_mm, variation: 0.0, seed: 0 }
    }
}

/// The lines of a person: by default three or so across the forehead, two between the brows, three beside each eye,
/// one beside each wing of the nose. Seed 0 has the middling number and places; the same seed gives the same lines.
#[must_use]
pub fn lines(seed: u64, style: &Style) -> Vec<WrinkleLine> {
    let mut person = Person::new(seed);
    // All groups are drawn, so that leaving one out does not change the others.
    let groups = [
        (style.forehead, forehead(&mut person)),
        (style.glabella, glabella(&mut person)),
        (style.crows_feet, [1.0, -1.0].into_iter().flat_map(|side| crows_feet(&mut person, side)).collect()),
        (style.nasolabial, [1.0, -1.0].into_iter().map(|side| nasolabial(&mut person, side)).collect()),
    ];
    let finish = |mut line: WrinkleLine, number: usize| {
        line.paint = style.paints.get(number % style.paints.len().max(1)).cloned().unwrap_or_default();
        line.width_mm *= style.width;
        line.variation = style.variation;
        line
    };
    let finished = groups.into_iter().map(|(wanted, group)| {
        (wanted, group.into_iter().enumerate().map(|(number, line)| finish(line, number)))
    });
    finished.filter(|(wanted, _)| *wanted).flat_map(|(_, group)| group).collect()
}

/// Draws what makes one person differ from another.
struct Person {
    rng: ChaCha8Rng,
    spread: f64,
    seed: u64,
}

impl Person {
    fn new(seed: u64) -> Self {
        let rng = ChaCha8Rng::seed_from_u64(seed ^ 0x0f01_d1e5);
        Self { rng, spread: if seed == 0 { 0.0 } else { 1.0 }, seed }
    }

    fn vary(&mut self, middle: f64, range: f64) -> f64 {
        middle + self.spread * range * self.rng.random_range(-1.0..1.0)
    }

    /// A number of lines: mostly the middling one.
    fn count(&mut self, middling: usize, least: usize, most: usize) -> usize {
        let draw = self.rng.random_range(0..5);
        match (self.spread > 0.0, draw) {
            (true, 0) => least,
            (true, 1) => most,
            _ => middling,
        }
    }

    fn wave(&mut self, shortest: f64, longest: f64) -> Wave {
        Wave::new(self.rng.random(), shortest, longest)
    }

    fn line(&mut self, id: String, group: Group, path: Vec<Point2<f64>>, width_mm: f64) -> WrinkleLine {
        let seed = self.rng.random::<u64>() ^ self.seed;
        let width_mm = width_mm.clamp(1.0, 2.5);
        WrinkleLine { id, group, paint: String::new(), path, width_mm, variation: 0.0, seed }
    }
}

fn letter(side: f64) -> char {
    if side > 0.0 { 'l' } else { 'r' }
}

/// A curve from `from` to `to` in steps of about ¾ mm.
fn traced(from: f64, to: f64, at: impl Fn(f64) -> Point2<f64>) -> Vec<Point2<f64>> {
    let count = ((to - from).abs() / 0.75).ceil().max(2.0) as usize;
    (0..=count).map(|i| at(from + (to - from) * i as f64 / count as f64)).collect()
}

fn forehead(person: &mut Person) -> Vec<WrinkleLine> {
    let count = person.count(3, 2, 4);
    let spacing = if count == 4 { person.vary(8.6, 0.1) } else { person.vary(10.2, 0.6) };
    // Four need the room up to the hair.
    let middle = if count == 4 { 82.0 } else { 80.2 };
    let lowest = middle - 0.5 * spacing * (count - 1) as f64 + person.vary(0.0, 0.8);
    let (arch, tilt) = (person.vary(-1.5, 1.8), person.vary(0.0, 0.02));
    // Neighbours wave together, so that they keep apart.
    let common = person.wave(22.0, 60.0);
    let mut line = |number: usize| {
        let (middle, half) = (person.vary(0.0, 5.0), person.vary(38.0 - 3.0 * number as f64, 4.0));
        let own = person.wave(14.0, 40.0);
        let t = lowest + spacing * number as f64;
        let path = traced(middle - half, middle + half, |s| {
            let bow = arch * (s / 40.0).powi(2) + tilt * s;
            Point2::new(s, t + bow + 1.3 * common.at(s) + 0.35 * own.at(s))
        });
        let width = person.vary(1.7, 0.4);
        person.line(format!("forehead_{}", number + 1), Group::Forehead, path, width)
    };
    (0..count).map(&mut line).collect()
}

fn glabella(person: &mut Person) -> Vec<WrinkleLine> {
    let count = person.count(2, 1, 2);
    let mut line = |number: usize| {
        // A single line stands beside the middle.
        let side = if number == 0 { 1.0 } else { -1.0 };
        let s = side * if count == 1 { person.vary(3.0, 2.0) } else { person.vary(6.3, 1.2) };
        let (low, high) = (person.vary(44.5, 1.0), person.vary(62.5, 1.0));
        let (lean, wave) = (person.vary(1.0, 1.0), person.wave(10.0, 30.0));
        let path = traced(low, high, |t| {
            let up = (t - low) / (high - low);
            Point2::new(s + side * lean * up * up + 0.4 * wave.at(t), t)
        });
        let width = person.vary(1.5, 0.35);
        person.line(format!("glabella_{}", letter(side)), Group::Glabella, path, width)
    };
    (0..count).map(&mut line).collect()
}

fn crows_feet(person: &mut Person, side: f64) -> Vec<WrinkleLine> {
    let count = person.count(3, 2, 4);
    let middle = person.vary(0.03, 0.06);
    let fan = person.vary(0.95, 0.12);
    let mut line = |number: usize| {
        let place = number as f64 / (count - 1) as f64 - 0.5;
        let start = Point2::new(51.5 + 1.2 * (1.0 - 4.0 * place * place), 36.3 - place * 9.0);
        let (length, bend) = (person.vary(16.5, 2.0), person.vary(0.006, 0.008));
        let angle = middle - place * fan;
        let wave = person.wave(9.0, 25.0);
        let along = Vector2::new(angle.cos(), angle.sin());
        let path = traced(0.0, length, |x| {
            let off = -bend * x * x * place.signum() + 0.35 * wave.at(x) * smooth_step(x / 4.0);
            let at = start + along * x + Vector2::new(-along.y, along.x) * off;
            Point2::new(side * at.x, at.y)
        });
        let width = person.vary(1.15, 0.15);
        person.line(format!("crows_feet_{}_{}", letter(side), number + 1), Group::CrowsFeet, path, width)
    };
    (0..count).map(&mut line).collect()
}

fn nasolabial(person: &mut Person, side: f64) -> WrinkleLine {
    let (top, bottom) = (person.vary(1.5, 1.5), person.vary(-36.0, 3.0));
    let (out, bow) = (person.vary(1.0, 0.8), person.vary(13.0, 1.0));
    let wave = person.wave(14.0, 40.0);
    let path = traced(top, bottom, |t| {
        let crease = 22.0 + bow * (1.0 - (-0.5 * ((t - 4.0) / 17.0).powi(2)).exp());
        Point2::new(side * (crease + out + 0.6 * wave.at(t)), t)
    });
    let width = person.vary(2.1, 0.35);
    person.line(format!("nasolabial_{}", letter(side)), Group::Nasolabial, path, width)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spacing(one: &WrinkleLine, other: &WrinkleLine) -> f64 {
        let near = |a: &Point2<f64>| other.path.iter().map(|b| (a - b).norm()).fold(f64::INFINITY, f64::min);
        one.path.iter().map(near).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn the_middling_face_has_thirteen() {
        let ids: Vec<String> = lines(0, &Style::default()).into_iter().map(|line| line.id).collect();
        assert_eq!(ids.len(), 13);
        for id in ["forehead_3", "glabella_r", "crows_feet_r_3", "nasolabial_l"] {
            assert!(ids.iter().any(|other| other == id), "{id}");
        }
    }

    #[test]
    fn lines_keep_apart_and_in_place() {
        for seed in 0..40 {
            let lines = lines(seed, &Style::default());
            for (i, one) in lines.iter().enumerate() {
                assert!((1.0..=2.5).contains(&one.width_mm));
                for other in &lines[..i] {
                    let least = match (one.group, other.group) {
                        (Group::Forehead, Group::Forehead) => 7.9,
                        (Group::CrowsFeet, Group::CrowsFeet) => 2.4,
                        _ => 3.0,
                    };
                    let apart = spacing(one, other);
                    assert!(apart >= least, "seed {seed}: {} and {} are {apart} mm apart", one.id, other.id);
                }
                for at in &one.path {
                    let inside = match one.group {
                        Group::Forehead => (63.0..97.0).contains(&at.y) && at.x.abs() < 50.0,
                        Group::Glabella => (43.0..65.0).contains(&at.y) && at.x.abs() < 11.0,
                        Group::CrowsFeet => (50.0..73.0).contains(&at.x.abs()),
                        _ => (20.0..41.0).contains(&at.x.abs()),
                    };
                    assert!(inside, "seed {seed}: {} at {at}", one.id);
                }
            }
        }
    }

    #[test]
    fn seeds_differ_and_repeat() {
        let style = Style::default();
        assert_eq!(lines(7, &style), lines(7, &style));
        assert_ne!(lines(7, &style), lines(8, &style));
        let counts: std::collections::BTreeSet<usize> =
            (1..20).map(|seed| lines(seed, &style).len()).collect();
        assert!(counts.len() > 2, "{counts:?}");
        let bare = lines(7, &Style { forehead: false, ..style.clone() });
        let full = lines(7, &style);
        assert!(bare.iter().all(|line| full.contains(line)) && bare.len() < full.len());
    }
}
