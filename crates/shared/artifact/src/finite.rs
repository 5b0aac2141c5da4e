//! Numbers must be finite: NaN would be written as `null` and come back as "missing".

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
