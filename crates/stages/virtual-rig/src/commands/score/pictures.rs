//! Pictures: masks of paint, and normals in camera space. One is in memory at a time.

use super::comparison::Comparison;
use anyhow::bail;
use artifact::picture::{self, Rgb};
use artifact::{CameraRig, image_numbers, image_path, read_document};
use nalgebra::Vector3;
use std::path::{Path, PathBuf};
use virtual_rig::score::{self, MaskPair, Metric, NormalField, ScoreError};

/// Where pictures lie below a folder.
const BELOW: &str = "{camera}/{frame:06}.png";

/// A picture of the truth, and where that of the result would be.
struct Pair {
    /// Camera and frame, for messages.
    place: String,
    truth: PathBuf,
    result: PathBuf,
}

/// Compares masks with the true coverage.
pub(super) fn masks(comparison: &mut Comparison) -> anyhow::Result<Vec<Metric>> {
    let pairs = pairs(comparison, "paint")?;
    let mut progress = comparison.run.progress("comparing", Some(pairs.len() as u64));
    let read = |pair: Pair| -> anyhow::Result<MaskPair> {
        progress.step();
        let (truth, result) = read_pair(comparison, &pair, picture::read_gray)?;
        Ok(MaskPair { place: pair.place, truth, result })
    };
    score::masks(pairs.into_iter().map(read))
}

/// Compares normals in camera space with the true ones, n = 2 c − 1.
pub(super) fn normals(comparison: &mut Comparison) -> anyhow::Result<Vec<Metric>> {
    let pairs = pairs(comparison, "normals")?;
    let mut progress = comparison.run.progress("comparing", Some(pairs.len() as u64));
    let read = |pair: Pair| -> anyhow::Result<NormalField> {
        progress.step();
        let (truth, result) = read_pair(comparison, &pair, picture::read_rgb)?;
        field(pair.place, &truth, result.as_ref())
    };
    score::normal_fields(pairs.into_iter().map(read))
}

/// The normals of all pixels where the truth has skin.
fn field(place: String, truth: &Rgb, result: Option<&Rgb>) -> anyhow::Result<NormalField> {
    let size = |picture: &Rgb| format!("{} × {} px", picture.width, picture.height);
    if let Some(result) = result.filter(|result| size(result) != size(truth)) {
        let place = format!("{place}, image size");
        return Err(ScoreError::Differs { place, truth: size(truth), result: size(result) }.into());
    }
    let pixels = (0..truth.height).flat_map(|row| (0..truth.width).map(move |column| (column, row)));
    let skin: Vec<(usize, usize)> = pixels.filter(|&(column, row)| truth.at(column, row) != BLACK).collect();
    let normals = |picture: &Rgb| skin.iter().map(|&(column, row)| normal(picture.at(column, row))).collect();
    Ok(NormalField { place, truth: normals(truth), result: result.map(normals) })
}

/// Where there is no skin.
const BLACK: [f64; 3] = [0.0; 3];

fn normal(code: [f64; 3]) -> Vector3<f64> {
    match code == BLACK {
        true => Vector3::zeros(),
        false => Vector3::from(code.map(|c| 2.0 * c - 1.0)),
    }
}

fn read_pair<T>(
    comparison: &mut Comparison,
    pair: &Pair,
    read: fn(&Path) -> artifact::Result<T>,
) -> anyhow::Result<(T, Option<T>)> {
    comparison.run.input(&format!("truth {}", pair.place), &pair.truth)?;
    let truth = read(&pair.truth)?;
    if !pair.result.is_file() {
        return Ok((truth, None));
    }
    comparison.run.input(&format!("result {}", pair.place), &pair.result)?;
    Ok((truth, Some(read(&pair.result)?)))
}

/// Every picture that the truth has in a folder of its own, and where the result's would be.
fn pairs(comparison: &mut Comparison, name: &str) -> anyhow::Result<Vec<Pair>> {
    let is_pattern = comparison.result.to_string_lossy().contains("{frame");
    if !is_pattern && !comparison.result.exists() {
        bail!(
            "{}: is not there\n  to do: check the path; the stage may not have run",
            comparison.result.display()
        );
    }
    match (comparison.against, comparison.result.is_file()) {
        (Some(truth), true) => single(comparison.result, truth),
        (Some(_), false) => bail!("--against: RESULT is not a single picture\n  to do: leave --against out"),
        (None, true) => bail!(
            "{}: is a single picture\n  to do: say --against with the picture of {} that it should be, or give the folder of all",
            comparison.result.display(),
            comparison.truth.path(name).display()
        ),
        (None, false) if is_pattern => all(comparison, name, comparison.result),
        (None, false) => all(comparison, name, &comparison.result.join(BELOW)),
    }
}

fn single(result: &Path, truth: &Path) -> anyhow::Result<Vec<Pair>> {
    let place = artifact::file_name(truth);
    Ok(vec![Pair { place, truth: truth.to_path_buf(), result: result.to_path_buf() }])
}

fn all(comparison: &mut Comparison, name: &str, pattern: &Path) -> anyhow::Result<Vec<Pair>> {
    let folder = comparison.truth.path(name);
    let rig: CameraRig = read_document(&comparison.truth.file("cameras.json")?)?;
    let (mut pairs, mut numbers, mut extra, mut cameras) = (Vec::new(), Vec::new(), Vec::new(), 0);
    for camera in rig.cameras.keys() {
        let truth = folder.join(camera).join("{frame:06}.png");
        let result = with_camera(pattern, camera);
        let true_numbers = image_numbers(&truth)?;
        cameras += usize::from(!true_numbers.is_empty());
        for number in image_numbers(&result)? {
            if comparison.frames.contains(number) && true_numbers.binary_search(&number).is_err() {
                extra.push(numbered(&result, number));
            }
        }
        numbers.extend(&true_numbers);
        let counted = true_numbers.into_iter().filter(|&number| comparison.frames.contains(number));
        pairs.extend(counted.map(|number| Pair {
            place: format!("{camera}, frame {number}"),
            truth: numbered(&truth, number),
            result: numbered(&result, number),
        }));
    }
    if numbers.is_empty() {
        return Err(comparison.truth.missing(&folder, name));
    }
    if cameras > 1 && with_camera(pattern, "") == pattern {
        bail!(
            "{}: names one picture for {cameras} cameras\n  to do: say {{camera}} where its id stands",
            pattern.display()
        );
    }
    numbers.sort_unstable();
    comparison.check_frames(&folder, &numbers)?;
    check_found(comparison, &pairs, &extra)?;
    Ok(pairs)
}

/// Refuses a result without any of the pictures, and warns of pictures that nothing can be said of.
fn check_found(comparison: &mut Comparison, pairs: &[Pair], extra: &[PathBuf]) -> anyhow::Result<()> {
    if let Some(first) = pairs.first().filter(|_| !pairs.iter().any(|pair| pair.result.is_file())) {
        bail!(
            "{}: holds no picture of this take\n  to do: pictures lie as {}; or give a pattern with {{camera}} and {{frame:06}}",
            comparison.result.display(),
            first.result.display()
        );
    }
    if let Some(first) = extra.first() {
        comparison.run.warn(format!(
            "pictures without truth are not scored: {}, e.g. {}",
            extra.len(),
            first.display()
        ));
    }
    Ok(())
}

fn with_camera(pattern: &Path, camera: &str) -> PathBuf {
    PathBuf::from(pattern.to_string_lossy().replace("{camera}", camera))
}

fn numbered(pattern: &Path, number: i64) -> PathBuf {
    PathBuf::from(image_path(&pattern.to_string_lossy(), number))
}
