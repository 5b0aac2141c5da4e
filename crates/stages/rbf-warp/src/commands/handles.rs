//! `rbf-warp handles`: markers through the warp → displacements of the scan's vertices.

use super::MarkerStream;
use anyhow::bail;
use artifact::{FileRef, FrameRange, FrameWriter, Staged, TakeRef, Unit, Warp};
use rbf_warp::{Displacer, handles_header, mismatch};
use serde::Serialize;
use stage::Run;
use std::path::PathBuf;

/// Turn moving markers into displacements of the scan's vertices
#[derive(clap::Args)]
pub(crate) struct Handles {
    /// The warp
    #[arg(long, value_name = "FILE")]
    warp: PathBuf,
    /// Markers in head space: head-trajectories (.jsonl, - for standard input), .c3d, .trc or .csv
    #[arg(long, value_name = "FILE")]
    markers: PathBuf,
    /// Unit of the markers, where their file may not say it
    #[arg(long, value_name = "mm|cm|m")]
    marker_unit: Option<Unit>,
    /// Take manifest of the markers, where their file does not name their take
    #[arg(long, value_name = "FILE")]
    take: Option<PathBuf>,
    /// Displacements to write (handles; - for standard output)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Frames to map [all]
    #[arg(long, value_name = "A-B", allow_hyphen_values = true)]
    frames: Option<FrameRange>,
    /// Accept markers of another session than the warp's
    #[arg(long)]
    across_takes: bool,
}

#[derive(Serialize)]
struct Parameters {
    /// As the user stated it; absent where the file's own word is taken.
    marker_unit: Option<Unit>,
    frames: String,
    across_takes: bool,
}

impl Handles {
    pub(crate) fn run(self, run: &mut Run) -> anyhow::Result<()> {
        run.subcommand("handles");
        let range = self.frames.unwrap_or(FrameRange::ALL);
        run.parameters(&Parameters {
            marker_unit: self.marker_unit,
            frames: range.to_string(),
            across_takes: self.across_takes,
        })?;
        let warp: Warp = artifact::read_document(&self.warp)?;
        let warp_file = run.input("warp", &self.warp)?;
        let markers = run.input("markers", &self.markers)?;
        let given = self.take.as_deref().map(|take| stage::load_take(run, take)).transpose()?;
        let stream = MarkerStream::open(run, &self.markers, self.marker_unit)?;
        let mut header = stream.header().clone();
        header.take = super::agreed_take(&self.markers, header.take.as_ref(), given.map(|(_, take)| take))?;
        self.check_session(&warp, &markers, header.take.as_ref())?;
        let displacer = Displacer::new(&warp, &header);
        self.check_markers(run, &warp, &displacer)?;
        let writer = FrameWriter::create(&self.out, handles_header(&warp, warp_file, &header))?;
        let mapped = self.map(run, stream, &displacer, writer)?;
        run.result("frames", mapped.frames);
        run.result("handles", warp.markers.len());
        run.result("missing_samples", mapped.missing);
        run.publish(vec![mapped.staged])
    }

    fn check_session(&self, warp: &Warp, markers: &FileRef, take: Option<&TakeRef>) -> anyhow::Result<()> {
        match mismatch(warp, markers, take).filter(|_| !self.across_takes) {
            Some(mismatch) => bail!(
                "{}: {mismatch}\n  to do: fit a warp for this session; or name the take with --take; or say \
                 --across-takes if the markers were not taken off in between",
                self.warp.display()
            ),
            None => Ok(()),
        }
    }

    fn check_markers(&self, run: &mut Run, warp: &Warp, displacer: &Displacer) -> anyhow::Result<()> {
        let absent = displacer.absent(warp);
        match absent.len() {
            0 => {}
            all if all == warp.markers.len() => bail!(
                "{}: none of the warp's markers is there (the warp has {}, …)\n  to do: check the marker names",
                self.markers.display(),
                absent[0]
            ),
            _ => run.warn(format!("markers of the warp that are not in the file: {}", absent.join(", "))),
        }
        Ok(())
    }

    /// Frame by frame, in constant memory.
    fn map(
        &self,
        run: &Run,
        stream: MarkerStream,
        displacer: &Displacer,
        mut writer: FrameWriter<artifact::Handles>,
    ) -> anyhow::Result<Mapped> {
        let range = self.frames.unwrap_or(FrameRange::ALL);
        let (mut frames, mut missing) = (0, 0);
        let mut progress = run.progress("frames", None);
        for frame in stream {
            let frame = frame?;
            if frame.frame > range.last {
                break;
            }
            if range.contains(frame.frame) {
                let handles = displacer.frame(&frame);
                missing += handles.displacements.iter().filter(|displacement| displacement.is_none()).count();
                frames += 1;
                writer.write(&handles)?;
                progress.step();
            }
        }
        if frames == 0 {
            bail!("{}: has no frame in {range}\n  to do: check --frames", self.markers.display());
        }
        Ok(Mapped { frames, missing, staged: writer.finish()? })
    }
}

struct Mapped {
    frames: usize,
    missing: usize,
    staged: Staged,
}
