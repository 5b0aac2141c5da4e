//! `virtual-rig character`.

use artifact::Staged;
use artifact::picture::write_rgb8;
use serde_json::json;
use stage::Run;
use std::path::PathBuf;
use virtual_rig::body::Body;
use virtual_rig::character::{Map, character, neutral_map, reference_names, reference_poses, wrinkle_map};

/// Make a skinned character for games: head.glb on 21 bones, its reference poses and their wrinkle maps
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Whose face; 0 is the average one
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// About so many vertices
    #[arg(long, value_name = "N", default_value_t = 6000, value_parser = clap::value_parser!(u32).range(1000..=200_000))]
    vertices: u32,
    /// Width and height of the maps
    #[arg(long, value_name = "PX", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(16..=8192))]
    map_size: u32,
    /// Folder for the files
    #[arg(long, value_name = "FOLDER")]
    out: PathBuf,
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("character");
    run.parameters(&json!({
        "seed": arguments.seed, "vertices": arguments.vertices, "map_size": arguments.map_size,
    }))?;
    let path = |name: &str| arguments.out.join(name);
    run.check_folders(&[&path("head.glb")])?;
    let body = run.timed("face", || Body::parametric(arguments.seed, arguments.vertices as usize, &[], 0.0));
    let character = run.timed("bones", || character(&body));
    let mut staged = vec![artifact::gltf::write(&path("head.glb"), &character)?];
    let mut poses = reference_poses(&character);
    let mut write = |name: &str, map: &Map| -> anyhow::Result<artifact::FileRef> {
        let path = arguments.out.join(name);
        let picture: Staged = write_rgb8(&path, map.size, map.size, &map.rgb)?;
        let sha256 = artifact::sha256(picture.temporary().unwrap_or(&path))?;
        staged.push(picture);
        Ok(artifact::FileRef { name: name.to_string(), sha256 })
    };
    let size = arguments.map_size as usize;
    for (pose, name) in poses.poses.iter_mut().zip(reference_names()) {
        let map = run.timed("maps", || wrinkle_map(arguments.seed, name, size));
        pose.map = Some(write(&format!("{name}.png"), &map)?);
    }
    write("neutral.png", &neutral_map(size))?;
    staged.push(artifact::write_document(&path("poses.json"), &poses)?);
    run.result("vertices", character.meshes[0].positions.len());
    run.result("triangles", character.meshes[0].triangles.len());
    run.result("bones", character.nodes.len());
    run.publish(staged)
}
