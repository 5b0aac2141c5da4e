//! Options of the method, which both subcommands have.

use normalmap_acquire::{Exposure, Light, Mode, Params, Region};

/// How normals are found
#[derive(clap::Args)]
#[command(next_help_heading = "Method")]
pub(crate) struct Options {
    /// The method: estimator, or paper (the published rule as it is printed)
    #[arg(long, value_name = "NAME", default_value = "estimator", value_parser = ["estimator", "paper"])]
    mode: String,
    /// The light: auto (from the face's shading, where landmarks have depths), unknown, flash, mixed, ambient, or the share of
    /// the flash, 0 to 1, with its tilt X,Y (y up) where it stands off the lens
    #[arg(long, value_name = "NAME|SHARE[,X,Y]", default_value = "auto", value_parser = light)]
    light: KnownLight,
    /// How exposure is taken out of the ratio: none, global, local [default: none for paper, else local]
    #[arg(long, value_name = "NAME", value_parser = ["none", "global", "local"])]
    exposure: Option<String>,
    /// Standard deviation of the ratio's blur, distances of the pupils
    #[arg(long, value_name = "IO", default_value_t = Params::default().blur_io)]
    blur: f64,
    /// Over which distance exposure may change, distances of the pupils
    #[arg(long, value_name = "IO", default_value_t = Params::default().exposure_io)]
    exposure_reach: f64,
    /// Blur of the ratio whose gradient tells the side, distances of the pupils [default: by the light]
    #[arg(long, value_name = "IO")]
    side_blur: Option<f64>,
    /// Slopes longer than this are flattened, distances of the pupils
    #[arg(long, value_name = "IO", default_value_t = Params::default().reach_io)]
    reach: f64,
    /// How many noise levels of darkening say nothing
    #[arg(long, value_name = "N", default_value_t = Params::default().dead_zone)]
    dead_zone: f64,
    /// Slope over that which a flash would need for the same darkening [default: by the light]
    #[arg(long, value_name = "FACTOR")]
    gain: Option<f64>,
    /// How far the warp may miss landmarks: smoothing of the thin plate
    #[arg(long, value_name = "N", default_value_t = 1e-3)]
    smoothing: f64,
    /// Do not correct the warp by what the photographs show
    #[arg(long)]
    no_refine: bool,
    /// Leave nothing out by itself: no soft borders, eyes, lips, cheeks' edges, blotches
    #[arg(long)]
    no_masks: bool,
}

/// The light as stated.
#[derive(Debug, Clone, Copy)]
enum KnownLight {
    Auto,
    Unknown,
    Stated(Light),
}

fn light(text: &str) -> Result<KnownLight, String> {
    let straight = |flash_share| Ok(KnownLight::Stated(Light { flash_share, tilt: [0.0; 2] }));
    match text {
        "auto" => return Ok(KnownLight::Auto),
        "unknown" => return Ok(KnownLight::Unknown),
        "flash" => return straight(1.0),
        "mixed" => return straight(0.5),
        "ambient" => return straight(0.0),
        _ => {}
    }
    let numbers: Option<Vec<f64>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[share]) if (0.0..=1.0).contains(&share) => straight(share),
        Some(&[share, x, y]) if (0.0..=1.0).contains(&share) && x.abs() <= 1.0 && y.abs() <= 1.0 => {
            Ok(KnownLight::Stated(Light { flash_share: share, tilt: [x, y] }))
        }
        _ => Err("say auto, unknown, flash, mixed, ambient, or a share from 0 to 1, alone or with a tilt X,Y from -1 to 1".to_string()),
    }
}

impl Options {
    pub(crate) fn params(&self) -> anyhow::Result<Params> {
        let params = Params {
            mode: if self.mode == "paper" { Mode::Paper } else { Mode::Estimator },
            light: match self.light {
                KnownLight::Stated(light) => Some(light),
                _ => None,
            },
            exposure: self.exposure.as_deref().map(|name| match name {
                "none" => Exposure::None,
                "global" => Exposure::Global,
                _ => Exposure::Local,
            }),
            blur_io: self.blur,
            exposure_io: self.exposure_reach,
            side_io: self.side_blur,
            reach_io: self.reach,
            dead_zone: self.dead_zone,
            gain: self.gain,
        };
        params.check()?;
        anyhow::ensure!(
            (0.0..=10.0).contains(&self.smoothing),
            "--smoothing {}: it must lie between 0 and 10",
            self.smoothing
        );
        Ok(params)
    }

    pub(crate) fn region(&self, params: &Params) -> Region {
        let usual = Region::of(params.mode);
        Region {
            smoothing: self.smoothing,
            refine: usual.refine && !self.no_refine,
            masks: usual.masks && !self.no_masks,
            find_light: usual.find_light && matches!(self.light, KnownLight::Auto),
        }
    }
}
