//! From the numbers of a file to a camera: what all formats say in the same way, and what none of ours can hold.

use super::tree::{Field, Table};
use crate::cameras::nearest_rotation;
use crate::{CameraRig, Error, Result, RigCamera, Unit};
use camera::{BrownConrady, Lens};
use nalgebra::{Matrix3, Translation3, UnitQuaternion, Vector2, Vector3};
use std::collections::BTreeMap;
use std::path::Path;

/// Names of OpenCV's distortion coefficients, in their order.
const COEFFICIENTS: [&str; 14] =
    ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6", "s1", "s2", "s3", "s4", "tau_x", "tau_y"];
/// Those that the lens has.
const KEPT: usize = 5;

/// Intrinsics from the matrix [fx 0 cx; 0 fy cy; 0 0 1] and OpenCV's coefficients.
pub(super) fn lens(matrix: &Field, distortion: &Field) -> Result<Lens> {
    let Table { shape, numbers: m } = matrix.table()?;
    if shape != [3, 3] {
        return Err(matrix.refuse(format!("is {} × {}, not 3 × 3", shape[0], shape[1])));
    }
    if m[1] != 0.0 {
        let what = format!("has the skew {}, which no camera here can hold", m[1]);
        return Err(matrix.refuse(what).fix("calibrate again without skew"));
    }
    if [m[3], m[6], m[7], m[8] - 1.0] != [0.0; 4] {
        let what = format!("is no camera matrix: its rows end {:?} and {:?}", &m[3..4], &m[6..9]);
        return Err(matrix.refuse(what).fix("it must be [fx 0 cx; 0 fy cy; 0 0 1]"));
    }
    let distortion = brown_conrady(distortion)?;
    Ok(Lens { focal_px: Vector2::new(m[0], m[4]), center_px: Vector2::new(m[2], m[5]), distortion })
}

fn brown_conrady(field: &Field) -> Result<BrownConrady> {
    let Table { shape, numbers } = field.table()?;
    if !shape.contains(&1) && !numbers.is_empty() || ![0, 4, 5, 8, 12, 14].contains(&numbers.len()) {
        let what =
            format!("has {} × {} coefficients; OpenCV's model has 4, 5, 8, 12 or 14", shape[0], shape[1]);
        return Err(field.refuse(what));
    }
    refuse_beyond(&numbers, |what| field.refuse(what))?;
    let value = |index: usize| numbers.get(index).copied().unwrap_or(0.0);
    Ok(BrownConrady { k1: value(0), k2: value(1), p1: value(2), p2: value(3), k3: value(4) })
}

/// Refuses coefficients beyond the first five that are not 0, by name.
pub(super) fn refuse_beyond(coefficients: &[f64], refuse: impl Fn(String) -> Error) -> Result<()> {
    let named = COEFFICIENTS.iter().zip(coefficients).skip(KEPT).filter(|(_, value)| **value != 0.0);
    let beyond: Vec<String> = named.map(|(name, value)| format!("{name} = {value}")).collect();
    match beyond.is_empty() {
        true => Ok(()),
        false => {
            let what =
                format!("the lens has {}; cameras here hold k1, k2, p1, p2, k3 only", beyond.join(", "));
            Err(refuse(what)
                .fix("calibrate again with five coefficients (no rational, thin prism or tilted model)"))
        }
    }
}

/// A rotation: 3 × 3, or its axis times its angle in radians.
pub(super) fn rotation(field: &Field) -> Result<UnitQuaternion<f64>> {
    let Table { shape, numbers } = field.table()?;
    match shape {
        [3, 3] => nearest_rotation(Matrix3::from_row_slice(&numbers)).map_err(|what| field.refuse(what)),
        [3, 1] | [1, 3] => Ok(UnitQuaternion::from_scaled_axis(Vector3::from_column_slice(&numbers))),
        [rows, columns] => {
            Err(field.refuse(format!("is {rows} × {columns}; a rotation is 3 × 3, or three numbers")))
        }
    }
}

/// A translation, mm.
pub(super) fn translation(field: &Field, unit: Unit) -> Result<Translation3<f64>> {
    let Table { shape, numbers } = field.table()?;
    match shape {
        [3, 1] | [1, 3] => Ok((Vector3::from_column_slice(&numbers) * unit.in_mm()).into()),
        [rows, columns] => {
            Err(field.refuse(format!("is {rows} × {columns}; a translation is three numbers")))
        }
    }
}

/// An image size, px; the one that the file says and the one that is stated must agree.
pub(super) fn image_size(
    camera: &Field,
    said: Option<(Field, [u32; 2])>,
    stated: Option<[u32; 2]>,
) -> Result<[u32; 2]> {
    match (said, stated) {
        (Some((place, said)), Some(stated)) if said != stated => {
            let what = format!(
                "the image is {} × {} px, but {} × {} is stated",
                said[0], said[1], stated[0], stated[1]
            );
            Err(place.refuse(what).fix("state no size, or the file's own"))
        }
        (Some((_, said)), _) => Ok(said),
        (None, Some(stated)) => Ok(stated),
        (None, None) => Err(camera
            .refuse("does not say how large the images are")
            .fix("state it: WIDTHxHEIGHT in pixels")),
    }
}

/// A unit that a file says of itself must be the stated one.
pub(super) fn check_unit(said: Option<Field>, stated: Unit) -> Result<()> {
    let Some(field) = said else { return Ok(()) };
    let unit: Unit = field.text()?.parse().map_err(|what: String| field.refuse(what))?;
    match unit == stated {
        true => Ok(()),
        false => {
            Err(field.refuse(format!("is in {unit}, but {stated} is stated")).fix("state the file's unit"))
        }
    }
}

/// A rig of named cameras, checked.
pub(super) fn rig(path: &Path, cameras: Vec<(String, RigCamera)>) -> Result<CameraRig> {
    let mut by_id = BTreeMap::new();
    for (id, camera) in cameras {
        if by_id.insert(id.clone(), camera).is_some() {
            return Err(Error::new(path, "two cameras have this name")
                .at(format!("camera {id}"))
                .fix("give each a name of its own"));
        }
    }
    if by_id.is_empty() {
        return Err(Error::new(path, "holds no cameras").fix("check that this is the right file"));
    }
    let rig = CameraRig { cameras: by_id, take: None };
    crate::Document::check(&rig).map_err(|violation| violation.in_file(path))?;
    Ok(rig)
}

/// A rig that a format of others is asked to hold: its numbers must make sense, its ids be printable.
pub(super) fn check_writable(path: &Path, rig: &CameraRig) -> Result<()> {
    crate::Document::check(rig).map_err(|violation| violation.in_file(path))?;
    if rig.cameras.is_empty() {
        return Err(Error::new(path, "there are no cameras to write"));
    }
    match rig.cameras.keys().find(|id| id.contains(char::is_control)) {
        Some(id) => Err(Error::new(path, "the id holds a control character")
            .at(format!("camera '{}'", id.escape_debug()))
            .fix("give it a printable name")),
        None => Ok(()),
    }
}
