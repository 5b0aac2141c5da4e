//! Writing OpenCV's `FileStorage`.

use crate::camera_file::calibration::check_writable;
use crate::source::ending;
use crate::{CameraRig, Error, Result, RigCamera, Sink, Staged, Unit};
use camera::Camera;
use std::io::Write;
use std::path::Path;

/// Writes cameras, as YAML or JSON by the file's ending: one camera's values at the top, several as a list `cameras`.
/// Translations are in `unit`, which the file says. The error and the number of images stand under OpenCV's names;
/// standard deviations and take are not kept. Numbers are the shortest that read back to the same value.
///
/// # Errors
/// If the ending is neither, the rig makes no sense, an id holds control characters, or the file cannot be written.
pub fn write(path: &Path, rig: &CameraRig, unit: Unit) -> Result<Staged> {
    check_writable(path, rig)?;
    let text = match ending(path).as_str() {
        "yml" | "yaml" => Form::Yaml.text(rig, unit),
        "json" => Form::Json.text(rig, unit),
        _ => {
            return Err(Error::new(path, "has an ending that is no form of OpenCV's files known here")
                .fix("use .yml, .yaml or .json"));
        }
    };
    let mut sink = Sink::create(path)?;
    sink.write_all(text.as_bytes()).map_err(|cause| sink.failed(&cause))?;
    sink.finish()
}

enum Written {
    Plain(String),
    Matrix([usize; 2], Vec<f64>),
}

/// What stands under a camera's name.
fn entries(id: &str, camera: &RigCamera, unit: Unit) -> Vec<(&'static str, Written)> {
    let RigCamera { camera: Camera { image_size, lens, cam_from_world }, rms_px, views, .. } = camera;
    let (focal, center, d) = (lens.focal_px, lens.center_px, lens.distortion);
    let matrix = vec![focal.x, 0.0, center.x, 0.0, focal.y, center.y, 0.0, 0.0, 1.0];
    let turn = cam_from_world.rotation.to_rotation_matrix().into_inner().transpose();
    let shift = cam_from_world.translation.vector / unit.in_mm();
    let quality = [
        ("avg_reprojection_error", rms_px.map(|rms| format!("{rms:?}"))),
        ("nframes", views.map(|views| views.to_string())),
    ];
    let quality = quality.into_iter().filter_map(|(key, value)| Some((key, Written::Plain(value?))));
    [
        ("name", Written::Plain(quoted(id))),
        ("image_width", Written::Plain(image_size[0].to_string())),
        ("image_height", Written::Plain(image_size[1].to_string())),
        ("camera_matrix", Written::Matrix([3, 3], matrix)),
        ("distortion_coefficients", Written::Matrix([1, 5], vec![d.k1, d.k2, d.p1, d.p2, d.k3])),
        ("R", Written::Matrix([3, 3], turn.add_scalar(0.0).as_slice().to_vec())),
        ("T", Written::Matrix([3, 1], shift.as_slice().to_vec())),
    ]
    .into_iter()
    .chain(quality)
    .collect()
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[derive(Clone, Copy, PartialEq)]
enum Form {
    Yaml,
    Json,
}

impl Form {
    fn text(self, rig: &CameraRig, unit: Unit) -> String {
        let cameras: Vec<_> = rig.cameras.iter().map(|(id, camera)| entries(id, camera, unit)).collect();
        let yaml = self == Self::Yaml;
        let mut text = if yaml {
            format!("%YAML:1.0\n---\nunit: {unit}\n")
        } else {
            format!("{{\n    \"unit\": \"{unit}\",\n")
        };
        match (&cameras[..], yaml) {
            ([only], true) => text += &self.lines(only, 0),
            ([only], false) => text += &format!("{}\n", self.lines(only, 4)),
            (several, true) => {
                text += "cameras:\n";
                several.iter().for_each(|camera| text += &format!("   -\n{}", self.lines(camera, 6)));
            }
            (several, false) => {
                let several = several
                    .iter()
                    .map(|camera| format!("        {{\n{}\n        }}", self.lines(camera, 12)));
                text += &format!("    \"cameras\": [\n{}\n    ]\n", several.collect::<Vec<_>>().join(",\n"));
            }
        }
        if yaml { text } else { text + "}\n" }
    }

    fn lines(self, entries: &[(&str, Written)], indent: usize) -> String {
        let pad = " ".repeat(indent);
        let line = |(key, value): &(&str, Written)| match (self, value) {
            (Self::Yaml, Written::Plain(value)) => format!("{pad}{key}: {value}\n"),
            (Self::Json, Written::Plain(value)) => format!("{pad}\"{key}\": {value}"),
            (Self::Yaml, Written::Matrix([rows, columns], numbers)) => format!(
                "{pad}{key}: !!opencv-matrix\n{pad}   rows: {rows}\n{pad}   cols: {columns}\n{pad}   dt: d\n\
                 {pad}   data: {}\n",
                listed(numbers)
            ),
            (Self::Json, Written::Matrix([rows, columns], numbers)) => format!(
                "{pad}\"{key}\": {{ \"type_id\": \"opencv-matrix\", \"rows\": {rows}, \"cols\": {columns}, \
                 \"dt\": \"d\",\n{pad}    \"data\": {} }}",
                listed(numbers)
            ),
        };
        let lines: Vec<String> = entries.iter().map(line).collect();
        lines.join(if self == Self::Yaml { "" } else { ",\n" })
    }
}

fn listed(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
    format!("[ {} ]", numbers.join(", "))
}
