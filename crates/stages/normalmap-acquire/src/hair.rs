//! Hair: beards, brows, strands over the forehead.

use crate::blur::blurred;
use crate::plane::{Plane, median};
use crate::ratio::counted;

/// Strands are told between these two blurs, io.
const STRAND_IO: [f64; 2] = [0.004, 0.014];
/// Window over which strands are counted together, io.
const WINDOW_IO: f64 = 0.035;
/// Skin whose fine structure is stronger by this factor than usual is hairy.
const ROUGH: f64 = 2.2;
/// Blur in which hair is dark as a whole, io, and how much darker than usual skin it is (log).
const DARK_IO: f64 = 0.03;
const DARK: f64 = 1.1;

/// 1 where skin is bare, 0 where it is hairy: much rougher or much darker than is usual in the region.
///
/// `light`: linear light at rest, where wrinkles are few; `region`: 1 within the face.
#[must_use]
pub(crate) fn bare(light: &Plane, region: &Plane, io: f64) -> Plane {
    let log = light.map(|light| light.max(1e-4).ln());
    let fine =
        blurred(&log, STRAND_IO[0] * io).with(&blurred(&log, STRAND_IO[1] * io), |a, b| (a - b).powi(2));
    let rough = blurred(&fine, WINDOW_IO * io).map(f64::sqrt);
    let usual = median(counted(&rough, region)).max(1e-6);
    let dark = blurred(&log, DARK_IO * io);
    let middle = median(counted(&dark, region));
    rough.with(&dark, |rough, dark| f64::from(u8::from(rough < ROUGH * usual && dark > middle - DARK)))
}
