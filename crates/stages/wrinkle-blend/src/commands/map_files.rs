//! The files of wrinkle maps.

use super::poses::{GivenMap, pose_of};
use anyhow::Context;
use artifact::Poses;
use artifact::picture::{Codes, read_rgb};
use stage::Run;
use std::path::{Path, PathBuf};
use wrinkle_blend::NormalMap;

#[derive(clap::Args)]
pub(crate) struct MapArguments {
    /// Wrinkle map of a pose
    #[arg(long = "map", value_name = "ID=PNG")]
    maps: Vec<GivenMap>,
    /// Normal map of the skin without wrinkles [default: flat]
    #[arg(long, value_name = "PNG")]
    neutral: Option<PathBuf>,
    /// Green points down in all maps (Direct3D)
    #[arg(long)]
    pub(crate) directx: bool,
}

/// The maps, as they were read.
pub(crate) struct Maps {
    pub(crate) neutral: NormalMap,
    /// One per pose.
    pub(crate) maps: Vec<NormalMap>,
    /// As many as the neutral map has, or else the first map.
    pub(crate) bits: u8,
}

/// A share of the texels that are no normals, above which a picture is none.
const DOUBTFUL: f64 = 0.02;

impl MapArguments {
    /// The maps of poses: the given ones, or those that the file of the poses names.
    pub(crate) fn read(&self, run: &mut Run, ids: &[String], poses: Option<&Path>) -> anyhow::Result<Maps> {
        let paths = self.paths(run, ids, poses)?;
        let (mut maps, mut bits) = (Vec::new(), None);
        for (id, path) in ids.iter().zip(&paths) {
            let (map, own) = self.map(run, &format!("map of {id}"), path)?;
            bits = bits.or(Some(own));
            maps.push(map);
        }
        let neutral = match &self.neutral {
            Some(path) => {
                let (map, own) = self.map(run, "neutral map", path)?;
                bits = Some(own);
                map
            }
            None => NormalMap::flat("flat", maps[0].width, maps[0].height),
        };
        Ok(Maps { neutral, maps, bits: bits.unwrap_or(8) })
    }

    fn paths(&self, run: &mut Run, ids: &[String], poses: Option<&Path>) -> anyhow::Result<Vec<PathBuf>> {
        let mut paths: Vec<Option<PathBuf>> = vec![None; ids.len()];
        if let Some(path) = poses {
            let file: Poses = artifact::read_document(path)?;
            run.input("poses", path)?;
            for (at, id) in ids.iter().enumerate() {
                let named = file.poses.iter().find(|pose| pose.id == *id).and_then(|pose| pose.map.as_ref());
                let Some(map) = named else { continue };
                let beside = path.parent().unwrap_or(Path::new("")).join(&map.name);
                // A map that was given is used instead.
                let is_given = self.maps.iter().any(|given| given.id == *id);
                if !is_given && artifact::sha256(&beside)? != map.sha256 {
                    run.warn(format!("{}: has changed since {} named it", beside.display(), path.display()));
                }
                paths[at] = Some(beside);
            }
        }
        for map in &self.maps {
            paths[pose_of(map, ids.iter().cloned())?] = Some(map.path.clone());
        }
        let found = |(id, path): (&String, Option<PathBuf>)| {
            path.with_context(|| format!("pose {id}: has no map\n  to do: give it with --map {id}=PNG"))
        };
        ids.iter().zip(paths).map(found).collect()
    }

    fn map(&self, run: &mut Run, role: &str, path: &Path) -> anyhow::Result<(NormalMap, u8)> {
        let picture = read_rgb(path)?;
        run.input(role, path)?;
        let name = path.display().to_string();
        let (mut map, bits) = match &picture.codes {
            Codes::Bits8(codes) => (NormalMap::from_8_bits(&name, picture.width, picture.height, codes)?, 8),
            Codes::Bits16(codes) => {
                (NormalMap::from_16_bits(&name, picture.width, picture.height, codes)?, 16)
            }
        };
        let doubtful = map.doubtful();
        if doubtful > DOUBTFUL {
            run.warn(format!(
                "{name}: {:.0} % of its texels are no unit normals turned outwards; is it a tangent-space normal map?",
                100.0 * doubtful
            ));
        }
        if self.directx {
            map.flip_green();
        }
        Ok((map, bits))
    }
}
