//! What the cameras' footage is like, and which of them count.

use anyhow::bail;
use artifact::{CameraRig, Error, Take, TakeRef};
use calibrate::Corners;
use nalgebra::Vector2;
use stage::Run;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The take, and cameras to leave out.
#[derive(clap::Args)]
pub(super) struct Footage {
    /// The take that the pictures belong to: its cameras' image sizes are checked
    #[arg(long, value_name = "FILE")]
    pub(super) take: Option<PathBuf>,
    /// Camera ids to leave out
    #[arg(long, value_name = "ID,…", value_delimiter = ',')]
    pub(super) without: Vec<String>,
}

impl Footage {
    pub(super) fn load(&self, run: &mut Run) -> anyhow::Result<Option<(Take, TakeRef)>> {
        self.take.as_deref().map(|path| stage::load_take(run, path)).transpose()
    }

    /// Takes the cameras to leave out from all of them.
    pub(super) fn leave_out<T>(&self, from: &Path, cameras: &mut BTreeMap<String, T>) -> anyhow::Result<()> {
        for id in &self.without {
            if cameras.remove(id).is_none() {
                bail!(
                    "--without {id}: {} has no such camera\n  to do: name one of its cameras",
                    from.display()
                );
            }
        }
        Ok(())
    }

    /// Checks found corners against the take, and leaves cameras out.
    pub(super) fn apply(&self, run: &mut Run, path: &Path, corners: &mut Corners) -> anyhow::Result<()> {
        self.leave_out(path, &mut corners.header.cameras)?;
        for frame in &mut corners.frames {
            frame.seen.retain(|id, _| corners.header.cameras.contains_key(id));
        }
        if let Some((take, reference)) = self.load(run)? {
            for (id, size) in &corners.header.cameras {
                check_size(path, id, *size, &take)?;
            }
            corners.header.take = Some(reference);
        }
        Ok(())
    }
}

/// Refuses a camera whose images have not the size that the take states.
pub(super) fn check_size(path: &Path, id: &str, size: [u32; 2], take: &Take) -> anyhow::Result<()> {
    let stated = take.cameras.iter().find(|known| known.id == id).map(|known| known.image_size);
    match stated {
        Some([width, height]) if [width, height] != size => {
            let what = format!(
                "its images have {} × {} px, but the take manifest says {width} × {height} px",
                size[0], size[1]
            );
            let error = Error::new(path, what).at(format!("camera {id}"));
            Err(error.fix("calibrate with the image size of the footage").into())
        }
        _ => Ok(()),
    }
}

/// Refuses calibrated cameras whose images have not the size that the take states.
pub(super) fn check_rig(path: &Path, rig: &CameraRig, take: &Take) -> anyhow::Result<()> {
    rig.cameras.iter().try_for_each(|(id, known)| check_size(path, id, known.camera.image_size, take))
}

/// Points may lie outside the image by so much, px: detectors place them between pixels.
const BEYOND_PX: f64 = 2.0;
/// Points that keep to this share of the image's width and height, from its first pixel on, were perhaps seen in smaller images.
const CORNER: f64 = 0.55;
/// Fewer points tell nothing about the image's size.
const ENOUGH: usize = 50;

/// Refuses points outside of the image of the size; warns of points that speak for a smaller image.
pub(super) fn check_points(
    run: &mut Run,
    path: &Path,
    id: &str,
    size: [u32; 2],
    points: &[Vector2<f64>],
) -> anyhow::Result<()> {
    let ends = Vector2::from(size.map(f64::from)) - Vector2::repeat(1.0);
    let is_outside = |at: &&Vector2<f64>| at.min() < -BEYOND_PX || (*at - ends).max() > BEYOND_PX;
    if let Some(at) = points.iter().find(is_outside) {
        let what = format!(
            "a point at ({:.1}, {:.1}) is outside of its image of {} × {} px",
            at.x, at.y, size[0], size[1]
        );
        let error = Error::new(path, what).at(format!("camera {id}"));
        return Err(error.fix("give points and cameras of images of one size").into());
    }
    let far = points.iter().fold(Vector2::zeros(), |far: Vector2<f64>, at| far.sup(at));
    if points.len() >= ENOUGH && far.component_div(&ends).max() < CORNER {
        run.warn(format!(
            "camera {id}: all its points lie above and left of ({:.0}, {:.0}) in an image of {} × {} px; is the image size right?",
            far.x, far.y, size[0], size[1]
        ));
    }
    Ok(())
}

/// [`check_points`] of all cameras of found corners.
pub(super) fn check_corners(run: &mut Run, path: &Path, corners: &Corners) -> anyhow::Result<()> {
    for (id, size) in &corners.header.cameras {
        let seen = corners.frames.iter().filter_map(|frame| frame.seen.get(id)).flat_map(BTreeMap::values);
        check_points(run, path, id, *size, &seen.map(|at| at.coords).collect::<Vec<_>>())?;
    }
    Ok(())
}

/// Refuses, before long work, outputs that could not be written after it.
pub(super) fn check_outputs(run: &Run, paths: &[Option<&Path>]) -> anyhow::Result<()> {
    let paths: Vec<&Path> = paths.iter().flatten().copied().collect();
    run.check_outputs(&paths)?;
    for path in &paths {
        if path.is_dir() {
            bail!("{}: is a folder\n  to do: name a file", path.display());
        }
    }
    run.check_folders(&paths)
}
