//! From a line of a list to an edit.

use crate::change::Quantity;
use crate::edit::Edit;
use crate::moment::Head;
use crate::read_drawn::{KeyWords, draw, key};
use crate::scope::Scope;
use crate::words::{Clauses, number};
use artifact::{FrameRange, Profile, matches};
use std::ops::RangeInclusive;

/// Factors of depths and widths.
const FACTORS: RangeInclusive<f64> = 0.0..=100.0;
/// Depths and widths, px.
pub(crate) const LENGTHS: RangeInclusive<f64> = 0.0..=1000.0;
/// Depth over width.
const RATIOS: RangeInclusive<f64> = 0.0..=10.0;
/// ε, and ± κ.
const SHAPES: RangeInclusive<f64> = 0.0..=0.95;

/// What a line says.
pub(crate) enum Line {
    /// An edit of its own.
    Edit(Edit),
    /// Another look of a wrinkle that was drawn before: its id, its camera, the frame.
    Key(String, String, i64, KeyWords),
}

/// Reads the words of a line; ids and cameras are those of the head as the lines before leave it.
pub(crate) fn read(words: &[&str], head: &Head) -> Result<Line, String> {
    let usage = |verb: &str| format!("write: {}", usage(verb));
    let edit = match *words {
        ["scale", what, by, ref rest @ ..] => scale(what, by, rest, head)?,
        ["set", what, to, ref rest @ ..] => set(what, to, rest, head)?,
        ["draw", id, ref rest @ ..] => draw(id, rest, head)?,
        ["key", id, ref rest @ ..] => return key(id, rest, head),
        ["delete", ids, ref rest @ ..] => {
            let (scope, everywhere) = partly(rest, known(ids, head)?, head)?;
            Edit::Delete { scope, everywhere }
        }
        ["rename", from, to, ref rest @ ..] => rename(from, to, rest, head)?,
        ["swap", one, other, ref rest @ ..] => {
            let ids = vec![one_of(one, head)?, one_of(other, head)?];
            if ids[0] == ids[1] {
                return Err("the wrinkle would change names with itself; name two wrinkles".into());
            }
            let (scope, everywhere) = partly(rest, ids, head)?;
            Edit::Swap { scope, everywhere }
        }
        ["copy", ids, ref rest @ ..] => copy(ids, rest, head)?,
        [verb @ ("scale" | "set" | "draw" | "key" | "delete" | "rename" | "swap" | "copy"), ..] => {
            return Err(usage(verb));
        }
        [other, ..] => {
            return Err(format!(
                "'{other}' is no edit; there are scale, set, draw, key, delete, rename, swap and copy"
            ));
        }
        [] => return Err("is empty".into()),
    };
    Ok(Line::Edit(edit))
}

fn usage(verb: &str) -> &'static str {
    match verb {
        "scale" => "scale depth|width FACTOR [of IDS] [in CAMERAS] [frames A-B] [ease N]",
        "set" => "set depth|width|ratio|epsilon|kappa VALUE [of IDS] [in CAMERAS] [frames A-B] [ease N]",
        "draw" => {
            "draw ID in CAMERA at FRAME through X,Y X,Y … width PX depth PX [frames A-B] [ease N] [follow IDS]"
        }
        "key" => "key ID in CAMERA at FRAME through X,Y X,Y … [width PX] [depth PX]",
        "delete" => "delete IDS [in CAMERAS] [frames A-B]",
        "rename" => "rename ID NEW [in CAMERAS] [frames A-B]",
        "swap" => "swap ID ID [in CAMERAS] [frames A-B]",
        _ => "copy IDS from FRAME frames A-B [in CAMERAS] [ease N] [follow IDS]",
    }
}

pub(crate) fn within(name: &str, value: f64, range: &RangeInclusive<f64>) -> Result<f64, String> {
    match range.contains(&value) {
        true => Ok(value),
        false => Err(format!("{name} {value} is out of range: write {} to {}", range.start(), range.end())),
    }
}

/// The wrinkles that a list of ids and patterns names, in their order.
fn known(list: &str, head: &Head) -> Result<Vec<String>, String> {
    let patterns: Vec<&str> = list.split(',').collect();
    let ids = || head.wrinkles.iter().map(|wrinkle| &wrinkle.id);
    if let Some(none) = patterns.iter().find(|pattern| !ids().any(|id| matches(pattern, id))) {
        return Err(format!("there is no wrinkle '{none}'; there are {}", listed(ids())));
    }
    Ok(ids().filter(|id| patterns.iter().any(|pattern| matches(pattern, id))).cloned().collect())
}

/// Ids that a message lists.
const LISTED: usize = 20;

fn listed<'a>(ids: impl Iterator<Item = &'a String>) -> String {
    let all: Vec<&str> = ids.map(String::as_str).collect();
    match all.len() {
        0 => "none".into(),
        1..=LISTED => all.join(", "),
        count => format!("{} and {} more", all[..LISTED].join(", "), count - LISTED),
    }
}

/// The one wrinkle of this id.
fn one_of(id: &str, head: &Head) -> Result<String, String> {
    match head.wrinkles.iter().any(|wrinkle| wrinkle.id == id) {
        true => Ok(id.to_string()),
        false => Err(format!(
            "there is no wrinkle '{id}'; there are {}",
            listed(head.wrinkles.iter().map(|wrinkle| &wrinkle.id))
        )),
    }
}

pub(crate) fn cameras(clauses: &Clauses, head: &Head) -> Result<Vec<String>, String> {
    let Some(cameras) = clauses.list("in")? else { return Ok(head.cameras.clone()) };
    match cameras.iter().find(|camera| !head.cameras.contains(camera)) {
        Some(none) => Err(format!("there is no camera '{none}'; there are {}", listed(head.cameras.iter()))),
        None => Ok(cameras),
    }
}

/// The scope of an edit whose wrinkles are known.
pub(crate) fn scope_of(clauses: &Clauses, ids: Vec<String>, head: &Head) -> Result<Scope, String> {
    let frames = clauses.frames()?.unwrap_or(FrameRange::ALL);
    Ok(Scope { ids, cameras: cameras(clauses, head)?, frames, ease: clauses.ease(frames)? })
}

/// The scope of a change of numbers: all wrinkles where none are named.
fn scope(rest: &[&str], head: &Head) -> Result<Scope, String> {
    let clauses = Clauses::of(rest, &["of", "in", "frames", "ease"])?;
    scope_of(&clauses, known(clauses.word("of")?.unwrap_or("*"), head)?, head)
}

/// The scope of an edit that holds everywhere where neither cameras nor frames are named.
fn partly(rest: &[&str], ids: Vec<String>, head: &Head) -> Result<(Scope, bool), String> {
    let clauses = Clauses::of(rest, &["in", "frames"])?;
    Ok((scope_of(&clauses, ids, head)?, rest.is_empty()))
}

fn scale(what: &str, by: &str, rest: &[&str], head: &Head) -> Result<Edit, String> {
    let what = match what {
        "depth" => Quantity::Depth,
        "width" => Quantity::Width,
        other => return Err(format!("'{other}' cannot be scaled; depth and width can")),
    };
    let by = within("the factor", number(by)?, &FACTORS)?;
    if what == Quantity::Width && by == 0.0 {
        return Err("a wrinkle of no width is none; scale its depth by 0, or delete it".into());
    }
    Ok(Edit::Scale { what, by, scope: scope(rest, head)? })
}

fn set(what: &str, to: &str, rest: &[&str], head: &Head) -> Result<Edit, String> {
    let to = number(to)?;
    let (what, to) = match what {
        "depth" => (Quantity::Depth, within("the depth", to, &LENGTHS)?),
        "width" => (Quantity::Width, width(to)?),
        "ratio" => (Quantity::Ratio, within("the ratio", to, &RATIOS)?),
        "epsilon" => (Quantity::Rounding, rounding(to, head)?),
        "kappa" => (Quantity::Asymmetry, asymmetry(to, head)?),
        other => {
            return Err(format!("'{other}' cannot be set; depth, width, ratio, epsilon and kappa can"));
        }
    };
    Ok(Edit::Set { what, to, scope: scope(rest, head)? })
}

pub(crate) fn width(value: f64) -> Result<f64, String> {
    match value > 0.0 {
        true => within("the width", value, &LENGTHS),
        false => Err(format!("the width {value} is not positive")),
    }
}

pub(crate) fn rounding(value: f64, head: &Head) -> Result<f64, String> {
    has_shape(value, head).and_then(|value| within("epsilon", value, &SHAPES))
}

pub(crate) fn asymmetry(value: f64, head: &Head) -> Result<f64, String> {
    let most = *SHAPES.end();
    has_shape(value, head).and_then(|value| within("kappa", value, &(-most..=most)))
}

fn has_shape(value: f64, head: &Head) -> Result<f64, String> {
    match head.profile == Profile::S && value != 0.0 {
        true => Err("these sections have the paper's profile, without a rounding or an asymmetry".into()),
        false => Ok(value),
    }
}

fn rename(from: &str, to: &str, rest: &[&str], head: &Head) -> Result<Edit, String> {
    let ids = vec![one_of(from, head)?];
    if from == to {
        return Err(format!("'{from}' is its name already"));
    }
    if to.contains([',', '*', '?']) {
        return Err(format!("'{to}' is no id: commas, * and ? mean something in edits"));
    }
    let (scope, everywhere) = partly(rest, ids, head)?;
    if everywhere && head.wrinkles.iter().any(|wrinkle| wrinkle.id == to) {
        return Err(format!(
            "there is a wrinkle '{to}' already; delete it first, swap the two, or name frames in which '{to}' is not to be seen"
        ));
    }
    Ok(Edit::Rename { to: to.to_string(), scope, everywhere })
}

pub(crate) fn frame(clauses: &Clauses, key: &str) -> Result<i64, String> {
    let word = clauses.needed(key)?;
    word.parse().map_err(|_| format!("'{word}' is no frame number"))
}

fn copy(ids: &str, rest: &[&str], head: &Head) -> Result<Edit, String> {
    let clauses = Clauses::of(rest, &["from", "frames", "in", "ease", "follow"])?;
    clauses.needed("frames")?;
    let scope = scope_of(&clauses, known(ids, head)?, head)?;
    Ok(Edit::Copy { from: frame(&clauses, "from")?, scope, follow: followed(&clauses, head, &[])? })
}

/// The wrinkles that something follows; `not` cannot be followed.
pub(crate) fn followed(clauses: &Clauses, head: &Head, not: &[&str]) -> Result<Vec<String>, String> {
    let Some(list) = clauses.word("follow")? else { return Ok(Vec::new()) };
    let ids: Vec<String> = known(list, head)?.into_iter().filter(|id| !not.contains(&id.as_str())).collect();
    match ids.is_empty() {
        true => Err("a wrinkle cannot follow itself".into()),
        false => Ok(ids),
    }
}
