//! Cameras that are known, made better.

use crate::bundle::{Adjusted, Element, Free, Loss, Observation, Scene};
use crate::extrinsics::place_boards;
use crate::intrinsics::{Alone, View, posed};
use crate::joint::{Assembly, in_rounds};
use crate::report::{self, Report};
use crate::{Corners, Error, Residual, Robust};
use artifact::{CameraRig, RigCamera, Sample2d, TrackState, Tracks2dFrame, Tracks2dHeader};
use camera::{Camera, fit_rigid, fit_similarity};
use nalgebra::{Isometry3, Point3, Similarity3, Vector2};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// Parameters of [`refine_with_corners`] and [`refine_with_tracks`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RefineParams {
    /// What of a camera moves.
    pub free: Free,
    /// Cameras that stay as they are.
    pub hold: BTreeSet<String>,
    /// How residuals are weighed.
    pub robust: Robust,
    /// From which length on a residual counts less than its square, px; from the residuals' own spread if absent.
    pub scale_px: Option<f64>,
    /// Corners that a view must show to be used.
    pub min_corners: usize,
}

impl Default for RefineParams {
    fn default() -> Self {
        let defaults = crate::Params::default();
        Self {
            free: Free::POSE,
            hold: BTreeSet::new(),
            robust: defaults.robust,
            scale_px: None,
            min_corners: defaults.min_corners,
        }
    }
}

impl RefineParams {
    fn check(&self, rig: &CameraRig) -> Result<(), Error> {
        let common = crate::Params {
            scale_px: self.scale_px,
            min_corners: self.min_corners,
            ..crate::Params::default()
        };
        common.check()?;
        match self.hold.iter().find(|id| !rig.cameras.contains_key(*id)) {
            Some(id) => Err(Error::Parameter {
                name: "hold",
                what: format!("{id} is not among the cameras to refine"),
            }),
            None => Ok(()),
        }
    }

    fn free_of(&self, id: &str) -> Free {
        if self.hold.contains(id) { Free::NOTHING } else { self.free }
    }
}

/// A rig made better.
#[derive(Debug, Clone)]
pub struct Refined {
    /// The cameras. One that saw nothing stays as it was.
    pub rig: CameraRig,
    /// Every observation that was used.
    pub residuals: Vec<Residual>,
    /// What was found, in numbers.
    pub report: Report,
}

/// A rig refined with the corners of a board. World space stays where it was: as a whole the boards do not move.
///
/// # Errors
/// If a camera of the corners is unknown or has another image size, or nothing can be used.
pub fn refine_with_corners(
    rig: &CameraRig,
    corners: &Corners,
    params: &RefineParams,
) -> Result<Refined, Error> {
    params.check(rig)?;
    let mut cameras = Vec::new();
    for (id, size) in &corners.header.cameras {
        cameras.push(of_size(known(rig, id)?, id, *size)?.clone());
    }
    let body = corners.header.board.corners();
    let alone = |(id, camera): (&String, &Camera)| -> Alone {
        let view = |(frame, seen): (usize, &crate::CornersFrame)| {
            let corners = seen.seen.get(id).filter(|corners| corners.len() >= params.min_corners)?;
            Some(View { frame, corners: corners.clone() })
        };
        posed(camera, &body, corners.frames.iter().enumerate().filter_map(view).collect())
    };
    let ids: Vec<&String> = corners.header.cameras.keys().collect();
    let alone: Vec<Alone> = ids.iter().copied().zip(&cameras).map(alone).collect();
    let poses = cameras.iter().map(|camera| camera.cam_from_world).collect();
    let joined = place_boards(&corners.header.board, &alone, poses);
    let mut assembly = Assembly::new(corners, &alone, &joined);
    assembly.scene.drop_behind();
    if assembly.scene.observations.is_empty() {
        return Err(Error::NothingSeen);
    }
    assembly.scene.free = ids.iter().map(|id| params.free_of(id)).collect();
    let numbers: Vec<i64> = assembly.frames.iter().map(|&frame| corners.frames[frame].frame).collect();
    let work = Work { ids: &ids, scene: &assembly.scene, frames: &numbers, points: None };
    work.adjusted(rig, params, assembly.renumbered)
}

/// A rig refined with markers tracked in its images, each a free point in each frame. World space and its scale stay: as a
/// whole the markers do not move or grow. Predicted samples are not used.
///
/// # Errors
/// If a camera of the tracks is unknown, or nothing can be used.
pub fn refine_with_tracks(
    rig: &CameraRig,
    header: &Tracks2dHeader,
    frames: &[Tracks2dFrame],
    params: &RefineParams,
) -> Result<Refined, Error> {
    params.check(rig)?;
    let cameras =
        header.cameras.iter().map(|id| known(rig, id).cloned()).collect::<Result<Vec<Camera>, Error>>()?;
    let free = header.cameras.iter().map(|id| params.free_of(id)).collect();
    let mut scene = Scene::new(cameras, free);
    let (mut numbers, mut markers) = (Vec::new(), Vec::new());
    for frame in frames {
        for marker in 0..header.markers.len() {
            if add_marker(&mut scene, frame, marker) {
                numbers.push(frame.frame);
                markers.push(marker as u32);
            }
        }
    }
    if scene.observations.is_empty() {
        return Err(Error::NoTracks);
    }
    let ids: Vec<&String> = header.cameras.iter().collect();
    Work { ids: &ids, scene: &scene, frames: &numbers, points: Some(&markers) }.adjusted(rig, params, 0)
}

/// Adds a marker in a frame where two cameras or more see it and their rays meet before them.
fn add_marker(scene: &mut Scene, frame: &Tracks2dFrame, marker: usize) -> bool {
    let sample = |(camera, samples): (usize, &Option<Vec<Option<Sample2d>>>)| {
        let sample = samples.as_ref()?.get(marker)?.as_ref()?;
        (sample.state != TrackState::Predicted).then_some((camera, sample.at.coords))
    };
    let seen: Vec<(usize, Vector2<f64>)> = frame.cameras.iter().enumerate().filter_map(sample).collect();
    let views: Vec<(&Camera, Vector2<f64>)> = seen.iter().map(|&(c, at)| (&scene.cameras[c], at)).collect();
    let Some(point) = Camera::nearest_to_rays(views.iter().copied()) else { return false };
    let element = scene.structure.len();
    scene.structure.push(Element::Point(point));
    let observe = |(camera, pixel)| Observation { camera, element, point: 0, pixel };
    scene.observations.extend(seen.into_iter().map(observe));
    true
}

fn known<'a>(rig: &'a CameraRig, id: &str) -> Result<&'a Camera, Error> {
    rig.cameras.get(id).map(|known| &known.camera).ok_or_else(|| Error::UnknownCamera(id.to_string()))
}

fn of_size<'a>(camera: &'a Camera, id: &str, size: [u32; 2]) -> Result<&'a Camera, Error> {
    let [width, height] = camera.image_size;
    match camera.image_size == size {
        true => Ok(camera),
        false => {
            let what = format!(
                "its pictures have {} × {} px, its calibration says {width} × {height}",
                size[0], size[1]
            );
            Err(Error::Mismatch { camera: id.to_string(), what })
        }
    }
}

/// What indices of an adjusted scene mean.
struct Work<'a> {
    ids: &'a [&'a String],
    scene: &'a Scene,
    /// Per element its frame.
    frames: &'a [i64],
    /// Per element its marker, where it is one.
    points: Option<&'a [u32]>,
}

impl Work<'_> {
    fn adjusted(&self, rig: &CameraRig, params: &RefineParams, renumbered: usize) -> Result<Refined, Error> {
        let (adjusted, loss) = in_rounds(self.scene.clone(), params.robust, params.scale_px)?;
        Ok(self.refined(rig, adjusted, loss, renumbered))
    }

    fn refined(&self, rig: &CameraRig, adjusted: Adjusted, loss: Loss, renumbered: usize) -> Refined {
        let home = self.home(&adjusted);
        let mut rig = rig.clone();
        for (c, id) in self.ids.iter().enumerate() {
            let Some(rms_px) = adjusted.camera_rms_px[c] else { continue };
            let mut camera = adjusted.cameras[c].clone();
            camera.cam_from_world = match self.scene.free[c].pose {
                true => carried(&camera.cam_from_world, &home),
                false => self.scene.cameras[c].cam_from_world,
            };
            let deviation = adjusted.deviations.as_ref().map(|deviations| deviations[c]);
            let seen = self.scene.observations.iter().filter(|seen| seen.camera == c);
            let views = seen.map(|seen| self.frames[seen.element]).collect::<BTreeSet<_>>().len();
            let found = RigCamera { camera, rms_px: Some(rms_px), views: Some(views), deviation };
            rig.cameras.insert((*id).clone(), found);
        }
        let residual = |(seen, error): (&Observation, &Vector2<f64>)| Residual {
            camera: self.ids[seen.camera].clone(),
            frame: self.frames[seen.element],
            point: self.points.map_or(seen.point as u32, |points| points[seen.element]),
            pixel: seen.pixel,
            error: *error,
            weight: loss.weight(error.norm_squared()),
        };
        let residuals: Vec<Residual> =
            self.scene.observations.iter().zip(&adjusted.residuals).map(residual).collect();
        let report = report::report(&rig, &residuals, &adjusted, loss, renumbered);
        Refined { rig, residuals, report }
    }

    /// The motion, and for free points the scale, that brings the structure back as a whole; none where a camera is held,
    /// which ties it to the world.
    fn home(&self, adjusted: &Adjusted) -> Similarity3<f64> {
        if self.scene.free.iter().any(|free| !free.pose) {
            return Similarity3::identity();
        }
        let places = |structure: &[Element]| -> Vec<Point3<f64>> {
            let place = |element: &Element| match element {
                Element::Point(point) => vec![*point],
                Element::Body { world_from_body } => {
                    self.scene.body.iter().map(|point| world_from_body * point).collect()
                }
            };
            structure.iter().flat_map(place).collect()
        };
        let (from, to) = (places(&adjusted.structure), places(&self.scene.structure));
        match self.points {
            Some(_) => fit_similarity(&from, &to, None).unwrap_or_else(|_| Similarity3::identity()),
            None => {
                let motion = fit_rigid(&from, &to, None).unwrap_or_else(|_| Isometry3::identity());
                Similarity3::from_isometry(motion, 1.0)
            }
        }
    }
}

/// A camera's pose after the world has moved and grown.
fn carried(cam_from_old: &Isometry3<f64>, new_from_old: &Similarity3<f64>) -> Isometry3<f64> {
    // x_cam = R (x_new − t)/s … scaled by s, which no image shows.
    let rotation = cam_from_old.rotation * new_from_old.isometry.rotation.inverse();
    let eye = new_from_old * cam_from_old.inverse_transform_point(&Point3::origin());
    Isometry3::from_parts((-(rotation * eye.coords)).into(), rotation)
}
