//! `wrinkle-blend maps`.

use super::map_files::MapArguments;
use super::model::{Model, ModelArguments};
use anyhow::{Context, bail};
use artifact::picture::{write_rgb8, write_rgb16};
use artifact::{BlendWeights, BlendWeightsHeader, FrameRange, FrameReader, Staged};
use serde_json::json;
use stage::Run;
use std::path::{Path, PathBuf};
use wrinkle_blend::{Atlas, Blended, MapBlender};

/// Blends wrinkle maps by weights into one normal map per frame: what a shader shows, as pictures
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// Weights of its vertices (blend-weights; - for standard input)
    #[arg(long, value_name = "FILE")]
    weights: PathBuf,
    /// Reference poses that name their maps, which lie beside them (poses)
    #[arg(long, value_name = "FILE")]
    poses: Option<PathBuf>,
    #[command(flatten)]
    maps: MapArguments,
    /// Bits per channel to write [default: as many as the neutral map has, or else the first map]
    #[arg(long, value_name = "N", value_parser = ["8", "16"])]
    bits: Option<String>,
    /// How far charts reach beyond their rim
    #[arg(long, value_name = "PX", default_value_t = 8, value_parser = clap::value_parser!(u16).range(0..=256))]
    padding: u16,
    /// Only these frames, e.g. 1001-1100
    #[arg(
        long,
        value_name = "A-B",
        default_value = "-",
        hide_default_value = true,
        allow_hyphen_values = true
    )]
    frames: FrameRange,
    /// Folder for the maps, one 000123.png per frame
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("maps");
    let model = arguments.model.read(run)?;
    let weights = FrameReader::<BlendWeights>::open(&arguments.weights)?;
    run.input("weights", &arguments.weights)?;
    let header = weights.header().clone();
    check(&arguments.weights, &header, &model)?;
    let blender = arguments.blender(run, &header)?;
    run.parameters(&json!({
        "model": arguments.model, "directx": arguments.maps.directx, "padding_px": arguments.padding,
        "frames": arguments.frames.to_string(), "bits": blender.1,
    }))?;
    let size = blender.0.size();
    let atlas = run
        .timed("lay out", || Atlas::new(model.mesh(), size, usize::from(arguments.padding)))
        .with_context(|| arguments.model.model.display().to_string())?;
    report(run, &arguments.model.model, &atlas);
    let staged = blend(run, arguments, weights, &blender.0, &atlas)?;
    run.result("frames", staged.len());
    run.result("size", size);
    run.result("texels_shared", atlas.shared);
    run.publish(staged)
}

fn blend(
    run: &mut Run,
    arguments: &Arguments,
    frames: FrameReader<BlendWeights>,
    blender: &MapBlender,
    atlas: &Atlas,
) -> anyhow::Result<Vec<Staged>> {
    let header = frames.header().clone();
    let [width, height] = blender.size();
    let (mut staged, mut progress) = (Vec::new(), run.progress("blending", None));
    let mut all = vec![0.0f32; header.poses.len() * header.vertex_count];
    for frame in frames {
        let frame = frame?;
        if !arguments.frames.contains(frame.frame) {
            continue;
        }
        let Some(vertices) = &frame.vertices else {
            bail!(
                "{}, frame {}: has no weights of vertices\n  to do: write it without --bones-only",
                arguments.weights.display(),
                frame.frame
            );
        };
        for (id, row) in header.poses.iter().zip(all.chunks_exact_mut(header.vertex_count.max(1))) {
            match vertices.get(id) {
                Some(weights) => row.copy_from_slice(weights),
                None => row.fill(0.0),
            }
        }
        let mut blended = run.timed("blend", || blender.blend(atlas, &all));
        if arguments.maps.directx {
            flip(&mut blended);
        }
        let path = arguments.out.join(format!("{:06}.png", frame.frame));
        staged.push(match &blended {
            Blended::Bits8(codes) => write_rgb8(&path, width, height, codes)?,
            Blended::Bits16(codes) => write_rgb16(&path, width, height, codes)?,
        });
        progress.step();
    }
    match staged.is_empty() {
        true => bail!("{}: holds none of the frames {}", arguments.weights.display(), arguments.frames),
        false => Ok(staged),
    }
}

fn check(path: &Path, header: &BlendWeightsHeader, model: &Model) -> anyhow::Result<()> {
    if header.model.sha256 != model.file.sha256 {
        bail!(
            "{}: was made for model {}, not for {}\n  to do: give the model that it was made for",
            path.display(),
            header.model,
            model.file
        );
    }
    let mesh = model.mesh();
    match header.mesh == mesh.name && header.vertex_count == mesh.positions.len() {
        true => Ok(()),
        false => bail!(
            "{}: was made for mesh {}\n  to do: say --mesh {}",
            path.display(),
            header.mesh,
            header.mesh
        ),
    }
}

fn report(run: &mut Run, model: &Path, atlas: &Atlas) {
    if atlas.shared > 0 {
        run.warn(format!(
            "{}: {} texels lie under more than one triangle (mirrored or overlapping texture coordinates); the first one counts there. A shader tells them apart, a map cannot",
            model.display(),
            atlas.shared
        ));
    }
    if atlas.outside > 0 {
        run.warn(format!(
            "{}: {} triangles reach out of the map and are cut off",
            model.display(),
            atlas.outside
        ));
    }
}

fn flip(blended: &mut Blended) {
    match blended {
        Blended::Bits8(codes) => {
            codes.iter_mut().skip(1).step_by(3).for_each(|green| *green = u8::MAX - *green)
        }
        Blended::Bits16(codes) => {
            codes.iter_mut().skip(1).step_by(3).for_each(|green| *green = u16::MAX - *green)
        }
    }
}

impl Arguments {
    /// The maps in the order of the weights' poses; and the bits of the output.
    fn blender(&self, run: &mut Run, header: &BlendWeightsHeader) -> anyhow::Result<(MapBlender, u8)> {
        let found = self.maps.read(run, &header.poses, self.poses.as_deref())?;
        let bits = self.bits.as_deref().and_then(|bits| bits.parse().ok()).unwrap_or(found.bits);
        Ok((MapBlender::new(found.neutral, found.maps, bits)?, bits))
    }
}
