//! Names of numbered image files: a pattern such as `m1/{frame:06}.png`, filled with a number.

use crate::{Error, Result, Violation};
use std::path::Path;

/// A pattern taken apart: what stands before and after the number, and how many digits it has at least.
fn parts(pattern: &str) -> Option<(&str, usize, &str)> {
    let (before, rest) = pattern.split_once("{frame")?;
    let (width, after) = rest.split_once('}')?;
    let width = match width.strip_prefix(":0") {
        Some(digits) => digits.parse().ok().filter(|width| (1..=MOST_DIGITS).contains(width))?,
        None if width.is_empty() => 1,
        None => return None,
    };
    (!before.contains(['{', '}']) && !after.contains(['{', '}'])).then_some((before, width, after))
}

/// No frame number has more.
const MOST_DIGITS: usize = 20;

/// Refuses a pattern that has not exactly one place for the number.
pub(crate) fn check_pattern(place: &str, pattern: &str) -> std::result::Result<(), Violation> {
    match parts(pattern) {
        Some(_) => Ok(()),
        None => {
            let what = format!("'{pattern}' has not one {{frame}} or {{frame:06}} where the number stands");
            Err(Violation::new(place, what))
        }
    }
}

/// The path of an image, by a pattern of a sound artifact: `{frame}` is its number, `{frame:06}` its number with zeros
/// before it to six digits.
#[must_use]
pub fn image_path(pattern: &str, number: i64) -> String {
    match parts(pattern) {
        Some((before, width, after)) => {
            let sign = if number < 0 { "-" } else { "" };
            format!("{before}{sign}{:0width$}{after}", number.unsigned_abs())
        }
        None => pattern.to_string(),
    }
}

/// The numbers of the images that lie where a pattern says, rising; none where its folder is not there. The number stands in
/// the file's name, not in a folder's.
///
/// # Errors
/// If the name has no place for the number, or the folder cannot be read.
pub fn image_numbers(pattern: &Path) -> Result<Vec<i64>> {
    let name = pattern.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let Some((before, _, after)) = parts(&name) else {
        return Err(Error::new(pattern, "the file's name has not one {frame} or {frame:06} in it"));
    };
    let folder = pattern.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let fail = |cause: std::io::Error| Error::io(folder, "read the folder", &cause);
    let mut numbers = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let file = entry.map_err(fail)?.file_name().to_string_lossy().into_owned();
        let digits = file.strip_prefix(before).and_then(|rest| rest.strip_suffix(after));
        let number = digits.and_then(|digits| digits.parse().ok());
        numbers.extend(number.filter(|&number| image_path(&name, number) == file));
    }
    numbers.sort_unstable();
    Ok(numbers)
}

/// The names of a folder's sub-folders, in order; hidden ones are left out.
///
/// # Errors
/// If the folder cannot be read.
pub fn subfolders(folder: &Path) -> Result<Vec<String>> {
    names(folder, Path::is_dir)
}

/// The names of a folder's files, in order; hidden ones are left out.
///
/// # Errors
/// If the folder cannot be read.
pub fn files(folder: &Path) -> Result<Vec<String>> {
    names(folder, Path::is_file)
}

fn names(folder: &Path, is_wanted: impl Fn(&Path) -> bool) -> Result<Vec<String>> {
    let fail = |cause: std::io::Error| Error::io(folder, "read the folder", &cause);
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if is_wanted(&entry.path()) && !name.starts_with('.') {
            names.push(name);
        }
    }
    names.sort_unstable();
    Ok(names)
}
