//! All cameras and all boards together.

use crate::bundle::{self, Adjusted, Element, Free, Loss, Observation, Scene, adjust};
use crate::error::FEWEST_VIEWS;
use crate::extrinsics::{Joined, join};
use crate::intrinsics::{Alone, View, calibrate_alone};
use crate::report::{self, Report};
use crate::{Corners, Error, Params, Robust};
use artifact::{CameraRig, RigCamera};
use camera::Camera;
use nalgebra::{Isometry3, Vector2};
use std::collections::BTreeMap;

/// A calibration, and how good it is.
#[derive(Debug, Clone)]
pub struct Calibration {
    /// The cameras in world space.
    pub rig: CameraRig,
    /// Per frame the pose of the board, where at least one camera shows it well enough.
    pub world_from_board: BTreeMap<i64, Isometry3<f64>>,
    /// Every corner that was used.
    pub residuals: Vec<Residual>,
    /// What was found, in numbers.
    pub report: Report,
}

/// How far a corner is from where the calibration puts it.
#[derive(Debug, Clone, PartialEq)]
pub struct Residual {
    /// The camera's id.
    pub camera: String,
    /// The frame.
    pub frame: i64,
    /// The corner's number on the board; of tracks, the marker's place in their header.
    pub point: u32,
    /// Where it was found, px.
    pub pixel: Vector2<f64>,
    /// projection − pixel, px.
    pub error: Vector2<f64>,
    /// How much it counted, 0–1.
    pub weight: f64,
}

/// Lenses and poses of all cameras from the corners of a board.
///
/// Each camera by itself first [Zhang2000], then how cameras stand that saw the board at the same time, then one bundle
/// adjustment over everything, with a robust loss (see [`Params`]). Chessboards numbered from their other end are turned.
/// World space is the board's of the first frame, or what the parameters say; mm.
///
/// # Errors
/// If a camera saw the board too rarely or never leaning, or groups of cameras never saw it at the same time; the error names
/// them.
pub fn calibrate_board(corners: &Corners, params: &Params) -> Result<Calibration, Error> {
    params.check()?;
    let ids: Vec<&String> = corners.header.cameras.keys().collect();
    if let Some(camera) = params.world_camera.as_ref().filter(|camera| !ids.contains(camera)) {
        return Err(Error::UnknownCamera(camera.clone()));
    }
    let cameras = ids.iter().map(|id| alone(corners, id, params)).collect::<Result<Vec<Alone>, Error>>()?;
    if cameras.is_empty() {
        return Err(Error::NothingSeen);
    }
    let named = |groups: Vec<Vec<usize>>| {
        Error::Apart(groups.iter().map(|group| group.iter().map(|&c| ids[c].clone()).collect()).collect())
    };
    let joined = join(&corners.header.board, &cameras).map_err(named)?;
    let mut assembly = Assembly::new(corners, &cameras, &joined);
    assembly.settle_poses()?;
    assembly.scene.free = vec![params.free(); cameras.len()];
    let (adjusted, loss) = in_rounds(assembly.scene.clone(), params.robust, params.scale_px)?;
    assembly.calibration(corners, params, adjusted, loss)
}

/// One camera by itself.
fn alone(corners: &Corners, id: &String, params: &Params) -> Result<Alone, Error> {
    let view = |(frame, seen): (usize, &crate::CornersFrame)| {
        let corners = seen.seen.get(id).filter(|corners| corners.len() >= params.min_corners)?;
        Some(View { frame, corners: corners.clone() })
    };
    let views: Vec<View> = corners.frames.iter().enumerate().filter_map(view).collect();
    let few = |views| Error::FewViews { camera: id.clone(), views };
    if views.len() < FEWEST_VIEWS {
        let nothing = corners.frames.iter().all(|frame| frame.seen.values().all(BTreeMap::is_empty));
        return Err(if nothing { Error::NothingSeen } else { few(views.len()) });
    }
    let image_size = corners.header.cameras[id];
    let found = calibrate_alone(image_size, &corners.header.board.corners(), &views, params);
    let found = found.ok_or_else(|| Error::NoLens { camera: id.clone() })?;
    match found.views.len() {
        count if count < FEWEST_VIEWS => Err(few(count)),
        views if !found.is_determined => Err(Error::Undetermined { camera: id.clone(), views }),
        _ => Ok(found),
    }
}

/// Scale of the loss while cameras move into place, px.
const COARSE_PX: f64 = 2.0;
/// Residuals up to so many standard deviations count in full: of normal noise in two axes, all but 1 in 90.
const CLEAN_SIGMAS: f64 = 3.0;
/// Rounds in which the scale of the loss is set anew.
const SCALE_ROUNDS: usize = 3;
/// The least scale, px: synthetic corners have no noise at all.
const MIN_SCALE_PX: f64 = 1e-3;

/// The scene of everything, and what its indices mean.
pub(crate) struct Assembly {
    pub(crate) scene: Scene,
    /// Per element the index of the frame.
    pub(crate) frames: Vec<usize>,
    /// Views whose corners were numbered from another end.
    pub(crate) renumbered: usize,
    /// Per camera how many views it has.
    pub(crate) views: Vec<usize>,
}

impl Assembly {
    pub(crate) fn new(corners: &Corners, cameras: &[Alone], joined: &Joined) -> Self {
        let camera = |(alone, cam_from_root): (&Alone, &Isometry3<f64>)| Camera {
            image_size: alone.image_size,
            lens: alone.lens,
            cam_from_world: *cam_from_root,
        };
        let placed = cameras.iter().zip(&joined.cam_from_root).map(camera).collect();
        let mut scene = Scene::new(placed, vec![Free::POSE; cameras.len()]);
        scene.body = corners.header.board.corners();
        scene.structure.extend(
            joined.root_from_board.values().map(|&world_from_body| Element::Body { world_from_body }),
        );
        let frames: Vec<usize> = joined.root_from_board.keys().copied().collect();
        let ways = corners.header.board.numberings();
        let mut renumbered = 0;
        for (camera, alone) in cameras.iter().enumerate() {
            for ((view, _), &way) in alone.views.iter().zip(&joined.numbering[camera]) {
                let Ok(element) = frames.binary_search(&view.frame) else { continue };
                renumbered += usize::from(way != 0);
                let observe = |(&id, at): (&u32, &nalgebra::Point2<f64>)| {
                    let point = ways[way][id as usize] as usize;
                    Observation { camera, element, point, pixel: at.coords }
                };
                scene.observations.extend(view.corners.iter().map(observe));
            }
        }
        let views = cameras.iter().map(|alone| alone.views.len()).collect();
        Self { scene, frames, renumbered, views }
    }

    /// Moves cameras and boards, not the lenses, to where they about belong.
    fn settle_poses(&mut self) -> Result<(), Error> {
        let mut rough = self.scene.clone();
        rough.drop_behind();
        rough.free = vec![Free::POSE; rough.cameras.len()];
        let adjusted = adjust(
            &rough,
            &bundle::Params { loss: Loss::Huber { scale_px: COARSE_PX }, ..Default::default() },
        )?;
        settle(&mut self.scene, &adjusted);
        Ok(())
    }

    fn calibration(
        &self,
        corners: &Corners,
        params: &Params,
        adjusted: Adjusted,
        loss: Loss,
    ) -> Result<Calibration, Error> {
        let ids: Vec<&String> = corners.header.cameras.keys().collect();
        let number = |element: usize| corners.frames[self.frames[element]].frame;
        let poses = || {
            adjusted.structure.iter().enumerate().filter_map(|(element, pose)| match pose {
                Element::Body { world_from_body } => Some((number(element), *world_from_body)),
                Element::Point(_) => None,
            })
        };
        let world_from_root = match (&params.world_camera, params.world_frame) {
            (Some(id), _) => {
                let at = ids.iter().position(|other| *other == id);
                at.map(|c| adjusted.cameras[c].cam_from_world)
                    .ok_or_else(|| Error::UnknownCamera(id.clone()))?
            }
            (None, Some(frame)) => {
                poses().find(|(other, _)| *other == frame).ok_or(Error::UnknownFrame(frame))?.1.inverse()
            }
            (None, None) => poses().next().ok_or(Error::NothingSeen)?.1.inverse(),
        };
        let residual = |(seen, error): (&Observation, &Vector2<f64>)| Residual {
            camera: ids[seen.camera].clone(),
            frame: number(seen.element),
            point: seen.point as u32,
            pixel: seen.pixel,
            error: *error,
            weight: loss.weight(error.norm_squared()),
        };
        let residuals: Vec<Residual> =
            self.scene.observations.iter().zip(&adjusted.residuals).map(residual).collect();
        let world_from_board = poses().map(|(frame, pose)| (frame, world_from_root * pose)).collect();
        let camera = |c: usize| {
            let mut camera = adjusted.cameras[c].clone();
            camera.cam_from_world *= world_from_root.inverse();
            let deviation = adjusted.deviations.as_ref().map(|deviations| deviations[c]);
            let found = RigCamera {
                camera,
                rms_px: adjusted.camera_rms_px[c],
                views: Some(self.views[c]),
                deviation,
            };
            (ids[c].clone(), found)
        };
        let rig =
            CameraRig { cameras: (0..ids.len()).map(camera).collect(), take: corners.header.take.clone() };
        let report = report::report(&rig, &residuals, &adjusted, loss, self.renumbered);
        Ok(Calibration { rig, world_from_board, residuals, report })
    }
}

/// The adjusted scene, and the loss that was used in the end: its scale comes from the residuals, unless it is stated.
pub(crate) fn in_rounds(
    mut scene: Scene,
    robust: Robust,
    scale_px: Option<f64>,
) -> Result<(Adjusted, Loss), Error> {
    let with = |scene: &Scene, loss| adjust(scene, &bundle::Params { loss, ..Default::default() });
    let stated = match (robust, scale_px) {
        (Robust::Squares, _) => Some(Loss::Squares),
        (_, scale_px) => scale_px.map(|scale_px| robust.loss(scale_px)),
    };
    let mut loss = stated.unwrap_or(Loss::Huber { scale_px: COARSE_PX });
    let mut adjusted = with(&scene, loss)?;
    for _ in 0..SCALE_ROUNDS {
        if stated.is_none() {
            loss = robust.loss(clean_scale(&adjusted.residuals));
            settle(&mut scene, &adjusted);
            adjusted = with(&scene, loss)?;
        }
    }
    Ok((adjusted, loss))
}

fn settle(scene: &mut Scene, adjusted: &Adjusted) {
    scene.cameras.clone_from(&adjusted.cameras);
    scene.structure.clone_from(&adjusted.structure);
}

/// From which length on a residual is no noise: from the median of the residuals' coordinates, which gross errors do not move.
fn clean_scale(residuals: &[Vector2<f64>]) -> f64 {
    let mut sizes: Vec<f64> = residuals.iter().flat_map(|r| [r.x.abs(), r.y.abs()]).collect();
    sizes.sort_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    (CLEAN_SIGMAS * NORMAL_FROM_MEDIAN * median).max(MIN_SCALE_PX)
}

/// Standard deviation of normal noise over its median size.
const NORMAL_FROM_MEDIAN: f64 = 1.4826;
