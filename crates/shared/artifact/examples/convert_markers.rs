//! Converts markers between formats by the files' endings: `convert_markers IN OUT [mm|cm|m]`.

use artifact::{Trajectories3d, Unit, read_trajectories, write_trajectories};
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [input, output, unit @ ..] = &arguments[..] else {
        return Err("usage: convert_markers IN OUT [mm|cm|m]".into());
    };
    let unit = unit.first().map(|unit| unit.to_string_lossy().parse::<Unit>()).transpose()?;
    let (trajectories, warnings) = read_trajectories::<Trajectories3d>(input, unit)?;
    #[allow(clippy::print_stderr, reason = "an example has no stage to print for it")]
    warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    write_trajectories::<Trajectories3d>(output, &trajectories)?.publish()?;
    Ok(())
}
