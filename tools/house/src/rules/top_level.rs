//! The top level of the repository stays small.

use crate::model::{Finding, House};
use std::collections::BTreeSet;

/// What must stand there.
const REQUIRED: [&str; 6] = ["Cargo.toml", "README.md", "crates", "docs", "justfile", "tools"];
/// What may stand there beside dot-files and licences.
const ALLOWED: [&str; 2] = ["Cargo.lock", "fixtures"];

pub(crate) fn check(house: &House) -> Vec<Finding> {
    let there: BTreeSet<&str> = house.paths.iter().filter_map(|path| path.split('/').next()).collect();
    let missing = REQUIRED.iter().filter(|name| !there.contains(**name));
    let unexpected = there.iter().filter(|name| {
        let known = REQUIRED.contains(name) || ALLOWED.contains(name);
        !known && !name.starts_with('.') && !name.starts_with("LICENSE")
    });
    missing
        .map(|name| Finding::fault(*name, "is missing at the top level"))
        .chain(unexpected.map(|name| {
            Finding::fault(
                *name,
                "does not belong at the top level: put it into crates, tools, fixtures or docs",
            )
        }))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(paths: &[&str]) -> Vec<String> {
        let house = House { paths: paths.iter().map(|path| (*path).into()).collect(), ..House::default() };
        check(&house).iter().map(ToString::to_string).collect()
    }

    const SOUND: [&str; 9] = [
        "Cargo.toml",
        "Cargo.lock",
        "README.md",
        "crates/a/src/lib.rs",
        "docs/a.md",
        "justfile",
        "tools/run",
        ".gitignore",
        "LICENSE-MIT",
    ];

    #[test]
    fn the_plan_is_sound() {
        assert_eq!(found(&SOUND), Vec::<String>::new());
    }

    #[test]
    fn a_stray_file_is_found() {
        assert!(found(&[&SOUND[..], &["notes.txt"]].concat())[0].contains("notes.txt"));
    }

    #[test]
    fn a_missing_room_is_found() {
        assert!(found(&SOUND[1..])[0].contains("Cargo.toml: is missing"));
    }
}
