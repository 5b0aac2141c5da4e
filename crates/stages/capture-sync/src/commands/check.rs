//! How far the cameras are apart, in ms and in mm.

use anyhow::bail;
use artifact::{FrameReader, SyncFrame, SyncHeader, SyncSource, TimeBase, Trajectories3d, picture};
use capture_sync::{Skew, draw, skews, speeds};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Report each camera's skew in ms, and what it means in mm where markers move
#[derive(clap::Args)]
pub(crate) struct Check {
    /// Time base (sync/1; - for standard input)
    sync: PathBuf,
    /// Speed of the markers, mm/s
    #[arg(long, value_name = "MM/S", conflicts_with = "markers", allow_negative_numbers = true, value_parser = positive)]
    speed: Option<f64>,
    /// Markers whose speed is measured (trajectories-3d, .c3d, .trc): 95 % of their steps are slower
    #[arg(long, value_name = "FILE")]
    markers: Option<PathBuf>,
    /// Draw per camera its lag over the take, and where images are missing (.png)
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// End with exit code 1 if a camera's skew is more than this, ms
    #[arg(long, value_name = "MS", allow_negative_numbers = true, value_parser = positive)]
    max_ms: Option<f64>,
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number.is_finite() && number > 0.0 => Ok(number),
        _ => Err(format!("'{text}' is not a number above 0")),
    }
}

impl Check {
    pub(crate) fn run(&self, run: &mut stage::Run) -> anyhow::Result<()> {
        run.subcommand("check");
        run.parameters(&json!({ "speed_mm_s": self.speed, "max_ms": self.max_ms }))?;
        let reader = FrameReader::<TimeBase>::open(&self.sync)?;
        let header = reader.header().clone();
        let frames: Vec<SyncFrame> = reader.collect::<Result<_, _>>()?;
        run.input("sync", &self.sync)?;
        if frames.is_empty() {
            bail!("{}: holds no frames\n  to do: run capture-sync again, to its end", self.sync.display());
        }
        let speed = match &self.markers {
            None => self.speed,
            Some(path) => Some(measured_speed(run, path, &header)?),
        };
        if let Some(speed) = speed {
            run.result("speed_mm_s", speed);
        }
        let skews = skews(&header, &frames, speed);
        run.report("camera    mean/ms  worst/ms  mean/mm  worst/mm   shown  missing  doubled  source")?;
        skews.iter().try_for_each(|(id, skew)| run.report(&row(id, skew)))?;
        warn_of_stated(run, &skews);
        let worst = skews.values().map(|skew| skew.worst_ms.abs()).fold(0.0, f64::max);
        run.result("worst_ms", worst);
        run.result("cameras", &skews);
        if let Some(path) = &self.picture {
            let drawn = draw(&header, &frames)?;
            run.publish(vec![picture::write_rgb8(path, drawn.width, drawn.height, &drawn.rgb)?])?;
        }
        if let Some(most) = self.max_ms.filter(|most| worst > *most) {
            run.object(format!(
                "{}: a camera is {worst:.3} ms off, more than {most} ms",
                self.sync.display()
            ));
        }
        Ok(())
    }
}

/// The speed that 95 % of the markers' steps stay below, mm/s.
fn measured_speed(run: &mut stage::Run, path: &Path, header: &SyncHeader) -> anyhow::Result<f64> {
    let markers = run.markers::<Trajectories3d>(path, None)?;
    run.input("markers", path)?;
    let rate = markers.header.rate.unwrap_or(header.rate);
    let Some(speeds) = speeds(&markers.frames, rate) else {
        bail!("{}: no marker is seen in two neighbouring frames\n  to do: say --speed", path.display());
    };
    run.result("speed_median_mm_s", speeds.median_mm_s);
    Ok(speeds.p95_mm_s)
}

fn row(id: &str, skew: &Skew) -> String {
    let mm = |value: Option<f64>| value.map_or_else(|| "–".to_string(), |value| format!("{value:.3}"));
    format!(
        "{id:<8} {:>8.3}  {:>8.3}  {:>7}  {:>8}  {:>6}  {:>7}  {:>7}  {}",
        unsigned_zero(skew.mean_ms),
        unsigned_zero(skew.worst_ms),
        mm(skew.mean_mm),
        mm(skew.worst_mm),
        skew.shown,
        skew.missing,
        skew.doubled,
        name(skew.source)
    )
}

/// What would be printed as -0.000 is 0.
fn unsigned_zero(ms: f64) -> f64 {
    if ms.abs() < 5e-4 { 0.0 } else { ms }
}

fn name(source: SyncSource) -> &'static str {
    match source {
        SyncSource::Stated => "stated",
        SyncSource::Timestamps => "timestamps",
        SyncSource::Trigger => "trigger",
        SyncSource::Flash => "flash",
        SyncSource::Correlation => "correlation",
    }
}

/// A lag that was only stated says nothing about the images.
fn warn_of_stated(run: &mut stage::Run, skews: &BTreeMap<String, Skew>) {
    let stated = skews.iter().filter(|(_, skew)| skew.source == SyncSource::Stated);
    let ids: Vec<&str> = stated.map(|(id, _)| &id[..]).collect();
    if !ids.is_empty() {
        run.warn(format!(
            "the lags of {} are stated, not measured; calibrate doctor measures them where tracks are, and capture-sync run \
             --late sets them",
            ids.join(", ")
        ));
    }
}
