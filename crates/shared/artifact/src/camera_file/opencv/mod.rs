//! Cameras in OpenCV's `FileStorage`, YAML or JSON, in and out.
//!
//! Read in any of the forms that are about: one camera (`camera_matrix`, `distortion_coefficients`, its pose as `rvec` or
//! `R` with `tvec` or `T`, `image_width`, `image_height`), as OpenCV's samples and ROS write it; a stereo pair (`M1 D1 M2
//! D2`, `R T` from camera 1 to camera 2), in two files or one; several cameras as a list or map named `cameras`, or as maps
//! named by the cameras. The model is ours: pixel (0, 0) is the centre of the top-left pixel.

mod write;

pub use write::write;

use super::calibration::{check_unit, image_size, lens, rig, rotation, translation};
use super::tree::Field;
use super::{Stated, storage};
use crate::source::read_text;
use crate::{CameraRig, Error, Result, RigCamera};
use camera::Camera;
use nalgebra::Isometry3;
use std::path::Path;

// Names in use, without the capitals, underlines and hyphens in which they differ.
const MATRIX: &[&str] = &["cameramatrix", "k", "m", "mtx"];
const DISTORTION: &[&str] = &["distortioncoefficients", "distcoeffs", "d", "dist"];
const ROTATION: &[&str] = &["r", "rvec"];
const TRANSLATION: &[&str] = &["t", "tvec"];
const NAME: &[&str] = &["name", "cameraname"];
const RMS: &[&str] = &["avgreprojectionerror"];
const VIEWS: &[&str] = &["nframes", "nrofframes", "framescount"];
const IMAGE_SIZE: &[&str] = &["imagesize", "cameraresolution"];
const FISHEYE: &[&str] = &["fisheyemodel", "fisheye"];
const MODEL: &[&str] = &["distortionmodel"];
/// Models of distortion that the five coefficients are of; the coefficients say whether there are more.
const MODELS: &[&str] = &["plumb_bob", "rational_polynomial"];

/// Reads cameras from files whose keys are taken together; translations come out in mm. Also returns warnings.
///
/// A single camera is named by `name` or else by its file, a stereo pair is `1` and `2`. Cameras without a pose stand in the
/// origin, if there is only one.
///
/// # Errors
/// Names file, line and key of what is missing, malformed or stands there twice, and of what a rig cannot hold: skew,
/// coefficients beyond `k3`, fisheye and other models. Refuses an image size that is unknown or not the stated one.
pub fn read(paths: &[&Path], stated: &Stated) -> Result<(CameraRig, Vec<String>)> {
    let texts: Vec<String> = paths.iter().map(|path| read_text(path)).collect::<Result<_>>()?;
    let texts: Vec<(&Path, &str)> =
        paths.iter().zip(&texts).map(|(path, text)| (*path, text.as_str())).collect();
    parse(&texts, stated)
}

/// Reads cameras from the texts of files; the paths are for messages and names.
///
/// # Errors
/// As [`read`].
pub fn parse(files: &[(&Path, &str)], stated: &Stated) -> Result<(CameraRig, Vec<String>)> {
    let Some((first, _)) = files.first() else {
        return Err(Error::new(Path::new("-"), "there is no file of cameras").fix("name one"));
    };
    let trees = files.iter().map(|(path, text)| storage::parse(path, text)).collect::<Result<Vec<_>>>()?;
    let roots: Vec<Field> =
        files.iter().zip(&trees).map(|((path, _), tree)| Field::root(path, tree)).collect();
    let mut reader = Reader { stated, warnings: Vec::new() };
    let cameras = reader.cameras(&roots, first)?;
    Ok((rig(first, cameras)?, reader.warnings))
}

/// The values of one or several maps by name, whatever its spelling.
struct Keys<'a> {
    owner: Field<'a>,
    fields: Vec<(String, Field<'a>)>,
}

impl<'a> Keys<'a> {
    fn of(owners: &[Field<'a>]) -> Option<Self> {
        let plain = |key: &str| key.replace(['_', '-'], "").to_ascii_lowercase();
        let fields = owners.iter().flat_map(Field::entries).map(|(key, field)| (plain(key), field));
        Some(Self { owner: owners.first()?.clone(), fields: fields.collect() })
    }

    /// The value that has one of these names with a suffix.
    fn find(&self, names: &[&str], suffix: &str) -> Result<Option<Field<'a>>> {
        let is_meant = |key: &str| key.strip_suffix(suffix).is_some_and(|key| names.contains(&key));
        let mut found = self.fields.iter().filter(|(key, _)| is_meant(key)).map(|(_, field)| field);
        match (found.next(), found.next()) {
            (Some(first), Some(second)) => {
                let what = format!("says the same thing as {} of {}", first.name, first.path().display());
                Err(second.refuse(what).fix("remove one of the two"))
            }
            (first, _) => Ok(first.cloned()),
        }
    }

    fn need(&self, names: &[&str], suffix: &str, name: &str, fix: &str) -> Result<Field<'a>> {
        let lacking = || self.owner.refuse(format!("lacks {name}{suffix}")).fix(fix);
        self.find(names, suffix)?.ok_or_else(lacking)
    }

    fn is_camera(&self) -> bool {
        self.fields.iter().any(|(key, _)| MATRIX.contains(&key.as_str()))
    }
}

type Named = (String, RigCamera);

struct Reader<'s> {
    stated: &'s Stated,
    warnings: Vec<String>,
}

impl Reader<'_> {
    fn cameras(&mut self, roots: &[Field], first: &Path) -> Result<Vec<Named>> {
        let Some(keys) = Keys::of(roots) else { return Ok(Vec::new()) };
        check_unit(keys.find(&["unit"], "")?, self.stated.unit)?;
        if keys.is_camera() {
            let stem = first.file_stem().map(|stem| stem.to_string_lossy().into_owned());
            return Ok(vec![self.camera(&keys, &stem.unwrap_or_default(), true)?]);
        }
        if keys.find(MATRIX, "1")?.is_some() {
            return self.stereo(&keys);
        }
        let mut owners = Vec::new();
        for (key, field) in &keys.fields {
            match key == "cameras" {
                // All that a list or map of this name holds must be cameras.
                true => owners.extend(
                    field.items().into_iter().chain(field.entries().into_iter().map(|(_, field)| field)),
                ),
                false if Keys::of(std::slice::from_ref(field)).is_some_and(|keys| keys.is_camera()) => {
                    owners.push(field.clone());
                }
                false => {}
            }
        }
        let alone = owners.len() == 1;
        let named = |owner: &Field| owner.name.rsplit('.').next().unwrap_or_default().to_string();
        owners
            .iter()
            .filter_map(|owner| Some((named(owner), Keys::of(std::slice::from_ref(owner))?)))
            .map(|(name, keys)| self.camera(&keys, &name, alone))
            .collect()
    }

    /// A camera of its own; `alone`: it needs no pose.
    fn camera(&mut self, keys: &Keys, name: &str, alone: bool) -> Result<Named> {
        let name = keys.find(NAME, "")?.map(|field| field.text()).transpose()?.unwrap_or(name).to_string();
        let pose = match (keys.find(ROTATION, "")?, keys.find(TRANSLATION, "")?) {
            (Some(turn), Some(shift)) => {
                Isometry3::from_parts(translation(&shift, self.stated.unit)?, rotation(&turn)?)
            }
            (None, None) if alone => {
                self.warnings.push(format!("camera {name} has no pose; it stands in the world's origin"));
                Isometry3::identity()
            }
            (turn, _) => {
                let lacking =
                    if turn.is_some() { "a translation (tvec or T)" } else { "a rotation (rvec or R)" };
                return Err(keys
                    .owner
                    .refuse(format!("camera {name} lacks {lacking}"))
                    .fix("write the camera's pose, world to camera, beside its intrinsics"));
            }
        };
        Ok((name, self.with_lens(keys, "", pose)?))
    }

    /// Camera 1 is the world's origin; x₂ = R x₁ + T.
    fn stereo(&mut self, keys: &Keys) -> Result<Vec<Named>> {
        let both = "give the file of the intrinsics and the file of the extrinsics together";
        let turn = rotation(&keys.need(ROTATION, "", "R", both)?)?;
        let shift = translation(&keys.need(TRANSLATION, "", "T", both)?, self.stated.unit)?;
        let second = Isometry3::from_parts(shift, turn);
        Ok(vec![
            ("1".to_string(), self.with_lens(keys, "1", Isometry3::identity())?),
            ("2".to_string(), self.with_lens(keys, "2", second)?),
        ])
    }

    fn with_lens(&mut self, keys: &Keys, suffix: &str, cam_from_world: Isometry3<f64>) -> Result<RigCamera> {
        refuse_other_models(keys)?;
        let zeros = "name it so; write zeros if the lens has none";
        let matrix = keys.need(MATRIX, suffix, "camera_matrix", "name it so, or K, or M1 and M2")?;
        let distortion = keys.need(DISTORTION, suffix, "distortion_coefficients", zeros)?;
        let image_size = image_size(&matrix, said_size(keys)?, self.stated.image_size)?;
        self.warn_of_fisheye(keys, &distortion)?;
        if let Some(poses) = keys.find(&["extrinsicparameters"], "")? {
            self.warnings.push(format!("{}: poses of the board, not of the camera; not kept", poses.name));
        }
        let rms_px = keys.find(RMS, "")?.map(|field| field.number()).transpose()?;
        let views = keys.find(VIEWS, "")?.map(|field| field.count()).transpose()?;
        let camera = Camera { image_size, lens: lens(&matrix, &distortion)?, cam_from_world };
        Ok(RigCamera { camera, rms_px, views: views.map(|views| views as usize), deviation: None })
    }

    /// OpenCV's fisheye calibrations have four coefficients, too, and often nothing that says so.
    fn warn_of_fisheye(&mut self, keys: &Keys, distortion: &Field) -> Result<()> {
        let says_model = keys.find(MODEL, "")?.is_some() || keys.find(FISHEYE, "")?.is_some();
        if distortion.table()?.numbers.len() == 4 && !says_model {
            self.warnings.push(format!(
                "{} has 4 coefficients, taken for k1, k2, p1, p2; make sure that they are not of OpenCV's fisheye model",
                distortion.name
            ));
        }
        Ok(())
    }
}

/// Fisheye, omnidirectional and whatever else is not Brown–Conrady.
fn refuse_other_models(keys: &Keys) -> Result<()> {
    let refuse = |field: &Field, model: &str| {
        let what = format!("is a {model}; cameras here are pinholes with k1, k2, p1, p2, k3");
        Err(field.refuse(what).fix("calibrate again with OpenCV's standard model"))
    };
    if let Some(field) = keys.find(FISHEYE, "")?
        && field.is_on()?
    {
        return refuse(&field, "fisheye model");
    }
    if let Some(field) = keys.find(&["xi"], "")? {
        return refuse(&field, "parameter of the omnidirectional model");
    }
    match keys.find(MODEL, "")? {
        Some(field) if !MODELS.contains(&field.text()?) => {
            refuse(&field, &format!("distortion model '{}'", field.text()?))
        }
        _ => Ok(()),
    }
}

fn said_size<'a>(keys: &Keys<'a>) -> Result<Option<(Field<'a>, [u32; 2])>> {
    if let Some(field) = keys.find(IMAGE_SIZE, "")? {
        let sides: Vec<u32> = match field.is_map() {
            true => {
                ["width", "height"].iter().map(|side| field.need(side)?.count()).collect::<Result<_>>()?
            }
            false => field.items().iter().map(Field::count).collect::<Result<_>>()?,
        };
        let [width, height] = sides[..] else {
            return Err(field.refuse("is not a width and a height"));
        };
        return Ok(Some((field, [width, height])));
    }
    match (keys.find(&["imagewidth"], "")?, keys.find(&["imageheight"], "")?) {
        (Some(width), Some(height)) => {
            let size = [width.count()?, height.count()?];
            Ok(Some((width, size)))
        }
        (Some(side), None) | (None, Some(side)) => Err(side.refuse("stands there without the other side")),
        (None, None) => Ok(None),
    }
}
