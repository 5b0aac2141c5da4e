//! `wrinkle-blend play`.

use super::map_files::{MapArguments, Maps};
use super::model::{Model, ModelArguments};
use super::options::{ParamArguments, PoseArguments, References};
use anyhow::{Context, bail};
use artifact::picture::{png_rgb8, read_rgb};
use loopback::{Asset, Limits, Method, Request, Response, Server, asset};
use serde_json::json;
use stage::Run;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use wrinkle_blend::player::{Mix, Scene, Wish, scene};
use wrinkle_blend::shader::{Language, text};
use wrinkle_blend::{Blender, Error, NormalMap};

/// Shows the character with its wrinkles in a browser on this machine: sliders for the poses, expressions, the file's animations
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    #[command(flatten)]
    poses: PoseArguments,
    #[command(flatten)]
    maps: MapArguments,
    /// Colour of the skin, in the texture coordinates of the maps [default: one colour]
    #[arg(long, value_name = "PNG")]
    color: Option<PathBuf>,
    /// An expression of your own: poses and how much of each; may be given again and again
    #[arg(long = "expression", value_name = "NAME=POSE:SHARE[+…]")]
    expressions: Vec<GivenMix>,
    /// Port of 127.0.0.1 to serve on [default: a free one]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Print the address, and open no browser
    #[arg(long)]
    no_open: bool,
    #[command(flatten)]
    params: ParamArguments,
}

/// An expression on the command line.
#[derive(Debug, Clone)]
struct GivenMix(Mix);

impl FromStr for GivenMix {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, parts) =
            text.split_once('=').ok_or("say NAME=POSE:SHARE, e.g. doubt=frown:0.6+brows-up:0.3")?;
        let part = |part: &str| {
            let (pose, share) = part.rsplit_once(':').unwrap_or((part, "1"));
            let share: f64 = share.trim().parse().map_err(|_| format!("'{share}' is no share"))?;
            match (0.0..=2.0).contains(&share) {
                true => Ok((pose.trim().to_string(), share)),
                false => Err(format!("{share} is no share from 0 to 2")),
            }
        };
        let parts = parts.split('+').map(part).collect::<Result<_, _>>()?;
        Ok(Self(Mix { name: name.trim().to_string(), parts }))
    }
}

/// What the page loads, by path: type and bytes.
type Files = BTreeMap<String, (&'static str, Vec<u8>)>;

/// The page, as it was built: see `web/`.
const ASSETS: [Asset; 3] = [
    Asset {
        path: "",
        content_type: "text/html; charset=utf-8",
        bytes: include_bytes!("../../web/built/index.html"),
    },
    Asset {
        path: "player.js",
        content_type: "text/javascript; charset=utf-8",
        bytes: include_bytes!("../../web/built/player.js"),
    },
    Asset {
        path: "player.css",
        content_type: "text/css; charset=utf-8",
        bytes: include_bytes!("../../web/built/player.css"),
    },
];

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("play");
    // Nobody waits for the maps to hear that a port is taken.
    let server = Server::bind(arguments.port, Limits { body: 0, ..Limits::default() })?;
    let path = &arguments.model.model;
    let model = arguments.model.read(run)?;
    let references = arguments.poses.read(run, &model, path)?;
    let params = arguments.params.params()?;
    let blender = references.blender(&model, &params, path)?;
    let mixes = arguments.mixes(blender.poses())?;
    let wish = Wish { params: &params, modulation: &references.modulation, expressions: &mixes };
    let (scene, block) = scene(model.setting(), &references.poses, &blender, wish)
        .with_context(|| path.display().to_string())?;
    let maps = arguments.maps.read(run, blender.poses(), arguments.poses.file())?;
    tell(run, &scene, &maps);
    let files = arguments.files(run, &model, &references, &blender, (&scene, block, &maps))?;
    run.parameters(&json!({ "model": arguments.model, "poses": arguments.poses, "comparison": params }))?;
    serve(run, server, arguments.no_open, files)
}

fn serve(run: &mut Run, server: Server, no_open: bool, files: Files) -> anyhow::Result<()> {
    let files: BTreeMap<String, Response> =
        files.into_iter().map(|(name, (kind, bytes))| (name, Response::bytes(kind, bytes))).collect();
    let (url, stopper) = (server.url(), server.stopper());
    run.until_interrupted(move || stopper.stop());
    run.report(&url)?;
    run.say("  the page is served to this machine until you stop this with Ctrl-C");
    if !no_open && !loopback::open_in_browser(&url) {
        run.say("  no browser could be opened: open the address yourself");
    }
    server.run(move |request: &Request| match request.method {
        Method::Get => asset(&ASSETS, &request.path)
            .or_else(|| files.get(&request.path).cloned())
            .unwrap_or_else(Response::missing),
        _ => Response::refused(405, "there is nothing to write here"),
    })?;
    Ok(())
}

/// What the user should know before looking.
fn tell(run: &mut Run, scene: &Scene, maps: &Maps) {
    if maps.bits == 16 {
        run.detail("  maps of 16 bits are drawn with 8");
    }
    for clip in scene.clips.iter().filter(|clip| clip.cut_s > 0.0) {
        run.warn(format!("animation {}: its last {:.0} s are not shown", clip.name, clip.cut_s));
    }
    let lacking: Vec<&str> =
        scene.expressions.iter().filter(|one| !one.lacks.is_empty()).map(|one| one.name.as_str()).collect();
    if !lacking.is_empty() {
        run.say(&format!(
            "  no pose of the character is named for {}: put them together with --expression NAME=POSE:SHARE",
            lacking.join(", ")
        ));
    }
}

impl Arguments {
    fn mixes(&self, poses: &[String]) -> anyhow::Result<Vec<Mix>> {
        for mix in &self.expressions {
            if let Some((id, _)) = mix.0.parts.iter().find(|(id, _)| !poses.contains(id)) {
                bail!(
                    "--expression {}: there is no pose '{id}'\n  to do: correct its name; there are {}",
                    mix.0.name,
                    poses.join(", ")
                );
            }
        }
        Ok(self.expressions.iter().map(|mix| mix.0.clone()).collect())
    }

    /// What the page loads beside itself.
    fn files(
        &self,
        run: &mut Run,
        model: &Model,
        references: &References,
        blender: &Blender,
        (scene, block, maps): (&Scene, Vec<u8>, &Maps),
    ) -> anyhow::Result<Files> {
        let mut files = BTreeMap::new();
        let mut add = |name: &str, kind, bytes| files.insert(name.to_string(), (kind, bytes));
        let size = [maps.neutral.width, maps.neutral.height];
        for (number, map) in std::iter::once(&maps.neutral).chain(&maps.maps).enumerate() {
            add(&format!("maps/{number}.png"), "image/png", png(map, &maps.neutral)?);
        }
        let color = self.color.as_deref().map(|path| color(run, path)).transpose()?;
        let names = json!({ "character": model.file.name, "mesh": model.mesh().name, "poses": references.poses.len(), "bones": blender.bones().len() });
        let about = json!({ "scene": scene, "map_size": size, "color": color.is_some(), "about": names });
        add("scene.json", "application/json", serde_json::to_vec(&about)?);
        add("scene.bin", "application/octet-stream", block);
        add("equations.glsl", "text/plain; charset=utf-8", text(Language::Glsl).into_bytes());
        if let Some(bytes) = color {
            add("color.png", "image/png", bytes);
        }
        Ok(files)
    }
}

/// A map as the page takes it: green up, no colour profile that a browser would obey.
fn png(map: &NormalMap, neutral: &NormalMap) -> anyhow::Result<Vec<u8>> {
    if [map.width, map.height] != [neutral.width, neutral.height] {
        bail!(Error::MapSize {
            map: map.name.clone(),
            width: map.width,
            height: map.height,
            neutral_width: neutral.width,
            neutral_height: neutral.height,
        });
    }
    Ok(png_rgb8(Path::new(&map.name), map.width, map.height, &map.to_8_bits())?)
}

fn color(run: &mut Run, path: &Path) -> anyhow::Result<Vec<u8>> {
    let picture = read_rgb(path)?;
    run.input("color", path)?;
    Ok(png_rgb8(path, picture.width, picture.height, &picture.to_8_bits())?)
}
