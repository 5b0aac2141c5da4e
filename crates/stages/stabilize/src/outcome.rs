//! What the stage hands over: trajectories in head space, poses, and a report.

use crate::Params;
use crate::pose::Pose;
use crate::report::{Gaps, Report};
use crate::samples::Samples;
use crate::stabilizer::{Findings, Work, written};
use crate::swaps::runs;
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

impl Work {
    /// Everything in head space, in the reference frame's coordinates.
    pub(crate) fn finish(&self, take: &Trajectories, params: &Params, found: Findings) -> Stabilized {
        let written = written(&self.ids, &self.body, params);
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
            head_markers_chosen: params.head_markers.is_empty(),
            reference_frame: self.world.numbers[found.reference.0],
            residual_rms_mm: root_mean(&squares),
            jitter_removed_rms_mm: root_mean(&shifts),
            pose_gap_frames: self.poses.iter().filter(|pose| pose.is_none()).count(),
            pose_bridged_frames: poses().filter(|(_, pose)| !pose.used.contains(&true)).count(),
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
