//! Markers by id and by pattern.

use crate::Error;
use artifact::matches;

/// Indices of the markers that the ids and patterns name, in the take's order.
///
/// # Errors
/// [`Error::UnknownMarker`] for the first that names none.
pub(crate) fn select(markers: &[String], wanted: &[String]) -> Result<Vec<usize>, Error> {
    let names = |pattern: &String| markers.iter().any(|id| matches(pattern, id));
    if let Some(missing) = wanted.iter().find(|pattern| !names(pattern)) {
        return Err(Error::UnknownMarker { wanted: missing.clone(), close: close_to(missing, markers) });
    }
    let named = |i: &usize| wanted.iter().any(|pattern| matches(pattern, &markers[*i]));
    Ok((0..markers.len()).filter(named).collect())
}

/// Up to three ids that look like what was asked for.
fn close_to(wanted: &str, markers: &[String]) -> Vec<String> {
    let wanted: Vec<char> = wanted.to_lowercase().chars().collect();
    let distance = |id: &String| edit_distance(&wanted, &id.to_lowercase().chars().collect::<Vec<_>>());
    let mut near: Vec<(usize, &String)> = markers.iter().map(|id| (distance(id), id)).collect();
    near.retain(|(distance, _)| *distance <= 2.max(wanted.len() / 3));
    near.sort();
    near.into_iter().take(3).map(|(_, id)| id.clone()).collect()
}

/// Levenshtein's distance.
fn edit_distance(a: &[char], b: &[char]) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.iter().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, to) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(from != to);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(row[j + 1] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_typing_mistake_finds_its_neighbours() {
        let ids = ["root-1", "root-2", "lip_l"].map(String::from);
        let error = select(&ids, &["rooot-1".into()]).unwrap_err();
        assert_eq!(
            error,
            Error::UnknownMarker { wanted: "rooot-1".into(), close: vec!["root-1".into(), "root-2".into()] }
        );
    }
}
