//! What is edited: the sections and curves of a frame together, and what their headers say.

use artifact::{Curve2d, PerCamera, Profile, Section, Wrinkle};

/// A frame of `sections`, of `wrinkles-2d`, or of both.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// Absolute frame number.
    pub frame: i64,
    /// Per camera and wrinkle its sections; none where only curves are known.
    pub sections: Option<PerCamera<Vec<Section>>>,
    /// Per camera and wrinkle its curve; none where only sections are known.
    pub curves: Option<PerCamera<Curve2d>>,
}

/// What holds for all frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Head {
    /// Camera ids.
    pub cameras: Vec<String>,
    /// The wrinkles.
    pub wrinkles: Vec<Wrinkle>,
    /// The family of profiles of the sections.
    pub profile: Profile,
}

impl Moment {
    /// Whether a camera has an image of the frame.
    pub(crate) fn has(&self, camera: &str) -> bool {
        self.sections.as_ref().is_some_and(|all| all.contains_key(camera))
            || self.curves.as_ref().is_some_and(|all| all.contains_key(camera))
    }

    /// A wrinkle's sections.
    pub(crate) fn sections_of(&self, camera: &str, id: &str) -> Option<&Vec<Section>> {
        self.sections.as_ref()?.get(camera)?.get(id)
    }

    /// A wrinkle's curve.
    pub(crate) fn curve_of(&self, camera: &str, id: &str) -> Option<&Curve2d> {
        self.curves.as_ref()?.get(camera)?.get(id)
    }

    /// Whether a wrinkle is to be seen.
    pub(crate) fn shows(&self, camera: &str, id: &str) -> bool {
        self.sections_of(camera, id).is_some() || self.curve_of(camera, id).is_some()
    }

    /// Puts a wrinkle in, where the camera has an image.
    pub(crate) fn put(
        &mut self,
        camera: &str,
        id: &str,
        sections: Option<Vec<Section>>,
        curve: Option<Curve2d>,
    ) {
        put(&mut self.sections, camera, id, sections);
        put(&mut self.curves, camera, id, curve);
    }

    /// Takes a wrinkle out.
    pub(crate) fn take(&mut self, camera: &str, id: &str) -> (Option<Vec<Section>>, Option<Curve2d>) {
        (take(&mut self.sections, camera, id), take(&mut self.curves, camera, id))
    }
}

fn put<T>(all: &mut Option<PerCamera<T>>, camera: &str, id: &str, value: Option<T>) {
    let here = all.as_mut().and_then(|all| all.get_mut(camera));
    if let (Some(here), Some(value)) = (here, value) {
        here.insert(id.to_string(), value);
    }
}

fn take<T>(all: &mut Option<PerCamera<T>>, camera: &str, id: &str) -> Option<T> {
    all.as_mut()?.get_mut(camera)?.remove(id)
}
