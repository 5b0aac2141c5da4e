//! Animated surfaces, frame by frame.

use super::comparison::Comparison;
use anyhow::bail;
use artifact::{LargeScale, MeshSequence, TakeRef, Valleys, Wrinkled, file_name, read_document};
use nalgebra::Point3;
use stage::Progress;
use std::path::Path;
use virtual_rig::score::{self, Metric, WrinkledFrame, WrinkledScene};

/// A sequence: its index, of the frames that count only, and its samples.
struct Surface {
    index: LargeScale,
    samples: MeshSequence,
}

/// How an index is read, by its kind.
type ReadIndex = fn(&Path) -> artifact::Result<LargeScale>;

fn wrinkled_index(path: &Path) -> artifact::Result<LargeScale> {
    Ok(read_document::<Wrinkled>(path)?.0)
}

/// Of either kind; what is neither is told as if wrinkles were wanted.
fn any_index(path: &Path) -> artifact::Result<LargeScale> {
    wrinkled_index(path).or_else(|error| read_document(path).map_err(|_| error))
}

impl Comparison<'_> {
    fn true_surface(&mut self, name: &str, read: ReadIndex) -> anyhow::Result<Surface> {
        let path = self.truth.file(name)?;
        let surface = self.surface(&format!("truth {name}"), &path, read)?;
        self.check_frames(&path, surface.samples.frames())?;
        Ok(surface)
    }

    fn surface(&mut self, role: &str, path: &Path, read: ReadIndex) -> anyhow::Result<Surface> {
        let mut index = read(path)?;
        self.run.input(role, path)?;
        let samples = MeshSequence::open(path, None)?;
        if let Some(cache) = samples.cache() {
            self.run.input(&format!("{role}, {}", file_name(cache)), cache)?;
        }
        index.frames.retain(|&frame| self.frames.contains(frame));
        Ok(Surface { index, samples })
    }

    fn progress(&self, surface: &Surface) -> Progress {
        self.run.progress("comparing", Some(surface.index.frames.len() as u64))
    }
}

/// Compares a sequence without wrinkles.
pub(super) fn large_scale(comparison: &mut Comparison) -> anyhow::Result<Vec<Metric>> {
    let truth = comparison.true_surface("large-scale.json", read_document)?;
    let result = comparison.surface("result", comparison.result, read_document)?;
    comparison.check_named(&truth.index, &result.index);
    let mut progress = comparison.progress(&truth);
    score::large_scale(&truth.index, &result.index, pairs(&truth, &result, &mut progress)?)
}

/// Compares the normals of a sequence's vertices with those of the surface with wrinkles.
pub(super) fn normals(comparison: &mut Comparison) -> anyhow::Result<Vec<Metric>> {
    if comparison.against.is_some() {
        bail!(
            "--against: a sequence's normals are those of the truth's wrinkled.json\n  to do: leave --against out"
        );
    }
    let truth = comparison.true_surface("wrinkled.json", wrinkled_index)?;
    let triangles = comparison.scan(&truth.index.mesh)?.triangles();
    let result = comparison.surface("result", comparison.result, any_index)?;
    comparison.check_named(&truth.index, &result.index);
    let mut progress = comparison.progress(&truth);
    score::surface_normals(&truth.index, &result.index, &triangles, pairs(&truth, &result, &mut progress)?)
}

type Points = Vec<Point3<f64>>;

/// Reads a frame of two sequences.
fn pairs<'a>(
    truth: &'a Surface,
    result: &'a Surface,
    progress: &'a mut Progress,
) -> anyhow::Result<impl FnMut(i64) -> anyhow::Result<(Points, Points)> + use<'a>> {
    let (mut truth, mut result) = (truth.samples.cursor()?, result.samples.cursor()?);
    Ok(move |frame| {
        progress.step();
        Ok((truth.read(frame)?, result.read(frame)?))
    })
}

/// Compares a sequence with wrinkles, and where it is known the one that it was made from.
pub(super) fn wrinkled(comparison: &mut Comparison) -> anyhow::Result<Vec<Metric>> {
    let truth = comparison.true_surface("wrinkled.json", wrinkled_index)?;
    let smooth = comparison.true_surface("large-scale.json", read_document)?;
    let (header, valleys) = comparison.true_stream::<Valleys>("valleys.jsonl")?;
    let scan = comparison.scan(&truth.index.mesh)?;
    let result = comparison.surface("result", comparison.result, wrinkled_index)?;
    comparison.check_named(&truth.index, &result.index);
    let own = comparison.against.map(|path| large_scale_of(comparison, path, &result.index)).transpose()?;
    let triangles = scan.triangles();
    let scene = WrinkledScene {
        truth: &truth.index,
        result: &result.index,
        valleys: (&header, &valleys),
        rest: &scan.positions,
        triangles: &triangles,
    };
    let mut progress = comparison.progress(&truth);
    let (mut with, mut without) = (truth.samples.cursor()?, smooth.samples.cursor()?);
    let mut found = result.samples.cursor()?;
    let mut flat = own.as_ref().map(|own| own.samples.cursor()).transpose()?;
    score::wrinkled(&scene, |frame| {
        progress.step();
        Ok(WrinkledFrame {
            truth: with.read(frame)?,
            truth_large_scale: without.read(frame)?,
            result: found.read(frame)?,
            result_large_scale: flat.as_mut().map(|flat| flat.read(frame)).transpose()?,
        })
    })
}

/// The sequence that a result was made from: of its mesh and take.
fn large_scale_of(comparison: &mut Comparison, path: &Path, result: &LargeScale) -> anyhow::Result<Surface> {
    let surface = comparison.surface("large-scale of the result", path, read_document)?;
    let fix = "to do: give the large-scale sequence that the result was made from";
    if let Some(mismatch) = surface.index.mesh.mismatch(&result.mesh) {
        bail!("{}: {mismatch}\n  {fix}", path.display());
    }
    let hash = |take: &Option<TakeRef>| take.as_ref().map(|take| take.sha256.clone());
    match (hash(&surface.index.take), hash(&result.take)) {
        (Some(own), Some(taken)) if own != taken => {
            bail!("{}: is of another take than the result\n  {fix}", path.display())
        }
        _ => Ok(surface),
    }
}
