//! What all kinds share: the truth, the result, which frames count, and errors that name files.

use super::Arguments;
use super::truth::Truth;
use anyhow::bail;
use artifact::{FrameRange, FrameReader, MeshRef, Stream, Unit};
use mesh::Mesh;
use serde::Serialize;
use stage::Run;
use std::path::Path;
use virtual_rig::score::ScoreError;

/// A comparison under way.
pub(super) struct Comparison<'a> {
    pub(super) run: &'a mut Run,
    pub(super) truth: Truth,
    pub(super) result: &'a Path,
    pub(super) against: Option<&'a Path>,
    pub(super) frames: FrameRange,
    pub(super) unit: Option<Unit>,
}

/// Header and frames of a stream.
pub(super) type Whole<S> = (<S as Stream>::Header, Vec<<S as Stream>::Frame>);

impl<'a> Comparison<'a> {
    pub(super) fn open(run: &'a mut Run, arguments: &'a Arguments) -> anyhow::Result<Self> {
        Ok(Self {
            run,
            truth: Truth::open(&arguments.truth)?,
            result: &arguments.result,
            against: arguments.against.as_deref(),
            frames: arguments.frames.unwrap_or(FrameRange::ALL),
            unit: arguments.unit,
        })
    }

    /// Whether the result's name is that of a mesh sequence's index.
    pub(super) fn result_is_sequence(&self) -> bool {
        self.result.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
    }

    /// Reads a stream of the truth; a truth without a frame to compare is refused.
    pub(super) fn true_stream<S: Stream>(&mut self, name: &str) -> anyhow::Result<Whole<S>> {
        let path = self.truth.file(name)?;
        self.run.input(&format!("truth {name}"), &path)?;
        let mut numbers = Vec::new();
        let read = self.read::<S>(&path, |number| numbers.push(number))?;
        self.check_frames(&path, &numbers)?;
        Ok(read)
    }

    /// Reads the result as a stream.
    pub(super) fn result_stream<S: Stream>(&mut self) -> anyhow::Result<Whole<S>> {
        let read = self.read::<S>(self.result, |_| ())?;
        self.run.input("result", self.result)?;
        Ok(read)
    }

    /// Keeps the frames that count; `each` hears of all.
    fn read<S: Stream>(&self, path: &Path, mut each: impl FnMut(i64)) -> anyhow::Result<Whole<S>> {
        let reader = FrameReader::<S>::open(path)?;
        let header = reader.header().clone();
        let mut frames = Vec::new();
        for frame in reader {
            let frame = frame?;
            each(S::number(&frame));
            if self.frames.contains(S::number(&frame)) {
                frames.push(frame);
            }
        }
        Ok((header, frames))
    }

    /// Refuses a truth that has none of the frames that count.
    pub(super) fn check_frames(&self, path: &Path, numbers: &[i64]) -> anyhow::Result<()> {
        if numbers.iter().any(|&number| self.frames.contains(number)) {
            return Ok(());
        }
        match (numbers.first(), numbers.last()) {
            (Some(first), Some(last)) => bail!(
                "{}: has none of the frames {}\n  to do: choose --frames from {first} to {last}",
                path.display(),
                self.frames
            ),
            _ => bail!("{}: holds no frames\n  to do: make the take again, to its end", path.display()),
        }
    }

    /// Reads the scan that the truth was made on.
    pub(super) fn scan(&mut self, reference: &MeshRef) -> anyhow::Result<Mesh> {
        let path = self.truth.scan(reference)?;
        let (mesh, found) = self.run.mesh("scan", &path, &[("the truth", Some(reference.unit))])?;
        match reference.mismatch(&found) {
            Some(mismatch) => bail!(
                "{}: is not the scan of this take: the truth {mismatch}\n  to do: make the take again; do not edit its scan",
                path.display()
            ),
            None => Ok(mesh),
        }
    }

    /// Warns of a result that cannot be known to belong to the take.
    pub(super) fn check_named(&mut self, truth: &impl Serialize, result: &impl Serialize) {
        if names_take(truth) && !names_take(result) {
            let path = self.result.display();
            self.run.warn(format!("{path}: names no take, so it is believed to be of this one"));
        }
    }

    /// Says of which files a comparison makes no sense, and what to do.
    pub(super) fn explain(&self, error: anyhow::Error) -> anyhow::Error {
        let Some(refusal) = error.downcast_ref::<ScoreError>() else { return error };
        let fix = match refusal {
            // Says it itself.
            ScoreError::OtherTake { .. } => None,
            ScoreError::UnknownId { .. } => {
                Some("score it against the truth of its own take, and name things as that take does")
            }
            ScoreError::Differs { .. } => {
                Some("check that it was made from this take, and not scaled, cut or resampled since")
            }
            ScoreError::NoCommonFrame { .. } => {
                Some("count frames by the mocap clock, as the take does, and check --frames")
            }
        };
        let fix = fix.map(|fix| format!("\n  to do: {fix}")).unwrap_or_default();
        anyhow::anyhow!("{}: {refusal}{fix}", self.result.display())
    }
}

/// Every header and document says its take, if any, under the same key.
fn names_take(header: &impl Serialize) -> bool {
    serde_json::to_value(header).is_ok_and(|header| header.get("take").is_some_and(|take| !take.is_null()))
}
