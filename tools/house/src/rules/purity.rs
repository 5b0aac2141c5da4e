//! A stage's library is pure: no arguments, disk, clock or environment. Those belong to its binary.

use crate::model::{Crate, Finding, House, SourceFile};
use crate::rust_text::{closing, line_of, without_tests, words};

/// Crates for the binary only.
const SHELL_CRATES: [&str; 2] = ["clap", "anyhow"];
/// Rooms of the standard library for the binary and for `artifact` and `stage` only.
const IMPURE_ROOMS: [&str; 6] = ["fs", "env", "time", "process", "net", "thread"];

pub(crate) fn check(house: &House) -> Vec<Finding> {
    let of_stage = |stage: &Crate, file: &SourceFile| {
        let inside = file.path.strip_prefix(&format!("{}/src/", stage.folder));
        inside
            .is_some_and(|path| path != "main.rs" && !path.starts_with("commands/") && path != "commands.rs")
    };
    house
        .stages()
        .flat_map(|stage| house.files.iter().filter(move |file| of_stage(stage, file)))
        .flat_map(check_library_file)
        .collect()
}

fn check_library_file(file: &SourceFile) -> Vec<Finding> {
    let Some(rust) = &file.rust else { return Vec::new() };
    let code = without_tests(&rust.code);
    let shell =
        SHELL_CRATES.iter().flat_map(|name| words(&code, name).map(move |at| (at, (*name).to_string())));
    let rooms = impure_rooms(&code).into_iter().map(|(at, room)| (at, format!("std::{room}")));
    let mut findings: Vec<(usize, String)> = shell.chain(rooms).collect();
    findings.sort();
    findings
        .into_iter()
        .map(|(at, what)| {
            let place = format!("{}:{}", file.path, line_of(&code, at));
            Finding::fault(place, format!("names {what}: in a stage, only main.rs and commands/ may"))
        })
        .collect()
}

/// Where impure rooms of the standard library are named, alone or in a group.
fn impure_rooms(code: &str) -> Vec<(usize, &'static str)> {
    let mut found = Vec::new();
    for at in words(code, "std") {
        let Some(rest) = code[at + 3..].strip_prefix("::") else { continue };
        let begin = at + 5;
        if !rest.starts_with('{') {
            let room = IMPURE_ROOMS.iter().find(|room| words(rest, room).next() == Some(0));
            found.extend(room.map(|room| (at, *room)));
            continue;
        }
        let end = closing(code, begin).unwrap_or(code.len());
        let group = &code[begin..end];
        for room in IMPURE_ROOMS {
            // Deeper in the group, a name belongs to another room.
            let own = words(group, room)
                .find(|&k| group[..k].matches(['{', '}']).count() % 2 == 1 && !group[..k].ends_with("::"));
            found.extend(own.map(|k| (begin + k, room)));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::samples::with_file;

    fn found(path: &str, text: &str) -> Vec<String> {
        check(&with_file(path, text)).iter().map(ToString::to_string).collect()
    }

    const LIBRARY: &str = "crates/stages/shell/src/lib.rs";

    #[test]
    fn each_impurity_is_found_with_its_line() {
        for line in [
            "use clap::Parser;",
            "fn f() -> anyhow::Result<()> { todo() }",
            "use std::fs;",
            "use std::{collections::BTreeMap, env};",
            "let now = std::time::Instant::now();",
            "std::process::exit(1)",
        ] {
            let faults = found(LIBRARY, &format!("//! Pure.\n{line}\n"));
            assert!(faults.len() == 1 && faults[0].contains("lib.rs:2"), "{line}: {faults:?}");
        }
    }

    #[test]
    fn binaries_comments_strings_and_tests_are_free() {
        let sound = "// std::fs\nlet a = \"clap\";\nuse std::{io::{self}, fmt};\nfn time(env: u8) {}\n\
                     #[cfg(test)]\nmod tests { use std::fs; }\n";
        assert_eq!(found(LIBRARY, sound), Vec::<String>::new());
        for path in ["main.rs", "commands/fit.rs"] {
            let path = format!("crates/stages/shell/src/{path}");
            assert_eq!(found(&path, "use clap::Parser; use std::fs;"), Vec::<String>::new());
        }
    }
}
