//! Ids of cameras, markers and wrinkles: what a header lists, frames may name.

use crate::Violation;
use std::collections::{BTreeMap, HashSet};

/// Values per camera id and, within, per marker or wrinkle id.
pub type PerCamera<T> = BTreeMap<String, BTreeMap<String, T>>;

/// Refuses empty and doubled ids of a header's list.
pub(crate) fn check_ids<'a>(
    list: &str,
    thing: &str,
    ids: impl IntoIterator<Item = &'a String>,
) -> Result<(), Violation> {
    let mut seen = HashSet::new();
    for id in ids {
        if id.is_empty() {
            return Err(Violation::new(list, format!("a {thing} has an empty id")));
        }
        if !seen.insert(id) {
            return Err(Violation::new(list, format!("the id {id} stands twice")));
        }
    }
    Ok(())
}

/// Refuses empty and doubled ids of a header's `markers`.
pub(crate) fn check_marker_ids<'a>(ids: impl IntoIterator<Item = &'a String>) -> Result<(), Violation> {
    check_ids("markers", "marker", ids)
}

/// The ids that the frames of a stream may name: cameras, and markers or wrinkles.
pub(crate) struct Known<'a> {
    pub(crate) cameras: &'a [String],
    /// What the second level is of: `marker` or `wrinkle`.
    pub(crate) thing: &'static str,
    pub(crate) things: Vec<&'a String>,
}

impl Known<'_> {
    /// Refuses empty and doubled ids.
    pub(crate) fn check(&self) -> Result<(), Violation> {
        check_ids("cameras", "camera", self.cameras)?;
        check_ids(&format!("{}s", self.thing), self.thing, self.things.iter().copied())
    }

    /// Refuses ids that the header does not list, then whatever `check` refuses of a value at its place.
    pub(crate) fn check_values<T>(
        &self,
        frame: i64,
        values: &PerCamera<T>,
        check: impl Fn(&str, &T) -> Result<(), Violation>,
    ) -> Result<(), Violation> {
        let thing = self.thing;
        for (camera, values) in values {
            let place = format!("frame {frame}, camera {camera}");
            if !self.cameras.contains(camera) {
                return Err(Violation::new(place, "is not among the header's cameras"));
            }
            for (id, value) in values {
                let place = format!("{place}, {thing} {id}");
                if !self.things.contains(&id) {
                    return Err(Violation::new(place, format!("is not among the header's {thing}s")));
                }
                check(&place, value)?;
            }
        }
        Ok(())
    }
}

/// Whether an id is the pattern, in which `*` stands for anything and `?` for one character. An id that holds such
/// a character is matched by itself too.
#[must_use]
pub fn matches(pattern: &str, id: &str) -> bool {
    let (pattern_chars, id_chars): (Vec<char>, Vec<char>) = (pattern.chars().collect(), id.chars().collect());
    pattern == id || glob(&pattern_chars, &id_chars)
}

fn glob(pattern: &[char], text: &[char]) -> bool {
    // Greedy, with one place to fall back to: the last star.
    let (mut p, mut t) = (0, 0);
    let mut star = None;
    while t < text.len() {
        if p < pattern.len() && pattern[p] == '*' {
            star = Some((p, t));
            p += 1;
        } else if p < pattern.len() && (pattern[p] == '?' || pattern[p] == text[t]) {
            (p, t) = (p + 1, t + 1);
        } else if let Some((at, from)) = star {
            star = Some((at, from + 1));
            (p, t) = (at + 1, from + 1);
        } else {
            return false;
        }
    }
    pattern[p..].iter().all(|&c| c == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_as_in_a_shell() {
        for (pattern, id, expected) in [
            ("root-*", "root-1", true),
            ("root-*", "roof-1", false),
            ("*", "", true),
            ("a?c*e", "abcdxe", true),
            ("a?c*e", "acde", false),
            ("*1", "section11-2", false),
            ("we*rd", "we*rd", true),
            ("Unlabeled*", "Unlabeled1", true),
        ] {
            assert_eq!(matches(pattern, id), expected, "{pattern} {id}");
        }
    }
}
