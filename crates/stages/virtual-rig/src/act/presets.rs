//! What an event can be called, and which shapes that means on which body.

use super::refuse;

/// Shapes that act together, with weights.
type Shapes = &'static [(&'static str, f64)];

/// A name, and its shapes: the first set of which a body has any.
const PRESETS: [(&str, &[Shapes]); 10] = [
    (
        "brow_raise",
        &[
            &[("brow_raise_l", 1.0), ("brow_raise_r", 1.0)],
            &[("brow_inner_up", 1.0)],
            &[("brow_inner_up_l", 1.0), ("brow_inner_up_r", 1.0)],
        ],
    ),
    (
        "frown",
        &[
            &[("brow_down_l", 1.0), ("brow_down_r", 1.0)],
            &[("brow_down", 1.0)],
            &[("nose_sneer", 0.6), ("mouth_frown", 0.7)],
        ],
    ),
    ("smile", &[&[("smile_l", 1.0), ("smile_r", 1.0)], &[("mouth_smile_l", 1.0), ("mouth_smile_r", 1.0)]]),
    (
        "squint",
        &[
            &[("eye_squint_l", 1.0), ("eye_squint_r", 1.0)],
            &[("cheek_squint_l", 1.0), ("cheek_squint_r", 1.0)],
            &[("nose_sneer", 0.4), ("eye_blink", 0.3)],
        ],
    ),
    ("jaw", &[&[("jaw_open", 0.8)]]),
    (
        "blink",
        &[
            &[("blink_l", 1.0), ("blink_r", 1.0)],
            &[("eye_blink", 1.0)],
            &[("eye_blink_l", 1.0), ("eye_blink_r", 1.0)],
        ],
    ),
    ("nose_wrinkle", &[&[("nose_sneer", 1.0)], &[("nose_sneer_l", 1.0), ("nose_sneer_r", 1.0)]]),
    ("pucker", &[&[("mouth_pucker", 1.0)]]),
    ("stretch", &[&[("mouth_stretch", 1.0)], &[("mouth_stretch_l", 1.0), ("mouth_stretch_r", 1.0)]]),
    ("press", &[&[("lips_press", 1.0)], &[("mouth_press_l", 1.0), ("mouth_press_r", 1.0)]]),
];

/// What speaks, each part moving on its own: the jaw, then the lips as far as a body has them.
const SPEECH: [&[Shapes]; 4] = [
    &[&[("jaw_open", 0.45)]],
    &[&[("pucker", 0.45)], &[("mouth_pucker", 0.45)]],
    &[&[("lips_funnel", 0.4)], &[("mouth_funnel", 0.4)]],
    &[&[("mouth_stretch", 0.5)], &[("mouth_stretch_l", 0.5), ("mouth_stretch_r", 0.5)], &[("smile", 0.25)]],
];

/// The name of speech-like motion.
pub(super) const SPEECH_NAME: &str = "speech";

/// Names of all presets.
#[must_use]
pub fn preset_names() -> Vec<&'static str> {
    PRESETS.iter().map(|preset| preset.0).chain([SPEECH_NAME]).collect()
}

/// Shapes of a body by index, and their weights.
pub(super) type Parts = Vec<(usize, f64)>;

/// What an action means on a body: a shape of that name, or else a preset.
///
/// # Errors
/// Names the action, and what there is instead.
pub(super) fn resolve(place: &str, action: &str, shapes: &[String]) -> Result<Parts, crate::Error> {
    if let Some(shape) = shapes.iter().position(|shape| shape == action) {
        return Ok(vec![(shape, 1.0)]);
    }
    let Some((_, sets)) = PRESETS.iter().find(|preset| preset.0 == action) else {
        let presets = preset_names().join(", ");
        let what =
            format!("'{action}' is no shape of this body ({}) and no preset ({presets})", shapes.join(", "));
        return Err(refuse(place, what));
    };
    first_present(sets, shapes).ok_or_else(|| {
        let sets: Vec<String> = sets.iter().map(names).collect();
        let what = format!("'{action}' needs {}; this body has {}", sets.join(" or "), shapes.join(", "));
        refuse(place, what)
    })
}

/// The parts of a body that speak; at least the jaw.
///
/// # Errors
/// If there is no jaw.
pub(super) fn resolve_speech(place: &str, shapes: &[String]) -> Result<Vec<Parts>, crate::Error> {
    let parts: Vec<Option<Parts>> = SPEECH.iter().map(|sets| first_present(sets, shapes)).collect();
    match parts[0] {
        Some(_) => Ok(parts.into_iter().flatten().collect()),
        None => Err(refuse(place, format!("'speech' needs jaw_open; this body has {}", shapes.join(", ")))),
    }
}

fn first_present(sets: &[Shapes], shapes: &[String]) -> Option<Parts> {
    let present = |set: &Shapes| -> Parts {
        let index = |name: &str| shapes.iter().position(|shape| shape == name);
        set.iter().filter_map(|&(name, weight)| Some((index(name)?, weight))).collect()
    };
    sets.iter().map(present).find(|parts| !parts.is_empty())
}

fn names(set: &Shapes) -> String {
    set.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(" and ")
}
