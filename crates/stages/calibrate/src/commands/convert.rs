//! Cameras from one format to another.

use anyhow::bail;
use artifact::{CameraFormat, CameraRig, Stated, Unit, read_cameras, write_cameras};
use clap::ValueEnum;
use serde::Serialize;
use stage::Run;
use std::path::PathBuf;

/// Convert calibrated cameras between cameras/1 and the formats of other programs
///
/// What a format cannot hold is refused by name: coefficients beyond k3, fisheye models, skew.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// What to convert: a file, two of OpenCV's (intrinsics, extrinsics), or COLMAP's folder
    #[arg(value_name = "IN", required = true)]
    input: Vec<PathBuf>,
    /// Format of what is read
    #[arg(long, value_enum, value_name = "FORMAT")]
    from: Format,
    /// Format to write
    #[arg(long, value_enum, value_name = "FORMAT")]
    to: Format,
    /// Unit of the translations in the other program's files: mm, cm or m (cameras/1 is in mm)
    #[arg(long)]
    unit: Unit,
    /// Size of the images, where the files do not say it, e.g. 656x490
    #[arg(long, value_name = "WxH", value_parser = image_size)]
    image_size: Option<[u32; 2]>,
    /// Give cameras other names, e.g. 1=m1,2=m2
    #[arg(long, value_name = "OLD=NEW", value_delimiter = ',', value_parser = renaming)]
    rename: Vec<Renaming>,
    /// Where to write the cameras: a file, or COLMAP's folder
    #[arg(long, value_name = "PATH")]
    out: PathBuf,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Format {
    /// cameras/1
    Furrow,
    /// OpenCV's FileStorage: .yml, .yaml or .json
    Opencv,
    /// TOML of aniposelib, Pose2Sim or Caliscope
    Anipose,
    /// A folder with COLMAP's cameras.txt and images.txt
    Colmap,
}

/// A camera's id, as it is and as it shall be.
#[derive(Debug, Clone, Serialize)]
struct Renaming {
    old: String,
    new: String,
}

#[derive(Serialize)]
struct Parameters<'a> {
    from: Format,
    to: Format,
    unit: Unit,
    image_size: Option<[u32; 2]>,
    rename: &'a [Renaming],
}

impl From<Format> for CameraFormat {
    fn from(format: Format) -> Self {
        match format {
            Format::Furrow => Self::Furrow,
            Format::Opencv => Self::Opencv,
            Format::Anipose => Self::Anipose,
            Format::Colmap => Self::Colmap,
        }
    }
}

fn image_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text
        .split_once(['x', '×'])
        .and_then(|(width, height)| Some([width.parse::<u32>().ok()?, height.parse::<u32>().ok()?]));
    sides
        .filter(|sides| !sides.contains(&0))
        .ok_or_else(|| "say WIDTHxHEIGHT in pixels, e.g. 656x490".to_string())
}

fn renaming(text: &str) -> Result<Renaming, String> {
    match text.split_once('=') {
        Some((old, new)) if !old.is_empty() && !new.is_empty() => {
            Ok(Renaming { old: old.to_string(), new: new.to_string() })
        }
        _ => Err("say OLD=NEW, e.g. 1=left".to_string()),
    }
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("convert");
    let &Arguments { from, to, unit, image_size, .. } = arguments;
    run.parameters(&Parameters { from, to, unit, image_size, rename: &arguments.rename })?;
    record_inputs(run, arguments)?;
    // Our own kind is in mm; the stated unit is the other side's.
    let stated = Stated { unit: if from == Format::Furrow { Unit::Mm } else { unit }, image_size };
    let (rig, warnings) = read_cameras(&arguments.input, from.into(), &stated)?;
    warnings.into_iter().for_each(|warning| run.warn(warning));
    let rig = renamed(rig, &arguments.rename)?;
    run.result("cameras", rig.cameras.keys().collect::<Vec<_>>());
    let (outputs, warnings) = write_cameras(&arguments.out, &rig, to.into(), unit)?;
    warnings.into_iter().for_each(|warning| run.warn(warning));
    run.publish(outputs)
}

fn record_inputs(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    for path in &arguments.input {
        match path.is_dir() {
            true => {
                run.input("lenses", &path.join("cameras.txt"))?;
                run.input("poses", &path.join("images.txt"))?;
            }
            false => {
                run.input("cameras", path)?;
            }
        }
    }
    Ok(())
}

/// The same cameras under other names, which may change places.
fn renamed(mut rig: CameraRig, names: &[Renaming]) -> anyhow::Result<CameraRig> {
    let mut moved = Vec::new();
    for Renaming { old, new } in names {
        let Some(camera) = rig.cameras.remove(old) else {
            let known: Vec<&str> = rig.cameras.keys().map(String::as_str).collect();
            bail!(
                "camera {old}: there is none to rename to {new}\n  to do: name one of {}",
                known.join(", ")
            );
        };
        moved.push((new, camera));
    }
    for (new, camera) in moved {
        if rig.cameras.insert(new.clone(), camera).is_some() {
            bail!("camera {new}: two cameras would have this name\n  to do: give each a name of its own");
        }
    }
    Ok(rig)
}
