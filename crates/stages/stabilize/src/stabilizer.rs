//! The whole stage: world space in, head space and poses out.

use crate::fill::{Filled, fill_gaps};
use crate::jumps::{self, Jump};
use crate::layout::Layout;
use crate::names::select;
use crate::pose::{Pose, bridge_gaps, fit_poses};
use crate::rigid_body::{RigidBody, Row};
use crate::rigid_subset::least_deforming;
use crate::samples::Samples;
use crate::swaps::{self, Swap};
use crate::{Error, JumpLimit, Params, Stabilized, Swaps};
use artifact::Trajectories;
use nalgebra::Isometry3;

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
    let (reference, _) = work.reference(params.reference_frame)?;
    let (jumps, swaps) = work.clean(&mut head, &layout, reference, params);
    let layout = Layout::of(&head);
    let mut head = work.steady(head, params);
    let gaps_left = |f: usize| work.poses[f].is_some();
    let filled = fill_gaps(&mut head, &layout, work.frames_in(params.fill_ms), gaps_left);
    let reference = work.reference(params.reference_frame)?;
    Ok(work.finish(take, params, Findings { head, jumps, swaps, filled, reference }))
}

/// The state between the steps.
pub(crate) struct Work {
    /// Markers that stay, as columns of the take.
    pub(crate) columns: Vec<usize>,
    pub(crate) ids: Vec<String>,
    pub(crate) world: Samples,
    rate: f64,
    pub(crate) body: RigidBody,
    pub(crate) poses: Vec<Option<Pose>>,
    /// As fitted, before jitter was taken out.
    pub(crate) fitted: Vec<Option<Isometry3<f64>>>,
}

/// What the steps found.
pub(crate) struct Findings {
    pub(crate) head: Samples,
    pub(crate) jumps: Vec<Jump>,
    pub(crate) swaps: Vec<Swap>,
    pub(crate) filled: Vec<Filled>,
    /// Position of the reference frame, and its pose.
    pub(crate) reference: (usize, Isometry3<f64>),
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
        if written(&ids, &body, params).is_empty() {
            return Err(Error::NothingLeft { wanted: params.head_markers.clone(), count: ids.len() });
        }
        let mut poses = fit_poses(&body, &rows);
        if poses.iter().all(Option::is_none) {
            return Err(Error::NeverSeen(body.markers.iter().map(|&m| ids[m].clone()).collect()));
        }
        let longest = frames_in(params.fill_ms, rate);
        bridge_gaps(&mut poses, &world.numbers, &rows, &body, longest);
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
    fn clean(
        &self,
        head: &mut Samples,
        layout: &Layout,
        reference: usize,
        params: &Params,
    ) -> (Vec<Jump>, Vec<Swap>) {
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
        let mut swaps = swaps::find(head, &labelled, layout, &jumps, params.swaps == Swaps::Mend);
        let is_asked = params.reference_frame.is_some();
        swaps::keep_reference_side(head, &mut jumps, &mut swaps, reference, is_asked);
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
}

/// Markers that are written, as positions among `ids`: named head markers are not, unless they are kept.
pub(crate) fn written(ids: &[String], body: &RigidBody, params: &Params) -> Vec<usize> {
    let stays =
        |m: &usize| params.head_markers.is_empty() || params.keep_head_markers || !body.markers.contains(m);
    (0..ids.len()).filter(stays).collect()
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
