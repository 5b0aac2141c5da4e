//! Where the points are at times between frames.

use super::Sighting;
use nalgebra::Point3;
use std::collections::BTreeMap;

/// Points over time, as trusted cameras see them.
pub(super) struct Trajectories<'a> {
    places: BTreeMap<&'a str, BTreeMap<i64, Point3<f64>>>,
}

impl<'a> Trajectories<'a> {
    pub(super) fn of(sightings: &'a [Sighting], points: &[Option<Point3<f64>>]) -> Self {
        let mut places: BTreeMap<&str, BTreeMap<i64, Point3<f64>>> = BTreeMap::new();
        for (sighting, point) in sightings.iter().zip(points) {
            if let Some(point) = point {
                places.entry(&sighting.name).or_default().insert(sighting.frame, *point);
            }
        }
        Self { places }
    }

    /// Where a point is at a time in frames: through the two frames around it and the two beyond [CatmullRom1974]; none
    /// where they were not all seen.
    pub(super) fn at(&self, name: &str, time: f64) -> Option<Point3<f64>> {
        let places = self.places.get(name)?;
        let before = time.floor();
        let share = time - before;
        let place = |step: i64| places.get(&(before as i64 + step)).map(|point| point.coords);
        if share == 0.0 {
            return place(0).map(Point3::from);
        }
        let [a, b, c, d] = [place(-1)?, place(0)?, place(1)?, place(2)?];
        let (out, back) = (0.5 * (c - a), 0.5 * (d - b));
        let (s2, s3) = (share * share, share * share * share);
        let point = b * (2.0 * s3 - 3.0 * s2 + 1.0)
            + out * (s3 - 2.0 * s2 + share)
            + c * (3.0 * s2 - 2.0 * s3)
            + back * (s3 - s2);
        Some(point.into())
    }
}
