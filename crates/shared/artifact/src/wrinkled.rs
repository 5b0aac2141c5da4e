//! `wrinkled/1`: an animated mesh with wrinkles; an index of the same form as `large-scale`.

use crate::{Document, Kind, LargeScale, Violation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The index of a mesh sequence with wrinkles: the form is that of [`LargeScale`], the kind another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Wrinkled(pub LargeScale);

impl Kind for Wrinkled {
    const NAME: &'static str = "wrinkled";
    const VERSION: u32 = 1;
}

impl Document for Wrinkled {
    fn check(&self) -> Result<(), Violation> {
        self.0.check()
    }
}
