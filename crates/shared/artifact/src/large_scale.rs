//! `large-scale/1`: an animated mesh; a rest mesh and a vertex cache, tied together by name, hash and frame numbers.

use crate::quantity::Rate;
use crate::{Document, Kind, MeshRef, TakeRef, Violation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The index of a mesh sequence without wrinkles. The samples stand in a PC2 file in the same folder, in the rest
/// mesh's unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LargeScale {
    /// The rest mesh.
    pub mesh: MeshRef,
    /// File name of the vertex cache, in the same folder.
    pub cache: String,
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
