//! Which wrinkles there are, by the mask of one image and the names that somebody gave.

use crate::bits::{Bits, Patch};
use crate::params::TrackParams;
use crate::region::Region;
use crate::spline::Place;
use std::collections::BTreeMap;

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
    let patches: Vec<Vec<Patch>> = (1..=paints.len() as u8)
        .map(|number| Bits::of(size[0], size[1], |pixel| labels[pixel] == number).patches(SPECK_PX))
        .collect();
    let lie_on = names.iter().map(|name| patch_of(&patches, name.at)).collect::<Vec<_>>();
    for (index, (paint, patches)) in paints.iter().zip(&patches).enumerate() {
        let groups = match names.is_empty() {
            true => joined(patches, params.join_px)
                .into_iter()
                .enumerate()
                .map(|(i, pixels)| (format!("{prefix}{paint}_{}", i + 1), pixels))
                .collect(),
            false => {
                let on: Vec<Vec<usize>> = (0..patches.len())
                    .map(|patch| (0..names.len()).filter(|i| lie_on[*i] == Some([index, patch])).collect())
                    .collect();
                named(patches, &on, names, params.join_px, &mut marked.unnamed)
            }
        };
        for (id, pixels) in groups {
            marked.wrinkles.push(MarkedWrinkle { id, paint: index as u8 + 1, region: Region::new(pixels) });
        }
    }
    let misplaced = names.iter().zip(&lie_on).filter(|(_, patch)| patch.is_none());
    marked.misplaced = misplaced.map(|(name, _)| name.clone()).collect();
    marked.wrinkles.sort_by(|a, b| a.id.cmp(&b.id));
    marked
}

/// The patch that a place lies on, or nearest to within reach of a shaking hand: its paint's index, its own.
fn patch_of(patches: &[Vec<Patch>], at: Place) -> Option<[usize; 2]> {
    let all = patches.iter().enumerate();
    let all = all.flat_map(|(paint, patches)| (0..patches.len()).map(move |patch| [paint, patch]));
    let distances = all.map(|place| (distance(&patches[place[0]][place[1]], at), place));
    let nearest = distances.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (nearest.0 <= BESIDE_PX).then_some(nearest.1)
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

/// Patches by the names that lie on them (`on`, per patch), then pieces by the nearest named patch.
fn named(
    patches: &[Patch],
    on: &[Vec<usize>],
    names: &[NamedPlace],
    join_px: f64,
    unnamed: &mut Vec<Place>,
) -> Vec<(String, Vec<[usize; 2]>)> {
    let mut groups = BTreeMap::new();
    for (patch, here) in patches.iter().zip(on) {
        if !here.is_empty() {
            share_out(patch, here, names, &mut groups);
            continue;
        }
        let near = patches.iter().zip(on).filter(|(_, on)| !on.is_empty());
        let nearest = near
            .map(|(other, on)| (gap(patch, other), on))
            .filter(|(gap, _)| *gap <= join_px)
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match nearest {
            Some((_, on)) => share_out(patch, on, names, &mut groups),
            None => unnamed.push(Region::new(patch.pixels().collect()).center()),
        }
    }
    groups.into_iter().map(|(id, pixels)| (id.to_string(), pixels)).collect()
}

/// Each pixel of a patch to the nearest of some names.
fn share_out<'a>(
    patch: &Patch,
    candidates: &[usize],
    names: &'a [NamedPlace],
    groups: &mut BTreeMap<&'a str, Vec<[usize; 2]>>,
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

/// How far beside a patch a place lies, px.
fn distance(patch: &Patch, at: Place) -> f64 {
    let to_run = |run: &crate::bits::Run| {
        let across = (run.from as f64 - at.x).max(at.x - run.to as f64).max(0.0);
        across.hypot(run.row as f64 - at.y)
    };
    patch.runs.iter().map(to_run).fold(f64::INFINITY, f64::min)
}

/// Whether a place lies on a patch, or as near beside it as hands shake.
pub(crate) fn lies_on(patch: &Patch, at: Place) -> bool {
    distance(patch, at) <= BESIDE_PX
}
