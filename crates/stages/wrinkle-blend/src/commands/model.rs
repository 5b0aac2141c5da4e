//! The character.

use anyhow::Context;
use artifact::FileRef;
use artifact::gltf::{Animation, Character, SkinnedMesh};
use serde::Serialize;
use stage::Run;
use std::path::{Path, PathBuf};
use wrinkle_blend::{Error, Pose, Setting, rest};

#[derive(clap::Args, Serialize)]
pub(crate) struct ModelArguments {
    /// Skinned character (.glb, .gltf)
    #[arg(long, value_name = "FILE")]
    #[serde(skip)]
    pub(crate) model: PathBuf,
    /// Its mesh that wears the wrinkles [default: the one of the most vertices]
    #[arg(long, value_name = "NAME")]
    mesh: Option<String>,
    /// Bone that defines the head's space [default: the one called head, or else the root of the skin's bones]
    #[arg(long, value_name = "NAME")]
    head_bone: Option<String>,
    /// Millimetres in a unit of the character's file; glTF says metres
    #[arg(long, value_name = "MM", default_value_t = 1000.0)]
    mm_per_unit: f64,
}

/// The character, as it was read.
pub(crate) struct Model {
    pub(crate) character: Character,
    pub(crate) file: FileRef,
    pub(crate) mesh: usize,
    pub(crate) neutral: Pose,
    head_bone: Option<String>,
    pub(crate) mm_per_unit: f64,
}

impl ModelArguments {
    pub(crate) fn read(&self, run: &mut Run) -> anyhow::Result<Model> {
        anyhow::ensure!(
            self.mm_per_unit.is_finite() && self.mm_per_unit > 0.0,
            "--mm-per-unit {}: must be positive\n  to do: say how many millimetres a unit of the file has",
            self.mm_per_unit
        );
        let (character, warnings) = artifact::gltf::read(&self.model)?;
        let name = self.model.display();
        warnings.into_iter().for_each(|warning| run.warn(format!("{name}, {warning}")));
        let file = run.input("model", &self.model)?;
        let mesh = chosen(&character.meshes, self.mesh.as_deref()).with_context(|| name.to_string())?;
        if self.mesh.is_none() && character.meshes.len() > 1 {
            run.detail(&format!("  mesh: {} (of {})", character.meshes[mesh].name, character.meshes.len()));
        }
        let neutral = rest(&character.nodes);
        self.check_size(run, &character.meshes[mesh]);
        let head_bone = self.head_bone.clone();
        Ok(Model { character, file, mesh, neutral, head_bone, mm_per_unit: self.mm_per_unit })
    }

    /// Heads of giants and dwarfs are other units.
    fn check_size(&self, run: &mut Run, mesh: &SkinnedMesh) {
        let (low, high) = mesh::bounding_box(&mesh.positions);
        let height = (high - low).max() * self.mm_per_unit;
        if !(PLAUSIBLE_MM[0]..=PLAUSIBLE_MM[1]).contains(&height) {
            run.warn(format!(
                "{}, mesh {}: is {:.3} m large; if its unit is not the metre, say so with --mm-per-unit",
                self.model.display(),
                mesh.name,
                height / 1000.0
            ));
        }
    }
}

/// From a face to a tall person.
const PLAUSIBLE_MM: [f64; 2] = [80.0, 2400.0];

impl Model {
    pub(crate) fn mesh(&self) -> &SkinnedMesh {
        &self.character.meshes[self.mesh]
    }

    pub(crate) fn setting(&self) -> Setting<'_> {
        Setting {
            character: &self.character,
            mesh: self.mesh,
            head_bone: self.head_bone.as_deref(),
            mm_per_unit: self.mm_per_unit,
            neutral: &self.neutral,
        }
    }
}

fn chosen(meshes: &[SkinnedMesh], name: Option<&str>) -> Result<usize, Error> {
    let found = match name {
        Some(name) => meshes.iter().position(|mesh| mesh.name == name),
        None => (0..meshes.len()).rev().max_by_key(|&mesh| meshes[mesh].positions.len()),
    };
    found.ok_or_else(|| Error::UnknownMesh {
        name: name.unwrap_or_default().to_string(),
        known: meshes.iter().map(|mesh| mesh.name.as_str()).collect::<Vec<_>>().join(", "),
    })
}

/// The animation of a name, or the only one.
pub(crate) fn animation<'a>(
    path: &Path,
    character: &'a Character,
    name: Option<&str>,
) -> anyhow::Result<&'a Animation> {
    let list = &character.animations;
    let found = match name {
        Some(name) => list.iter().find(|animation| animation.name == name),
        None => list.first().filter(|_| list.len() == 1),
    };
    let known: Vec<&str> = list.iter().map(|animation| animation.name.as_str()).collect();
    let known =
        if known.is_empty() { "it has none".to_string() } else { format!("it has {}", known.join(", ")) };
    found.with_context(|| match name {
        Some(name) => {
            format!("{}: has no animation '{name}'\n  to do: correct the name; {known}", path.display())
        }
        None => format!("{}: which animation is not clear\n  to do: name it; {known}", path.display()),
    })
}
