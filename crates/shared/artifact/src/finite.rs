//! What numbers must be: finite, since NaN would be written as `null` and come back as "missing"; and in range.

use crate::Violation;
use mesh::Mesh;

/// Refuses numbers that are not finite, naming the place.
///
/// # Errors
/// A [`Violation`] at `place` if any number is NaN or infinite.
pub fn finite<'a>(
    place: &str,
    numbers: impl IntoIterator<Item = &'a f64>,
) -> std::result::Result<(), Violation> {
    match numbers.into_iter().find(|number| !number.is_finite()) {
        Some(number) => Err(Violation::new(place, format!("{number} is not a finite number"))),
        None => Ok(()),
    }
}

/// Refuses a number outside a range.
pub(crate) fn within(
    place: &str,
    name: &str,
    value: f64,
    range: impl std::ops::RangeBounds<f64> + std::fmt::Debug,
) -> std::result::Result<(), Violation> {
    match range.contains(&value) {
        true => Ok(()),
        false => Err(Violation::new(place, format!("{name} {value} is not in {range:?}"))),
    }
}

/// How far the length of a direction may be from 1.
const UNIT_TOLERANCE: f64 = 1e-6;

/// Refuses a direction that has not length 1.
pub(crate) fn unit_vector(place: &str, name: &str, vector: &[f64]) -> std::result::Result<(), Violation> {
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    match (length - 1.0).abs() <= UNIT_TOLERANCE {
        true => Ok(()),
        false => Err(Violation::new(place, format!("{name} has length {length}, not 1"))),
    }
}

/// Refuses a mesh with a number that is not finite: every writer asks.
pub(crate) fn check_finite(mesh: &Mesh) -> std::result::Result<(), Violation> {
    let refuse = |place: String, what: &str| Err(Violation::new(place, format!("the {what} is not finite")));
    if let Some(vertex) = mesh.positions.iter().position(|point| point.iter().any(|x| !x.is_finite())) {
        return refuse(format!("vertex {vertex}"), "position");
    }
    if let Some(vertex) = mesh.colors.iter().position(|color| color.iter().any(|x| !x.is_finite())) {
        return refuse(format!("vertex {vertex}"), "colour");
    }
    match mesh.uvs.iter().position(|uv| uv.iter().any(|x| !x.is_finite())) {
        Some(uv) => refuse(format!("texture coordinate {uv}"), "value"),
        None => Ok(()),
    }
}
