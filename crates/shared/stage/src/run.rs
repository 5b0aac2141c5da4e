//! One run of a stage: what it read, how it was told to work, what came out.

use crate::{Common, Progress};
use anyhow::bail;
use artifact::provenance::{self, Provenance};
use artifact::{FileRef, Staged};
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::collections::HashSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A run in progress: the record that ends up in the side-cars and in the summary.
pub struct Run {
    common: Common,
    record: Provenance,
    warnings: Vec<String>,
    seconds: Map<String, Value>,
    outputs: Vec<String>,
    /// Where the inputs are, so that no output is written over one.
    input_paths: Vec<PathBuf>,
    summary_to_stderr: bool,
    objection: Option<String>,
}

impl Run {
    pub(crate) fn new(name: &str, version: &str, common: Common) -> Self {
        let record = Provenance {
            stage: name.to_string(),
            version: version.to_string(),
            parameters: json!({}),
            inputs: Map::new(),
            results: Map::new(),
        };
        let (warnings, seconds, outputs, input_paths) = Default::default();
        let (summary_to_stderr, objection) = Default::default();
        Self { common, record, warnings, seconds, outputs, input_paths, summary_to_stderr, objection }
    }

    /// The stage's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.record.stage
    }

    /// Adds the subcommand to the stage's name in side-cars.
    pub fn subcommand(&mut self, name: &str) {
        self.record.stage = format!("{} {name}", self.record.stage);
    }

    /// Records all parameters, defaults included.
    ///
    /// # Errors
    /// If they cannot be written as JSON.
    pub fn parameters(&mut self, parameters: &impl Serialize) -> anyhow::Result<()> {
        self.record.parameters = serde_json::to_value(parameters)?;
        Ok(())
    }

    /// Records an input file by name and hash. Standard input has no hash.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn input(&mut self, role: &str, path: &Path) -> anyhow::Result<FileRef> {
        let sha256 = match artifact::is_standard_stream(path) {
            true => String::new(),
            false => artifact::sha256(path)?,
        };
        let file = FileRef { name: artifact::file_name(path), sha256 };
        self.record.add_input(role, &file);
        self.input_paths.push(path.to_path_buf());
        Ok(file)
    }

    /// Records a residual, a count, a finding. It stands in the side-cars and in the summary.
    pub fn result(&mut self, key: &str, value: impl Serialize) {
        self.record.results.insert(key.to_string(), serde_json::to_value(value).unwrap_or(Value::Null));
    }

    /// Warns the user; the run goes on, and the summary repeats it.
    pub fn warn(&mut self, message: impl Into<String>) {
        let message = message.into();
        self.print(&format!("{}: warning: {message}", self.name()));
        self.warnings.push(message);
    }

    /// Tells the user something, unless `--quiet`.
    pub fn say(&self, message: &str) {
        self.print(message);
    }

    /// Prints a line of a report that is what the user asked for: to standard output, where it can be kept, or, where JSON is
    /// wanted there, among the messages.
    ///
    /// # Errors
    /// If standard output cannot be written.
    pub fn report(&self, line: &str) -> anyhow::Result<()> {
        match self.common.json {
            true => self.print(line),
            false => writeln!(std::io::stdout(), "{line}")?,
        }
        Ok(())
    }

    /// Tells the user something only with `--verbose`.
    pub fn detail(&self, message: &str) {
        if self.common.verbose {
            self.print(message);
        }
    }

    fn print(&self, message: &str) {
        if !self.common.quiet {
            // A closed standard error must not stop the work.
            let _ = writeln!(std::io::stderr(), "{message}");
        }
    }

    /// Does a part of the work and notes how long it took; for the summary only, never for an artifact.
    #[allow(clippy::disallowed_methods, reason = "this is the only room with a clock")]
    pub fn timed<T>(&mut self, part: &str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let outcome = work();
        let before = self.seconds.get(part).and_then(Value::as_f64).unwrap_or(0.0);
        self.seconds.insert(part.to_string(), json!(before + start.elapsed().as_secs_f64()));
        outcome
    }

    /// A progress report over `total` steps, if the total is known.
    #[must_use]
    pub fn progress(&self, what: &str, total: Option<u64>) -> Progress {
        Progress::start(what, total, self.common.quiet)
    }

    /// Shows outputs under their names, each followed by its side-car. Nothing shows before everything is written, and
    /// nothing is written over an input or over another output.
    ///
    /// # Errors
    /// If an output's name is taken, a side-car cannot be written or a file not renamed.
    pub fn publish(&mut self, outputs: Vec<Staged>) -> anyhow::Result<()> {
        let named = outputs.iter().filter(|output| output.temporary().is_some());
        self.check_outputs(&named.map(Staged::path).collect::<Vec<_>>())?;
        let side_car = |output: Staged| {
            let side_car = output.temporary().map(|_| provenance::write(output.path(), &self.record));
            Ok((output, side_car.transpose()?))
        };
        let staged: Vec<(Staged, Option<Staged>)> =
            outputs.into_iter().map(side_car).collect::<artifact::Result<_>>()?;
        for (output, side_car) in staged {
            self.summary_to_stderr |= output.temporary().is_none();
            self.outputs.push(output.path().display().to_string());
            output.publish()?;
            side_car.map_or(Ok(()), Staged::publish)?;
        }
        Ok(())
    }

    /// Refuses names of outputs that would take the place of an input or of each other. [`Run::publish`] asks by itself;
    /// a stage that works for long asks before it starts.
    ///
    /// # Errors
    /// Names the output.
    pub fn check_outputs(&self, paths: &[&Path]) -> anyhow::Result<()> {
        let paths = paths.iter().copied().filter(|path| !artifact::is_standard_stream(path));
        let inputs: Vec<PathBuf> = self.input_paths.iter().map(|input| place(input)).collect();
        let mut taken = HashSet::new();
        for path in paths {
            let place = place(path);
            if inputs.contains(&place) {
                bail!(
                    "{}: would be written over an input\n  to do: give the output another name",
                    path.display()
                );
            }
            if !taken.insert(place) {
                bail!("{}: is the name of two outputs\n  to do: name two files", path.display());
            }
        }
        Ok(())
    }

    /// Refuses outputs in folders that are far from there: one new folder is made for an output, but not two within each other,
    /// nor one at the root of the disk; such paths are mistyped, and nobody would look there.
    ///
    /// # Errors
    /// Names the folder.
    pub fn check_folders(&self, paths: &[&Path]) -> anyhow::Result<()> {
        match paths.iter().find_map(|path| Some((path, far_folder(path)?))) {
            Some((path, folder)) => bail!(
                "{}: there is no folder {}\n  to do: correct the name, or make the folder",
                path.display(),
                folder.display()
            ),
            None => Ok(()),
        }
    }

    /// Objects to what was found: the work is done and its summary is printed, but the run ends with `why` and exit
    /// code 1. For tools that compare and check.
    pub fn object(&mut self, why: impl Into<String>) {
        self.objection = Some(why.into());
    }

    /// Lets the user's Ctrl-C end the work through `end`, for work that goes on until then; a second one ends the process.
    pub fn until_interrupted(&self, end: impl FnOnce() + Send + 'static) {
        crate::shell::end_with(end);
    }

    /// Whether the summary is asked for as JSON on standard output, so that nothing else may stand there.
    #[must_use]
    pub fn is_json(&self) -> bool {
        self.common.json
    }

    /// Prints the summary, and ends with the objection if there is one.
    pub(crate) fn conclude(&self) -> anyhow::Result<()> {
        self.finish()?;
        self.objection.clone().map_or(Ok(()), |why| Err(anyhow::anyhow!(why)))
    }

    /// Prints the summary.
    fn finish(&self) -> anyhow::Result<()> {
        if self.common.json {
            let summary = serde_json::to_string(&json!({
                "stage": self.record.stage,
                "version": self.record.version,
                "parameters": self.record.parameters,
                "inputs": self.record.inputs,
                "results": self.record.results,
                "warnings": self.warnings,
                "seconds": self.seconds,
                "outputs": self.outputs,
            }))?;
            match self.summary_to_stderr {
                true => writeln!(std::io::stderr(), "{summary}")?,
                false => writeln!(std::io::stdout(), "{summary}")?,
            }
            return Ok(());
        }
        for (key, value) in
            self.record.results.iter().filter(|(_, value)| !value.is_object() && !value.is_array())
        {
            self.print(&format!("  {}: {}", key.replace('_', " "), shown(value)));
        }
        let shown = if self.outputs.len() > MANY { &self.outputs[..1] } else { &self.outputs };
        shown.iter().for_each(|output| self.print(&format!("  → {output}")));
        if shown.len() < self.outputs.len() {
            self.print(&format!("  → and {} more", self.outputs.len() - shown.len()));
        }
        Ok(())
    }
}

/// More outputs are counted, not listed.
const MANY: usize = 12;

/// Where a path leads, also where the file is still to be made: two paths of one file lead to the same place.
fn place(path: &Path) -> PathBuf {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside = || Some(folder.canonicalize().ok()?.join(path.file_name()?));
    path.canonicalize().ok().or_else(beside).unwrap_or_else(|| path.to_path_buf())
}

/// The folder of an output, if it is not there and is not one to be made.
fn far_folder(path: &Path) -> Option<&Path> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir())?;
    let above = folder.parent()?;
    let is_near = above.as_os_str().is_empty() || (above.is_dir() && above.parent().is_some());
    (!is_near || folder.exists()).then_some(folder)
}

/// Numbers for people: four significant digits.
fn shown(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => {
            let number = number.as_f64().unwrap_or(0.0);
            match number.abs() {
                0.0 => "0".to_string(),
                1e-3..1e5 => format!("{number:.4}"),
                _ => format!("{number:.3e}"),
            }
        }
        other => other.to_string(),
    }
}
