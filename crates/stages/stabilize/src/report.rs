//! What was found and done: for the summary and the side-car.

use crate::jumps::Jump;
use crate::swaps::Swap;
use crate::words::{counted, span};
use serde::Serialize;
use std::collections::BTreeMap;

/// Found head markers that stray further than this (mm, root mean square) are no rigid body.
const SOFT_MM: f64 = 1.5;

/// What was found and done.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Report {
    /// Frames of the take.
    pub frames: usize,
    /// Markers of the take, those left out not counted.
    pub markers: usize,
    /// Head markers that the pose was found from.
    pub head_markers: Vec<String>,
    /// Whether the stage chose them, because none were named.
    pub head_markers_chosen: bool,
    /// The frame at which head space is world space.
    pub reference_frame: i64,
    /// Root mean square distance of the head markers from their places on the rigid head, mm.
    pub residual_rms_mm: f64,
    /// Root mean square motion of the head markers by which the pose's jitter was taken out, mm.
    pub jitter_removed_rms_mm: f64,
    /// Frames without a pose.
    pub pose_gap_frames: usize,
    /// Frames whose pose no head marker shows: interpolated over time, or carried over the gap by the face.
    pub pose_bridged_frames: usize,
    /// Per head marker the frames in which it was seen but not trusted: it had slipped, or was another one.
    pub head_marker_rejected: BTreeMap<String, usize>,
    /// Markers that are seen in no frame.
    pub never_seen: Vec<String>,
    /// Per marker its missing samples, before and after.
    pub gaps: BTreeMap<String, Gaps>,
    /// Samples filled.
    pub filled_samples: usize,
    /// Samples taken out because they were off their marker's place.
    pub removed_samples: usize,
    /// Samples given to the marker whose place they are at.
    pub mended_samples: usize,
    /// Markers that jumped.
    pub jumps: Vec<JumpReport>,
}

/// A marker's missing samples. Frames without a pose are not counted here.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Gaps {
    /// Samples that the take lacks.
    pub missing: usize,
    /// … in so many runs.
    pub runs: usize,
    /// Samples taken out.
    pub removed: usize,
    /// Samples given back to it from under another name.
    pub mended: usize,
    /// Samples filled.
    pub filled: usize,
    /// Samples that are missing in the end.
    pub left: usize,
}

/// A run of samples off their marker's place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JumpReport {
    /// The marker.
    pub marker: String,
    /// First and last frame.
    pub frames: [i64; 2],
    /// Largest step against the neighbours, mm.
    pub step_mm: f64,
    /// Whether the samples were taken out. If not, both sides of the jump lie in the marker's usual range: look at it.
    pub removed: bool,
    /// At whose places they were.
    pub at_place_of: Vec<PlaceReport>,
}

/// Samples at another marker's place.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlaceReport {
    /// Whose place.
    pub marker: String,
    /// First and last frame.
    pub frames: [i64; 2],
    /// Whether the samples were given to it.
    pub mended: bool,
}

impl Report {
    /// Names jumps and swaps by marker and frame.
    pub(crate) fn tell_jumps(&mut self, jumps: &[Jump], swaps: &[Swap], ids: &[String], numbers: &[i64]) {
        let span = |frames: (usize, usize)| [numbers[frames.0], numbers[frames.1]];
        let within = |swap: &&Swap, jump: &Jump| {
            swap.marker == jump.marker && jump.frames.0 <= swap.frames.0 && swap.frames.1 <= jump.frames.1
        };
        let place = |swap: &Swap| PlaceReport {
            marker: ids[swap.place_of].clone(),
            frames: span(swap.frames),
            mended: swap.is_mended,
        };
        self.jumps = jumps
            .iter()
            .map(|jump| JumpReport {
                marker: ids[jump.marker].clone(),
                frames: span(jump.frames),
                step_mm: jump.size_mm,
                removed: jump.is_off,
                at_place_of: swaps.iter().filter(|swap| within(swap, jump)).map(place).collect(),
            })
            .collect();
    }

    /// Sentences that a user should read, each naming marker and frames.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let never = self.never_seen.iter().map(|id| format!("marker {id} is missing in all frames"));
        // Found markers are skin: that they move now and then is no news.
        let named = (!self.head_markers_chosen).then_some(&self.head_marker_rejected);
        let rejected = named.into_iter().flatten().map(|(id, count)| {
            let frames = counted(self.frames, "frame");
            format!("head marker {id} was off its place and left out in {count} of {frames}")
        });
        let jumps = self.jumps.iter().map(JumpReport::sentence);
        let gap = (self.pose_gap_frames > 0).then(|| {
            let (frames, have) = (
                counted(self.pose_gap_frames, "frame"),
                if self.pose_gap_frames == 1 { "has" } else { "have" },
            );
            format!("{frames} {have} no pose: fewer than three head markers agree there")
        });
        let soft = (self.head_markers_chosen && self.residual_rms_mm > SOFT_MM).then(|| {
            let stray = self.residual_rms_mm;
            format!("the least deforming markers still stray {stray:.1} mm: this head motion is a guess; name head markers")
        });
        never.chain(rejected).chain(soft).chain(gap).chain(jumps).collect()
    }
}

impl JumpReport {
    fn sentence(&self) -> String {
        let first = self.frames[0];
        let (marker, step) = (&self.marker, self.step_mm);
        if !self.removed {
            return format!(
                "marker {marker} jumps by {step:.1} mm at frame {first}, but both sides may be its place: left as it is"
            );
        }
        let places: Vec<String> = self
            .at_place_of
            .iter()
            .map(|place| {
                let (frames, other) = (span(place.frames), &place.marker);
                let mended = format!("; those samples were given to {other}");
                let done = if place.mended { mended } else { String::new() };
                format!("; in {frames} it stands at the place of {other}{done}")
            })
            .collect();
        format!(
            "marker {marker} is off its place in {} ({step:.1} mm): taken out{}",
            span(self.frames),
            places.concat()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_says_where_its_samples_went() {
        let place = PlaceReport { marker: "b".into(), frames: [8, 9], mended: true };
        let mut jump = JumpReport {
            marker: "a".into(),
            frames: [5, 9],
            step_mm: 20.0,
            removed: true,
            at_place_of: vec![place],
        };
        let off = "marker a is off its place in frames 5-9 (20.0 mm): taken out";
        let there = "; in frames 8-9 it stands at the place of b";
        let given = "; those samples were given to b";
        assert_eq!(jump.sentence(), format!("{off}{there}{given}"));
        jump.at_place_of[0].mended = false;
        assert_eq!(jump.sentence(), format!("{off}{there}"));
    }

    #[test]
    fn one_frame_is_singular() {
        let report = |frames| Report { pose_gap_frames: frames, ..Default::default() };
        assert!(report(1).warnings()[0].starts_with("1 frame has no pose"));
        assert!(report(2).warnings()[0].starts_with("2 frames have no pose"));
    }
}
