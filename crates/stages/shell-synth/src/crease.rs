//! The creases of a take: each a line on the skin, with its section over time.

use crate::curve::{Curve, tangent};
use crate::line::Line;
use crate::locator::Locator;
use crate::moment::{Moment, monotone};
use crate::profile::between;
use crate::surface::Surface;
use crate::{Error, Params, Track};
use artifact::{ProfileShape, ValleysFrame};
use nalgebra::Vector3;
use serde::Serialize;

/// A crease over a take.
pub(crate) struct Crease {
    pub(crate) id: String,
    pub(crate) curve: Curve,
    /// Per frame that valleys were given for, per sample: the section, d = 0 where there is none.
    sections: Vec<Vec<ProfileShape>>,
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

    /// Where a frame lies among the known ones.
    pub(crate) fn moment(&self, frame: i64, params: &Params) -> Option<Moment> {
        Moment::of(&self.frames, self.step, frame, i64::from(params.longest_gap))
    }
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
        let open = || sections.iter().flatten().filter(|section| section.d > params.fade_depth_mm);
        Some(Self {
            id: id.to_string(),
            widest_mm: open().map(|section| section.w * (1.0 + section.kappa.abs())).fold(0.0, f64::max),
            narrowest_mm: open().map(|section| section.w).fold(f64::INFINITY, f64::min),
            deepest_mm: deepest,
            offsets: (params.track == Track::AsFound && found_mm > 0.0).then_some(wander),
            drift: Drift { found_mm, used_mm },
            curve,
            sections,
        })
    }

    /// The sections along the crease at a time; nothing where it is closed all along.
    pub(crate) fn sections(&self, moment: &Moment) -> Option<Vec<ProfileShape>> {
        let row = |at: usize, k: usize| &self.sections[at.min(self.sections.len() - 1)][k];
        let mix = |k: usize| {
            let mut section = between(row(moment.before, k), row(moment.after, k), moment.share);
            let beyond = [moment.before.saturating_sub(1), moment.before, moment.after, moment.after + 1];
            section.d = moment.held * monotone(beyond.map(|at| row(at, k).d), moment.share);
            section
        };
        let sections: Vec<ProfileShape> = (0..self.curve.points.len()).map(mix).collect();
        sections.iter().any(|section| section.d > 0.0).then_some(sections)
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
fn crossings(guide: &Curve, lines: &[Line]) -> (Rows<ProfileShape>, Rows<Option<f64>>) {
    let directions: Vec<Vector3<f64>> = (0..guide.points.len()).map(|k| tangent(&guide.points, k)).collect();
    let of_line = |line: &Line| -> (Vec<ProfileShape>, Vec<Option<f64>>) {
        let at = |k: usize| line.crossing(&guide.points[k], &directions[k], &guide.across[k]);
        (0..guide.points.len())
            .map(at)
            .map(|found| {
                found.map_or((ProfileShape::default(), None), |(offset, section)| (section, Some(offset)))
            })
            .unzip()
    };
    lines.iter().map(of_line).unzip()
}

/// Where there is no section, that of the nearest time with one is taken, 0 deep.
fn fill_sections(rows: &mut [Vec<ProfileShape>]) {
    let samples = rows.first().map_or(0, Vec::len);
    for k in 0..samples {
        let known: Vec<usize> = (0..rows.len()).filter(|&t| rows[t][k].w > 0.0).collect();
        for t in 0..rows.len() {
            if rows[t][k].w > 0.0 {
                continue;
            }
            let nearest = known.iter().min_by_key(|&&other| other.abs_diff(t));
            rows[t][k] = match nearest {
                Some(&other) => ProfileShape { d: 0.0, ..rows[other][k] },
                None => ProfileShape { w: 1.0, ..ProfileShape::default() },
            };
        }
    }
}

/// Per sample the median offset over all frames, weighted by depth, smoothed a little along the crease.
fn steady_track(sections: &[Vec<ProfileShape>], offsets: &[Vec<Option<f64>>]) -> Vec<f64> {
    let samples = sections.first().map_or(0, Vec::len);
    let median = |k: usize| {
        let mut seen: Vec<(f64, f64)> =
            (0..sections.len()).filter_map(|t| Some((offsets[t][k]?, sections[t][k].d))).collect();
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
fn wander_95(wander: &[Vec<f64>], sections: &[Vec<ProfileShape>], open_mm: f64) -> f64 {
    let mut all: Vec<f64> = wander
        .iter()
        .flatten()
        .zip(sections.iter().flatten())
        .filter(|(_, section)| section.d > open_mm)
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
