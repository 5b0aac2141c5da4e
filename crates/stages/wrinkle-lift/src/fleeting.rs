//! Valleys that a single image shows, and those before and after it do not.

use artifact::{SectionState, SectionsFrame, ValleyPoint, ValleysFrame};
use nalgebra::{Point3, Vector3};
use std::collections::BTreeSet;

/// Flattens wrinkles that are open in one image only, between images that see them flat: skin folds and unfolds over several images, and what
/// comes and goes within one is noise of the measurement, which would be seen as a flicker. At the ends of a take, and beside images that
/// do not show the wrinkle, one flat neighbour is enough; one that is farther than twice the usual time between images says nothing. What
/// is [`edited`] stays.
///
/// Returns how many were flattened.
pub fn flatten_fleeting(frames: &mut [ValleysFrame], edited: &BTreeSet<(i64, String)>) -> usize {
    let numbers: Vec<i64> = frames.iter().map(|frame| frame.frame).collect();
    let Some(usual) = numbers.windows(2).map(|pair| pair[1] - pair[0]).min() else { return 0 };
    let ids: BTreeSet<String> = frames.iter().flat_map(|frame| frame.valleys.keys().cloned()).collect();
    let mut count = 0;
    for id in ids {
        let seen: Vec<(usize, bool)> = frames
            .iter()
            .enumerate()
            .filter_map(|(i, frame)| Some((i, is_open(frame.valleys.get(&id)?))))
            .collect();
        for (k, &(i, open)) in seen.iter().enumerate() {
            let beside = [k.checked_sub(1), Some(k + 1)].into_iter().flatten().filter_map(|k| seen.get(k));
            let near = |other: usize| (numbers[other] - numbers[i]).abs() <= 2 * usual;
            let mut beside = beside.filter(|(other, _)| near(*other)).peekable();
            let fleeting = open && beside.peek().is_some() && beside.all(|(_, open)| !open);
            if fleeting && !edited.contains(&(numbers[i], id.clone())) {
                frames[i].valleys.get_mut(&id).into_iter().flatten().for_each(flatten);
                count += 1;
            }
        }
    }
    count
}

/// Which wrinkles a person set, by frame.
#[must_use]
pub fn edited(frames: &[SectionsFrame]) -> BTreeSet<(i64, String)> {
    let mut found = BTreeSet::new();
    for frame in frames {
        for (id, sections) in frame.sections.values().flatten() {
            if sections.iter().any(|section| section.state == SectionState::Edited) {
                found.insert((frame.frame, id.clone()));
            }
        }
    }
    found
}

fn is_open(points: &[ValleyPoint]) -> bool {
    points.iter().any(|point| point.d_mm > 0.0)
}

/// The bottom rises to the surface.
fn flatten(point: &mut ValleyPoint) {
    point.at_mm = (Point3::from(point.at_mm) + Vector3::from(point.normal) * point.d_mm).into();
    point.d_mm = 0.0;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(frame: i64, d_mm: f64) -> ValleysFrame {
        let point = |x_mm| ValleyPoint {
            x_mm,
            face: 0,
            barycentric: [1.0, 0.0, 0.0],
            at_mm: [x_mm, 0.0, -d_mm],
            normal: [0.0, 0.0, 1.0],
            across: [0.0, 1.0, 0.0],
            w_mm: 1.0,
            d_mm,
            epsilon: 0.0,
            kappa: 0.0,
        };
        ValleysFrame { frame, valleys: [("brow".to_string(), vec![point(0.0), point(1.0)])].into() }
    }

    fn depths(d_mm: &[f64], edited: &[i64]) -> (Vec<f64>, usize) {
        let mut frames: Vec<ValleysFrame> = (0..).zip(d_mm).map(|(i, d)| frame(1001 + 4 * i, *d)).collect();
        let edited = edited.iter().map(|frame| (*frame, "brow".to_string())).collect();
        let count = flatten_fleeting(&mut frames, &edited);
        let at = |frame: &ValleysFrame| frame.valleys["brow"][1];
        assert!(frames.iter().all(|frame| at(frame).at_mm[2] == -at(frame).d_mm));
        (frames.iter().map(|frame| at(frame).d_mm).collect(), count)
    }

    #[test]
    fn what_lasts_for_one_image_is_noise() {
        assert_eq!(depths(&[0.7, 0.0, 0.4, 0.0, 0.5, 0.9, 0.0], &[]).0, [0.0, 0.0, 0.0, 0.0, 0.5, 0.9, 0.0]);
        assert_eq!(depths(&[0.0, 0.5, 0.8, 0.3], &[]), (vec![0.0, 0.5, 0.8, 0.3], 0));
    }

    #[test]
    fn what_a_person_set_and_what_stands_alone_stays() {
        assert_eq!(depths(&[0.0, 0.4, 0.0], &[1005]).0, [0.0, 0.4, 0.0]);
        assert_eq!(depths(&[0.4], &[]), (vec![0.4], 0));
        let mut apart = [frame(1001, 0.0), frame(1005, 0.0), frame(1100, 0.4), frame(1200, 0.0)];
        assert_eq!(flatten_fleeting(&mut apart, &BTreeSet::new()), 0, "no image near it");
    }
}
