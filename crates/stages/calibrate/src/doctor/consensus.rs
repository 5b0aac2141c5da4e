//! Who is right: cameras are trusted until the others show that they are wrong.

use super::fault::{Verdict, judge};
use super::model::Datum;
use super::rays::{Ray, Rays, nearest};
use super::trajectory::Trajectories;
use super::{Evidence, Examination, Finding, Kind, Params, Sighting, lengths};
use nalgebra::Point3;
use rayon::prelude::*;

/// Sightings of a camera that faults are fitted to, at most.
const MOST_DATA: usize = 600;
/// Sightings that a camera is judged by, at least.
const LEAST_DATA: usize = 12;
/// Cameras whose pairs are off by more than this are put aside first, px: their rays would drag everything along.
const GROSS_PX: f64 = 12.0;
/// ... and by as many times what the middle pair is.
const GROSS_RATIO: f64 = 4.0;

pub(super) fn examine(evidence: &Evidence, params: &Params, examination: &mut Examination) {
    let rays = Rays::of(evidence);
    let seeing = (0..evidence.patients.len()).filter(|&c| rays.count(c) >= LEAST_DATA).count();
    if seeing < 2 {
        examination.unchecked.push("poses, focal lengths and clocks: no points that two cameras see".into());
        return;
    }
    examination.compared = true;
    let mut court = Court { evidence, rays, params, trusted: vec![true; evidence.patients.len()] };
    if let Some(finding) = court.all_mirrored() {
        examination.findings.push(finding);
        return;
    }
    if seeing == 2 {
        court.judge_two(examination);
    } else {
        court.put_aside_gross();
        court.put_aside();
        court.report(examination);
    }
    let points = court.rays.points(&court.trusted, None);
    court.behind(&points, examination);
    lengths::examine(evidence, &points, params, examination);
}

struct Court<'a> {
    evidence: &'a Evidence,
    rays: Rays,
    params: &'a Params,
    trusted: Vec<bool>,
}

impl Court<'_> {
    /// Median distance between the rays of two cameras, px; none where they share too little.
    fn pair_px(&self, a: usize, b: usize) -> Option<f64> {
        let focal = |c: usize| self.evidence.patients[c].camera.lens.focal_px.x;
        let gap = |views: &Vec<Ray>| {
            let pair: Vec<_> = views.iter().filter(|view| view.0 == a || view.0 == b).collect();
            let point = nearest(pair.iter().copied()).filter(|_| pair.len() == 2)?;
            let off = pair.iter().map(|(c, eye, direction)| {
                let depth = (point - eye).dot(direction);
                if depth <= 0.0 { 1e4 } else { (point - eye).cross(direction).norm() / depth * focal(*c) }
            });
            Some(off.sum::<f64>())
        };
        let mut gaps: Vec<f64> = self.rays.views.iter().filter_map(gap).collect();
        gaps.sort_by(f64::total_cmp);
        (gaps.len() >= LEAST_DATA).then(|| gaps[gaps.len() / 2])
    }

    /// Puts aside cameras that agree with hardly any other.
    fn put_aside_gross(&mut self) {
        let count = self.trusted.len();
        let mut gaps = vec![vec![None; count]; count];
        for (a, b) in (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))) {
            let gap = self.pair_px(a, b);
            (gaps[a][b], gaps[b][a]) = (gap, gap);
        }
        while self.trusted.iter().filter(|trusted| **trusted).count() > 3 {
            let kept: Vec<usize> = (0..count).filter(|&c| self.trusted[c]).collect();
            let middle = |a: usize| median(kept.iter().filter_map(|&b| gaps[a][b]).collect());
            let all = median(
                kept.iter()
                    .flat_map(|&a| kept.iter().filter_map(|&b| gaps[a][b]).collect::<Vec<_>>())
                    .collect(),
            );
            let worst = kept.iter().map(|&c| (middle(c), c)).max_by(|x, y| x.0.total_cmp(&y.0));
            match worst {
                Some((gap, camera)) if gap > GROSS_PX && gap > GROSS_RATIO * all => {
                    self.trusted[camera] = false
                }
                _ => break,
            }
        }
    }

    /// Puts aside the camera that the others object to most, until they object to none.
    fn put_aside(&mut self) {
        while self.trusted.iter().filter(|trusted| **trusted).count() > 2 {
            let verdicts = self.verdicts();
            let guilt = |(c, verdict): (usize, &Option<Verdict>)| {
                let verdict =
                    verdict.as_ref().filter(|verdict| self.trusted[c] && verdict.finding.is_some())?;
                // In millimetres, so that long lenses are not blamed for their scale; what a fault explains counts.
                let focal = self.evidence.patients[c].camera.lens.focal_px.x;
                Some(((verdict.rms_px - verdict.left_px) / focal, c))
            };
            let worst = verdicts.iter().enumerate().filter_map(guilt).max_by(|a, b| a.0.total_cmp(&b.0));
            match worst {
                Some((_, camera)) => self.trusted[camera] = false,
                None => break,
            }
        }
    }

    /// What the trusted cameras say of each; none of a camera that they cannot judge.
    fn verdicts(&self) -> Vec<Option<Verdict>> {
        let points: Vec<Vec<Option<Point3<f64>>>> =
            (0..self.trusted.len()).map(|c| self.rays.points(&self.trusted, Some(c))).collect();
        let data: Vec<Vec<Datum>> =
            points.iter().enumerate().map(|(c, points)| self.data(c, points)).collect();
        let rms = |c: usize| super::model::rms(&self.evidence.patients[c].camera, &data[c]);
        let noise = median(
            (0..data.len()).filter(|&c| data[c].len() >= LEAST_DATA && self.trusted[c]).map(rms).collect(),
        );
        let verdict = |c: usize| {
            let trajectories = Trajectories::of(&self.evidence.sightings, &points[c]);
            let patient = &self.evidence.patients[c];
            (data[c].len() >= LEAST_DATA)
                .then(|| judge(patient, &self.evidence.patients, &data[c], &trajectories, noise, self.params))
        };
        (0..data.len()).into_par_iter().map(verdict).collect()
    }

    fn data(&self, camera: usize, points: &[Option<Point3<f64>>]) -> Vec<Datum<'_>> {
        let pairs = self.evidence.sightings.iter().zip(points);
        let all: Vec<Datum> = pairs
            .filter_map(|(sighting, point)| {
                let (_, pixel) = sighting.views.iter().find(|view| view.0 == camera)?;
                let (name, frame) = (sighting.name.as_str(), sighting.frame);
                Some(Datum { name, frame, point: (*point)?, pixel: *pixel })
            })
            .collect();
        let step = all.len().div_ceil(MOST_DATA).max(1);
        all.into_iter().step_by(step).collect()
    }

    fn report(&mut self, examination: &mut Examination) {
        let verdicts = self.verdicts();
        for (c, verdict) in verdicts.into_iter().enumerate() {
            let id = &self.evidence.patients[c].id;
            let Some(verdict) = verdict else {
                examination.unjudged.push(format!("camera {id}: {}", self.why_not(c)));
                continue;
            };
            let report = &mut examination.cameras[c];
            report.sightings = self.rays.count(c);
            report.residual_px = Some(verdict.rms_px);
            let is_about_time = verdict.finding.as_ref().is_none_or(|finding| finding.kind == Kind::Late);
            report.late_frames = verdict.late.filter(|_| is_about_time);
            if verdict.late.is_none() {
                examination.unchecked.push(format!("camera {id}, clock: no point moves enough"));
            }
            match verdict.finding {
                Some(finding) => examination.findings.push(finding),
                // Blamed for what another one did.
                None => self.trusted[c] = true,
            }
        }
    }

    /// Why a camera cannot be judged.
    fn why_not(&self, camera: usize) -> String {
        let shared = self.rays.count(camera);
        let placed = self.data(camera, &self.rays.points(&self.trusted, Some(camera))).len();
        match shared {
            0 => "it sees no point that another camera sees".to_string(),
            _ if shared < LEAST_DATA => {
                format!("it shares {shared} points with other cameras; {LEAST_DATA} are needed")
            }
            _ => format!(
                "of the {shared} points that it shares, two other cameras place {placed}; {LEAST_DATA} are needed: show the points \
                 to three cameras at once"
            ),
        }
    }

    /// The median distance between rays over all pairs of cameras, px.
    fn all_px(&self) -> f64 {
        let count = self.trusted.len();
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        median(pairs.filter_map(|(a, b)| self.pair_px(a, b)).collect())
    }

    /// Cameras that were calibrated from mirrored pictures, or whose footage is, all of them: their rays meet once all images are
    /// mirrored.
    fn all_mirrored(&self) -> Option<Finding> {
        let stated = self.all_px();
        if stated < GROSS_PX {
            return None;
        }
        let mut evidence = self.evidence.clone();
        for (c, pixel) in evidence.sightings.iter_mut().flat_map(|sighting| &mut sighting.views) {
            pixel.x = f64::from(evidence.patients[*c].camera.image_size[0]) - 1.0 - pixel.x;
        }
        let rays = Rays::of(&evidence);
        let court = Court { evidence: &evidence, rays, params: self.params, trusted: self.trusted.clone() };
        let mirrored = court.all_px();
        (GROSS_RATIO * mirrored < stated).then(|| Finding {
            camera: None,
            kind: Kind::Mirrored,
            number: mirrored,
            unit: "px",
            what: format!(
                "all images are mirrored against the calibration: rays miss each other by {stated:.1} px in the median, of mirrored \
                 images by {mirrored:.1} px"
            ),
            advice: "calibrate with pictures that are mirrored as the footage is, best neither",
        })
    }

    /// Of two cameras nobody can say which is wrong.
    fn judge_two(&self, examination: &mut Examination) {
        let count = self.trusted.len();
        examination.unchecked.push("which camera is wrong: only two see the points".into());
        for (a, b) in (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))) {
            let Some(gap) = self.pair_px(a, b).filter(|gap| *gap > 2.0 * self.params.tolerance_px) else {
                continue;
            };
            let [a, b] = [a, b].map(|c| &self.evidence.patients[c].id);
            examination.findings.push(Finding {
                camera: None,
                kind: Kind::Unexplained,
                number: gap,
                unit: "px",
                what: format!("the rays of {a} and {b} miss each other by {gap:.2} px in the median"),
                advice: Kind::Unexplained.advice(),
            });
        }
    }

    /// Points behind a camera that sees them.
    fn behind(&self, points: &[Option<Point3<f64>>], examination: &mut Examination) {
        for (c, patient) in self.evidence.patients.iter().enumerate() {
            let is_behind = |(sighting, point): &(&Sighting, &Option<Point3<f64>>)| {
                let sees = sighting.views.iter().any(|view| view.0 == c);
                sees && point.is_some_and(|point| (patient.camera.cam_from_world * point).z <= 0.0)
            };
            let count = self.evidence.sightings.iter().zip(points).filter(is_behind).count();
            if count > 0 {
                let what = format!("{count} points that it sees lie behind it");
                examination.findings.push(Finding::of(patient, Kind::Behind, count as f64, "points", what));
            }
        }
    }
}

/// 0 of nothing.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
