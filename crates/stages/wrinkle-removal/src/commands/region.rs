//! The region, as the user said where it is.

use super::Arguments;
use anyhow::{Context, bail};
use artifact::{FrameReader, MeshRef, Valleys, ValleysFrame, VertexSet};
use mesh::Mesh;
use stage::Run;
use std::path::Path;
use wrinkle_removal::{Detection, Mask, along_valleys, detect, listed, painted};

/// The greatest of the weights that the sources give; with `--detect`, what is found within them.
pub(crate) fn region(
    run: &mut Run,
    arguments: &Arguments,
    mesh: &Mesh,
    reference: &MeshRef,
    detection: &Detection,
) -> anyhow::Result<Vec<f64>> {
    let mut told: Option<Vec<f64>> = None;
    let mut add = |more: Vec<f64>| match &mut told {
        Some(weights) => weights.iter_mut().zip(more).for_each(|(weight, more)| *weight = weight.max(more)),
        None => told = Some(more),
    };
    if let Some(path) = &arguments.uv_mask {
        add(painted(mesh, &mask(run, path)?).with_context(|| path.display().to_string())?);
    }
    if let Some(path) = &arguments.vertices {
        let set: VertexSet = artifact::read_document(path)?;
        refuse_other(path, &set.mesh, reference)?;
        run.input("vertices", path)?;
        add(listed(mesh, &set.vertices).with_context(|| path.display().to_string())?);
    }
    if let Some(path) = &arguments.valleys {
        let frame = valleys(run, path, arguments.frame, reference)?;
        let place = || format!("{}, frame {}", path.display(), frame.frame);
        add(along_valleys(mesh, &frame, arguments.reach).with_context(place)?);
    }
    match (arguments.detect, told) {
        (true, within) => {
            let found = run.timed("detection", || detect(mesh, within.as_deref(), detection));
            found.with_context(|| arguments.scan.mesh.display().to_string())
        }
        (false, told) => told.context("no region is given"),
    }
}

/// Refuses what was made on another mesh.
fn refuse_other(path: &Path, of: &MeshRef, mesh: &MeshRef) -> anyhow::Result<()> {
    match of.mismatch(mesh) {
        Some(why) => bail!(
            "{}: {why}\n  to do: make it again on this mesh, or give the mesh it was made for",
            path.display()
        ),
        None => Ok(()),
    }
}

fn mask(run: &mut Run, path: &Path) -> anyhow::Result<Mask> {
    let picture = artifact::picture::read_gray(path)?;
    run.input("uv mask", path)?;
    Ok(Mask { width: picture.width, height: picture.height, texels: picture.pixels })
}

fn valleys(run: &mut Run, path: &Path, wanted: Option<i64>, mesh: &MeshRef) -> anyhow::Result<ValleysFrame> {
    let reader = FrameReader::<Valleys>::open(path)?;
    refuse_other(path, &reader.header().mesh, mesh)?;
    for frame in reader {
        let frame = frame?;
        if wanted.is_none_or(|wanted| wanted == frame.frame) {
            run.input("valleys", path)?;
            return Ok(frame);
        }
    }
    match wanted {
        Some(frame) => {
            bail!("{}: has no frame {frame}\n  to do: give --frame one of its frames", path.display())
        }
        None => bail!("{}: has no frame\n  to do: check the stage that wrote it", path.display()),
    }
}
