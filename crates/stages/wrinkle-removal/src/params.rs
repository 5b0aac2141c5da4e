//! Scales and switches.

use crate::Error;
use serde::Serialize;

/// How fine detail is told from wrinkles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Split {
    /// An implicit step of Laplacian smoothing, as in the paper: a soft split, that takes broad parts of creases for detail.
    Laplacian,
    /// Three implicit steps of bi-Laplacian smoothing: a steep one.
    Bilaplacian,
}

/// Parameters of [`remove`](crate::remove).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Params {
    /// Wavelength, mm, below which the surface's relief is fine detail, which stays: pores and the fine mesh between them.
    pub detail_mm: f64,
    /// How detail is told from wrinkles.
    pub split: Split,
    /// Fine detail is no higher or deeper than this many times its root mean square on the skin around the region: more is the edge
    /// at the bottom of a crease, which is as sharp as a pore. 0 keeps it.
    pub detail_limit: f64,
    /// Wavelength, mm, above which relief is the shape of the face, which stays: of a wide region, what is broader than this is
    /// kept from the scan, where the least bending surface would flatten it. About 20 widths of the widest wrinkle; 0 leaves
    /// all of the region to that surface.
    pub shape_mm: f64,
    /// Share of each wrinkle that is taken out, 0 to 1.
    pub strength: f64,
    /// Width of the band inside the region's rim over which the removal sets in, mm; 0: at once (the surface is
    /// tangent-continuous in any case).
    pub feather_mm: f64,
    /// Cotangents beyond this are scaled down, against needles among the triangles.
    pub cotangent_limit: f64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            detail_mm: 1.6,
            split: Split::Bilaplacian,
            detail_limit: 4.0,
            shape_mm: 25.0,
            strength: 1.0,
            feather_mm: 0.0,
            cotangent_limit: 1e4,
        }
    }
}

impl Params {
    /// The paper's three steps as they are printed [BickelBotsch2007, Sec. 5.4].
    #[must_use]
    pub fn paper() -> Self {
        Self { split: Split::Laplacian, detail_limit: 0.0, shape_mm: 0.0, ..Self::default() }
    }

    /// Whether every parameter is in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the first that is not.
    pub fn check(&self) -> Result<(), Error> {
        let (positive, not_negative) = (f64::MIN_POSITIVE..f64::INFINITY, 0.0..f64::INFINITY);
        let rows = [
            ("wavelength of detail in mm", self.detail_mm, positive.clone(), "a positive number"),
            ("limit of detail", self.detail_limit, not_negative.clone(), "a number from 0 on"),
            ("wavelength of shape in mm", self.shape_mm, not_negative.clone(), "a number from 0 on"),
            ("strength", self.strength, 0.0..1.0f64.next_up(), "from 0 to 1"),
            ("feather in mm", self.feather_mm, not_negative, "a number from 0 on"),
            ("limit of cotangents", self.cotangent_limit, positive, "a positive number"),
        ];
        match rows.into_iter().find(|(_, value, range, _)| !range.contains(value)) {
            Some((name, value, _, range)) => Err(Error::Parameter { name, value, range }),
            None => Ok(()),
        }
    }
}
