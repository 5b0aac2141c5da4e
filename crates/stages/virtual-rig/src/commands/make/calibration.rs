//! What is filmed before the take: a board, and a waved bright point.

use artifact::picture;
use camera::Camera;
use nalgebra::{Isometry3, Point3};
use rayon::prelude::*;
use serde_json::json;
use stage::Run;
use std::path::Path;
use virtual_rig::Error;
use virtual_rig::calibration::{
    BoardCamera, Picture, Volume, board_poses, common_volume, corners_in_image, render_led, wand_path,
};
use virtual_rig::film::Exposure;
use virtual_rig::take::Studio;

/// Where boards and wand are held.
pub(super) struct Plan<'a> {
    studio: &'a Studio,
    /// As they were when they were calibrated.
    cameras: Vec<(&'a str, &'a Camera)>,
    boards: Vec<Isometry3<f64>>,
    wand: Vec<Point3<f64>>,
}

impl<'a> Plan<'a> {
    /// Writes nothing, but refuses what could not be filmed.
    pub(super) fn new(studio: &'a Studio) -> Result<Self, Error> {
        let stations = studio.stations().iter();
        let cameras: Vec<_> = stations.map(|(id, station)| (id.as_str(), &station.calibrated)).collect();
        let (params, seed) = (&studio.scenario().calibration, studio.scenario().seed);
        let boards = board_poses(&cameras, &params.boards, seed)?;
        let wand = match params.wand.frames {
            0 => Vec::new(),
            frames => {
                let all: Vec<Camera> = cameras.iter().map(|(_, camera)| (*camera).clone()).collect();
                let volume = common_volume(&all).ok_or_else(|| {
                    Error::parameter(
                        "calibration.wand",
                        "the cameras' views do not meet; leave it out with frames = 0, or move the cameras",
                    )
                })?;
                let reach = Volume { radius_mm: volume.radius_mm * params.wand.reach, ..volume };
                wand_path(&reach, frames, params.wand.frames_per_sweep, seed)
            }
        };
        Ok(Self { studio, cameras, boards, wand })
    }

    /// Films boards and wand with the cameras as they were when they were calibrated: what is wrong in the take went wrong
    /// later.
    pub(super) fn film(&self, run: &mut Run, out: &Path) -> anyhow::Result<()> {
        let steps = self.boards.len() + self.wand.len();
        let mut progress = run.progress("calibration", Some(steps as u64));
        if !self.boards.is_empty() {
            self.film_boards(out, &mut || progress.step())?;
        }
        if !self.wand.is_empty() {
            self.film_wand(out, &mut || progress.step())?;
        }
        Ok(())
    }

    fn film_boards(&self, out: &Path, step: &mut dyn FnMut()) -> anyhow::Result<()> {
        let views = &self.studio.scenario().calibration.boards;
        let lenses: Vec<BoardCamera> =
            self.cameras.iter().map(|(_, camera)| BoardCamera::new(camera)).collect();
        let mut truth = Vec::new();
        for (number, pose) in self.boards.iter().enumerate() {
            let picture = |lens: &BoardCamera| lens.render(&views.board, pose, &views.light, views.samples);
            let pictures: Vec<Picture> = lenses.par_iter().map(picture).collect();
            self.write(pictures, out, ("board", number), number)?;
            let corners = self.cameras.iter().map(|(id, camera)| {
                let seen = corners_in_image(camera, &views.board, pose);
                let places: Vec<_> = seen
                    .iter()
                    .map(|corner| json!([corner.id, corner.point_in_image.x, corner.point_in_image.y]))
                    .collect();
                ((*id).to_string(), serde_json::Value::from(places))
            });
            truth.push(json!({ "view": number, "corners": corners.collect::<serde_json::Map<_, _>>() }));
            step();
        }
        let truth = json!({ "board": views.board, "views": truth });
        artifact::stage_bytes(&out.join("truth/calibration/board.json"), truth.to_string().as_bytes())?
            .publish()?;
        let board = json!({ "board": views.board });
        artifact::stage_bytes(&out.join("take/calibration/board.json"), board.to_string().as_bytes())?
            .publish()?;
        Ok(())
    }

    fn film_wand(&self, out: &Path, step: &mut dyn FnMut()) -> anyhow::Result<()> {
        let wand = &self.studio.scenario().calibration.wand;
        let mut truth = Vec::new();
        for (number, point) in self.wand.iter().enumerate() {
            let picture = |(_, camera): &(&str, &Camera)| {
                render_led(camera, point, wand.radius_mm, wand.radiance, wand.room)
            };
            let pictures: Vec<Picture> = self.cameras.par_iter().map(picture).collect();
            self.write(pictures, out, ("wand", number), self.boards.len() + number)?;
            truth.push(json!({ "frame": number, "point_mm": [point.x, point.y, point.z] }));
            step();
        }
        let truth = json!({ "frames": truth });
        artifact::stage_bytes(&out.join("truth/calibration/wand.json"), truth.to_string().as_bytes())?
            .publish()?;
        Ok(())
    }

    /// What the sensors make of the pictures of all cameras.
    fn write(
        &self,
        pictures: Vec<Picture>,
        out: &Path,
        (kind, number): (&str, usize),
        shot: usize,
    ) -> anyhow::Result<()> {
        let develop = |((id, _), picture): (&(&str, &Camera), Picture)| {
            let station = &self.studio.stations()[*id];
            let exposure = Exposure::of_radiance(picture.size, picture.radiance);
            // Other grain than the take's: frames before it.
            self.studio.develop_before(&exposure, station, -1 - shot as i64)
        };
        let images: Vec<Vec<u8>> =
            self.cameras.par_iter().zip(pictures).map(develop).collect::<Result<_, _>>()?;
        for ((id, camera), image) in self.cameras.iter().zip(images) {
            let [width, height] = camera.image_size.map(|side| side as usize);
            let path = out.join(format!("take/calibration/{kind}/{id}/{number:06}.png"));
            picture::write_rgb8(&path, width, height, &image)?.publish()?;
        }
        Ok(())
    }
}
