//! Cameras as TOML, in and out: aniposelib's and Pose2Sim's form, and Caliscope's.
//!
//! A table per camera with `name`, `size`, `matrix`, `distortions` (OpenCV's order), `rotation` (world to camera, axis times
//! angle; Caliscope: 3 × 3) and `translation`. Caliscope's tables stand within `cameras`, with an `error` and the number of
//! boards. OpenCV's model: pixel (0, 0) is the centre of the top-left pixel.

use super::Stated;
use super::calibration::{check_unit, check_writable, image_size, lens, rig, rotation, translation};
use super::tree::{Field, Node, Value};
use crate::source::read_text;
use crate::{CameraRig, Error, Result, RigCamera, Sink, Staged, Unit};
use camera::Camera;
use nalgebra::Isometry3;
use std::io::Write;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

/// The table that is no camera.
const METADATA: &str = "metadata";
/// What only cameras have.
const OF_CAMERAS: [&str; 4] = ["matrix", "distortions", "rotation", "translation"];

/// Reads cameras; translations come out in mm. Also returns warnings.
///
/// A camera is named by `name`, or `cam_` and `cam_id` (the names of Caliscope's videos), or else by its table. Cameras
/// that Caliscope was told to ignore are left out, with a warning.
///
/// # Errors
/// Names line and key of what is missing or malformed, and of what a rig cannot hold: skew, coefficients beyond `k3`,
/// fisheye models. Refuses an image size that is unknown or not the stated one.
pub fn read(path: &Path, stated: &Stated) -> Result<(CameraRig, Vec<String>)> {
    parse(path, &read_text(path)?, stated)
}

/// Reads cameras from the text of a file; `path` is for messages.
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, text: &str, stated: &Stated) -> Result<(CameraRig, Vec<String>)> {
    let tree = tree(path, text.strip_prefix('\u{feff}').unwrap_or(text))?;
    let root = Field::root(path, &tree);
    check_unit(root.find(METADATA).and_then(|metadata| metadata.find("unit")), stated.unit)?;
    let tables = root.find("cameras").unwrap_or(root).entries();
    let (mut cameras, mut warnings) = (Vec::new(), Vec::new());
    for (key, table) in tables.into_iter().filter(|(key, table)| *key != METADATA && table.is_map()) {
        let name = name(key, &table)?;
        if table.find("ignore").map(|field| field.is_on()).transpose()? == Some(true) {
            warnings.push(format!("camera {name} is marked to be ignored; left out"));
        } else if OF_CAMERAS.iter().any(|key| table.find(key).is_some()) {
            cameras.push((name, camera(&table, stated)?));
        } else {
            warnings.push(format!("table {} is no camera; passed over", table.name));
        }
    }
    Ok((rig(path, cameras)?, warnings))
}

fn name(key: &str, table: &Field) -> Result<String> {
    match (table.find("name"), table.find("cam_id").or_else(|| table.find("port"))) {
        (Some(name), _) => Ok(name.text()?.to_string()),
        (None, Some(number)) => Ok(format!("cam_{}", number.text()?)),
        (None, None) => Ok(key.to_string()),
    }
}

fn camera(table: &Field, stated: &Stated) -> Result<RigCamera> {
    if let Some(fisheye) = table.find("fisheye")
        && fisheye.is_on()?
    {
        return Err(fisheye
            .refuse("the camera has a fisheye lens; cameras here are pinholes with k1, k2, p1, p2, k3")
            .fix("calibrate again without fisheye, or crop the images"));
    }
    let said = table.find("size").map(|size| {
        let sides = size.items().iter().map(Field::count).collect::<Result<Vec<u32>>>()?;
        match sides[..] {
            [width, height] => Ok((size, [width, height])),
            _ => Err(size.refuse("is not a width and a height")),
        }
    });
    let image_size = image_size(table, said.transpose()?, stated.image_size)?;
    let lens = lens(&table.need("matrix")?, &table.need("distortions")?)?;
    let turn = rotation(&table.need("rotation")?)?;
    let shift = translation(&table.need("translation")?, stated.unit)?;
    let cam_from_world = Isometry3::from_parts(shift, turn);
    let rms_px = table.find("error").map(|error| error.number()).transpose()?;
    let views = table.find("grid_count").map(|count| count.count()).transpose()?;
    let camera = Camera { image_size, lens, cam_from_world };
    Ok(RigCamera { camera, rms_px, views: views.map(|views| views as usize), deviation: None })
}

/// The tree of a TOML text.
fn tree(path: &Path, text: &str) -> Result<Node> {
    let line = |at: usize| text[..at].matches('\n').count() + 1;
    let table = DeTable::parse(text).map_err(|error| {
        let said = Error::new(path, format!("is not TOML: {}", error.message()));
        match error.span() {
            Some(span) => said.at(format!("line {}", line(span.start))),
            None => said,
        }
    })?;
    Ok(Node { line: 1, value: map(table.get_ref(), &line) })
}

/// A map whose values stand in the lines of their keys.
fn map(table: &DeTable, line: &impl Fn(usize) -> usize) -> Value {
    let entry = |(key, value): (&Spanned<DeString>, &Spanned<DeValue>)| {
        let key_line = line(key.span().start);
        (key.get_ref().to_string(), Node { line: key_line, value: node(value, line).value })
    };
    Value::Map(table.iter().map(entry).collect())
}

fn node(value: &Spanned<DeValue>, line: &impl Fn(usize) -> usize) -> Node {
    let read = match value.get_ref() {
        DeValue::String(text) => Value::Scalar(text.to_string()),
        DeValue::Integer(number) => Value::Scalar(number.to_string()),
        DeValue::Float(number) => Value::Scalar(number.to_string()),
        DeValue::Boolean(switch) => Value::Scalar(switch.to_string()),
        DeValue::Datetime(time) => Value::Scalar(time.to_string()),
        DeValue::Array(items) => Value::List(items.iter().map(|item| node(item, line)).collect()),
        DeValue::Table(table) => map(table, line),
    };
    Node { line: line(value.span().start), value: read }
}

/// Writes cameras in aniposelib's and Pose2Sim's form, tables in the order of ids, with translations in `unit`, which
/// `metadata` says. Numbers are the shortest that read back to the same value. What is known about the cameras' quality, and
/// the take, is not kept.
///
/// # Errors
/// If the rig makes no sense, an id holds control characters, or the file cannot be written.
pub fn write(path: &Path, rig: &CameraRig, unit: Unit) -> Result<Staged> {
    check_writable(path, rig)?;
    let mut sink = Sink::create(path)?;
    write_text(&mut sink, rig, unit).map_err(|cause| Error::io(path, "write", &cause))?;
    sink.finish()
}

fn write_text(out: &mut impl Write, rig: &CameraRig, unit: Unit) -> std::io::Result<()> {
    // aniposelib sorts tables by name, so their numbers are padded.
    let width = rig.cameras.len().saturating_sub(1).to_string().len();
    for (number, (id, RigCamera { camera, .. })) in rig.cameras.iter().enumerate() {
        let Camera { image_size, lens, cam_from_world } = camera;
        let (focal, center, d) = (lens.focal_px, lens.center_px, lens.distortion);
        let name = id.replace('\\', "\\\\").replace('"', "\\\"");
        // + 0.0: no number is -0.0.
        let turn: [f64; 3] = cam_from_world.rotation.scaled_axis().add_scalar(0.0).into();
        let shift: [f64; 3] = (cam_from_world.translation.vector / unit.in_mm()).into();
        writeln!(out, "[cam_{number:0width$}]\nname = \"{name}\"\nsize = {image_size:?}")?;
        writeln!(
            out,
            "matrix = [[{:?}, 0.0, {:?}], [0.0, {:?}, {:?}], [0.0, 0.0, 1.0]]",
            focal.x, center.x, focal.y, center.y
        )?;
        writeln!(out, "distortions = {:?}", [d.k1, d.k2, d.p1, d.p2, d.k3])?;
        writeln!(out, "rotation = {turn:?}\ntranslation = {shift:?}\nfisheye = false\n")?;
    }
    writeln!(out, "[{METADATA}]\nadjusted = false\nunit = \"{unit}\"")
}
