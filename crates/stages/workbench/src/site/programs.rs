//! The stages that pages ask, as programs.

use super::{Bench, refused};
use anyhow::{Context, bail};
use loopback::Response;
use serde::Deserialize;
use serde_json::json;
use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Where the stages' programs are.
pub(crate) struct Programs(PathBuf);

/// An image, and the paint of the dots on it: its colour, or a place on one.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Dots {
    camera: String,
    frame: i64,
    color: Option<String>,
    at: Option<[f64; 2]>,
}

impl Programs {
    /// Programs of a folder, or of that of this one.
    ///
    /// # Errors
    /// If the system does not say where this program is.
    pub(crate) fn new(folder: Option<PathBuf>) -> anyhow::Result<Self> {
        let here = || Ok(std::env::current_exe()?.parent().context("this program is in no folder")?.to_path_buf());
        folder.map_or_else(here, Ok).map(Self)
    }

    /// Runs a stage, quietly.
    ///
    /// # Errors
    /// What it said, if it did not do its work.
    fn run<I: AsRef<OsStr>>(&self, stage: &str, words: impl IntoIterator<Item = I>) -> anyhow::Result<()> {
        let program = self.0.join(stage);
        let mut command = Command::new(&program);
        command.args(words).args(["--quiet", "--threads", "1"]).stdin(Stdio::null());
        let done = command.output().with_context(|| {
            format!("{}: cannot be run\n  to do: just build, or say --programs", program.display())
        })?;
        if !done.status.success() {
            bail!("{}", String::from_utf8_lossy(&done.stderr).trim());
        }
        Ok(())
    }

    /// The dots of an image, as the table of `marker-track detect`.
    pub(crate) fn dots(&self, bench: &Bench, asked: &Dots) -> anyhow::Result<Response> {
        let list = match bench.images() {
            Ok(images) => images.list(),
            Err(refusal) => return Ok(refusal),
        };
        let paint = match (&asked.color, asked.at) {
            (Some(color), _) => ["--color".to_string(), color.clone()],
            (None, Some([x, y])) => ["--at".to_string(), format!("{x},{y}")],
            (None, None) => bail!("click on a dot first, or say its colour"),
        };
        let scratch = tempfile::tempdir()?;
        let [table, picture] = ["dots.csv", "dots.png"].map(|name| scratch.path().join(name));
        let mut words: Vec<std::ffi::OsString> = vec!["detect".into(), "--frames".into(), list.into()];
        words.extend(["--sync".into(), list.with_file_name("sync.jsonl").into()]);
        words.extend(["--camera".into(), (&asked.camera).into()]);
        words.extend(["--frame".into(), asked.frame.to_string().into()]);
        words.extend(paint.map(Into::into));
        words.extend(["--out".into(), picture.into(), "--csv".into(), (&table).into()]);
        match self.run("marker-track", words) {
            Ok(()) => Ok(Response::json(&json!({ "table": artifact::read_text(&table)? }))),
            Err(error) => Ok(refused(&error)),
        }
    }
}
