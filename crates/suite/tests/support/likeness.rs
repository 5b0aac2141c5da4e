//! How alike two files are, kind by kind.

use serde_json::Value;
use std::path::{Path, PathBuf};

/// Of two pictures: mean difference of their samples, levels of 255.
const MEAN_LEVELS: f64 = 1.0;
/// Of two pictures: share of samples that are the same.
const SAME_SHARE: f64 = 0.95;

/// The files below a folder, relative to it, in order; side-cars are none of them.
pub(crate) fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for name in super::names(folder) {
        let path = folder.join(&name);
        if path.is_dir() {
            found.extend(files(&path).into_iter().map(|inner| Path::new(&name).join(inner)));
        } else if !name.ends_with(".prov.json") {
            found.push(name.into());
        }
    }
    found
}

/// JSON, or JSON lines. What stands under the keys `besides` is not compared.
pub(crate) fn json_difference(
    golden: &Path,
    made: &Path,
    tolerance: f64,
    besides: &[&str],
) -> Option<String> {
    let lines = |path: &Path| -> Vec<Value> {
        let text = std::fs::read_to_string(path).expect("a text");
        text.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
    };
    let apart = |a: f64, b: f64| (a - b).abs() > tolerance;
    value_difference("", &Value::Array(lines(golden)), &Value::Array(lines(made)), &apart, besides)
}

fn value_difference(
    place: &str,
    golden: &Value,
    made: &Value,
    apart: &impl Fn(f64, f64) -> bool,
    besides: &[&str],
) -> Option<String> {
    match (golden, made) {
        (Value::Number(a), Value::Number(b)) => {
            let far = apart(a.as_f64().expect("a number"), b.as_f64().expect("a number"));
            far.then(|| format!("{place}: {b}, not {a}"))
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            (0..a.len()).find_map(|i| value_difference(&format!("{place}/{i}"), &a[i], &b[i], apart, besides))
        }
        (Value::Object(a), Value::Object(b)) if a.keys().eq(b.keys()) => {
            a.iter().filter(|(key, _)| !besides.contains(&key.as_str())).find_map(|(key, value)| {
                value_difference(&format!("{place}/{key}"), value, &b[key], apart, besides)
            })
        }
        _ => (golden != made).then(|| format!("{place}: {made}, not {golden}")),
    }
}

/// A table of words and numbers, with commas.
pub(crate) fn table_difference(golden: &Path, made: &Path, tolerance: f64) -> Option<String> {
    let [golden, made] = [golden, made].map(|path| std::fs::read_to_string(path).expect("a text"));
    let cells = |text: &str| -> Vec<String> { text.split([',', '\n']).map(str::to_string).collect() };
    let (golden, made) = (cells(&golden), cells(&made));
    if golden.len() != made.len() {
        return Some(format!("{} cells, not {}", made.len(), golden.len()));
    }
    let alike = |a: &String, b: &String| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= tolerance,
        _ => a == b,
    };
    let other = golden.iter().zip(&made).find(|(a, b)| !alike(a, b));
    other.map(|(golden, made)| format!("{made}, not {golden}"))
}

/// Pictures: nearly all samples are the same, and the rest is close.
pub(crate) fn picture_difference(golden: &Path, made: &Path) -> Option<String> {
    let [golden, made] = [golden, made].map(|path| image::open(path).expect("a picture").into_rgb8());
    if golden.dimensions() != made.dimensions() {
        return Some(format!("{:?} pixels, not {:?}", made.dimensions(), golden.dimensions()));
    }
    let apart = || golden.iter().zip(made.iter()).map(|(a, b)| f64::from(a.abs_diff(*b)));
    let count = golden.len() as f64;
    let mean = apart().sum::<f64>() / count;
    let same = apart().filter(|levels| *levels == 0.0).count() as f64 / count;
    (mean > MEAN_LEVELS || same < SAME_SHARE)
        .then(|| format!("{mean:.2} levels apart, {:.1} % are the same", 100.0 * same))
}
