//! `large-scale/1`: an animated mesh; a rest mesh and a vertex cache, tied together by name, hash and frame numbers.

use crate::quantity::Rate;
use crate::{Document, Kind, MeshRef, TakeRef, Violation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The form that the samples of a sequence have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SequenceForm {
    /// One PC2 vertex cache.
    #[default]
    Pc2,
    /// A folder with an OBJ per frame.
    Obj,
    /// A folder with a PLY per frame.
    Ply,
    /// A folder with a NumPy array of displacements, mm, per frame.
    Npy,
    /// One USD layer.
    Usda,
}

impl SequenceForm {
    #[allow(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
    fn is_pc2(&self) -> bool {
        *self == Self::Pc2
    }
}

/// The index of a mesh sequence without wrinkles. The samples stand in a file or folder beside it, in the rest mesh's
/// unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LargeScale {
    /// The rest mesh.
    pub mesh: MeshRef,
    /// Name of the file, or of the folder of per-frame files, with the samples; in the same folder as the index.
    pub cache: String,
    /// What the samples are; a PC2 cache where nothing is said.
    #[serde(default, skip_serializing_if = "SequenceForm::is_pc2")]
    pub form: SequenceForm,
    /// Frames per second; absent where the source did not say.
    pub rate: Option<Rate>,
    /// Absolute frame number of every sample, rising; gaps stay gaps.
    pub frames: Vec<i64>,
    /// The take that the motion comes from.
    pub take: Option<TakeRef>,
}

impl Kind for LargeScale {
    const NAME: &'static str = "large-scale";
    const VERSION: u32 = 1;
}

impl Document for LargeScale {
    fn check(&self) -> Result<(), Violation> {
        if self.cache.is_empty() || self.cache.contains(['/', '\\']) {
            return Err(Violation::new("cache", "must be a file name in the same folder"));
        }
        self.rate.map_or(Ok(()), |rate| rate.check("rate"))?;
        match self.frames.windows(2).find(|pair| pair[0] >= pair[1]) {
            Some(pair) => {
                let what = format!("frame {} follows frame {}; they must rise", pair[1], pair[0]);
                Err(Violation::new("frames", what))
            }
            None => Ok(()),
        }
    }
}
