//! Which wrinkles there are, by the mask of one image and the names that somebody gave.

use crate::bits::{Bits, Patch};
use crate::params::TrackParams;
use crate::region::Region;
use crate::spline::Place;

/// A place on a wrinkle's paint, with the wrinkle's name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedPlace {
    /// The wrinkle.
    pub wrinkle: String,
    /// Column and row, px.
    pub at: Place,
}

/// A wrinkle as it is marked.
#[derive(Debug, Clone, PartialEq)]
pub struct MarkedWrinkle {
    /// Its id.
    pub id: String,
    /// Number of its paint, counted from 1.
    pub paint: u8,
    /// Its marked pixels.
    pub region: Region,
}

/// The wrinkles of a mask, and what could not be placed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Marked {
    /// The wrinkles, sorted by id.
    pub wrinkles: Vec<MarkedWrinkle>,
    /// Centres of patches that have no name, and lie near none that has.
    pub unnamed: Vec<Place>,
    /// Names beside which nothing is painted.
    pub misplaced: Vec<NamedPlace>,
}

/// A name may lie so far beside its paint, px: hands shake.
const BESIDE_PX: f64 = 6.0;
/// Smaller specks of a mask are slips of the brush, px².
const SPECK_PX: usize = 8;

/// The wrinkles that a mask marks (`labels` as [`crate::marks::labels`] gives them). With names, each patch belongs to the wrinkle
/// whose name lies on it, several names on one patch share it, and pieces without a name belong to the named patch of their
/// paint within reach. Without, pieces of a paint near each other are one wrinkle, called `prefix`, the paint and a number.
#[must_use]
pub fn marked_wrinkles(
    size: [usize; 2],
    labels: &[u8],
    paints: &[String],
    names: &[NamedPlace],
    prefix: &str,
    params: &TrackParams,
) -> Marked {
    let mut marked = Marked::default();
    let mut placed = vec![false; names.len()];
    for (index, paint) in paints.iter().enumerate() {
        let number = index as u8 + 1;
        let bits = Bits::of(size[0], size[1], |pixel| labels[pixel] == number);
        let patches = bits.patches(SPECK_PX);
        let groups = match names.is_empty() {
            true => joined(&patches, params.join_px)
                .into_iter()
                .enumerate()
                .map(|(i, pixels)| (format!("{prefix}{paint}_{}", i + 1), pixels))
                .collect(),
            false => named(&patches, names, &mut placed, params.join_px, &mut marked.unnamed),
        };
        for (id, pixels) in groups {
            marked.wrinkles.push(MarkedWrinkle { id, paint: number, region: Region::new(pixels) });
        }
    }
    marked.misplaced =
        names.iter().zip(&placed).filter(|(_, placed)| !**placed).map(|(name, _)| name.clone()).collect();
    marked.wrinkles.sort_by(|a, b| a.id.cmp(&b.id));
    marked
}

/// Pixels of patches that lie near each other, directly or by others.
fn joined(patches: &[Patch], join_px: f64) -> Vec<Vec<[usize; 2]>> {
    let mut groups: Vec<usize> = (0..patches.len()).collect();
    for i in 0..patches.len() {
        for j in 0..i {
            if groups[i] != groups[j] && gap(&patches[i], &patches[j]) <= join_px {
                let (from, to) = (groups[i].max(groups[j]), groups[i].min(groups[j]));
                groups.iter_mut().filter(|group| **group == from).for_each(|group| *group = to);
            }
        }
    }
    let collect = |group: usize| -> Vec<[usize; 2]> {
        let members = patches.iter().zip(&groups).filter(|(_, of)| **of == group);
        members.flat_map(|(patch, _)| patch.pixels()).collect()
    };
    (0..patches.len()).map(collect).filter(|pixels| !pixels.is_empty()).collect()
}

/// The distance of two patches, px.
fn gap(one: &Patch, other: &Patch) -> f64 {
    let mut least = f64::INFINITY;
    for a in &one.runs {
        for b in &other.runs {
            let across = a.from.saturating_sub(b.to).max(b.from.saturating_sub(a.to)) as f64;
            least = least.min(across.hypot(a.row.abs_diff(b.row) as f64));
        }
    }
    least
}

/// Patches by the names that lie on them, then pieces by the nearest named patch.
fn named(
    patches: &[Patch],
    names: &[NamedPlace],
    placed: &mut [bool],
    join_px: f64,
    unnamed: &mut Vec<Place>,
) -> Vec<(String, Vec<[usize; 2]>)> {
    let on: Vec<Vec<usize>> = patches
        .iter()
        .map(|patch| (0..names.len()).filter(|name| lies_on(patch, names[*name].at)).collect())
        .collect();
    let mut groups: std::collections::BTreeMap<&str, Vec<[usize; 2]>> = Default::default();
    for (patch, here) in patches.iter().zip(&on) {
        here.iter().for_each(|name| placed[*name] = true);
        if here.is_empty() {
            let near = patches.iter().zip(&on).filter(|(_, on)| !on.is_empty());
            let nearest = near
                .map(|(other, on)| (gap(patch, other), on))
                .filter(|(gap, _)| *gap <= join_px)
                .min_by(|a, b| a.0.total_cmp(&b.0));
            match nearest {
                Some((_, on)) => share_out(patch, on, names, &mut groups),
                None => unnamed.push(Region::new(patch.pixels().collect()).center()),
            }
        } else {
            share_out(patch, here, names, &mut groups);
        }
    }
    groups.into_iter().map(|(id, pixels)| (id.to_string(), pixels)).collect()
}

/// Each pixel of a patch to the nearest of some names.
fn share_out<'a>(
    patch: &Patch,
    candidates: &[usize],
    names: &'a [NamedPlace],
    groups: &mut std::collections::BTreeMap<&'a str, Vec<[usize; 2]>>,
) {
    for pixel in patch.pixels() {
        let place = Place::new(pixel[0] as f64, pixel[1] as f64);
        let nearest = candidates.iter().min_by(|a, b| {
            let distance = |name: usize| (names[name].at - place).norm_squared();
            distance(**a).total_cmp(&distance(**b))
        });
        if let Some(name) = nearest {
            groups.entry(&names[*name].wrinkle).or_default().push(pixel);
        }
    }
}

/// Whether a place lies on a patch, or as near beside it as hands shake.
pub(crate) fn lies_on(patch: &Patch, at: Place) -> bool {
    patch.runs.iter().any(|run| {
        let across = (run.from as f64 - at.x).max(at.x - run.to as f64).max(0.0);
        across.hypot(run.row as f64 - at.y) <= BESIDE_PX
    })
}
