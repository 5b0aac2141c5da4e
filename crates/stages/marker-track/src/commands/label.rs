//! `marker-track label`.

use anyhow::{Context, bail};
use artifact::Labels;
use stage::Run;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Makes labels of the tables that `detect` wrote, once names stand in their column `marker`
///
/// Rows without a name are left out. A marker has the same name in the tables of all cameras.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Tables of one frame with the columns camera, frame, x, y and marker, one or several cameras in each (CSV)
    #[arg(required = true, value_name = "FILE")]
    tables: Vec<PathBuf>,
    /// Take manifest, which the labels will refer to
    #[arg(long, value_name = "FILE")]
    take: Option<PathBuf>,
    /// Labels to write (labels)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("label");
    let take = arguments.take.as_deref().map(|path| stage::load_take(run, path)).transpose()?;
    let mut sheet = Sheet::default();
    for path in &arguments.tables {
        sheet.read(path)?;
        run.input("table", path)?;
    }
    let Some(frame) = sheet.frame.filter(|_| !sheet.cameras.is_empty()) else {
        bail!(
            "{}: names no marker\n  to do: write names into the column marker",
            arguments.tables[0].display()
        );
    };
    for (camera, places) in &sheet.cameras {
        if let Some((take, _)) = &take
            && !take.cameras.iter().any(|known| known.id == *camera)
        {
            bail!("the take has no camera {camera}, which {} markers are named in", places.len());
        }
    }
    run.result("frame", frame);
    run.result("cameras", sheet.cameras.len());
    run.result("labels", sheet.cameras.values().map(BTreeMap::len).sum::<usize>());
    let labels = Labels { take: take.map(|(_, reference)| reference), frame, cameras: sheet.cameras };
    let written = artifact::write_document(&arguments.out, &labels)?;
    run.publish(vec![written])
}

/// What the tables say together.
#[derive(Default)]
struct Sheet {
    frame: Option<i64>,
    cameras: BTreeMap<String, BTreeMap<String, [f64; 2]>>,
}

/// The columns that count; others may stand beside them.
const COLUMNS: [&str; 5] = ["camera", "frame", "x", "y", "marker"];

impl Sheet {
    fn read(&mut self, path: &Path) -> anyhow::Result<()> {
        let bytes = artifact::read_bytes(path)?;
        let mut table = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(bytes.as_slice());
        let heads = table.headers().with_context(|| path.display().to_string())?.clone();
        let find = |name: &str| heads.iter().position(|head| head.trim_start_matches('\u{feff}') == name);
        let mut columns = [0; COLUMNS.len()];
        for (column, name) in columns.iter_mut().zip(COLUMNS) {
            *column = find(name).with_context(|| {
                format!(
                    "{}: has no column {name}\n  to do: take a table that marker-track detect wrote, and save it with commas",
                    path.display()
                )
            })?;
        }
        for row in table.records() {
            let row = row.with_context(|| path.display().to_string())?;
            let line = row.position().map_or(0, csv::Position::line);
            self.add(columns.map(|column| row.get(column).unwrap_or("")))
                .map_err(|what| anyhow::anyhow!("{}, line {line}: {what}", path.display()))?;
        }
        Ok(())
    }

    fn add(&mut self, [camera, frame, x, y, marker]: [&str; 5]) -> Result<(), String> {
        if marker.is_empty() {
            return Ok(());
        }
        let frame = frame.parse().map_err(|_| format!("'{frame}' is no frame"))?;
        let number = |text: &str| match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(format!("'{text}' is no place in px")),
        };
        let at = [number(x)?, number(y)?];
        if let Some(other) = self.frame.replace(frame).filter(|other| *other != frame) {
            return Err(format!("is of frame {frame}, rows before of frame {other}; label one frame"));
        }
        let places = self.cameras.entry(camera.to_string()).or_default();
        match places.insert(marker.to_string(), at) {
            Some([x, y]) => Err(format!("{marker} stands twice in camera {camera}, first at {x}, {y}")),
            None => Ok(()),
        }
    }
}
