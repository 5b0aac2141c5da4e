//! The stages that pages ask, as programs.

use super::{Bench, refused};
use anyhow::{Context, bail};
use artifact::Warp;
use loopback::Response;
use serde::Deserialize;
use serde_json::{Value, json};
use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use workbench::{Document, HEAD, Place, SCAN};

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

/// An image whose paint is marked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Marked {
    camera: String,
    frame: i64,
}

/// Picks that are not saved yet.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Picks {
    picks: String,
}

impl Programs {
    /// Programs of a folder, or of that of this one.
    ///
    /// # Errors
    /// If the system does not say where this program is.
    pub(crate) fn new(folder: Option<PathBuf>) -> anyhow::Result<Self> {
        let here =
            || Ok(std::env::current_exe()?.parent().context("this program is in no folder")?.to_path_buf());
        folder.map_or_else(here, Ok).map(Self)
    }

    /// Runs a stage, quietly; its summary.
    ///
    /// # Errors
    /// What it said, if it did not do its work.
    fn run<I: AsRef<OsStr>>(&self, stage: &str, words: impl IntoIterator<Item = I>) -> anyhow::Result<Value> {
        let program = self.0.join(stage);
        let mut command = Command::new(&program);
        command.args(words).args(["--quiet", "--json", "--threads", "1"]).stdin(Stdio::null());
        let done = command.output().with_context(|| {
            format!("{}: cannot be run\n  to do: just build, or say --programs", program.display())
        })?;
        if !done.status.success() {
            bail!("{}", String::from_utf8_lossy(&done.stderr).trim());
        }
        Ok(serde_json::from_slice(&done.stdout).unwrap_or(Value::Null))
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
            Ok(_) => Ok(Response::json(&json!({ "table": artifact::read_text(&table)? }))),
            Err(error) => Ok(refused(&error)),
        }
    }

    /// What the warp makes of picks: leave-one-out errors; or what lacks for it.
    pub(crate) fn warp(&self, bench: &Bench, asked: &Picks) -> anyhow::Result<Response> {
        let lacks = |what: &str| Ok(Response::json(&json!({ "lacks": what })));
        let Some(markers) = bench.find(HEAD) else {
            return lacks(
                "There are no markers in 3D yet: just take TAKE makes them of the labels; then the warp is shown here.",
            );
        };
        let (Some(scan), Some(take)) = (bench.find(SCAN), bench.find(&[(Place::Take, "take.json")])) else {
            return lacks("The scan or the take's manifest is not there.");
        };
        let scratch = tempfile::tempdir()?;
        let [picks, pairs, warp] =
            ["picks.csv", "pairs.json", "warp.json"].map(|name| scratch.path().join(name));
        artifact::stage_bytes(&picks, asked.picks.as_bytes())?.publish()?;
        let scan = [OsStr::new("--mesh"), scan.as_os_str(), OsStr::new("--take"), take.as_os_str()];
        let correspond = [OsStr::new("--picks"), picks.as_os_str(), OsStr::new("--out"), pairs.as_os_str()];
        let fit =
            [OsStr::new("--markers"), markers.as_os_str(), OsStr::new("--correspondence"), pairs.as_os_str()];
        let done = self
            .run("rbf-warp", [OsStr::new("correspond")].into_iter().chain(scan).chain(correspond))
            .and_then(|_| {
                let out = [OsStr::new("--out"), warp.as_os_str()];
                self.run("rbf-warp", [OsStr::new("fit")].into_iter().chain(scan).chain(fit).chain(out))
            });
        match done {
            Ok(_) => Ok(Response::json(&json!({ "fit": artifact::read_document::<Warp>(&warp)?.fit }))),
            Err(error) => lacks(&format!("{error:#}")),
        }
    }

    /// What a classifier learns from all masks as they are now, and what it takes for paint in one image: its mask, and its scores.
    pub(crate) fn learn(&self, bench: &Bench, asked: &Marked) -> anyhow::Result<(Vec<u8>, Value)> {
        let images = bench.images().map_err(|_| anyhow::anyhow!("there are no images by frame yet"))?;
        let scratch = tempfile::tempdir()?;
        let [masks, model, found] = ["masks", "model.json", "found"].map(|name| scratch.path().join(name));
        for camera in images.ids() {
            if let Some(bytes) = bench.documents.latest(&Document::Paint(camera.clone()))? {
                artifact::stage_bytes(&masks.join(format!("{camera}.png")), &bytes)?.publish()?;
            }
        }
        let sync = images.list().with_file_name("sync.jsonl");
        let source =
            [OsStr::new("--frames"), images.list().as_os_str(), OsStr::new("--sync"), sync.as_os_str()];
        let frame = asked.frame.to_string();
        let train = [OsStr::new("--masks"), masks.as_os_str(), OsStr::new("--out"), model.as_os_str()];
        // Where another image than the first is marked, the stages are told so.
        let of = match images.first(&asked.camera) == Some(asked.frame) {
            true => Vec::new(),
            false => vec![OsStr::new("--mask-frame"), OsStr::new(&frame)],
        };
        let learnt = self
            .run("wrinkle-track", [OsStr::new("train")].into_iter().chain(source).chain(train).chain(of))?;
        let range = format!("{frame}-{frame}");
        let apply = ["--camera", &asked.camera, "--range", &range].map(OsStr::new);
        let to = [OsStr::new("--model"), model.as_os_str(), OsStr::new("--out"), found.as_os_str()];
        self.run("wrinkle-track", [OsStr::new("apply")].into_iter().chain(source).chain(apply).chain(to))?;
        let folder = found.join(&asked.camera);
        let mask = artifact::files(&folder)?.into_iter().find(|name| name.ends_with(".png"));
        let mask = folder.join(mask.context("nothing of the image was taken for paint")?);
        Ok((artifact::read_bytes(&mask)?, learnt["results"].clone()))
    }
}
