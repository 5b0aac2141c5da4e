//! The run: read, prepare, frame after frame, write.

use super::Arguments;
use super::findings::{Findings, report_creases};
use super::refined::Ground;
use anyhow::{Context, bail};
use artifact::{
    FrameRange, FrameReader, LargeScale, MeshRef, MeshSequence, SequenceForm, Unit, Valleys, ValleysFrame,
    ValleysHeader, Wrinkled, pc2,
};
use mesh::Mesh;
use nalgebra::Point3;
use shell_synth::{Memory, Synthesis};
use stage::Run;
use std::path::{Path, PathBuf};

/// A frame whose number is a multiple of this starts anew, so that a part of a take equals the same part of the whole.
const BLOCK: i64 = 8;

pub(crate) fn run(run: &mut Run, arguments: Arguments) -> anyhow::Result<()> {
    arguments.check()?;
    let params = arguments.params();
    params.check()?;
    run.parameters(&params)?;
    let large = Sequence::open(run, &arguments)?;
    let scan = read_mesh(run, &arguments, &large)?;
    let scan_sha = scan.1.file.sha256.clone();
    let (header, valleys, valleys_sha) = read_valleys(run, &arguments.valleys, &scan.1, &large)?;
    let outputs = arguments.outputs();
    let outputs: Vec<&Path> = outputs.iter().map(PathBuf::as_path).collect();
    run.check_outputs(&outputs)?;
    run.check_folders(&outputs)?;
    let ids: Vec<String> = header.wrinkles.iter().map(|wrinkle| wrinkle.id.clone()).collect();
    let ground = Ground::new(run, &arguments, scan, &ids, valleys, &params)?;
    let synthesis = run
        .timed("prepare", || Synthesis::new(&ground.mesh, &ids, &ground.valleys, &params))
        .with_context(|| format!("{} with {}", arguments.mesh.display(), arguments.valleys.display()))?;
    report_creases(run, &synthesis.creases());
    let inputs = [&scan_sha, &ground.mesh_ref.file.sha256, &large.sha256[0], &large.sha256[1], &valleys_sha];
    let key = artifact::sha256_of(serde_json::json!([inputs, params, large.wanted]).to_string().as_bytes());
    let (writer, there) = pc2::Writer::resumable(
        &arguments.samples(),
        ground.mesh.positions.len(),
        large.wanted[0],
        &key,
        arguments.resume,
    )?;
    if there > 0 {
        run.say(&format!("{there} frames are there already"));
    }
    let mut output = Output { writer, unit: ground.mesh_ref.unit };
    let findings = animate(run, &synthesis, &ground, &large, there as usize, &mut output)?;
    findings.report(run);
    publish(run, &arguments, large, ground, output, &findings)
}

/// The frames without wrinkles.
struct Sequence {
    index: LargeScale,
    samples: MeshSequence,
    /// Of the index and of the cache.
    sha256: [String; 2],
    /// Frames to make.
    wanted: Vec<i64>,
    /// Whether frames start from the one before.
    chained: bool,
}

impl Sequence {
    fn open(run: &mut Run, arguments: &Arguments) -> anyhow::Result<Self> {
        let path = &arguments.large_scale;
        let index: LargeScale = artifact::read_document(path)?;
        let samples = MeshSequence::open(path, arguments.unit)?;
        let cache = samples.cache().unwrap_or(path).to_path_buf();
        let sha256 = [run.input("large-scale", path)?.sha256, run.input("large-scale cache", &cache)?.sha256];
        let range = arguments.frames.unwrap_or(FrameRange::ALL);
        let wanted: Vec<i64> = index.frames.iter().copied().filter(|&frame| range.contains(frame)).collect();
        if wanted.is_empty() {
            let (first, last) = (index.frames.first(), index.frames.last());
            bail!(
                "{}: has no frame of {range}\n  to do: it has frames from {} to {}",
                path.display(),
                first.copied().unwrap_or(0),
                last.copied().unwrap_or(0)
            );
        }
        Ok(Self { index, samples, sha256, wanted, chained: arguments.params().warm_start })
    }

    /// The frame that must be made first so that one of the wanted frames comes out as in the whole take.
    fn warm_up(&self, frame: i64) -> i64 {
        let frames = &self.index.frames;
        let mut at = frames.partition_point(|&other| other < frame);
        while self.chained && at > 0 && !starts_anew(frames[at]) && frames[at - 1] == frames[at] - 1 {
            at -= 1;
        }
        frames[at]
    }
}

fn starts_anew(frame: i64) -> bool {
    frame.rem_euclid(BLOCK) == 0
}

fn read_mesh(run: &mut Run, arguments: &Arguments, large: &Sequence) -> anyhow::Result<(Mesh, MeshRef)> {
    let stated = [("--unit", arguments.unit), ("the large-scale index", Some(large.index.mesh.unit))];
    let (mesh, mesh_ref) = run.mesh("mesh", &arguments.mesh, &stated)?;
    match large.index.mesh.mismatch(&mesh_ref) {
        Some(why) => bail!(
            "{}: {why}\n  to do: give the mesh that the sequence was made for",
            arguments.large_scale.display()
        ),
        None => Ok((mesh, mesh_ref)),
    }
}

fn read_valleys(
    run: &mut Run,
    path: &Path,
    mesh: &MeshRef,
    large: &Sequence,
) -> anyhow::Result<(ValleysHeader, Vec<ValleysFrame>, String)> {
    let reader = FrameReader::<Valleys>::open(path)?;
    let header = reader.header().clone();
    let sha256 = run.input("valleys", path)?.sha256;
    if let Some(why) = header.mesh.mismatch(mesh) {
        bail!("{}: {why}\n  to do: give the mesh that the valleys were lifted to", path.display());
    }
    stage::check_take(run, path, header.take.as_ref(), large.index.take.as_ref())?;
    let frames = reader.collect::<artifact::Result<Vec<_>>>()?;
    let (first, last) = (large.index.frames[0], large.index.frames[large.index.frames.len() - 1]);
    match frames.iter().any(|frame| (first..=last).contains(&frame.frame)) {
        true => Ok((header, frames, sha256)),
        false => bail!(
            "{}: has no frame between {first} and {last}, where the large-scale sequence is\n  to do: give files of one take",
            path.display()
        ),
    }
}

/// The sequence that is being written.
struct Output {
    writer: pc2::Writer,
    unit: Unit,
}

impl Output {
    fn write(&mut self, positions: &[Point3<f64>]) -> artifact::Result<()> {
        let in_mm = self.unit.in_mm();
        let coordinates: Vec<f32> = positions
            .iter()
            .flat_map(|point| [point.x, point.y, point.z].map(|x| (x / in_mm) as f32))
            .collect();
        self.writer.write(&coordinates)
    }
}

/// Makes every frame that is not there yet.
fn animate(
    run: &mut Run,
    synthesis: &Synthesis,
    ground: &Ground,
    large: &Sequence,
    there: usize,
    output: &mut Output,
) -> anyhow::Result<Findings> {
    let mut findings = Findings::default();
    let Some(&first) = large.wanted.get(there) else { return Ok(findings) };
    let start = large.warm_up(first);
    let last = large.wanted[large.wanted.len() - 1];
    let mut cursor = large.samples.cursor()?;
    let mut progress = run.progress("frames", Some((large.wanted.len() - there) as u64));
    let mut before: Option<(i64, Memory)> = None;
    for &frame in large.index.frames.iter().filter(|frame| (start..=last).contains(*frame)) {
        let smooth = ground.carry(run.timed("read", || cursor.read(frame))?);
        let warm = before.take().filter(|(number, _)| *number == frame - 1 && !starts_anew(frame));
        let warm = warm.as_ref().map(|(_, memory)| memory);
        let name = if warm.is_some() { "synthesis-warm" } else { "synthesis" };
        let made = run
            .timed(name, || synthesis.frame(frame, &smooth, warm))
            .with_context(|| format!("{}, frame {frame}", large.samples.path().display()))?;
        if frame >= first {
            findings.add(frame, &made.regions);
            run.timed("write", || output.write(&made.positions))?;
            progress.step();
        }
        before = Some((frame, made.memory));
    }
    Ok(findings)
}

fn publish(
    run: &mut Run,
    arguments: &Arguments,
    large: Sequence,
    ground: Ground,
    output: Output,
    findings: &Findings,
) -> anyhow::Result<()> {
    let index = Wrinkled(LargeScale {
        mesh: ground.mesh_ref,
        cache: artifact::file_name(&arguments.samples()),
        form: SequenceForm::Pc2,
        rate: large.index.rate,
        frames: large.wanted,
        take: large.index.take,
    });
    let mut staged = vec![output.writer.finish()?, artifact::write_document(&arguments.out, &index)?];
    staged.extend(ground.staged);
    if let Some(path) = &arguments.report {
        staged.push(artifact::stage_bytes(path, findings.table().as_bytes())?);
    }
    run.publish(staged)
}
