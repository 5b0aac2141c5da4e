//! Every citation, a key alone in brackets or with a place after a comma (`[Key, Eq. 1]`), has an entry in the bibliography.

use crate::model::{Finding, House, SourceFile};
use crate::rust_text::line_of;
use std::collections::BTreeSet;

const BIBLIOGRAPHY: &str = "docs/references.bib";

pub(crate) fn check(house: &House) -> Vec<Finding> {
    let Some(bibliography) = house.text(BIBLIOGRAPHY) else {
        return vec![Finding::fault(BIBLIOGRAPHY, "is missing")];
    };
    let mut known = BTreeSet::new();
    let mut findings = Vec::new();
    for key in keys(bibliography) {
        if !known.insert(key) {
            findings.push(Finding::fault(BIBLIOGRAPHY, format!("has the key {key} twice")));
        }
    }
    for file in &house.files {
        let text = match &file.rust {
            Some(rust) => &rust.comments,
            None if file.path.ends_with(".md") || file.path.ends_with(".py") => &file.text,
            None => continue,
        };
        findings.extend(citations(text).filter(|(_, key)| !known.contains(key)).map(|(at, key)| {
            Finding::fault(place(file, text, at), format!("cites [{key}], which {BIBLIOGRAPHY} lacks"))
        }));
    }
    findings
}

fn place(file: &SourceFile, text: &str, at: usize) -> String {
    format!("{}:{}", file.path, line_of(text, at))
}

/// The keys of a BibTeX file.
fn keys(bibliography: &str) -> impl Iterator<Item = &str> {
    bibliography.lines().filter_map(|line| {
        let (_, rest) = line.trim().strip_prefix('@')?.split_once('{')?;
        Some(rest.split(',').next()?.trim())
    })
}

/// Citations in a text: where, and of what. Several share a bracket with `;` between them.
fn citations(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.match_indices('[').flat_map(|(at, _)| {
        let inside = text[at + 1..].split(']').next().unwrap_or_default();
        inside.split(';').filter_map(move |one| {
            let key = one.split(',').next()?.trim();
            is_key(key).then_some((at, key))
        })
    })
}

/// A name with a capital, then a year of four digits, perhaps a letter: `BotschKobbelt2004a`.
fn is_key(word: &str) -> bool {
    let bare = word.strip_suffix(|one: char| one.is_ascii_lowercase()).unwrap_or(word);
    let Some((name, year)) = bare.len().checked_sub(4).and_then(|at| bare.split_at_checked(at)) else {
        return false;
    };
    year.bytes().all(|one| one.is_ascii_digit())
        && name.starts_with(char::is_uppercase)
        && name.contains(char::is_lowercase)
        && name.chars().all(|one| one.is_alphabetic() || one == '-')
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::samples::with_file;

    fn found(path: &str, text: &str) -> Vec<String> {
        let mut house = with_file(path, text);
        house.files.push(SourceFile::new(BIBLIOGRAPHY, "@article{Meyer2003,\n}\n@book{Carr2001a,\n}\n"));
        check(&house).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn an_unknown_key_is_found_with_its_line() {
        for text in ["a\n[Nobody1999]", "a\n[Nobody1999, Eq. 3]", "a\n[Meyer2003; Nobody1999, Sec. 2]"] {
            let faults = found("docs/guide.md", text);
            assert!(
                faults.len() == 1 && faults[0].contains("guide.md:2") && faults[0].contains("Nobody1999")
            );
        }
        assert_eq!(found("crates/shared/mesh/src/lib.rs", "/// [Nobody1999]").len(), 1);
    }

    #[test]
    fn known_keys_code_and_links_are_sound() {
        let text = "/// [Meyer2003, Sec. 3.3] and [Carr2001a] [`Take2000`] [SEED2000] [x] [A §3]\nlet a = [Nobody1999];";
        assert_eq!(found("crates/shared/mesh/src/lib.rs", text), Vec::<String>::new());
    }

    #[test]
    fn a_missing_bibliography_and_a_double_key_are_found() {
        assert_eq!(check(&with_file("docs/a.md", "")).len(), 1);
        let mut house = with_file("docs/a.md", "");
        house.files.push(SourceFile::new(BIBLIOGRAPHY, "@a{Meyer2003,\n}\n@a{Meyer2003,\n}"));
        assert!(check(&house)[0].message.contains("twice"));
    }
}
