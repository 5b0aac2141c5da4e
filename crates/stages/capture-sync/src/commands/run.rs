//! Take manifest and footage → sync, frames.

use super::extract::extract;
use super::footage_files::{FootageFiles, Looking, Read};
use super::output_folder::{self, OutputFolder};
use anyhow::{anyhow, bail};
use artifact::{Clock, FrameRange, FrameWriter, Frames, SyncFrame, Take, TakeRef, TimeBase, Timecode};
use capture_sync::{
    CameraReport, DRIFT_PRIOR_PPM, Error, LATE_FRAMES, Loss, Mode, Params, SEARCH_S, Synchronized, TakeClock,
    synchronize,
};
use clap::ValueEnum;
use rayon::prelude::*;
use serde_json::json;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::Mutex;

/// Find the time base of a take, and extract its images
///
/// Writes DIR/sync.jsonl (sync/1), DIR/frames.json (frames/1) and DIR/<camera>/<frame:06>.png. Numbered pictures keep their
/// bytes (hard links where the file system can make them); frames of videos become PNG.
#[derive(clap::Args)]
pub(crate) struct Run {
    /// Take manifest
    take: PathBuf,
    /// Folder to write to
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Where the images' times are taken from; auto: what the take's clock says
    #[arg(long, value_enum, default_value_t = ModeArgument::Auto)]
    mode: ModeArgument,
    /// Do not use time stamps to find dropped and doubled images
    #[arg(long)]
    ignore_timestamps: bool,
    /// How far the cameras' starts may lie apart, s (correlation)
    #[arg(long, value_name = "S", default_value_t = Params::default().search_s, allow_negative_numbers = true, value_parser = seconds)]
    search_s: f64,
    /// How far off a clock is expected to run, ppm: holds back the drift of short takes
    #[arg(long, value_name = "PPM", default_value_t = Params::default().drift_prior_ppm, allow_negative_numbers = true, value_parser = ppm)]
    drift_prior_ppm: f64,
    /// How many mocap frames later than found otherwise a camera takes its images; for what tracks tell; may be said again
    #[arg(long, value_name = "ID=FRAMES", value_parser = late)]
    late: Vec<(String, f64)>,
    /// Mocap frames to write, by their absolute numbers; the time base is found from all footage
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    frames: Option<FrameRange>,
    /// Cameras to use [default: all that have footage]
    #[arg(long, value_name = "ID,…", value_delimiter = ',')]
    camera: Vec<String>,
    /// Go on with a video that ends early: the frames that are not there are gaps
    #[arg(long)]
    accept_short: bool,
    /// Write only sync.jsonl
    #[arg(long)]
    no_extract: bool,
}

fn seconds(text: &str) -> Result<f64, String> {
    within(text, SEARCH_S, "s")
}

fn ppm(text: &str) -> Result<f64, String> {
    within(text, DRIFT_PRIOR_PPM, "ppm")
}

fn within(text: &str, range: RangeInclusive<f64>, unit: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| range.contains(number));
    number.ok_or_else(|| format!("say a number from {} to {} {unit}", range.start(), range.end()))
}

fn late(text: &str) -> Result<(String, f64), String> {
    let parts = text.split_once('=').and_then(|(id, frames)| Some((id, frames.parse::<f64>().ok()?)));
    match parts.filter(|(id, frames)| !id.is_empty() && LATE_FRAMES.contains(frames)) {
        Some((id, frames)) => Ok((id.to_string(), frames)),
        None => Err(format!(
            "'{text}' is not a camera and a number of mocap frames from {} to {}, as in m4=2.3",
            LATE_FRAMES.start(),
            LATE_FRAMES.end()
        )),
    }
}

/// Offsets that are less sure than this are pointed out, mocap frames.
const SURE_FRAMES: f64 = 0.1;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ModeArgument {
    Auto,
    /// As the take says: 'first' shows the first frame
    Stated,
    /// Time stamps by a common clock
    Timestamps,
    /// A flash that all cameras see
    Flash,
    /// What moves in the images
    Correlation,
}

impl ModeArgument {
    fn mode(self, clock: Clock, is_stamped: bool) -> Mode {
        match (self, clock) {
            (Self::Stated, _) => Mode::Stated,
            (Self::Timestamps, _) | (Self::Auto, Clock::Timestamps) => Mode::Timestamps,
            (Self::Flash, _) | (Self::Auto, Clock::Flash) => Mode::Flash,
            (Self::Correlation, _) | (Self::Auto, Clock::Free) => Mode::Correlation,
            // A trigger's log, where there is one, also knows whose first image is missing.
            (Self::Auto, Clock::Trigger | Clock::Mocap) if is_stamped => Mode::Timestamps,
            (Self::Auto, Clock::Trigger | Clock::Mocap) => Mode::Stated,
        }
    }
}

impl Run {
    pub(crate) fn run(&self, run: &mut stage::Run) -> anyhow::Result<()> {
        run.subcommand("run");
        let (take, reference) = stage::load_take(run, &self.take)?;
        let files = self.open(run, &take)?;
        let is_stamped = !self.ignore_timestamps && files.iter().all(FootageFiles::is_stamped);
        let params = Params {
            mode: self.mode.mode(take.clock, is_stamped),
            use_stamps: !self.ignore_timestamps,
            search_s: self.search_s,
            drift_prior_ppm: self.drift_prior_ppm,
            late: self.late()?,
        };
        params.check()?;
        let range = self.frames.unwrap_or(FrameRange::ALL);
        run.parameters(&json!({ "sync": params, "frames": range.to_string(), "extract": !self.no_extract }))?;
        let outputs = [self.out.join("sync.jsonl"), self.out.join("frames.json")];
        run.check_outputs(&[&outputs[0], &outputs[1]])?;
        output_folder::check_writable(&self.out)?;
        let folder = (!self.no_extract).then(|| {
            let ids: Vec<&str> = files.iter().map(|files| &files.camera.id[..]).collect();
            OutputFolder::check(&self.out, &self.take, &take, &ids)
        });
        let folder = folder.transpose()?;
        let found = self.synchronize(run, &take, &files, &params)?;
        let frames: Vec<SyncFrame> =
            found.frames.iter().filter(|frame| range.contains(frame.frame)).cloned().collect();
        if frames.is_empty() {
            bail!(
                "{}: has no frames in {range}\n  to do: choose --frames from {} on",
                self.take.display(),
                take.first_frame
            );
        }
        report(run, &found, &frames, &take)?;
        self.write(run, &found, &frames, &files, folder, reference)
    }

    fn late(&self) -> anyhow::Result<BTreeMap<String, f64>> {
        let late: BTreeMap<String, f64> = self.late.iter().cloned().collect();
        match late.len() == self.late.len() {
            true => Ok(late),
            false => bail!("--late: a camera is named twice\n  to do: name each camera once"),
        }
    }

    fn open(&self, run: &mut stage::Run, take: &Take) -> anyhow::Result<Vec<FootageFiles>> {
        if let Some(id) = self.camera.iter().find(|id| !take.cameras.iter().any(|camera| camera.id == **id)) {
            let known: Vec<&str> = take.cameras.iter().map(|camera| &camera.id[..]).collect();
            bail!(
                "{}: has no camera {id}\n  to do: choose --camera of {}",
                self.take.display(),
                known.join(", ")
            );
        }
        let chosen = take.cameras.iter().filter(|camera| match self.camera.is_empty() {
            true => camera.footage.is_some(),
            false => self.camera.contains(&camera.id),
        });
        let files: Vec<FootageFiles> =
            chosen.map(|camera| FootageFiles::open(run, &self.take, camera)).collect::<Result<_, _>>()?;
        match files.is_empty() {
            true => bail!(
                "{}: no camera has footage\n  to do: name the cameras' footage there",
                self.take.display()
            ),
            false => Ok(files),
        }
    }

    fn synchronize(
        &self,
        run: &mut stage::Run,
        take: &Take,
        files: &[FootageFiles],
        params: &Params,
    ) -> anyhow::Result<Synchronized> {
        // A video's own times start at 0 whenever it does.
        let unstamped = files.iter().find(|files| params.mode == Mode::Timestamps && !files.is_stamped());
        if let Some(files) = unstamped {
            return Err(self.refused(&Error::NoStamps(files.camera.id.clone())));
        }
        let needs_images = matches!(params.mode, Mode::Flash | Mode::Correlation);
        let look = |files: &FootageFiles| needs_images || !params.use_stamps || !files.is_stamped();
        let total: Option<u64> = files.iter().map(FootageFiles::image_count).sum();
        let progress = Mutex::new(run.progress("reading images", total));
        let looking =
            |files| Looking { at_pixels: look(files), accept_short: self.accept_short, progress: &progress };
        let read: Vec<anyhow::Result<Read>> =
            run.timed("read", || files.par_iter().map(|files| files.recording(looking(files))).collect());
        drop(progress);
        let mut recordings = Vec::with_capacity(files.len());
        for camera in read {
            let Read { recording, warnings } = camera?;
            warnings.into_iter().for_each(|warning| run.warn(warning));
            recordings.push(recording);
        }
        let clock = TakeClock { rate: take.rate, first_frame: take.first_frame, clock: take.clock };
        run.timed("synchronize", || synchronize(&clock, &recordings, params))
            .map_err(|error| self.refused(&error))
    }

    fn refused(&self, error: &Error) -> anyhow::Error {
        anyhow!("{}: {error}\n  to do: {}", self.take.display(), error.fix())
    }

    fn write(
        &self,
        run: &mut stage::Run,
        found: &Synchronized,
        frames: &[SyncFrame],
        files: &[FootageFiles],
        folder: Option<OutputFolder>,
        take: TakeRef,
    ) -> anyhow::Result<()> {
        let mut header = found.header.clone();
        header.take = Some(take.clone());
        let mut sync = FrameWriter::<TimeBase>::create(&self.out.join("sync.jsonl"), header)?;
        for frame in frames {
            sync.write(frame)?;
        }
        let mut outputs = vec![sync.finish()?];
        if let Some(folder) = folder {
            // Until it is written anew, no list of images says that they are all there.
            artifact::withdraw(&self.out.join("frames.json"))?;
            folder.clear()?;
            let mut cameras = BTreeMap::new();
            for files in files {
                cameras.insert(files.camera.id.clone(), extract(run, files, frames, &self.out)?);
            }
            let frames = Frames { take: Some(take), cameras };
            outputs.push(artifact::write_document(&self.out.join("frames.json"), &frames)?);
        }
        run.publish(outputs)
    }
}

/// Where most images are missing, a rate is wrong more often than a camera.
fn warn_of_few(run: &mut stage::Run, found: &Synchronized) {
    for (id, CameraReport { images, dropped, missing, .. }) in &found.report {
        let rate = found.header.cameras[id].rate;
        let due = found.frames.iter().filter(|frame| frame.shows.contains_key(id)).count();
        if *dropped as u64 > *images as u64 {
            run.warn(format!(
                "camera {id}: of {} images most, {dropped}, are missing; is its rate {rate}, and are its stamps right?",
                *images as u64 + *dropped as u64
            ));
        } else if 2 * missing > due {
            run.warn(format!(
                "camera {id}: most of its frames, {missing} of {due}, have no image; are its rate {rate} and the take's {} \
                 right?",
                found.header.rate
            ));
        }
    }
}

/// What was found, for people and for programs.
fn report(
    run: &mut stage::Run,
    found: &Synchronized,
    frames: &[SyncFrame],
    take: &Take,
) -> anyhow::Result<()> {
    run.say("camera   images  dropped  doubled  missing  offset/frames  drift/ppm");
    for (id, CameraReport { images, dropped, doubled, missing, offset_frames, drift_ppm, .. }) in
        &found.report
    {
        run.say(&format!(
            "{id:<8} {images:>6}  {dropped:>7}  {doubled:>7}  {missing:>7}  {offset_frames:>13.3}  {drift_ppm:>9.1}"
        ));
    }
    warn_of_few(run, found);
    for (id, camera) in &found.report {
        for Loss { before_image, within, images } in &camera.losses {
            run.warn(format!(
                "camera {id}: {images} lost without a trace before image {before_image} (± {within}), as motion tells; they are gaps"
            ));
        }
        if let Some(sigma) =
            camera.sigma_frames.filter(|sigma| *sigma > SURE_FRAMES && found.zero_s.is_none())
        {
            run.warn(format!(
                "camera {id}: its offset is known to ± {sigma:.2} frames only; a longer take, more motion or a flash tell more"
            ));
        }
    }
    run.result("frames", frames.len());
    run.result("first_frame", frames.first().map(|frame| frame.frame));
    run.result("last_frame", frames.last().map(|frame| frame.frame));
    run.result("zero_s", found.zero_s);
    if let (Some(start), Some(last)) = (&take.start_timecode, frames.last()) {
        let start = Timecode::parse(start, take.rate)
            .map_err(|what| anyhow!("take manifest, start_timecode: {what}\n  to do: correct it"))?;
        run.result("start_timecode", start.to_string());
        run.result("last_timecode", start.plus(last.frame - take.first_frame).to_string());
    }
    run.result("cameras", &found.report);
    Ok(())
}
