//! What is filmed before the take: a board, and a waved bright point.

use anyhow::Context;
use artifact::picture;
use camera::Camera;
use rayon::prelude::*;
use serde_json::json;
use stage::Run;
use std::path::Path;
use virtual_rig::calibration::{
    BoardCamera, Picture, board_poses, common_volume, corners_in_image, render_led, wand_path,
};
use virtual_rig::film::Exposure;
use virtual_rig::take::Studio;

/// Films boards and wand with the cameras as they were when they were calibrated: what is wrong in the take went wrong later.
pub(super) fn film(run: &mut Run, studio: &Studio, out: &Path) -> anyhow::Result<()> {
    let params = &studio.scenario().calibration;
    let cameras: Vec<(&String, &Camera)> =
        studio.stations().iter().map(|(id, station)| (id, &station.calibrated)).collect();
    let steps = params.boards.count + params.wand.frames;
    let mut progress = run.progress("calibration", Some(steps as u64));
    boards(studio, &cameras, out, &mut || progress.step())?;
    wand(studio, &cameras, out, &mut || progress.step())
}

fn boards(
    studio: &Studio,
    cameras: &[(&String, &Camera)],
    out: &Path,
    step: &mut dyn FnMut(),
) -> anyhow::Result<()> {
    let views = &studio.scenario().calibration.boards;
    if views.count == 0 {
        return Ok(());
    }
    let all: Vec<Camera> = cameras.iter().map(|(_, camera)| (*camera).clone()).collect();
    let poses = board_poses(&all, views, studio.scenario().seed)?;
    let lenses: Vec<BoardCamera> = all.iter().map(BoardCamera::new).collect();
    let mut truth = Vec::new();
    for (number, pose) in poses.iter().enumerate() {
        let picture = |lens: &BoardCamera| lens.render(&views.board, pose, &views.light, views.samples);
        let pictures: Vec<Picture> = lenses.par_iter().map(picture).collect();
        write(studio, cameras, pictures, out, ("board", number), number as i64)?;
        let corners = cameras.iter().map(|(id, camera)| {
            let seen = corners_in_image(camera, &views.board, pose);
            let places: Vec<_> = seen
                .iter()
                .map(|corner| json!([corner.id, corner.point_in_image.x, corner.point_in_image.y]))
                .collect();
            ((*id).clone(), serde_json::Value::from(places))
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

fn wand(
    studio: &Studio,
    cameras: &[(&String, &Camera)],
    out: &Path,
    step: &mut dyn FnMut(),
) -> anyhow::Result<()> {
    let wand = &studio.scenario().calibration.wand;
    if wand.frames == 0 {
        return Ok(());
    }
    let all: Vec<Camera> = cameras.iter().map(|(_, camera)| (*camera).clone()).collect();
    let volume = common_volume(&all).context("calibration.wand: the cameras' views do not meet")?;
    let reach = virtual_rig::calibration::Volume { radius_mm: volume.radius_mm * wand.reach, ..volume };
    let path = wand_path(&reach, wand.frames, wand.frames_per_sweep, studio.scenario().seed);
    let mut truth = Vec::new();
    for (number, point) in path.iter().enumerate() {
        let picture = |camera: &Camera| render_led(camera, point, wand.radius_mm, wand.radiance, wand.room);
        let pictures: Vec<Picture> = all.par_iter().map(picture).collect();
        let shot = (studio.scenario().calibration.boards.count + number) as i64;
        write(studio, cameras, pictures, out, ("wand", number), shot)?;
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
    studio: &Studio,
    cameras: &[(&String, &Camera)],
    pictures: Vec<Picture>,
    out: &Path,
    (kind, number): (&str, usize),
    shot: i64,
) -> anyhow::Result<()> {
    let develop = |((id, _), picture): (&(&String, &Camera), Picture)| {
        let station = &studio.stations()[*id];
        let exposure = Exposure::of_radiance(picture.size, picture.radiance);
        // Other grain than the take's: frames before it.
        studio.develop_before(&exposure, station, -1 - shot)
    };
    let images: Vec<Vec<u8>> = cameras.par_iter().zip(pictures).map(develop).collect::<Result<_, _>>()?;
    for ((id, camera), image) in cameras.iter().zip(images) {
        let [width, height] = camera.image_size.map(|side| side as usize);
        let path = out.join(format!("take/calibration/{kind}/{id}/{number:06}.png"));
        picture::write_rgb8(&path, width, height, &image)?.publish()?;
    }
    Ok(())
}
