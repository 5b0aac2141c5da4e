//! Which columns of an ARKit recording drive which shape.

/// A shape, and the columns whose weighted sum it takes. The names are those of the parametric body and of
/// expression sets; a shape that is not listed takes the column that has its name.
const COLUMNS: [(&str, &[(&str, f64)]); 20] = [
    ("jaw_open", &[("JawOpen", 1.0)]),
    ("smile_l", &[("MouthSmileLeft", 1.0)]),
    ("smile_r", &[("MouthSmileRight", 1.0)]),
    ("smile", &[("MouthSmileLeft", 0.5), ("MouthSmileRight", 0.5)]),
    ("brow_raise", &[("BrowInnerUp", 0.5), ("BrowOuterUpLeft", 0.25), ("BrowOuterUpRight", 0.25)]),
    ("brow_raise_l", &[("BrowInnerUp", 0.5), ("BrowOuterUpLeft", 0.5)]),
    ("brow_raise_r", &[("BrowInnerUp", 0.5), ("BrowOuterUpRight", 0.5)]),
    ("frown", &[("BrowDownLeft", 0.5), ("BrowDownRight", 0.5)]),
    ("blink", &[("EyeBlinkLeft", 0.5), ("EyeBlinkRight", 0.5)]),
    ("blink_l", &[("EyeBlinkLeft", 1.0)]),
    ("blink_r", &[("EyeBlinkRight", 1.0)]),
    ("squint", &[("EyeSquintLeft", 0.5), ("EyeSquintRight", 0.5)]),
    ("nose_wrinkle", &[("NoseSneerLeft", 0.5), ("NoseSneerRight", 0.5)]),
    ("pucker", &[("MouthPucker", 1.0)]),
    ("lips_funnel", &[("MouthFunnel", 1.0)]),
    ("lips_press", &[("MouthPressLeft", 0.5), ("MouthPressRight", 0.5)]),
    ("mouth_stretch", &[("MouthStretchLeft", 0.5), ("MouthStretchRight", 0.5)]),
    ("eye_blink", &[("EyeBlinkLeft", 0.5), ("EyeBlinkRight", 0.5)]),
    ("nose_sneer", &[("NoseSneerLeft", 0.5), ("NoseSneerRight", 0.5)]),
    ("mouth_frown", &[("MouthFrownLeft", 0.5), ("MouthFrownRight", 0.5)]),
];

/// Columns by index and their weights for a shape; `None` if the recording has none for it.
///
/// Listed shapes first; else the column of the same name, whatever its case and underscores, with `_l` and `_r` as
/// `Left` and `Right` (`browDown_L`, `brow_down_l` and `BrowDownLeft` are one).
pub(super) fn columns_of(shape: &str, columns: &[String]) -> Option<Vec<(usize, f64)>> {
    let index = |name: &str| columns.iter().position(|column| bare(column) == bare(name));
    if let Some((_, sum)) = COLUMNS.iter().find(|listed| listed.0 == shape) {
        return sum.iter().map(|&(name, weight)| Some((index(name)?, weight))).collect();
    }
    let lower = shape.to_ascii_lowercase();
    let spelt = match (lower.strip_suffix("_l"), lower.strip_suffix("_r")) {
        (Some(stem), _) => format!("{stem}left"),
        (_, Some(stem)) => format!("{stem}right"),
        _ => lower,
    };
    // BrowInnerUp and CheekPuff have no sides in ARKit.
    let sideless = || spelt.strip_suffix("left").or(spelt.strip_suffix("right")).and_then(index);
    index(&spelt).or_else(sideless).map(|column| vec![(column, 1.0)])
}

/// Letters and digits in lower case.
fn bare(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).map(|letter| letter.to_ascii_lowercase()).collect()
}
