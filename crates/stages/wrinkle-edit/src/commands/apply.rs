//! `wrinkle-edit apply`.

use super::frames::{Moments, head};
use anyhow::{Context, bail};
use artifact::{
    FrameReader, FrameWriter, Sections, SectionsFrame, SectionsHeader, Staged, Wrinkles2d, Wrinkles2dFrame,
    Wrinkles2dHeader, is_standard_stream,
};
use serde::Serialize;
use stage::Run;
use std::path::{Path, PathBuf};
use wrinkle_edit::{Editor, Edits, Error, Head, Moment, Params, VERSION};

/// Replays a list of edits on sections, and on the curves they were measured on
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("what").multiple(true).required(true))]
pub(crate) struct Arguments {
    /// Sections to edit (sections; - for standard input)
    #[arg(long, value_name = "FILE")]
    sections: PathBuf,
    /// Their curves (wrinkles-2d): edits that add, remove or rename wrinkles change them too
    #[arg(long, value_name = "FILE", requires = "out_wrinkles")]
    wrinkles: Option<PathBuf>,
    /// List of edits (text, one per line; - for standard input)
    #[arg(long, value_name = "FILE", group = "what")]
    edits: Option<PathBuf>,
    /// Multiply all depths, after the list: the same as its line `scale depth FACTOR`
    #[arg(long, value_name = "FACTOR", group = "what", allow_negative_numbers = true)]
    scale_depth: Option<f64>,
    /// Multiply all widths, after the list: the same as its line `scale width FACTOR`
    #[arg(long, value_name = "FACTOR", group = "what", allow_negative_numbers = true)]
    scale_width: Option<f64>,
    /// Distance of the sections of a drawn wrinkle, px
    #[arg(long, value_name = "PX", default_value_t = Params::default().step_px)]
    step_px: f64,
    /// Sections to write (sections; - for standard output)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Curves to write (wrinkles-2d; - for standard output)
    #[arg(long, value_name = "FILE", requires = "wrinkles")]
    out_wrinkles: Option<PathBuf>,
}

/// What the side-car says of how it was made.
#[derive(Serialize)]
struct Parameters<'a> {
    step_px: f64,
    edits: &'a [String],
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("apply");
    arguments.check_streams()?;
    let params = Params { step_px: arguments.step_px };
    params.check()?;
    let sections = FrameReader::<Sections>::open(&arguments.sections)?;
    run.input("sections", &arguments.sections)?;
    let wrinkles = arguments.wrinkles.as_deref().map(FrameReader::<Wrinkles2d>::open).transpose()?;
    if let Some(path) = &arguments.wrinkles {
        run.input("wrinkles", path)?;
    }
    let head = head(&sections, wrinkles.as_ref())?;
    let edits = arguments.edits(run, &head)?;
    run.parameters(&Parameters { step_px: params.step_px, edits: edits.lines() })?;
    let outputs: Vec<&Path> =
        [Some(arguments.out.as_path()), arguments.out_wrinkles.as_deref()].into_iter().flatten().collect();
    run.check_outputs(&outputs)?;
    run.check_folders(&outputs)?;
    let headers = (sections.header().clone(), wrinkles.as_ref().map(|reader| reader.header().clone()));
    let moments = Moments::new(sections, wrinkles);
    if edits.count() == 0 && !arguments.reads_stream() {
        let staged = unchanged(run, arguments, moments)?;
        return run.publish(staged);
    }
    let writers = Writers::create(arguments, headers, &edits.edited(&head))?;
    let staged = replay(run, arguments, &edits, &params, moments, writers)?;
    run.publish(staged)
}

impl Arguments {
    fn check_streams(&self) -> anyhow::Result<()> {
        let given = |paths: &[Option<&PathBuf>]| {
            paths.iter().flatten().filter(|path| is_standard_stream(path)).count() > 1
        };
        if given(&[Some(&self.sections), self.wrinkles.as_ref(), self.edits.as_ref()]) {
            bail!("standard input (-) cannot be two inputs\n  to do: name files for all but one");
        }
        if given(&[Some(&self.out), self.out_wrinkles.as_ref()]) {
            bail!("standard output (-) cannot be two outputs\n  to do: name a file for one");
        }
        Ok(())
    }

    fn reads_stream(&self) -> bool {
        [Some(&self.sections), self.wrinkles.as_ref()]
            .into_iter()
            .flatten()
            .any(|path| is_standard_stream(path))
    }

    fn edits(&self, run: &mut Run, head: &Head) -> anyhow::Result<Edits> {
        let mut text = match &self.edits {
            Some(path) => {
                let text = artifact::read_text(path)?;
                run.input("edits", path)?;
                text
            }
            None => String::new(),
        };
        // The list itself is checked before anything is added to it.
        let file = self.edits.as_deref().unwrap_or(Path::new("--scale-depth, --scale-width"));
        let mut edits = Edits::parse(&text, head).with_context(|| file.display().to_string())?;
        for (option, what, factor) in
            [("--scale-depth", "depth", self.scale_depth), ("--scale-width", "width", self.scale_width)]
        {
            let Some(factor) = factor else { continue };
            if edits.count() == 0 {
                text = VERSION.to_string();
            }
            text.push_str(&format!("\nscale {what} {factor}"));
            edits = Edits::parse(&text, head).map_err(|error| match error {
                Error::Edit { what, .. } => anyhow::anyhow!("{option}: {what}"),
                other => other.into(),
            })?;
        }
        Ok(edits)
    }
}

/// The files that are being written.
struct Writers {
    sections: FrameWriter<Sections>,
    wrinkles: Option<FrameWriter<Wrinkles2d>>,
}

impl Writers {
    fn create(
        arguments: &Arguments,
        (sections, wrinkles): (SectionsHeader, Option<Wrinkles2dHeader>),
        edited: &Head,
    ) -> anyhow::Result<Self> {
        let known = edited.wrinkles.clone();
        let sections =
            FrameWriter::create(&arguments.out, SectionsHeader { wrinkles: known.clone(), ..sections })?;
        let wrinkles = match (wrinkles, &arguments.out_wrinkles) {
            (Some(header), Some(path)) => {
                Some(FrameWriter::create(path, Wrinkles2dHeader { wrinkles: known, ..header })?)
            }
            _ => None,
        };
        Ok(Self { sections, wrinkles })
    }

    fn write(&mut self, moment: Moment) -> artifact::Result<()> {
        let Moment { frame, sections, curves } = moment;
        if let Some(sections) = sections {
            self.sections.write(&SectionsFrame { frame, sections })?;
        }
        if let (Some(writer), Some(curves)) = (&mut self.wrinkles, curves) {
            writer.write(&Wrinkles2dFrame { frame, curves })?;
        }
        Ok(())
    }

    fn finish(self) -> artifact::Result<Vec<Staged>> {
        let wrinkles = self.wrinkles.map(FrameWriter::finish).transpose()?;
        Ok([Some(self.sections.finish()?), wrinkles].into_iter().flatten().collect())
    }
}

/// Edits frame by frame; those between which something is carried, together.
fn replay(
    run: &mut Run,
    arguments: &Arguments,
    edits: &Edits,
    params: &Params,
    moments: Moments,
    mut writers: Writers,
) -> anyhow::Result<Vec<Staged>> {
    let file = arguments.edits.as_deref().unwrap_or(Path::new("edits")).display().to_string();
    let mut editor = Editor::new(edits, params)?;
    let linked = edits.linked();
    let mut progress = run.progress("editing", None);
    let (mut count, mut together) = (0usize, Vec::new());
    let mut flush = |together: &mut Vec<Moment>, editor: &mut Editor| -> anyhow::Result<()> {
        editor.apply(together).with_context(|| file.clone())?;
        together.drain(..).try_for_each(|moment| Ok(writers.write(moment)?))
    };
    for moment in moments {
        let moment = moment?;
        let is_linked = linked.is_some_and(|range| range.contains(moment.frame));
        if !is_linked {
            flush(&mut together, &mut editor)?;
        }
        together.push(moment);
        if !is_linked {
            flush(&mut together, &mut editor)?;
        }
        count += 1;
        progress.step();
    }
    flush(&mut together, &mut editor)?;
    drop(progress);
    let warnings = editor.finish().with_context(|| file.clone())?;
    warnings.into_iter().for_each(|warning| run.warn(format!("{file}, {warning}")));
    run.result("frames", count);
    run.result("edits", edits.count());
    run.result("changed_wrinkles", editor.changed());
    Ok(writers.finish()?)
}

/// Without an edit, files keep their bytes, however they were written; they are read all the same.
fn unchanged(run: &mut Run, arguments: &Arguments, moments: Moments) -> anyhow::Result<Vec<Staged>> {
    let mut count = 0usize;
    for moment in moments {
        moment?;
        count += 1;
    }
    run.result("frames", count);
    run.result("edits", 0);
    run.result("changed_wrinkles", 0);
    let files = [
        (Some(&arguments.sections), Some(&arguments.out)),
        (arguments.wrinkles.as_ref(), arguments.out_wrinkles.as_ref()),
    ];
    let files = files.into_iter().filter_map(|(from, to)| Some((from?, to?)));
    files.map(|(from, to)| Ok(artifact::stage_bytes(to, &artifact::read_bytes(from)?)?)).collect()
}
