//! The cameras at work: images are read in blocks, all cameras at once, and tracked, each camera on its own.

use super::guide::Guide;
use anyhow::Context;
use artifact::Sample2d;
use artifact::picture::Image8;
use marker_track::{GuideHits, Hint, Tracker};
use rayon::prelude::*;
use stage::{CameraImages, Run};

/// Images read ahead, per camera.
const BLOCK: usize = 16;

/// A camera at work.
pub(crate) struct Camera {
    pub(crate) id: String,
    pub(crate) images: CameraImages,
    pub(crate) tracker: Tracker,
    /// Per frame its samples.
    pub(crate) samples: Vec<Option<Vec<Option<Sample2d>>>>,
    /// Per frame the dots that no marker has.
    pub(crate) strays: Vec<Vec<[f64; 2]>>,
    /// What the guide was worth in all images.
    pub(crate) guided: GuideHits,
    /// Place of the frame that the tracker was last given.
    pub(crate) last: usize,
}

/// What all cameras share.
pub(crate) struct Plan<'a> {
    pub(crate) numbers: &'a [i64],
    pub(crate) markers: &'a [String],
    pub(crate) guide: Option<&'a Guide>,
}

/// Follows the markers from the frame at `first` to both ends of the take.
pub(crate) fn follow(run: &mut Run, cameras: &mut [Camera], plan: &Plan, first: usize) -> anyhow::Result<()> {
    let starts: Vec<Tracker> = cameras.iter().map(|camera| camera.tracker.clone()).collect();
    let forward: Vec<usize> = (first + 1..plan.numbers.len()).collect();
    let backward: Vec<usize> = (0..first).rev().collect();
    let mut progress = run.progress("tracking", Some(plan.numbers.len() as u64 - 1));
    for order in [forward, backward] {
        for (camera, start) in cameras.iter_mut().zip(&starts) {
            (camera.tracker, camera.last) = (start.clone(), first);
        }
        for block in order.chunks(BLOCK) {
            follow_block(run, cameras, plan, block)?;
            block.iter().for_each(|_| progress.step());
        }
    }
    Ok(())
}

/// An image, and what the guide says of it.
type Step = Option<(Image8, Option<Vec<Option<Hint>>>)>;

fn follow_block(run: &mut Run, cameras: &mut [Camera], plan: &Plan, block: &[usize]) -> anyhow::Result<()> {
    let read = |camera: &Camera| -> anyhow::Result<Vec<Step>> {
        block.par_iter().map(|&index| read_step(camera, plan, index)).collect()
    };
    let steps: Vec<Vec<Step>> =
        run.timed("decode", || cameras.par_iter().map(read).collect::<anyhow::Result<_>>())?;
    let follow = |(camera, steps): (&mut Camera, &Vec<Step>)| -> anyhow::Result<()> {
        for (&index, step) in block.iter().zip(steps) {
            let Some((image, hints)) = step else { continue };
            let frames = plan.numbers[index].abs_diff(plan.numbers[camera.last]) as f64;
            let samples = camera
                .tracker
                .step(&image.picture(), frames, hints.as_deref())
                .with_context(|| format!("camera {}, frame {}", camera.id, plan.numbers[index]))?;
            camera.guided += camera.tracker.guide_hits();
            camera.strays[index] = camera.tracker.strays();
            (camera.samples[index], camera.last) = (Some(samples), index);
        }
        Ok(())
    };
    run.timed("track", || cameras.par_iter_mut().zip(&steps).try_for_each(follow))
}

fn read_step(camera: &Camera, plan: &Plan, index: usize) -> anyhow::Result<Step> {
    let Some(path) = &camera.images.paths[index] else { return Ok(None) };
    let image = camera.images.read_8_bits(path)?;
    let hints = plan
        .guide
        .map(|guide| guide.hints(plan.numbers[index], &camera.id, camera.images.size, plan.markers));
    Ok(Some((image, hints.transpose()?.flatten())))
}
