//! What is no wrinkle: hair, and shading that falls off towards the face's border.
#![allow(clippy::unwrap_used, reason = "tests may")]

use normalmap_acquire::{Acquired, Face, Pair, Params, Photo, Plane, Region, acquire};

const SIDE: usize = 240;

/// A number between −1 and 1 for each pixel of a picture, without a pattern.
fn noise(picture: u64, x: usize, y: usize) -> f64 {
    let mut bits = picture << 40 ^ (x as u64) << 20 ^ y as u64;
    for _ in 0..3 {
        bits = (bits ^ bits >> 31).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
    (bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

fn photo(log: impl Fn(usize, usize) -> f64 + Sync) -> Photo {
    let light = Plane::from_fn(SIDE, SIDE, |x, y| 0.4 * log(x, y).exp());
    Photo { usable: light.map(|_| 1.0), light }
}

fn found(rest: &Photo, smile: &Photo) -> Acquired {
    let at = |i: usize| [4.0 + 58.0 * (i % 5) as f64, 4.0 + 58.0 * (i / 5) as f64];
    let pairs = (0..25).map(|i| Pair { id: i.to_string(), from: at(i), to: at(i) }).collect();
    let face = Face { pairs, io_px: 120.0, ..Face::default() };
    let region = Region { refine: false, ..Region::of(Default::default()) };
    acquire(rest, smile, &face, &region, &Params::default()).unwrap()
}

/// Tilts over columns and rows, degrees, rising.
fn tilts(found: &Acquired, columns: std::ops::Range<usize>, rows: std::ops::Range<usize>) -> Vec<f64> {
    let all = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
    let mut tilts: Vec<f64> =
        all.map(|(x, y)| found.normals[2].at(x, y).min(1.0).acos().to_degrees()).collect();
    tilts.sort_by(f64::total_cmp);
    tilts
}

fn wrinkle(y: usize) -> f64 {
    -0.35 * (-((y as f64 - 75.0) / 4.0).powi(2)).exp()
}

#[test]
fn hair_that_moves_is_left_out_and_the_wrinkle_beside_it_stays() {
    let strand =
        |shift: usize, x: usize, y: usize| if y > 150 { 0.5 * (1.3 * (x + shift) as f64).sin() } else { 0.0 };
    let rest = photo(|x, y| 0.02 * noise(1, x, y) + strand(0, x, y));
    let smile = photo(|x, y| 0.02 * noise(2, x, y) + strand(1, x, y) + wrinkle(y));
    let found = found(&rest, &smile);
    assert_eq!(tilts(&found, 20..220, 160..225).last(), Some(&0.0));
    let walls = tilts(&found, 60..180, 69..73);
    assert!(walls[walls.len() / 2] > 12.0, "{}", walls[walls.len() / 2]);
}

#[test]
fn shading_that_falls_off_at_the_border_is_no_wrinkle() {
    let fall = |x: usize| -0.3 * (x as f64 - 180.0).max(0.0) / 56.0;
    let rest = photo(|x, y| 0.02 * noise(1, x, y));
    let smile = photo(|x, y| 0.02 * noise(2, x, y) + fall(x) + wrinkle(y));
    let found = found(&rest, &smile);
    let border = tilts(&found, 205..234, 110..220);
    assert!(border[border.len() * 9 / 10] < 4.0, "{}", border[border.len() * 9 / 10]);
    let walls = tilts(&found, 60..160, 69..73);
    assert!(walls[walls.len() / 2] > 12.0, "{}", walls[walls.len() / 2]);
}
