//! One frame: all markers that two cameras see, and the rays of those that one sees.

use crate::Error;
use crate::point::{Fix, Scale, Sight, triangulate_point};
use crate::view::View;
use artifact::{CameraRig, Sample2d, TrackState, Tracks2dFrame, Tracks2dHeader};
use nalgebra::{Point3, Unit, Vector3};

/// How far outside its image a point may lie, px: trackers extrapolate a little at the border.
const MARGIN_PX: f64 = 8.0;
/// Points that all lie within this share of the image's width and height are taken for those of smaller images.
const PART: f64 = 0.6;

/// The cameras of the tracks, in their order.
pub(crate) struct Rig {
    pub(crate) views: Vec<View>,
    /// Per camera the right lower end of what was seen, px.
    reach: Vec<[f64; 2]>,
}

/// What a frame shows of a marker.
#[derive(Debug, Clone)]
pub(crate) enum Found {
    /// No camera sees it.
    Nothing,
    /// One camera sees it: which one, and its ray.
    Ray(Ray),
    /// Two cameras or more see it, but do not agree.
    Disagreed,
    /// Where it is.
    Point(Fix),
}

/// A half-line in world space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ray {
    pub(crate) camera: usize,
    pub(crate) origin: Point3<f64>,
    pub(crate) direction: Unit<Vector3<f64>>,
}

/// A frame, triangulated.
#[derive(Debug, Clone)]
pub(crate) struct Solved {
    pub(crate) frame: i64,
    /// Per marker.
    pub(crate) found: Vec<Found>,
}

impl Solved {
    pub(crate) fn fix(&self, marker: usize) -> Option<&Fix> {
        match &self.found[marker] {
            Found::Point(fix) => Some(fix),
            _ => None,
        }
    }

    pub(crate) fn fixes(&self) -> impl Iterator<Item = (usize, &Fix)> {
        (0..self.found.len()).filter_map(|marker| Some((marker, self.fix(marker)?)))
    }
}

impl Rig {
    /// The cameras that the tracks name.
    pub(crate) fn new(rig: &CameraRig, header: &Tracks2dHeader) -> Result<Self, Error> {
        let view = |id: &String| match rig.cameras.get(id) {
            Some(camera) => Ok(View::of(&camera.camera)),
            None => {
                let known = rig.cameras.keys().cloned().collect();
                Err(Error::UnknownCamera { camera: id.clone(), known })
            }
        };
        let views = header.cameras.iter().map(view).collect::<Result<Vec<_>, _>>()?;
        match views.len() {
            0 | 1 => Err(Error::TooFewCameras(views.len())),
            count => Ok(Self { views, reach: vec![[0.0; 2]; count] }),
        }
    }

    /// Refuses points far outside the images: calibration and footage are then of different sizes.
    pub(crate) fn check(&mut self, header: &Tracks2dHeader, frame: &Tracks2dFrame) -> Result<(), Error> {
        for (camera, samples) in frame.cameras.iter().enumerate() {
            let (view, reach) = (&self.views[camera], &mut self.reach[camera]);
            let seen = samples.iter().flatten().enumerate();
            let seen = seen.filter_map(|(marker, sample)| Some((marker, measured(sample.as_ref())?)));
            for (marker, sample) in seen {
                *reach = [reach[0].max(sample.at.x), reach[1].max(sample.at.y)];
                if view.may_show(sample.at.coords, MARGIN_PX) {
                    continue;
                }
                let [width, height] = view.image_size;
                return Err(Error::OutsideImage {
                    frame: frame.frame,
                    camera: header.cameras[camera].clone(),
                    marker: header.markers[marker].clone(),
                    x: sample.at.x,
                    y: sample.at.y,
                    width,
                    height,
                });
            }
        }
        Ok(())
    }

    /// The camera whose points came nearest to its image's right lower end, with that end and theirs, if all cameras saw points in
    /// the left upper part of their images alone.
    pub(crate) fn beyond(&self) -> Option<(usize, [u32; 2], [f64; 2])> {
        let share = |camera: usize| {
            let [width, height] = self.views[camera].image_size.map(f64::from);
            (self.reach[camera][0] / width).max(self.reach[camera][1] / height)
        };
        let farthest = (0..self.views.len()).max_by(|a, b| share(*a).total_cmp(&share(*b)))?;
        let is_part = share(farthest) < PART;
        is_part.then(|| (farthest, self.views[farthest].image_size, self.reach[farthest]))
    }

    /// Triangulates all markers of a frame.
    pub(crate) fn solve(&self, frame: &Tracks2dFrame, marker_count: usize, scale: Scale) -> Solved {
        let mut sights = Vec::with_capacity(self.views.len());
        let found = (0..marker_count).map(|marker| {
            sights.clear();
            sights.extend(frame.cameras.iter().enumerate().filter_map(|(camera, samples)| {
                let sample = measured(samples.as_ref()?[marker].as_ref())?;
                Sight::new(camera, &self.views[camera], sample.at.coords, sample.confidence, scale)
            }));
            match &sights[..] {
                [] => Found::Nothing,
                [sight] => {
                    let (origin, direction) = sight.ray();
                    Found::Ray(Ray { camera: sight.camera, origin, direction })
                }
                sights => triangulate_point(sights, scale).map_or(Found::Disagreed, Found::Point),
            }
        });
        Solved { frame: frame.frame, found: found.collect() }
    }
}

/// A sample that was seen in the image: a tracker's prediction measures nothing.
fn measured(sample: Option<&Sample2d>) -> Option<&Sample2d> {
    sample.filter(|sample| sample.state != TrackState::Predicted)
}
