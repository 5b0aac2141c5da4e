//! The creases of a take: each a line on the skin, with its section over time.

use crate::curve::{Curve, tangent};
use crate::locator::{Locator, Place};
use crate::profile::Profile;
use crate::surface::Surface;
use crate::{Error, Params, Track};
use artifact::{ValleyPoint, ValleysFrame};
use nalgebra::{Point3, Vector3};
use serde::Serialize;

/// Spacing of the samples along a crease, mm.
const SPACING_MM: f64 = 0.5;
/// How far, mm, a crease may wander to be taken for the same.
const FARTHEST_MM: f64 = 5.0;
/// A valley that ends open ends on a slope of so many mm per mm.
const END_SLOPE: f64 = 0.7;

/// A crease over a take.
pub(crate) struct Crease {
    pub(crate) id: String,
    pub(crate) curve: Curve,
    /// Per frame that valleys were given for, per sample: the section, d = 0 where there is none.
    sections: Vec<Vec<Profile>>,
    /// The same for how far to the right of the curve it was found, mm; without any where it stays.
    offsets: Option<Vec<Vec<f64>>>,
    pub(crate) drift: Drift,
    /// Largest width of all, mm.
    pub(crate) widest_mm: f64,
    pub(crate) deepest_mm: f64,
    /// Narrowest width of where it is deeper than the fading depth, mm.
    pub(crate) narrowest_mm: f64,
}

/// How far a crease wanders over the skin, 95 % of all samples, mm in the rest pose.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Drift {
    /// As it was found.
    pub found_mm: f64,
    /// As it is used.
    pub used_mm: f64,
}

/// All creases, and the frames that they are known in.
pub(crate) struct Creases {
    pub(crate) all: Vec<Crease>,
    pub(crate) frames: Vec<i64>,
    step: i64,
}

impl Creases {
    pub(crate) fn new(
        surface: &Surface,
        normals: &[Vector3<f64>],
        ids: &[String],
        frames: &[ValleysFrame],
        params: &Params,
    ) -> Result<Self, Error> {
        check_triangles(surface, frames)?;
        let numbers: Vec<i64> = frames.iter().map(|frame| frame.frame).collect();
        let mut steps: Vec<i64> = numbers.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_unstable();
        let step = steps.get(steps.len() / 2).copied().unwrap_or(1);
        let locator = Locator::new(surface);
        let all = ids
            .iter()
            .filter_map(|id| {
                let given = frames.iter().map(|frame| frame.valleys.get(id).map_or(&[][..], Vec::as_slice));
                let lines: Vec<Line> = given.map(|points| Line::new(surface, points)).collect();
                Crease::new(surface, normals, &locator, id, &lines, params)
            })
            .collect();
        Ok(Self { all, frames: numbers, step })
    }

    /// Between which of the known frames a frame lies, and how deep valleys still are that far from them.
    pub(crate) fn moment(&self, frame: i64, params: &Params) -> Option<Moment> {
        let after = self.frames.partition_point(|&known| known <= frame);
        let gap = i64::from(params.longest_gap);
        // Depth falls linearly from the known frame on, over the longest gap.
        let alone = |at: usize| {
            let away = ((self.frames[at] - frame).abs() - self.step).max(0);
            let held = 1.0 - away as f64 / gap.max(1) as f64;
            (held > 0.0).then_some(Moment { before: at, after: at, share: 0.0, held })
        };
        match (after.checked_sub(1), after < self.frames.len()) {
            (None, false) => None,
            (None, true) => alone(0),
            (Some(before), false) => alone(before),
            (Some(before), true) => {
                let span = self.frames[after] - self.frames[before];
                let share = (frame - self.frames[before]) as f64 / span as f64;
                match span <= gap {
                    true => Some(Moment { before, after, share, held: 1.0 }),
                    false if share < 0.5 => alone(before),
                    false => alone(after),
                }
            }
        }
    }
}

/// A time between two frames in which valleys are known.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    before: usize,
    after: usize,
    share: f64,
    held: f64,
}

fn check_triangles(surface: &Surface, frames: &[ValleysFrame]) -> Result<(), Error> {
    let count = surface.triangles.len();
    for frame in frames {
        for (wrinkle, points) in &frame.valleys {
            if let Some(point) = points.iter().position(|point| point.face as usize >= count) {
                let (frame, wrinkle, face) = (frame.frame, wrinkle.clone(), points[point].face);
                return Err(Error::NoSuchTriangle { frame, wrinkle, point, face, count });
            }
        }
    }
    Ok(())
}

/// A crease as it was found in one frame, on the rest mesh.
struct Line {
    points: Vec<Point3<f64>>,
    places: Vec<Place>,
    /// Length from the start, mm.
    along: Vec<f64>,
    sections: Vec<Profile>,
}

impl Line {
    fn new(surface: &Surface, points: &[ValleyPoint]) -> Self {
        let places: Vec<Place> =
            points.iter().map(|point| Place { triangle: point.face, shares: point.barycentric }).collect();
        let section =
            |p: &ValleyPoint| Profile { w_mm: p.w_mm, d_mm: p.d_mm, epsilon: p.epsilon, kappa: p.kappa };
        let mut line = Self {
            points: places.iter().map(|place| place.on(&surface.rest, &surface.triangles)).collect(),
            places,
            along: Vec::new(),
            sections: points.iter().map(section).collect(),
        };
        let mut length = 0.0;
        for k in 0..line.points.len() {
            length += if k == 0 { 0.0 } else { (line.points[k] - line.points[k - 1]).norm() };
            line.along.push(length);
        }
        for (section, at) in line.sections.iter_mut().zip(&line.along) {
            section.d_mm = section.d_mm.min(END_SLOPE * at.min(length - at));
        }
        line
    }

    fn length(&self) -> f64 {
        self.along.last().copied().unwrap_or(0.0)
    }

    fn deepest(&self) -> f64 {
        self.sections.iter().map(|section| section.d_mm).fold(0.0, f64::max)
    }

    /// Where it crosses the plane across another curve at one of its samples: the distance along `across`, and the section.
    fn crossing(
        &self,
        at: &Point3<f64>,
        along: &Vector3<f64>,
        across: &Vector3<f64>,
    ) -> Option<(f64, Profile)> {
        let before = |point: &Point3<f64>| (point - at).dot(along);
        let mut best: Option<(f64, f64, Profile)> = None;
        for k in 1..self.points.len() {
            let (a, b) = (before(&self.points[k - 1]), before(&self.points[k]));
            if (a > 0.0) == (b > 0.0) && a != 0.0 {
                continue;
            }
            let share = if a == b { 0.0 } else { a / (a - b) };
            let from = self.points[k - 1] + (self.points[k] - self.points[k - 1]) * share - at;
            let distance = from.norm();
            if distance <= FARTHEST_MM && best.is_none_or(|best| distance < best.0) {
                best = Some((
                    distance,
                    from.dot(across),
                    self.sections[k - 1].between(&self.sections[k], share),
                ));
            }
        }
        best.map(|(_, offset, section)| (offset, section))
    }

    /// Places at equal distances along it.
    fn resampled(&self) -> Vec<Place> {
        let count = (self.length() / SPACING_MM).ceil().max(1.0) as usize;
        let place = |k: usize| {
            let at = self.length() * k as f64 / count as f64;
            let next = self.along.partition_point(|&along| along < at).clamp(1, self.along.len() - 1);
            let share = (at - self.along[next - 1])
                / (self.along[next] - self.along[next - 1]).max(f64::MIN_POSITIVE);
            (next, share)
        };
        (0..=count)
            .map(place)
            .map(|(next, share)| self.places[if share < 0.5 { next - 1 } else { next }])
            .collect()
    }
}

impl Crease {
    fn new(
        surface: &Surface,
        normals: &[Vector3<f64>],
        locator: &Locator,
        id: &str,
        lines: &[Line],
        params: &Params,
    ) -> Option<Self> {
        let deepest = lines.iter().map(Line::deepest).fold(0.0, f64::max);
        let longest = lines
            .iter()
            .filter(|line| line.points.len() > 1 && line.deepest() > 0.0 && line.deepest() >= 0.3 * deepest)
            .max_by(|a, b| a.length().total_cmp(&b.length()))?;
        let mut places = longest.resampled();
        places.dedup();
        let guide = Curve::new(surface, normals, places);
        let (mut sections, offsets) = crossings(&guide, lines);
        fill_sections(&mut sections);
        let track = steady_track(&sections, &offsets);
        let wander: Vec<Vec<f64>> = offsets
            .iter()
            .map(|row| {
                row.iter().zip(&track).map(|(offset, track)| offset.unwrap_or(*track) - track).collect()
            })
            .collect();
        let found_mm = wander_95(&wander, &sections, params.fade_depth_mm);
        let curve = shifted(surface, normals, locator, &guide, &track);
        let used_mm = if params.track == Track::AsFound { found_mm } else { 0.0 };
        let open = || sections.iter().flatten().filter(|section| section.d_mm > params.fade_depth_mm);
        Some(Self {
            id: id.to_string(),
            widest_mm: open().map(|section| section.w_mm * (1.0 + section.kappa.abs())).fold(0.0, f64::max),
            narrowest_mm: open().map(|section| section.w_mm).fold(f64::INFINITY, f64::min),
            deepest_mm: deepest,
            offsets: (params.track == Track::AsFound && found_mm > 0.0).then_some(wander),
            drift: Drift { found_mm, used_mm },
            curve,
            sections,
        })
    }

    /// The sections along the crease at a time; nothing where it is closed all along.
    pub(crate) fn sections(&self, moment: &Moment) -> Option<Vec<Profile>> {
        let row = |at: usize, k: usize| &self.sections[at.min(self.sections.len() - 1)][k];
        let mix = |k: usize| {
            let mut section = row(moment.before, k).between(row(moment.after, k), moment.share);
            let beyond = [moment.before.saturating_sub(1), moment.before, moment.after, moment.after + 1];
            section.d_mm = moment.held * monotone(beyond.map(|at| row(at, k).d_mm), moment.share);
            section
        };
        let sections: Vec<Profile> = (0..self.curve.points.len()).map(mix).collect();
        sections.iter().any(|section| section.d_mm > 0.0).then_some(sections)
    }

    /// The line at a time.
    pub(crate) fn curve_at(
        &self,
        surface: &Surface,
        normals: &[Vector3<f64>],
        locator: &Locator,
        moment: &Moment,
    ) -> Option<Curve> {
        let offsets = self.offsets.as_ref()?;
        let pairs = offsets[moment.before].iter().zip(&offsets[moment.after]);
        let offsets: Vec<f64> = pairs.map(|(a, b)| a + moment.share * (b - a)).collect();
        Some(shifted(surface, normals, locator, &self.curve, &offsets))
    }
}

type Rows<T> = Vec<Vec<T>>;

/// Per frame and sample of the guide: section and offset of the line that was found.
fn crossings(guide: &Curve, lines: &[Line]) -> (Rows<Profile>, Rows<Option<f64>>) {
    let directions: Vec<Vector3<f64>> = (0..guide.points.len()).map(|k| tangent(&guide.points, k)).collect();
    let of_line = |line: &Line| -> (Vec<Profile>, Vec<Option<f64>>) {
        let at = |k: usize| line.crossing(&guide.points[k], &directions[k], &guide.across[k]);
        (0..guide.points.len())
            .map(at)
            .map(|found| {
                found.map_or((Profile::default(), None), |(offset, section)| (section, Some(offset)))
            })
            .unzip()
    };
    lines.iter().map(of_line).unzip()
}

/// Where there is no section, that of the nearest time with one is taken, 0 deep.
fn fill_sections(rows: &mut [Vec<Profile>]) {
    let samples = rows.first().map_or(0, Vec::len);
    for k in 0..samples {
        let known: Vec<usize> = (0..rows.len()).filter(|&t| rows[t][k].w_mm > 0.0).collect();
        for t in 0..rows.len() {
            if rows[t][k].w_mm > 0.0 {
                continue;
            }
            let nearest = known.iter().min_by_key(|&&other| other.abs_diff(t));
            rows[t][k] = match nearest {
                Some(&other) => Profile { d_mm: 0.0, ..rows[other][k] },
                None => Profile { w_mm: 1.0, ..Profile::default() },
            };
        }
    }
}

/// Per sample the median offset over all frames, weighted by depth, smoothed a little along the crease.
fn steady_track(sections: &[Vec<Profile>], offsets: &[Vec<Option<f64>>]) -> Vec<f64> {
    let samples = sections.first().map_or(0, Vec::len);
    let median = |k: usize| {
        let mut seen: Vec<(f64, f64)> =
            (0..sections.len()).filter_map(|t| Some((offsets[t][k]?, sections[t][k].d_mm))).collect();
        seen.sort_by(|a, b| a.0.total_cmp(&b.0));
        let half: f64 = 0.5 * seen.iter().map(|seen| seen.1).sum::<f64>();
        let mut sum = 0.0;
        seen.iter()
            .find(|seen| {
                sum += seen.1;
                sum >= half
            })
            .map_or(0.0, |seen| seen.0)
    };
    let mut track: Vec<f64> = (0..samples).map(median).collect();
    for _ in 0..4 {
        let before = track.clone();
        for k in 1..samples.saturating_sub(1) {
            track[k] = 0.25 * before[k - 1] + 0.5 * before[k] + 0.25 * before[k + 1];
        }
    }
    track
}

/// The distance that 95 % of all open samples stay below.
fn wander_95(wander: &[Vec<f64>], sections: &[Vec<Profile>], open_mm: f64) -> f64 {
    let mut all: Vec<f64> = wander
        .iter()
        .flatten()
        .zip(sections.iter().flatten())
        .filter(|(_, section)| section.d_mm > open_mm)
        .map(|(offset, _)| offset.abs())
        .collect();
    all.sort_by(f64::total_cmp);
    all.get((0.95 * all.len() as f64) as usize).or(all.last()).copied().unwrap_or(0.0)
}

/// A curve moved to its right by an offset per sample, on the surface.
fn shifted(
    surface: &Surface,
    normals: &[Vector3<f64>],
    locator: &Locator,
    curve: &Curve,
    offsets: &[f64],
) -> Curve {
    let place = |k: usize| {
        let moved = || locator.nearest(&(curve.points[k] + curve.across[k] * offsets[k]));
        if offsets[k].abs() < 1e-6 { curve.places[k] } else { moved().unwrap_or(curve.places[k]) }
    };
    Curve::new(surface, normals, (0..curve.places.len()).map(place).collect())
}

/// The value at a share of the way between the second and the third of four equally spaced values, by a cubic that rises and
/// falls only where they do [FritschButland1984].
fn monotone([a, b, c, d]: [f64; 4], share: f64) -> f64 {
    let slope =
        |left: f64, right: f64| if left * right <= 0.0 { 0.0 } else { 2.0 * left * right / (left + right) };
    let (at_b, at_c) = (slope(b - a, c - b), slope(c - b, d - c));
    let (s, s2, s3) = (share, share * share, share * share * share);
    (2.0 * s3 - 3.0 * s2 + 1.0) * b
        + (s3 - 2.0 * s2 + s) * at_b
        + (3.0 * s2 - 2.0 * s3) * c
        + (s3 - s2) * at_c
}

#[cfg(test)]
mod tests {
    use super::monotone;

    #[test]
    fn a_depth_that_comes_from_nothing_never_falls_below_it() {
        for i in 0..=10 {
            let share = f64::from(i) / 10.0;
            let value = monotone([0.0, 0.0, 1.0, 1.2], share);
            assert!((0.0..=1.0).contains(&value), "{value} at {share}");
            assert!((monotone([1.0, 2.0, 3.0, 4.0], share) - (2.0 + share)).abs() < 1e-12);
        }
    }
}
