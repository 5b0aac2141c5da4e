//! All dots of one image, without names.

use crate::blobs::{self, Area};
use crate::center::{Owners, Patch};
use crate::{Error, Paint, Picture};

/// Dots whose colour is within this of a stated one start the search, 8-bit codes.
const NEAR_CODES: i32 = 48;

/// A dot of an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// Centroid of its paint, px.
    pub at: [f64; 2],
    /// Its paint's area in the image, px².
    pub area: f64,
}

/// Finds all dots of the paint, from top to bottom.
#[must_use]
pub fn detect(picture: &Picture, paint: &Paint) -> Vec<Found> {
    let blobs = blobs::find(picture, paint, &Area::everything(picture));
    let mut owners = Owners::default();
    owners.enter(picture, &blobs);
    let spot =
        |(number, blob): (usize, &blobs::Blob)| Patch::cut(picture, paint, &owners, blob, &[number])?.spot();
    blobs
        .iter()
        .enumerate()
        .filter(|(_, blob)| blob.is_dot())
        .filter_map(spot)
        .map(|spot| Found { at: spot.at, area: spot.area })
        .collect()
}

/// Places that show a colour, one per patch: where to learn the paint from if nobody has clicked on dots.
///
/// # Errors
/// [`Error::NoColor`] if no pixel shows it.
pub fn places_of_color(picture: &Picture, color: [u8; 3]) -> Result<Vec<[f64; 2]>, Error> {
    let off = |pixel: [u8; 3]| {
        let offs = pixel.iter().zip(color).map(|(a, b)| (i32::from(*a) - i32::from(b)).abs());
        offs.max().unwrap_or(0)
    };
    let mut places: Vec<[f64; 2]> = Vec::new();
    // Coarse cells keep one place each: the pixel nearest to the colour.
    const CELL: usize = 8;
    for top in (0..picture.height).step_by(CELL) {
        for left in (0..picture.width).step_by(CELL) {
            let rows = top..(top + CELL).min(picture.height);
            let columns = left..(left + CELL).min(picture.width);
            let pixels = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
            let best = pixels.map(|(x, y)| (off(picture.at(x, y)), x, y)).min();
            if let Some((_, x, y)) = best.filter(|(off, _, _)| *off <= NEAR_CODES) {
                places.push([x as f64, y as f64]);
            }
        }
    }
    match places.is_empty() {
        true => Err(Error::NoColor(color)),
        false => Ok(places),
    }
}
