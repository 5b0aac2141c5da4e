//! Calibrated cameras in the formats of others, to and from [`CameraRig`].

pub mod anipose;
mod calibration;
pub mod colmap;
pub mod opencv;
mod storage;
mod tree;

use crate::{CameraRig, Error, Result, RigCamera, Staged, Unit, read_document, write_document};
use std::path::{Path, PathBuf};

/// What the user says about files of cameras, because the files do not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Stated {
    /// The unit of their translations.
    pub unit: Unit,
    /// Width and height of the images, px, for files that do not say it.
    pub image_size: Option<[u32; 2]>,
}

/// A format of calibrated cameras.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraFormat {
    /// `cameras/1`.
    Furrow,
    /// OpenCV's `FileStorage`, [`opencv`].
    Opencv,
    /// aniposelib, Pose2Sim, Caliscope: [`anipose`].
    Anipose,
    /// A folder of COLMAP's text files, [`colmap`].
    Colmap,
}

/// Reads cameras of a format; translations come out in mm. Only OpenCV's may be spread over several files. Also returns
/// warnings: what the files say that a rig does not hold.
///
/// # Errors
/// As the reader of the format; several files where one is expected; a unit other than mm stated for `cameras/1`.
pub fn read_cameras(
    paths: &[PathBuf],
    format: CameraFormat,
    stated: &Stated,
) -> Result<(CameraRig, Vec<String>)> {
    let paths: Vec<&Path> = paths.iter().map(PathBuf::as_path).collect();
    if format == CameraFormat::Opencv {
        return opencv::read(&paths, stated);
    }
    let [path] = paths[..] else {
        let place = paths.get(1).copied().unwrap_or(Path::new("-"));
        return Err(Error::new(
            place,
            "is one file too many, or there is none; this format is read from one",
        )
        .fix("name one; only OpenCV's intrinsics and extrinsics may stand in two files"));
    };
    match format {
        CameraFormat::Furrow => read_own(path, stated),
        CameraFormat::Anipose => anipose::read(path, stated),
        CameraFormat::Opencv | CameraFormat::Colmap => colmap::read(path, stated),
    }
}

fn read_own(path: &Path, stated: &Stated) -> Result<(CameraRig, Vec<String>)> {
    if stated.unit != Unit::Mm {
        return Err(Error::new(path, format!("is in mm, but {} is stated", stated.unit)).fix("state mm"));
    }
    Ok((read_document(path)?, Vec::new()))
}

/// Writes cameras in a format, with translations in `unit` (mm for `cameras/1`); COLMAP's is a folder. Also returns
/// warnings: what the format does not hold.
///
/// # Errors
/// As the writer of the format.
pub fn write_cameras(
    path: &Path,
    rig: &CameraRig,
    format: CameraFormat,
    unit: Unit,
) -> Result<(Vec<Staged>, Vec<String>)> {
    let staged = match format {
        CameraFormat::Furrow => vec![write_document(path, rig)?],
        CameraFormat::Opencv => vec![opencv::write(path, rig, unit)?],
        CameraFormat::Anipose => vec![anipose::write(path, rig, unit)?],
        CameraFormat::Colmap => colmap::write(path, rig, unit)?,
    };
    Ok((staged, lost(rig, format)))
}

/// What is known about the cameras of a rig, beyond their parameters, that a format has no place for.
fn lost(rig: &CameraRig, format: CameraFormat) -> Vec<String> {
    let holds_quality = matches!(format, CameraFormat::Furrow | CameraFormat::Opencv);
    let of = |what: &str, has: fn(&RigCamera) -> bool| {
        let ids: Vec<&str> =
            rig.cameras.iter().filter(|(_, camera)| has(camera)).map(|(id, _)| id.as_str()).collect();
        let said = format!("the format has no place for the {what} of {}; not kept", ids.join(", "));
        (!ids.is_empty()).then_some(said)
    };
    let deviation = of("standard deviations", |camera| camera.deviation.is_some());
    let quality = of("reprojection errors and image counts", |camera| {
        camera.rms_px.is_some() || camera.views.is_some()
    });
    let take = rig.take.as_ref().map(|_| "the format has no place for the take; not kept".to_string());
    let own = format == CameraFormat::Furrow;
    deviation.into_iter().chain(take).filter(|_| !own).chain(quality.filter(|_| !holds_quality)).collect()
}
