//! The outside check of the light: how bright is the bottom of a groove?

use serde_json::json;
use stage::Run;
use virtual_rig::light::groove::groove_table;

/// Trace the light at the bottom of long grooves of the profile S(p), to be compared with its closed form
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Depths over widths d/w
    #[arg(long, value_name = "D/W,…", value_delimiter = ',', default_values_t = [0.1, 0.2, 0.3, 0.5, 0.7, 1.0])]
    ratio: Vec<f64>,
    /// Rays over the hemisphere
    #[arg(long, value_name = "N", default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=1_048_576))]
    rays: u32,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("groove");
    if let Some(ratio) = arguments.ratio.iter().find(|ratio| !(0.01..=5.0).contains(*ratio)) {
        anyhow::bail!("--ratio {ratio}: must lie between 0.01 and 5");
    }
    run.parameters(&json!({ "ratio": arguments.ratio, "rays": arguments.rays }))?;
    let table = run.timed("trace", || groove_table(&arguments.ratio, arguments.rays));
    for (ratio, light) in &table {
        run.say(&format!("  d/w {ratio}: {light:.4}"));
    }
    run.result("table", table);
    Ok(())
}
