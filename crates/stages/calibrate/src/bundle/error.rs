//! Scenes that cannot be adjusted.

use super::{Element, Scene};
use std::collections::BTreeSet;

/// Why a scene cannot be adjusted; indices are those of the scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// Nothing is seen.
    #[error("there are no observations")]
    Empty,
    /// An index points nowhere.
    #[error("observation {0} names a camera, an element or a point that the scene does not have")]
    OutOfRange(usize),
    /// `free` and `cameras` differ in length.
    #[error("{cameras} cameras, but {free} statements of what is free")]
    Uneven {
        /// How many cameras there are.
        cameras: usize,
        /// How many statements.
        free: usize,
    },
    /// An element is seen too little to have a place: a point by one camera, a body at fewer than three points.
    #[error("element {0} is seen too little to have a place")]
    Thin(usize),
    /// A point is not in front of a camera that sees it.
    #[error("element {element} is not in front of camera {camera}, which sees it")]
    Behind {
        /// The camera.
        camera: usize,
        /// The element.
        element: usize,
    },
}

/// Refuses what cannot be adjusted.
pub(super) fn check(scene: &Scene, structure_moves: bool) -> Result<(), Error> {
    if scene.cameras.len() != scene.free.len() {
        return Err(Error::Uneven { cameras: scene.cameras.len(), free: scene.free.len() });
    }
    if scene.observations.is_empty() {
        return Err(Error::Empty);
    }
    let mut cameras = vec![BTreeSet::new(); scene.structure.len()];
    let mut points = cameras.clone();
    for (o, seen) in scene.observations.iter().enumerate() {
        let known = match scene.structure.get(seen.element) {
            Some(Element::Point(_)) => true,
            Some(Element::Body { .. }) => seen.point < scene.body.len(),
            None => false,
        };
        if !known || seen.camera >= scene.cameras.len() {
            return Err(Error::OutOfRange(o));
        }
        cameras[seen.element].insert(seen.camera);
        points[seen.element].insert(seen.point);
    }
    let is_thin = |e: &usize| match scene.structure[*e] {
        _ if cameras[*e].is_empty() => false,
        Element::Point(_) => cameras[*e].len() < 2,
        Element::Body { .. } => points[*e].len() < 3,
    };
    match (0..scene.structure.len()).find(is_thin) {
        Some(element) if structure_moves => Err(Error::Thin(element)),
        _ => Ok(()),
    }
}

/// The first observation of a point that is not in front of its camera.
pub(super) fn behind(scene: &Scene) -> Error {
    match scene.observations.iter().find(|seen| scene.residual(seen).is_none()) {
        Some(seen) => Error::Behind { camera: seen.camera, element: seen.element },
        None => Error::Empty,
    }
}
