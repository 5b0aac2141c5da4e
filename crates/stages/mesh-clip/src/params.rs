//! What to cut away by numbers.

use crate::Error;
use nalgebra::Point3;
use serde::Serialize;

/// Parameters of [`crate::clip`]. The default cuts nothing.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Params {
    /// Only faces inside every one of these stay.
    pub keep_regions: Vec<Region>,
    /// Faces inside any of these go.
    pub remove_regions: Vec<Region>,
    /// Whether one vertex in what is removed is enough for a face to go; otherwise all its vertices must be.
    pub touching: bool,
    /// Faces whose centre is closer than half of this to a cut go, mm; 0 leaves a slit without width.
    pub slit_width_mm: f64,
    /// Texels darker than this (0–1) are cut away by a mask.
    pub mask_level: f64,
    /// Whether to drop faces until no edge has more than two and no vertex is a bow tie.
    pub drop_non_manifold: bool,
    /// Whether only the component of the largest area stays.
    pub keep_largest_component: bool,
}

/// A part of space, mm.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Region {
    /// A ball.
    Sphere {
        /// Its centre, mm.
        center_mm: [f64; 3],
        /// Its radius, mm.
        radius_mm: f64,
    },
    /// A box along the axes.
    Box {
        /// Its lowest corner, mm.
        low_mm: [f64; 3],
        /// Its highest corner, mm.
        high_mm: [f64; 3],
    },
    /// Where a coordinate (0: x, 1: y, 2: z) is at least a value.
    Above {
        /// The axis.
        axis: usize,
        /// The value, mm.
        value_mm: f64,
    },
    /// Where a coordinate is at most a value.
    Below {
        /// The axis.
        axis: usize,
        /// The value, mm.
        value_mm: f64,
    },
}

impl Region {
    /// Whether a point is in the region, its border included.
    #[must_use]
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        match self {
            Self::Sphere { center_mm, radius_mm } => (point - Point3::from(*center_mm)).norm() <= *radius_mm,
            Self::Box { low_mm, high_mm } => {
                (0..3).all(|axis| (low_mm[axis]..=high_mm[axis]).contains(&point[axis]))
            }
            Self::Above { axis, value_mm } => point[*axis] >= *value_mm,
            Self::Below { axis, value_mm } => point[*axis] <= *value_mm,
        }
    }

    fn is_sound(&self) -> bool {
        match self {
            Self::Sphere { center_mm, radius_mm } => {
                center_mm.iter().all(|x| x.is_finite()) && radius_mm.is_finite() && *radius_mm > 0.0
            }
            Self::Box { low_mm, high_mm } => {
                (0..3).all(|axis| low_mm[axis].is_finite() && high_mm[axis].is_finite())
                    && (0..3).all(|axis| low_mm[axis] <= high_mm[axis])
            }
            Self::Above { axis, value_mm } | Self::Below { axis, value_mm } => {
                *axis < 3 && value_mm.is_finite()
            }
        }
    }
}

impl Params {
    /// Whether the numbers make sense.
    ///
    /// # Errors
    /// [`Error::Parameter`] with what does not.
    pub fn check(&self) -> Result<(), Error> {
        if let Some(region) = self.keep_regions.iter().chain(&self.remove_regions).find(|r| !r.is_sound()) {
            return Err(Error::Parameter(format!("the region {region:?} is empty or not finite")));
        }
        if !(self.slit_width_mm.is_finite() && self.slit_width_mm >= 0.0) {
            return Err(Error::Parameter(format!("the slit width {} mm is not a width", self.slit_width_mm)));
        }
        match (0.0..=1.0).contains(&self.mask_level) {
            true => Ok(()),
            false => Err(Error::Parameter(format!("the mask level {} is not from 0 to 1", self.mask_level))),
        }
    }
}
