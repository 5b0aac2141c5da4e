//! Cameras in COLMAP's text files, in and out: a folder with `cameras.txt` and `images.txt`.
//!
//! `cameras.txt` has a line per lens, `images.txt` two per image: its pose (a unit quaternion, scalar first, and t; world to
//! camera), its lens and its name; and points, which are passed over and written empty. Each image is a camera of the
//! rig, named as its file without the ending. In COLMAP (0.5, 0.5) is the centre of the top-left pixel, here it is (0, 0):
//! principal points are moved by half a pixel.

use super::Stated;
use super::calibration::{check_writable, refuse_beyond, rig};
use crate::source::read_text;
use crate::{CameraRig, Error, Result, RigCamera, Staged, Unit, stage_bytes};
use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector2, Vector3};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

const LENSES: &str = "cameras.txt";
const IMAGES: &str = "images.txt";
/// COLMAP's programs ask for it, even empty.
const POINTS: &str = "points3D.txt";
/// What COLMAP adds to pixel coordinates.
const PIXEL_SHIFT: f64 = 0.5;
/// How far a quaternion may be from length 1.
const UNIT_TOLERANCE: f64 = 1e-6;
/// Words in the first line of an image.
const IMAGE_WORDS: usize = 10;

/// Reads a folder with `cameras.txt` and `images.txt`; translations come out in mm. Also returns warnings.
///
/// Models: `SIMPLE_PINHOLE`, `PINHOLE`, `SIMPLE_RADIAL`, `RADIAL`, `OPENCV`, and `FULL_OPENCV` with `k4`, `k5`, `k6` zero.
///
/// # Errors
/// Names file and line of what is malformed, of another model, and of a name that stands there twice; refuses a stated
/// image size that is not the file's.
pub fn read(folder: &Path, stated: &Stated) -> Result<(CameraRig, Vec<String>)> {
    if folder.is_file() {
        return Err(Error::new(folder, "is a file; COLMAP's cameras are a folder").fix(format!(
            "name the folder that holds {LENSES} and {IMAGES}, as text (model_converter writes it)"
        )));
    }
    let text = |name: &str| read_text(&folder.join(name));
    parse(folder, &text(LENSES)?, &text(IMAGES)?, stated)
}

/// Reads cameras from the texts of `cameras.txt` and `images.txt`; `folder` is for messages.
///
/// # Errors
/// As [`read`].
pub fn parse(folder: &Path, lenses: &str, images: &str, stated: &Stated) -> Result<(CameraRig, Vec<String>)> {
    let path = folder.join(LENSES);
    let mut by_number = BTreeMap::new();
    for line in lines(&path, lenses).filter(|line| !line.is_passed_over()) {
        let (number, size, lens) = line.lens()?;
        if stated.image_size.is_some_and(|stated| stated != size) {
            return Err(line
                .refuse(format!("the image is {} × {} px, not the size that is stated", size[0], size[1])));
        }
        if by_number.insert(number, (size, lens)).is_some() {
            return Err(line.refuse(format!("camera {number} stands there twice")));
        }
    }
    let path = folder.join(IMAGES);
    let mut cameras = Vec::new();
    let mut lines = lines(&path, images);
    while let Some(line) = lines.next() {
        if line.is_passed_over() {
            continue;
        }
        let (name, number, cam_from_world) = line.image(stated.unit)?;
        let Some(&(image_size, lens)) = by_number.get(&number) else {
            return Err(line.refuse(format!("camera {number} is not in {LENSES}")));
        };
        // The points of the image: empty, or triples.
        if let Some(points) = lines.next().filter(|line| line.words().count() % 3 != 0) {
            return Err(points
                .refuse("is no list of points x, y, id")
                .fix("each image has two lines, of which the second may be empty, but must be there"));
        }
        cameras.push((name, RigCamera::from(Camera { image_size, lens, cam_from_world })));
    }
    Ok((rig(&path, cameras)?, Vec::new()))
}

/// A line of a file.
struct Line<'a> {
    path: &'a Path,
    number: usize,
    text: &'a str,
}

fn lines<'a>(path: &'a Path, text: &'a str) -> impl Iterator<Item = Line<'a>> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    text.lines().enumerate().map(move |(index, text)| Line { path, number: index + 1, text })
}

impl<'a> Line<'a> {
    fn refuse(&self, what: impl Into<String>) -> Error {
        Error::new(self.path, what).at(format!("line {}", self.number))
    }

    fn is_passed_over(&self) -> bool {
        self.text.trim().is_empty() || self.text.trim_start().starts_with('#')
    }

    fn words(&self) -> impl Iterator<Item = &'a str> + use<'a> {
        self.text.split_whitespace()
    }

    fn count(&self, word: &str) -> Result<u32> {
        word.parse().map_err(|_| self.refuse(format!("'{word}' is not a whole number")))
    }

    fn numbers(&self, words: &[&str]) -> Result<Vec<f64>> {
        let number = |word: &&str| match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            Ok(_) => Err(self.refuse(format!("'{word}' is not a finite number"))),
            Err(_) => Err(self.refuse(format!("'{word}' is not a number"))),
        };
        words.iter().map(number).collect()
    }

    /// `CAMERA_ID MODEL WIDTH HEIGHT PARAMS…`
    fn lens(&self) -> Result<(u32, [u32; 2], Lens)> {
        let words: Vec<&str> = self.words().collect();
        let [number, model, width, height, ref parameters @ ..] = words[..] else {
            return Err(self
                .refuse("is cut short: a number, a model, a width, a height and parameters were expected"));
        };
        let size = [self.count(width)?, self.count(height)?];
        let p = self.numbers(parameters)?;
        let counts = [
            ("SIMPLE_PINHOLE", 3),
            ("PINHOLE", 4),
            ("SIMPLE_RADIAL", 4),
            ("RADIAL", 5),
            ("OPENCV", 8),
            ("FULL_OPENCV", 12),
        ];
        let Some((_, count)) = counts.iter().find(|(known, _)| *known == model) else {
            let known: Vec<&str> = counts.iter().map(|(known, _)| *known).collect();
            return Err(self
                .refuse(format!("has the model {model}, which no camera here can hold"))
                .fix(format!("use one of {}", known.join(", "))));
        };
        if p.len() != *count {
            return Err(self.refuse(format!("has {} parameters; {model} has {count}", p.len())));
        }
        // [fx, fy, cx, cy] and OpenCV's coefficients.
        let (pinhole, coefficients) = match model {
            "SIMPLE_PINHOLE" | "SIMPLE_RADIAL" | "RADIAL" => ([p[0], p[0], p[1], p[2]], &p[3..]),
            _ => ([p[0], p[1], p[2], p[3]], &p[4..]),
        };
        refuse_beyond(coefficients, |what| self.refuse(what))?;
        let value = |index: usize| coefficients.get(index).copied().unwrap_or(0.0);
        let distortion =
            BrownConrady { k1: value(0), k2: value(1), p1: value(2), p2: value(3), k3: value(4) };
        let [fx, fy, cx, cy] = pinhole;
        let center_px = Vector2::new(cx, cy).add_scalar(-PIXEL_SHIFT);
        Ok((self.count(number)?, size, Lens { focal_px: Vector2::new(fx, fy), center_px, distortion }))
    }

    /// `IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME`: name, camera and pose.
    fn image(&self, unit: Unit) -> Result<(String, u32, Isometry3<f64>)> {
        let words: Vec<&str> = self.words().collect();
        if words.len() != IMAGE_WORDS {
            let what =
                format!("has {} words; an image has {IMAGE_WORDS}, and no blank in its name", words.len());
            return Err(self
                .refuse(what)
                .fix("each image has two lines, of which the second may be empty, but must be there"));
        }
        let numbers = self.numbers(&words[1..8])?;
        let turn = Quaternion::new(numbers[0], numbers[1], numbers[2], numbers[3]);
        if (turn.norm() - 1.0).abs() > UNIT_TOLERANCE {
            return Err(self.refuse(format!("its quaternion has length {}, not 1", turn.norm())));
        }
        let shift = Vector3::from_column_slice(&numbers[4..]) * unit.in_mm();
        let pose = Isometry3::from_parts(shift.into(), UnitQuaternion::new_normalize(turn));
        Ok((stem(words[9]).to_string(), self.count(words[8])?, pose))
    }
}

/// A file name without its ending; folders stay.
fn stem(name: &str) -> &str {
    match name.rsplit_once('.') {
        Some((stem, ending)) if !stem.is_empty() && !stem.ends_with('/') && !ending.contains('/') => stem,
        _ => name,
    }
}

/// Writes `cameras.txt`, `images.txt` (a camera `m1` is the image `m1.png`) and an empty `points3D.txt` into a folder, with
/// translations in `unit`. The model of each lens is the simplest that holds it: `PINHOLE`, `OPENCV` or, for `k3`,
/// `FULL_OPENCV`. Numbers are the shortest that read back to the same value. What is known about the cameras' quality, and
/// the take, is not kept.
///
/// # Errors
/// If the rig makes no sense, an id holds blanks or control characters, or a file cannot be written.
pub fn write(folder: &Path, rig: &CameraRig, unit: Unit) -> Result<Vec<Staged>> {
    check_writable(folder, rig)?;
    if let Some(id) = rig.cameras.keys().find(|id| id.contains(char::is_whitespace)) {
        return Err(Error::new(folder, "COLMAP's names hold no blanks")
            .at(format!("camera '{id}'"))
            .fix("give it a name without"));
    }
    let mut lenses = String::from("# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n");
    let mut images =
        String::from("# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, then a line of points (none)\n");
    for (index, (id, RigCamera { camera, .. })) in rig.cameras.iter().enumerate() {
        let number = index + 1;
        let q = camera.cam_from_world.rotation;
        let t = camera.cam_from_world.translation.vector / unit.in_mm();
        let pose = [q.w, q.i, q.j, q.k, t.x, t.y, t.z];
        // Writing to a text cannot fail.
        let _ = writeln!(lenses, "{number} {}", lens_line(camera));
        let _ = writeln!(images, "{number} {} {number} {id}.png\n", joined(&pose));
    }
    let points = "# POINT3D_ID X Y Z R G B ERROR TRACK[]: none\n";
    [(LENSES, lenses.as_str()), (IMAGES, &images), (POINTS, points)]
        .into_iter()
        .map(|(name, text)| stage_bytes(&folder.join(name), text.as_bytes()))
        .collect()
}

/// `MODEL WIDTH HEIGHT PARAMS…`
fn lens_line(camera: &Camera) -> String {
    let Camera { image_size: [width, height], lens, .. } = camera;
    let BrownConrady { k1, k2, p1, p2, k3 } = lens.distortion;
    let center = lens.center_px.add_scalar(PIXEL_SHIFT);
    let pinhole = [lens.focal_px.x, lens.focal_px.y, center.x, center.y];
    let (model, coefficients): (_, &[f64]) = match (lens.distortion == BrownConrady::default(), k3 == 0.0) {
        (true, _) => ("PINHOLE", &[]),
        (false, true) => ("OPENCV", &[k1, k2, p1, p2]),
        (false, false) => ("FULL_OPENCV", &[k1, k2, p1, p2, k3, 0.0, 0.0, 0.0]),
    };
    format!("{model} {width} {height} {}", joined(&[&pinhole, coefficients].concat()))
}

fn joined(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|number| format!("{number:?}")).collect();
    numbers.join(" ")
}
