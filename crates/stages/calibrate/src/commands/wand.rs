//! `calibrate wand`: from pictures of a waved point to cameras.

use super::footage::{check_outputs, check_points};
use super::length::{self, Word};
use super::shared::Lens;
use super::wand_input::{self, Given};
use anyhow::Context;
use artifact::{
    CameraRig, FrameWriter, RigCamera, Sample2d, Staged, Tracks2d, Tracks2dFrame, Tracks2dHeader,
    read_document, write_document,
};
use calibrate::LensModel;
use calibrate::bundle::Focal;
use calibrate::wand::{Params, Scale, Sightings, Wand, calibrate};
use serde_json::{Value, json};
use stage::Run;
use std::path::{Path, PathBuf};

/// Find all cameras from one bright point, waved in a dark room
///
/// Images of equal number must have been taken at the same time. Wave the point through all of the space that the cameras share,
/// its depth too. How large that space is, the point does not tell: say it with --scale.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Folder with a folder of numbered PNG images or a video per camera, named by the camera's id; or points found elsewhere:
    /// tracks-2d (.jsonl), or .csv with columns frame, camera, x, y
    #[arg(value_name = "FOLDER|FILE")]
    input: PathBuf,
    /// Names of the images in a camera's folder [default: {frame:06}.png]
    #[arg(long, value_name = "PATTERN")]
    name: Option<String>,
    /// Take manifest: gives the images' sizes and transfer functions (else sRGB), and is referred to by what is written
    #[arg(long, value_name = "FILE")]
    take: Option<PathBuf>,
    /// Lenses that are about right (cameras), to start from; they are improved all the same
    #[arg(long, value_name = "FILE")]
    intrinsics: Option<PathBuf>,
    /// Do not improve the given lenses: find poses only
    #[arg(long, requires = "intrinsics")]
    hold_intrinsics: bool,
    /// Where the size comes from: A:B=MM, a length measured between the point's places in two frames or between two cameras
    /// (several may be given); MM, the cameras' mean distance from the wand; or unknown
    #[arg(long, value_name = "A:B=MM|MM|unknown", value_parser = length::word, required = true, allow_negative_numbers = true, num_args = 1.., value_delimiter = ',')]
    scale: Vec<Word>,
    /// Camera ids to leave out
    #[arg(long, value_name = "ID,…", value_delimiter = ',')]
    without: Vec<String>,
    /// Do not look for the principal points: they are in the middle of the images, or where --intrinsics says
    #[arg(long)]
    hold_center: bool,
    /// Which distortion is looked for, at most: terms that the point does not tell stay 0
    #[arg(long, value_enum, default_value = "tangential")]
    lens: Lens,
    /// Seed of the random samples
    #[arg(long, value_name = "N", default_value_t = Params::default().seed)]
    seed: u64,
    /// Cameras to write
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Where the point was seen, to write as tracks-2d; the doctor asks for it
    #[arg(long, value_name = "FILE")]
    out_tracks: Option<PathBuf>,
}

impl Arguments {
    fn scale(&self) -> anyhow::Result<Scale> {
        match self.scale.as_slice() {
            [Word::Unknown] => return Ok(Scale::Unknown),
            [Word::Distance(mm)] => return Ok(Scale::Distance(*mm)),
            _ => {}
        }
        let length = |word: &Word| match word {
            Word::Length(length) => Ok(length.clone()),
            _ => anyhow::bail!(
                "--scale: lengths A:B=MM can be given together, nothing else\n  to do: give lengths, or one word"
            ),
        };
        Ok(Scale::Lengths(self.scale.iter().map(length).collect::<anyhow::Result<_>>()?))
    }

    fn params(&self) -> anyhow::Result<Params> {
        let mut params = Params { seed: self.seed, scale: self.scale()?, ..Params::default() };
        let free = &mut params.free;
        free.center = !self.hold_center && !self.hold_intrinsics;
        free.focal = if self.hold_intrinsics { Focal::Held } else { Focal::Tied };
        let lens = if self.hold_intrinsics { LensModel::Pinhole } else { self.lens.into() };
        free.distortion = lens.free();
        Ok(params)
    }
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("wand");
    let params = arguments.params()?;
    run.parameters(&params)?;
    let take = arguments.take.as_deref().map(|path| stage::load_take(run, path)).transpose()?;
    let lenses: Option<CameraRig> = match &arguments.intrinsics {
        Some(path) => {
            run.input("intrinsics", path)?;
            Some(read_document(path)?)
        }
        None => None,
    };
    check_outputs(run, &[Some(&arguments.out), arguments.out_tracks.as_deref()])?;
    let given = Given {
        name: arguments.name.as_deref(),
        take: take.as_ref().map(|(take, _)| take),
        lenses: lenses.as_ref(),
        without: &arguments.without,
    };
    let sightings = wand_input::read(run, &arguments.input, &given)?;
    for camera in &sightings.cameras {
        let seen: Vec<_> = camera.track.iter().flatten().copied().collect();
        check_points(run, &arguments.input, &camera.id, camera.image_size, &seen)?;
    }
    let reference = take.map(|(_, reference)| reference);
    // Before the adjustment: where that fails, they tell why.
    if let Some(path) = &arguments.out_tracks {
        run.publish(vec![write_tracks(path, &sightings, reference.clone())?])?;
    }
    let wand = run
        .timed("calibrate", || calibrate(&sightings, &params))
        .map_err(|error| told(&arguments.input, &error))?;
    report(run, &sightings, &wand);
    tell_scale(run, &params.scale);
    run.publish(vec![write_document(&arguments.out, &rig(&sightings, &wand, reference))?])
}

/// An error of the method, said of its input.
fn told(input: &Path, error: &calibrate::wand::Error) -> artifact::Error {
    let said = artifact::Error::new(input, error.to_string());
    match error.fix() {
        Some(fix) => said.fix(fix),
        None => said,
    }
}

fn rig(sightings: &Sightings, wand: &Wand, take: Option<artifact::TakeRef>) -> CameraRig {
    let camera = |(i, seen): (usize, &calibrate::wand::WandCamera)| {
        let camera = RigCamera {
            camera: wand.cameras[i].clone(),
            rms_px: Some(wand.rms_px[i]),
            views: Some(wand.used[i]),
            deviation: wand.deviations.as_ref().map(|all| all[i]),
        };
        (seen.id.clone(), camera)
    };
    CameraRig { cameras: sightings.cameras.iter().enumerate().map(camera).collect(), take }
}

fn report(run: &mut Run, sightings: &Sightings, wand: &Wand) {
    let worst =
        (0..wand.rms_px.len()).max_by(|&a, &b| wand.rms_px[a].total_cmp(&wand.rms_px[b])).unwrap_or(0);
    let row = |(i, camera): (usize, &calibrate::wand::WandCamera)| {
        let row = json!({
            "rms_px": wand.rms_px[i], "used": wand.used[i], "rejected": wand.rejected[i],
            "focal_px": wand.cameras[i].lens.focal_px.x,
        });
        (camera.id.clone(), row)
    };
    for (i, camera) in sightings.cameras.iter().enumerate() {
        run.say(&format!(
            "  {}: {:.3} px rms over {} frames, {} rejected; focal length {:.1} px",
            camera.id, wand.rms_px[i], wand.used[i], wand.rejected[i], wand.cameras[i].lens.focal_px.x
        ));
        if 5 * wand.rejected[i] > wand.used[i] {
            run.warn(format!("camera {}: {} of its sightings fit with nothing", camera.id, wand.rejected[i]));
        }
    }
    let rows: serde_json::Map<String, Value> = sightings.cameras.iter().enumerate().map(row).collect();
    run.result("cameras", rows);
    run.result("worst_rms_px", wand.rms_px[worst]);
    run.result("lengths", &wand.lengths);
    for one in &wand.lengths {
        let off = one.mm / one.length.mm - 1.0;
        if off.abs() > 0.005 {
            run.warn(format!(
                "the known length of {} mm comes out as {:.2} mm, {:+.1} % off the others",
                one.length.mm,
                one.mm,
                100.0 * off
            ));
        }
    }
}

/// A scale that is unknown stays in the record.
fn tell_scale(run: &mut Run, scale: &Scale) {
    if *scale == Scale::Unknown {
        run.result("scale", "unknown");
        run.warn(
            "the scale is not known: the cameras are set 1000 mm from the wand on average, and nothing that is measured with them \
             is in mm; give --scale a length before markers are measured",
        );
    }
}

/// The name of the point in tracks.
const MARKER: &str = "wand";

fn write_tracks(
    path: &Path,
    sightings: &Sightings,
    take: Option<artifact::TakeRef>,
) -> anyhow::Result<Staged> {
    let cameras = sightings.cameras.iter().map(|camera| camera.id.clone()).collect();
    let header = Tracks2dHeader { cameras, markers: vec![MARKER.to_string()], rate: None, take };
    let mut writer = FrameWriter::<Tracks2d>::create(path, header)?;
    for (place, &frame) in sightings.frames.iter().enumerate() {
        let sample = |seen: nalgebra::Vector2<f64>| Sample2d::seen(seen.into());
        let cameras =
            sightings.cameras.iter().map(|camera| Some(vec![camera.track[place].map(sample)])).collect();
        writer.write(&Tracks2dFrame { frame, cameras })?;
    }
    writer.finish().context("the tracks cannot be finished")
}
