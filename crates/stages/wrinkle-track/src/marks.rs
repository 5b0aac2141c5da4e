//! What somebody marked as paint: the colours of a mask, and which pixels have them.

use crate::Error;
use artifact::picture::Marked;
use std::collections::BTreeMap;

/// A paint as it is marked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MarkedPaint {
    /// Name of the paint.
    pub name: String,
    /// Colour that stands for it in masks.
    pub mark: [u8; 3],
}

/// Of a pixel that is not marked.
pub const BARE: u8 = 0;
/// Of a pixel of which nobody knows: its mark has no paint's colour.
pub const UNKNOWN: u8 = u8::MAX;

/// A colour of fewer marked pixels than this share is a blend, as soft brushes leave them.
const LEAST_SHARE: f64 = 0.005;
/// With so many blends something is wrong with the mask.
const MOST_BLENDS: f64 = 0.25;

/// The paints that masks mark, sorted by name; `named` are those whose names are given.
///
/// # Errors
/// [`Error::EmptyMask`], [`Error::Blends`].
pub fn marked_paints(masks: &[Marked], named: &[MarkedPaint]) -> Result<Vec<MarkedPaint>, Error> {
    let mut counts: BTreeMap<[u8; 3], usize> = BTreeMap::new();
    for mark in masks.iter().flat_map(|mask| mask.marks.iter().flatten()) {
        *counts.entry(*mark).or_default() += 1;
    }
    let painted: usize = counts.values().sum();
    if painted == 0 {
        return Err(Error::EmptyMask);
    }
    let is_common = |mark: &[u8; 3], count: usize| {
        named.iter().any(|paint| paint.mark == *mark) || count as f64 >= LEAST_SHARE * painted as f64
    };
    let blends =
        counts.iter().filter(|(mark, count)| !is_common(mark, **count)).map(|(_, count)| count).sum();
    if blends as f64 > MOST_BLENDS * painted as f64 {
        return Err(Error::Blends { blends, painted });
    }
    let mut paints: Vec<MarkedPaint> = Vec::new();
    for (mark, _) in counts.into_iter().filter(|(mark, count)| is_common(mark, *count)) {
        let given = named.iter().find(|paint| paint.mark == mark).map(|paint| paint.name.clone());
        let hue = hue_name(mark);
        let is_free = |name: &str| !paints.iter().chain(named).any(|paint| paint.name == name);
        let fallback = || match is_free(hue) {
            true => hue.to_string(),
            false => format!("{hue}_{:02x}{:02x}{:02x}", mark[0], mark[1], mark[2]),
        };
        paints.push(MarkedPaint { name: given.unwrap_or_else(fallback), mark });
    }
    paints.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(paints)
}

/// Per pixel of a mask the number of its paint, counted from 1; [`BARE`] and [`UNKNOWN`] else.
#[must_use]
pub fn labels(mask: &Marked, paints: &[MarkedPaint]) -> Vec<u8> {
    let label = |mark: &Option<[u8; 3]>| match mark {
        None => BARE,
        Some(mark) => paints.iter().position(|paint| paint.mark == *mark).map_or(UNKNOWN, |i| i as u8 + 1),
    };
    mask.marks.iter().map(label).collect()
}

/// What people call a colour.
fn hue_name([red, green, blue]: [u8; 3]) -> &'static str {
    let [r, g, b] = [red, green, blue].map(f64::from);
    let (most, least) = (r.max(g).max(b), r.min(g).min(b));
    if most - least < 0.12 * most {
        return if most > 160.0 { "white" } else { "grey" };
    }
    let span = most - least;
    let sixth = match () {
        () if most == r => (g - b) / span,
        () if most == g => 2.0 + (b - r) / span,
        () => 4.0 + (r - g) / span,
    };
    match (60.0 * sixth).rem_euclid(360.0) {
        hue if hue < 15.0 => "red",
        hue if hue < 45.0 => "orange",
        hue if hue < 70.0 => "yellow",
        hue if hue < 165.0 => "green",
        hue if hue < 195.0 => "cyan",
        hue if hue < 255.0 => "blue",
        hue if hue < 300.0 => "violet",
        hue if hue < 345.0 => "magenta",
        _ => "red",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mask(marks: Vec<Option<[u8; 3]>>) -> Marked {
        Marked { width: marks.len(), height: 1, marks }
    }

    #[test]
    fn colours_have_the_names_that_people_give_them() {
        let names =
            [[255, 0, 0], [107, 255, 146], [229, 118, 255], [30, 60, 250], [255, 255, 255]].map(hue_name);
        assert_eq!(names, ["red", "green", "violet", "blue", "white"]);
    }

    #[test]
    fn two_colours_of_one_name_are_told_apart_and_given_names_hold() {
        let marks = vec![Some([0, 255, 0]), Some([0, 200, 0]), None, Some([9, 9, 255])];
        let named = [MarkedPaint { name: "brow".into(), mark: [9, 9, 255] }];
        let paints = marked_paints(&[mask(marks.clone())], &named).unwrap();
        let names: Vec<&str> = paints.iter().map(|paint| paint.name.as_str()).collect();
        assert_eq!(names, ["brow", "green", "green_00ff00"]);
        assert_eq!(labels(&mask(marks), &paints), [3, 2, BARE, 1]);
    }

    #[test]
    fn soft_edges_are_of_no_paint_and_too_many_are_refused() {
        let mut marks = vec![Some([255, 0, 0]); 1000];
        marks.extend((0..100).map(|i| Some([100 + i, 0, 0])));
        let paints = marked_paints(&[mask(marks.clone())], &[]).unwrap();
        assert_eq!((paints.len(), labels(&mask(marks.clone()), &paints)[1050]), (1, UNKNOWN));
        let soft = (0..500).map(|i| Some([100 + (i % 100) as u8, (i / 100) as u8, 0]));
        marks.extend(soft);
        assert_eq!(marked_paints(&[mask(marks)], &[]), Err(Error::Blends { blends: 600, painted: 1600 }));
        assert_eq!(marked_paints(&[mask(vec![None; 4])], &[]), Err(Error::EmptyMask));
    }
}
