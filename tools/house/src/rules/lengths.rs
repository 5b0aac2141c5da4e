//! Long files and long functions: warnings, to look at. Clippy refuses functions past 60 lines.

use crate::model::{Finding, House, SourceFile};
use crate::rust_text::{closing, line_of, without_tests, words};

/// A file past this needs a reason.
const FILE_LINES: usize = 300;
/// Nearly all functions stay below.
const FUNCTION_LINES: usize = 40;

pub(crate) fn check(house: &House) -> Vec<Finding> {
    house.files.iter().flat_map(check_file).collect()
}

fn check_file(file: &SourceFile) -> Vec<Finding> {
    let is_code = file.rust.is_some() || file.path.ends_with(".py");
    let lines = file.text.lines().count();
    let mut findings = Vec::new();
    if is_code && lines > FILE_LINES {
        findings.push(Finding::warning(
            &file.path,
            format!("has {lines} lines; past {FILE_LINES} it needs a reason"),
        ));
    }
    let Some(rust) = file.rust.as_ref().filter(|_| !file.path.contains("/tests/")) else { return findings };
    let code = without_tests(&rust.code);
    findings.extend(functions(&code).filter(|(.., lines)| *lines > FUNCTION_LINES).map(
        |(at, name, lines)| {
            let place = format!("{}:{}", file.path, line_of(&code, at));
            Finding::warning(
                place,
                format!("{name} has {lines} lines; nearly all stay below {FUNCTION_LINES}"),
            )
        },
    ));
    findings
}

/// Functions with a body: where, name, lines.
fn functions(code: &str) -> impl Iterator<Item = (usize, &str, usize)> {
    words(code, "fn").filter_map(|at| {
        let rest = &code[at + 2..];
        let name = rest.trim_start().split(|one: char| !(one.is_alphanumeric() || one == '_')).next()?;
        let stop = rest.find(['{', ';'])?;
        let open = at + 2 + stop;
        let end = closing(code, open).filter(|_| !name.is_empty())?;
        Some((at, name, code[at..end].matches('\n').count() + 1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::samples::with_file;

    fn found(text: &str) -> Vec<String> {
        check(&with_file("crates/shared/mesh/src/lib.rs", text)).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_long_file_is_found() {
        assert!(found(&"//\n".repeat(301))[0].contains("301 lines"));
        assert!(found(&"//\n".repeat(300)).is_empty());
    }

    #[test]
    fn a_long_function_is_found() {
        let body = |lines: usize| format!("\nfn slow<T>(a: T) {{\n{}}}\n", "x();\n".repeat(lines));
        let warnings = found(&body(39));
        assert!(warnings[0].contains("lib.rs:2: slow has 41 lines"), "{warnings:?}");
        assert!(found(&body(38)).is_empty());
    }
}
