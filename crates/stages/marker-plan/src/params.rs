//! How many markers, and how dense where.

use crate::Error;
use serde::{Deserialize, Serialize};

/// Parameters of [`plan`](crate::plan).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Params {
    /// Markers in all.
    pub count: usize,
    /// Of them on the lips' edge: 0, 2 (corners), 4 (and middles) or 8 (and quarter points).
    pub lip_points: usize,
    /// Of them at the lids' edges: 0, 4 (middles) or 8 (and quarter points of the upper lids).
    pub lid_points: usize,
    /// How many times denser (in length) markers stand near the lips than on the cheeks; no unit.
    pub lip_density: f64,
    /// The same near the lids.
    pub lid_density: f64,
    /// The same at the throat, the angle of the jaw and before the ears, where skin moves little but with the rest.
    pub outskirt_density: f64,
    /// Distance from lips and lids over which the density falls off, mm.
    pub falloff_mm: f64,
    /// Least distance between two markers, mm: closer dots merge in the images.
    pub least_distance_mm: f64,
    /// Least distance from where the scan ends, mm.
    pub border_mm: f64,
    /// Largest distance between a marker's mirror image and its partner, mm; where the face is less symmetric, the
    /// marker stands alone.
    pub asymmetry_mm: f64,
    /// Boundary loops shorter than this, mm, are holes of the scan, not mouth or eyes.
    pub smallest_opening_mm: f64,
    /// Any vertex of the mouth's rim, where it is not to be found by itself.
    pub mouth: Option<u32>,
    /// Any vertex of each eye's rim, likewise.
    pub eyes: Option<[u32; 2]>,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            count: 90,
            lip_points: 8,
            lid_points: 4,
            lip_density: 2.0,
            lid_density: 1.8,
            outskirt_density: 0.85,
            falloff_mm: 18.0,
            least_distance_mm: 5.0,
            border_mm: 6.0,
            asymmetry_mm: 4.0,
            smallest_opening_mm: 40.0,
            mouth: None,
            eyes: None,
        }
    }
}

impl Params {
    /// Whether every parameter is in its range.
    ///
    /// # Errors
    /// [`Error::Parameter`] names the first that is not, [`Error::FeaturePoints`] a number of points that has no rule.
    pub fn check(&self) -> Result<(), Error> {
        let lengths = [
            ("density near the lips", self.lip_density, 1.0),
            ("density near the lids", self.lid_density, 1.0),
            ("density at the outskirts", self.outskirt_density, 0.1),
            ("falloff", self.falloff_mm, f64::MIN_POSITIVE),
            ("least distance", self.least_distance_mm, 0.0),
            ("distance from the border", self.border_mm, 0.0),
            ("asymmetry", self.asymmetry_mm, 0.0),
        ];
        if let Some(&(name, value, least)) =
            lengths.iter().find(|(_, value, least)| !(value.is_finite() && value >= least))
        {
            return Err(Error::Parameter { name, value, least });
        }
        let known = [0, 2, 4, 8].contains(&self.lip_points) && [0, 4, 8].contains(&self.lid_points);
        let features = self.lip_points + self.lid_points;
        match known && features <= self.count && self.count > 0 {
            true => Ok(()),
            false => {
                Err(Error::FeaturePoints { lips: self.lip_points, lids: self.lid_points, count: self.count })
            }
        }
    }
}
