//! Numbers on the command line.

use calibrate::FEWEST_CORNERS;

/// A number from 0 on.
pub(super) fn from_zero(text: &str) -> Result<f64, String> {
    number(text).filter(|number| *number >= 0.0).ok_or_else(|| format!("'{text}' is not a number from 0 on"))
}

/// A number above 0.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    number(text).filter(|number| *number > 0.0).ok_or_else(|| format!("'{text}' is not a number above 0"))
}

/// A share, from 0 to 1.
pub(super) fn share(text: &str) -> Result<f64, String> {
    let share = number(text).filter(|number| (0.0..=1.0).contains(number));
    share.ok_or_else(|| format!("'{text}' is not a share from 0 to 1"))
}

/// Corners of a view: as many as fix a board's pose.
pub(super) fn corners(text: &str) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| *count >= FEWEST_CORNERS);
    count.ok_or_else(|| format!("'{text}' corners do not fix a board's pose; {FEWEST_CORNERS} do"))
}

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}
