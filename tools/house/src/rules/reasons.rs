//! An exception from a lint stands beside its reason.

use crate::model::{Finding, House, SourceFile};
use crate::rust_text::{closing, line_of};

pub(crate) fn check(house: &House) -> Vec<Finding> {
    house.files.iter().flat_map(check_file).collect()
}

fn check_file(file: &SourceFile) -> Vec<Finding> {
    let Some(rust) = &file.rust else { return Vec::new() };
    let code = &rust.code;
    let mut findings = Vec::new();
    for (at, _) in code.match_indices('#') {
        let open = at + code[at..].find('[').unwrap_or(0);
        let marks = &code[at..open];
        let end = closing(code, open).filter(|_| marks == "#" || marks == "#!");
        let Some(attribute) = end.map(|end| &code[open + 1..end]) else { continue };
        let exception = ["allow", "expect"].iter().find(|name| {
            attribute.trim_start().strip_prefix(**name).is_some_and(|rest| rest.trim_start().starts_with('('))
        });
        if let Some(name) = exception.filter(|_| !attribute.contains("reason")) {
            let place = format!("{}:{}", file.path, line_of(code, at));
            findings.push(Finding::fault(place, format!("`{name}` without `reason = \"…\"`")));
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::samples::with_file;

    fn count(text: &str) -> usize {
        check(&with_file("crates/shared/mesh/src/lib.rs", text)).len()
    }

    #[test]
    fn an_exception_without_a_reason_is_found() {
        assert_eq!(count("#[allow(dead_code)]\nfn a() {}\n#![expect(\n  unused\n)]"), 2);
    }

    #[test]
    fn a_reason_makes_it_sound() {
        assert_eq!(count("#[allow(dead_code, reason = \"soon\")]\n#[derive(Debug)]\n// #[allow(x)]\n"), 0);
        assert_eq!(count("#![allow(\n  a,\n  reason = \"b\"\n)]\nlet c = #[inline] 3;"), 0);
    }
}
