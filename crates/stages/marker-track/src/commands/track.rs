//! `marker-track track`.

use super::footage::{CameraImages, Image, Source};
use anyhow::{Context, bail};
use artifact::{FrameWriter, Labels, Sample2d, TrackState, Tracks2d, Tracks2dFrame, Tracks2dHeader};
use marker_track::{Params, Tracker};
use rayon::prelude::*;
use stage::Run;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

/// Images read ahead, per camera.
const BLOCK: usize = 16;

/// Follows the labelled markers through all images
///
/// Tracks run from the labelled frame to both ends of the take.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: Source,
    /// Markers labelled in one frame of each camera (labels); the cameras that have labels are tracked
    #[arg(long, value_name = "FILE")]
    labels: PathBuf,
    /// Tracks to write (tracks-2d; - for standard output)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// A camera at work.
struct Camera {
    id: String,
    images: CameraImages,
    tracker: Tracker,
    /// Per frame its samples.
    samples: Vec<Option<Vec<Option<Sample2d>>>>,
    /// Frame that the tracker was last given, by its place.
    last: usize,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("track");
    let params = Params::default();
    params.check()?;
    run.parameters(&params)?;
    let labels: Labels = artifact::read_document(&arguments.labels)?;
    run.input("labels", &arguments.labels)?;
    let footage = arguments.source.open(run)?;
    let numbers = footage.numbers();
    let markers: BTreeSet<&String> = labels.cameras.values().flat_map(BTreeMap::keys).collect();
    let markers: Vec<String> = markers.into_iter().cloned().collect();
    let Some(first) = numbers.iter().position(|&number| number == labels.frame) else {
        bail!("{}: labels frame {}, which the take has not", arguments.labels.display(), labels.frame);
    };
    let mut cameras = Vec::new();
    for (id, places) in &labels.cameras {
        let images = footage.camera(id)?;
        let Some(path) = &images.paths[first] else {
            bail!("{}, camera {id}: has no image of frame {}", arguments.labels.display(), labels.frame);
        };
        let image = Image::read(path, images.size)?;
        let tracker = Tracker::start(&image.picture()?, &images.transfer, &markers, places, &params)
            .with_context(|| format!("{}, camera {id}", arguments.labels.display()))?;
        let mut samples = vec![None; numbers.len()];
        samples[first] = Some(tracker.samples());
        cameras.push(Camera { id: id.clone(), images, tracker, samples, last: first });
    }
    let starts: Vec<Tracker> = cameras.iter().map(|camera| camera.tracker.clone()).collect();
    let forward: Vec<usize> = (first + 1..numbers.len()).collect();
    let backward: Vec<usize> = (0..first).rev().collect();
    for order in [forward, backward] {
        for (camera, start) in cameras.iter_mut().zip(&starts) {
            (camera.tracker, camera.last) = (start.clone(), first);
        }
        for block in order.chunks(BLOCK) {
            follow(run, &mut cameras, block, &numbers)?;
        }
    }
    let _ = TrackState::Seen;
    let header = Tracks2dHeader {
        cameras: cameras.iter().map(|camera| camera.id.clone()).collect(),
        markers,
        rate: Some(footage.rate),
        take: footage.take.clone(),
    };
    let mut writer = FrameWriter::<Tracks2d>::create(&arguments.out, header)?;
    for (index, &frame) in numbers.iter().enumerate() {
        let cameras = cameras.iter_mut().map(|camera| camera.samples[index].take()).collect();
        writer.write(&Tracks2dFrame { frame, cameras })?;
    }
    run.publish(vec![writer.finish()?])
}

fn follow(run: &mut Run, cameras: &mut [Camera], block: &[usize], numbers: &[i64]) -> anyhow::Result<()> {
    let read = |camera: &Camera| -> anyhow::Result<Vec<Option<Image>>> {
        block
            .par_iter()
            .map(|&index| camera.images.paths[index].as_ref())
            .map(|path| path.map(|path| Image::read(path, camera.images.size)).transpose())
            .collect()
    };
    let images: Vec<Vec<Option<Image>>> =
        run.timed("decode", || cameras.par_iter().map(read).collect::<anyhow::Result<_>>())?;
    let step = |(camera, images): (&mut Camera, &Vec<Option<Image>>)| -> anyhow::Result<()> {
        for (&index, image) in block.iter().zip(images) {
            let Some(image) = image else { continue };
            let frames = numbers[index].abs_diff(numbers[camera.last]) as f64;
            camera.samples[index] = Some(camera.tracker.step(&image.picture()?, frames, None)?);
            camera.last = index;
        }
        Ok(())
    };
    run.timed("track", || cameras.par_iter_mut().zip(&images).try_for_each(step))
}
