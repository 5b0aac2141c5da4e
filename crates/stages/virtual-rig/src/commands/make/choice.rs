//! Which scenario, and what is changed about it.

use anyhow::{anyhow, bail};
use stage::Run;
use std::path::Path;
use virtual_rig::scenario::{Fault, Length, PRESETS, Scenario, preset};

#[derive(clap::Args)]
pub(crate) struct Choice {
    /// Scenario: clean, standard, hard, or a file
    #[arg(long, value_name = "NAME|FILE", default_value = "standard")]
    scenario: String,
    /// Length: tiny (3 + 1 frames, small), short (25 + 7) or long (500 + 125), each with its vertices, image scale and
    /// calibration; the scenario's own if absent
    #[arg(long, value_name = "tiny|short|long")]
    length: Option<Length>,
    /// Seed: another person, performance, paint and noise
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Vertices of the face
    #[arg(long, value_name = "N")]
    vertices: Option<usize>,
    /// Frames of the mocap clock
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    count: Option<u32>,
    /// Size of the images as a share of the cameras' own
    #[arg(long, value_name = "SHARE")]
    image_scale: Option<f64>,
    /// Cameras of the rig to film with, e.g. m1,m2,w1; all if absent
    #[arg(long, value_name = "ID,ID...", value_delimiter = ',')]
    cameras: Vec<String>,
    /// Something that goes wrong, e.g. rotated=0.3@m2 (degrees); may be said again
    #[arg(long, value_name = "KIND=AMOUNT[@CAMERA]")]
    fault: Vec<Fault>,
}

impl Choice {
    /// The scenario with all changes, checked.
    pub(crate) fn scenario(&self, run: &mut Run) -> anyhow::Result<Scenario> {
        let read = self.named(run)?;
        let mut scenario = read.clone().with_seed(self.seed.unwrap_or(read.seed));
        if let Some(length) = self.length {
            length.apply(&mut scenario);
        }
        scenario.vertices = self.vertices.unwrap_or(scenario.vertices);
        scenario.extent.frames = self.count.unwrap_or(scenario.extent.frames);
        scenario.image_scale = self.image_scale.unwrap_or(scenario.image_scale);
        self.explain(scenario.keep_cameras(&self.cameras))?;
        scenario.faults.extend(self.fault.iter().cloned());
        scenario.mark_changes(&read);
        self.explain(scenario.validate())?;
        Ok(scenario)
    }

    /// Says of what is wrong with a scenario which one it is, and what to do.
    pub(crate) fn explain<T>(&self, outcome: Result<T, virtual_rig::Error>) -> anyhow::Result<T> {
        outcome.map_err(|error| {
            anyhow!(
                "--scenario {}: {error}\n  to do: change it in the scenario (virtual-rig scenario prints it), or by the options",
                self.scenario
            )
        })
    }

    fn named(&self, run: &mut Run) -> anyhow::Result<Scenario> {
        if let Some(scenario) = preset(&self.scenario) {
            return Ok(scenario);
        }
        let path = Path::new(&self.scenario);
        if !self.scenario.contains(['/', '.']) {
            let names: Vec<&str> = PRESETS.iter().map(|(name, _)| *name).collect();
            bail!(
                "--scenario {}: there is no such scenario\n  to do: say {}, or the path of a file",
                self.scenario,
                names.join(", ")
            );
        }
        let scenario = artifact::read_document::<Scenario>(path)?;
        run.input("scenario", path)?;
        Ok(scenario)
    }
}
