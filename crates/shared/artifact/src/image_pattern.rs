//! Names of numbered image files: a pattern such as `m1/{frame:06}.png`, filled with a number.

use crate::Violation;

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
pub(crate) fn check_pattern(place: &str, pattern: &str) -> Result<(), Violation> {
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
