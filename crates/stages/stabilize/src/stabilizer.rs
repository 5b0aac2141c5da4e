//! The whole stage: world space in, head space and poses out.

use crate::fill::{Filled, fill_gaps};
use crate::jumps::{self, Jump};
use crate::layout::Layout;
use crate::names::select;
use crate::pose::{Pose, bridge_gaps, fit_poses};
use crate::report::{Gaps, Report};
use crate::rigid_body::{RigidBody, Row};
use crate::rigid_subset::least_deforming;
use crate::samples::Samples;
use crate::swaps::{self, Swap, runs};
use crate::{Error, JumpLimit, Params, Swaps};
use artifact::{HeadPoseFrame, HeadPoseHeader, MarkerFrame, MarkerHeader, SampleStatus, Trajectories};
use nalgebra::{Isometry3, Quaternion, UnitQuaternion};

/// A take with the head's motion taken out.
#[derive(Debug, Clone)]
pub struct Stabilized {
    /// Trajectories in head space, mm.
    pub head: Trajectories,
    /// What holds for all poses.
    pub pose_header: HeadPoseHeader,
    /// `world_from_head` per frame.
    pub poses: Vec<HeadPoseFrame>,
    /// What was found and done.
    pub report: Report,
}

/// Finds the head's pose in every frame and brings the markers to head space.
///
/// `take`: world space, mm. Where the pose is unknown, a frame's samples are missing in head space.
///
/// # Errors
/// [`Error`] if the head cannot be found in the take, or parameters do not fit it.
pub fn stabilize(take: &Trajectories, params: &Params) -> Result<Stabilized, Error> {
    let mut work = Work::begin(take, params)?;
    let mut head = work.to_head();
    let layout = Layout::of(&head);
    let (jumps, swaps) = work.clean(&mut head, &layout, params);
    let layout = Layout::of(&head);
    let mut head = work.steady(head, params);
    let gaps_left = |f: usize| work.poses[f].is_some();
    let filled = fill_gaps(&mut head, &layout, work.frames_in(params.fill_ms), gaps_left);
    let reference = work.reference(params.reference_frame)?;
    Ok(work.finish(take, params, Findings { head, jumps, swaps, filled, reference }))
}

/// The state between the steps.
struct Work {
    /// Markers that stay, as columns of the take.
    columns: Vec<usize>,
    ids: Vec<String>,
    world: Samples,
    rate: f64,
    body: RigidBody,
    poses: Vec<Option<Pose>>,
    /// As fitted, before jitter was taken out.
    fitted: Vec<Option<Isometry3<f64>>>,
}

struct Findings {
    head: Samples,
    jumps: Vec<Jump>,
    swaps: Vec<Swap>,
    filled: Vec<Filled>,
    /// Position of the reference frame, and its pose.
    reference: (usize, Isometry3<f64>),
}

impl Work {
    fn begin(take: &Trajectories, params: &Params) -> Result<Self, Error> {
        params.check()?;
        if take.frames.is_empty() {
            return Err(Error::NoFrames);
        }
        let rate = match take.header.rate {
            Some(rate) => rate.hz(),
            None if params.needs_rate() => return Err(Error::NoRate),
            None => f64::INFINITY,
        };
        let dropped = select(&take.header.markers, &params.drop)?;
        let columns: Vec<usize> = (0..take.header.markers.len()).filter(|m| !dropped.contains(m)).collect();
        let ids: Vec<String> = columns.iter().map(|&m| take.header.markers[m].clone()).collect();
        let world = Samples {
            numbers: take.frames.iter().map(|frame| frame.frame).collect(),
            points: take
                .frames
                .iter()
                .map(|frame| columns.iter().map(|&m| frame.points[m]).collect())
                .collect(),
        };
        let rows: Vec<&Row> = world.points.iter().map(Vec::as_slice).collect();
        let body = find_body(&rows, &ids, params)?;
        let mut poses = fit_poses(&body, &rows);
        if poses.iter().all(Option::is_none) {
            return Err(Error::NeverSeen(body.markers.iter().map(|&m| ids[m].clone()).collect()));
        }
        let longest = frames_in(params.fill_ms, rate);
        bridge_gaps(&mut poses, &world.numbers, &body, longest);
        let fitted = poses.iter().map(|pose| pose.as_ref().map(|pose| pose.world_from_body)).collect();
        Ok(Self { columns, ids, world, rate, body, poses, fitted })
    }

    fn frames_in(&self, ms: f64) -> i64 {
        frames_in(ms, self.rate)
    }

    fn to_head(&self) -> Samples {
        self.world.moved(|f| self.poses[f].as_ref().map(|pose| pose.world_from_body.inverse()))
    }

    /// Takes out samples that are off their place, and mends swaps. Head markers are judged by the rigid fit alone.
    fn clean(&self, head: &mut Samples, layout: &Layout, params: &Params) -> (Vec<Jump>, Vec<Swap>) {
        if params.jump == JumpLimit::Off {
            return (Vec::new(), Vec::new());
        }
        let named = !params.head_markers.is_empty();
        let candidates: Vec<usize> =
            (0..self.ids.len()).filter(|m| !(named && self.body.markers.contains(m))).collect();
        let labelled = head.clone();
        let mut jumps = jumps::take_out(head, layout, &candidates, params.jump, self.rate);
        let squatters = swaps::take_out_squatters(head, layout, &candidates, &jumps);
        jumps.extend(squatters);
        jumps.sort_by_key(|jump| (jump.frames, jump.marker));
        let swaps = swaps::find(head, &labelled, layout, &jumps, params.swaps == Swaps::Mend);
        (jumps, swaps)
    }

    /// Gives the jitter that all markers share back to the pose.
    fn steady(&mut self, head: Samples, params: &Params) -> Samples {
        if params.smooth_ms == 0.0 {
            return head;
        }
        // Half the time scale to each side of the window's middle: its standard deviation.
        let sigma = 0.5 * params.smooth_ms * 1e-3 * self.rate;
        let jitter = crate::jitter::common_jitter(&head, sigma, &self.body.markers);
        for (pose, jitter) in self.poses.iter_mut().zip(&jitter) {
            if let Some(pose) = pose {
                pose.world_from_body *= jitter;
            }
        }
        head.moved(|f| Some(jitter[f].inverse()))
    }

    /// The reference frame and its pose: the one asked for, or the first that shows the most markers.
    fn reference(&self, wanted: Option<i64>) -> Result<(usize, Isometry3<f64>), Error> {
        let numbers = &self.world.numbers;
        let measured = |f: usize| {
            self.poses[f].as_ref().filter(|pose| pose.used.contains(&true)).map(|pose| pose.world_from_body)
        };
        if let Some(frame) = wanted {
            let (first, last) = (numbers[0], numbers[numbers.len() - 1]);
            let at = numbers.binary_search(&frame);
            let at = at.map_err(|_| Error::NoReferenceFrame { frame, first, last })?;
            let of = self.body.markers.len();
            let seen = self.body.markers.iter().filter(|&&m| self.world.points[at][m].is_some()).count();
            return Ok((at, measured(at).ok_or(Error::ReferenceUnseen { frame, seen, of })?));
        }
        let seen = |f: usize| self.world.points[f].iter().flatten().count();
        let known = (0..numbers.len()).filter_map(|f| Some((f, measured(f)?)));
        let best = known.rev().max_by_key(|(f, _)| seen(*f));
        best.ok_or_else(|| Error::NeverSeen(self.body.markers.iter().map(|&m| self.ids[m].clone()).collect()))
    }

    fn finish(&self, take: &Trajectories, params: &Params, found: Findings) -> Stabilized {
        let written: Vec<usize> = (0..self.ids.len())
            .filter(|m| {
                params.head_markers.is_empty() || params.keep_head_markers || !self.body.markers.contains(m)
            })
            .collect();
        let header = MarkerHeader {
            markers: written.iter().map(|&m| self.ids[m].clone()).collect(),
            ..take.header.clone()
        };
        let pose_header = HeadPoseHeader {
            rate: take.header.rate,
            reference_frame: self.world.numbers[found.reference.0],
            markers: self.body.markers.iter().map(|&m| self.ids[m].clone()).collect(),
            take: take.header.take.clone(),
        };
        let status = self.statuses(take, &found);
        let head = found.head.moved(|_| Some(found.reference.1));
        let frame = |f: usize| MarkerFrame {
            frame: self.world.numbers[f],
            points: written.iter().map(|&m| head.points[f][m]).collect(),
            status: written.iter().map(|&m| status[f][m]).collect(),
        };
        let frames = (0..head.frame_count()).map(frame).collect();
        let poses = (0..head.frame_count()).map(|f| self.pose_frame(f, &found)).collect();
        let report = self.report(params, &found, &head);
        Stabilized { head: Trajectories { header, frames }, pose_header, poses, report }
    }

    /// The take's own word on each sample, save where it was filled or came from under another name.
    fn statuses(&self, take: &Trajectories, found: &Findings) -> Vec<Vec<SampleStatus>> {
        let mut status: Vec<Vec<SampleStatus>> =
            take.frames.iter().map(|frame| self.columns.iter().map(|&m| frame.status[m]).collect()).collect();
        for swap in found.swaps.iter().filter(|swap| swap.is_mended) {
            (swap.frames.0..=swap.frames.1).for_each(|f| {
                status[f][swap.place_of] = take.frames[f].status[self.columns[swap.marker]];
            });
        }
        for filled in &found.filled {
            status[filled.frame][filled.marker] = filled.status;
        }
        status
    }

    fn pose_frame(&self, f: usize, found: &Findings) -> HeadPoseFrame {
        let frame = self.world.numbers[f];
        let Some(pose) = &self.poses[f] else {
            return HeadPoseFrame { frame, world_from_head: None, residual_mm: None, markers_used: 0 };
        };
        let world_from_head = match f == found.reference.0 {
            true => Isometry3::identity(),
            false => positive(pose.world_from_body * found.reference.1.inverse()),
        };
        let squares = self.squared_residuals(f, pose);
        let residual_mm = (!squares.is_empty()).then(|| root_mean(&squares));
        HeadPoseFrame {
            frame,
            world_from_head: Some(world_from_head),
            residual_mm,
            markers_used: squares.len(),
        }
    }

    fn squared_residuals(&self, f: usize, pose: &Pose) -> Vec<f64> {
        let used = self.body.markers.iter().zip(&self.body.places).zip(&pose.used).filter(|(_, used)| **used);
        used.filter_map(|((&m, place), _)| {
            Some((self.world.points[f][m]? - pose.world_from_body * place).norm_squared())
        })
        .collect()
    }

    fn report(&self, params: &Params, found: &Findings, head: &Samples) -> Report {
        let poses = || self.poses.iter().enumerate().filter_map(|(f, pose)| Some((f, pose.as_ref()?)));
        let squares: Vec<f64> = poses().flat_map(|(f, pose)| self.squared_residuals(f, pose)).collect();
        let shift = |(f, pose): (usize, &Pose)| {
            let fitted = self.fitted[f]?;
            let moved = self
                .body
                .places
                .iter()
                .map(|place| (fitted * place - pose.world_from_body * place).norm_squared());
            Some(moved.sum::<f64>() / self.body.places.len() as f64)
        };
        let shifts: Vec<f64> = poses().filter_map(shift).collect();
        let mut report = Report {
            frames: head.frame_count(),
            markers: self.ids.len(),
            head_markers: self.body.markers.iter().map(|&m| self.ids[m].clone()).collect(),
            head_markers_found: params.head_markers.is_empty(),
            reference_frame: self.world.numbers[found.reference.0],
            residual_rms_mm: root_mean(&squares),
            jitter_removed_rms_mm: root_mean(&shifts),
            pose_gap_frames: self.poses.iter().filter(|pose| pose.is_none()).count(),
            pose_interpolated_frames: poses().filter(|(_, pose)| !pose.used.contains(&true)).count(),
            filled_samples: found.filled.len(),
            ..Default::default()
        };
        self.count_rejections(&mut report);
        self.count_gaps(&mut report, found, head);
        report.tell_jumps(&found.jumps, &found.swaps, &self.ids, &self.world.numbers);
        report
    }

    fn count_rejections(&self, report: &mut Report) {
        for (i, &marker) in self.body.markers.iter().enumerate() {
            let rejected = |(f, pose): (usize, &Option<Pose>)| {
                let measured = pose.as_ref().is_some_and(|pose| pose.used.contains(&true) && !pose.used[i]);
                measured && self.world.points[f][marker].is_some()
            };
            let count = self.poses.iter().enumerate().filter(|pair| rejected(*pair)).count();
            if count > 0 {
                report.head_marker_rejected.insert(self.ids[marker].clone(), count);
            }
        }
    }

    fn count_gaps(&self, report: &mut Report, found: &Findings, head: &Samples) {
        let is_posed = |f: &usize| self.poses[*f].is_some();
        let posed: Vec<usize> = (0..head.frame_count()).filter(is_posed).collect();
        for (marker, id) in self.ids.iter().enumerate() {
            let missing: Vec<bool> = posed.iter().map(|&f| self.world.points[f][marker].is_none()).collect();
            let length = |frames: (usize, usize)| frames.1 + 1 - frames.0;
            let removed = found.jumps.iter().filter(|jump| jump.marker == marker && jump.is_off);
            let mended = found.swaps.iter().filter(|swap| swap.place_of == marker && swap.is_mended);
            let off = |f: usize| self.world.points[f][marker].is_some();
            let gaps = Gaps {
                missing: missing.iter().filter(|missing| **missing).count(),
                runs: runs(&missing).len(),
                removed: removed
                    .map(|jump| (jump.frames.0..=jump.frames.1).filter(|&f| off(f)).count())
                    .sum(),
                mended: mended.map(|swap| length(swap.frames)).sum(),
                filled: found.filled.iter().filter(|filled| filled.marker == marker).count(),
                left: posed.iter().filter(|&&f| head.points[f][marker].is_none()).count(),
            };
            report.removed_samples += gaps.removed;
            report.mended_samples += gaps.mended;
            if self.world.points.iter().all(|row| row[marker].is_none()) {
                report.never_seen.push(id.clone());
            } else if gaps != Gaps::default() {
                report.gaps.insert(id.clone(), gaps);
            }
        }
    }
}

fn find_body(rows: &[&Row], ids: &[String], params: &Params) -> Result<RigidBody, Error> {
    let markers = match params.head_markers.is_empty() {
        true => least_deforming(rows, ids)?,
        false => select(ids, &params.head_markers)?,
    };
    if markers.len() < 3 {
        return Err(Error::TooFewHeadMarkers(markers.iter().map(|&m| ids[m].clone()).collect()));
    }
    RigidBody::estimate(rows, &markers, ids)
}

/// Whole frames in a time.
fn frames_in(ms: f64, rate: f64) -> i64 {
    // Without a rate no time but 0 gets here.
    if ms == 0.0 { 0 } else { (ms * 1e-3 * rate + 1e-9).floor() as i64 }
}

fn root_mean(squares: &[f64]) -> f64 {
    if squares.is_empty() { 0.0 } else { (squares.iter().sum::<f64>() / squares.len() as f64).sqrt() }
}

/// The same transform with a quaternion of positive scalar part, so that equal poses are equal numbers.
fn positive(pose: Isometry3<f64>) -> Isometry3<f64> {
    let q = pose.rotation.into_inner();
    let q = if q.w < 0.0 { -q } else { q };
    Isometry3::from_parts(
        pose.translation,
        UnitQuaternion::from_quaternion(Quaternion::new(q.w, q.i, q.j, q.k)),
    )
}
