//! The face in the frames and moments that are asked for, read from front to back.

use super::options::Material;
use artifact::MeshCursor;
use nalgebra::Point3;
use std::collections::{BTreeMap, BTreeSet};
use wrinkle_lift::Moment;

/// The frames of the sequence around the one at work.
pub(crate) struct Faces<'a> {
    cursor: MeshCursor<'a>,
    /// All frames that will be needed, rising.
    wanted: Vec<i64>,
    next: usize,
    /// How far from its frame an image can be, frames.
    reach: i64,
    held: BTreeMap<i64, Vec<Point3<f64>>>,
}

impl<'a> Faces<'a> {
    /// `moments`: per frame the moments of its images, rising.
    pub(crate) fn open(material: &'a Material, moments: &[(i64, Moment)]) -> anyhow::Result<Self> {
        let needed = |(frame, moment): &(i64, Moment)| moment.frames().chain([*frame]).collect::<Vec<_>>();
        let wanted: BTreeSet<i64> = moments.iter().flat_map(needed).collect();
        let reach = moments.iter().map(|(frame, moment)| frame.abs_diff(moment.from) as i64 + 1).max();
        Ok(Self {
            cursor: material.sequence.cursor()?,
            wanted: wanted.into_iter().collect(),
            next: 0,
            reach: reach.unwrap_or(1),
            held: BTreeMap::new(),
        })
    }

    /// The face in a frame; frames are asked for in rising order, but for the moments around them.
    pub(crate) fn frame(&mut self, frame: i64) -> anyhow::Result<&[Point3<f64>]> {
        while let Some(&number) = self.wanted.get(self.next).filter(|number| **number <= frame) {
            self.held.insert(number, self.cursor.read(number)?);
            self.next += 1;
        }
        Ok(self.held.get(&frame).map_or(&[], Vec::as_slice))
    }

    /// The face at a moment.
    pub(crate) fn moment(&mut self, moment: Moment) -> anyhow::Result<Vec<Point3<f64>>> {
        let from = self.frame(moment.from)?.to_vec();
        match moment.share > 0.0 {
            true => Ok(moment.points(&from, self.frame(moment.from + 1)?)),
            false => Ok(from),
        }
    }

    /// Lets go of what no later frame than this needs.
    pub(crate) fn release(&mut self, frame: i64) {
        self.held = self.held.split_off(&(frame - 2 * self.reach));
    }
}
