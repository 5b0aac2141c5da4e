//! The ground of a new stage: a small crate that works, from the templates in `skeleton/`.

use crate::disk;
use anyhow::{Context as _, bail};
use std::path::Path;

/// Each file of the new crate, and its template.
const TEMPLATES: [(&str, &str); 8] = [
    ("Cargo.toml", include_str!("../skeleton/Cargo.toml.tmpl")),
    ("README.md", include_str!("../skeleton/README.md.tmpl")),
    ("src/lib.rs", include_str!("../skeleton/lib.rs.tmpl")),
    ("src/params.rs", include_str!("../skeleton/params.rs.tmpl")),
    ("src/error.rs", include_str!("../skeleton/error.rs.tmpl")),
    ("src/main.rs", include_str!("../skeleton/main.rs.tmpl")),
    ("tests/properties.rs", include_str!("../skeleton/properties.rs.tmpl")),
    ("tests/cli.rs", include_str!("../skeleton/cli.rs.tmpl")),
];

/// Where the suite lists how each binary is called, and the line before which a new one goes.
const MANNERS: &str = "crates/suite/tests/manners.rs";
const MANNERS_MARK: &str = "    // `house new-stage` adds here\n";

/// Writes the crate and tells the suite how its binary is called.
///
/// # Errors
/// If the name is no proper one or taken, or a file cannot be written.
pub(crate) fn create(root: &Path, name: &str) -> anyhow::Result<()> {
    check_name(name)?;
    let folder = root.join("crates/stages").join(name);
    if folder.exists() {
        bail!("crates/stages/{name} is there already");
    }
    let manners = with_manners(&disk::read(&root.join(MANNERS))?, name)?;
    for (file, template) in TEMPLATES {
        disk::write(&folder.join(file), &filled(template, name))?;
    }
    disk::write(&root.join(MANNERS), &manners)
}

/// What the author does next.
pub(crate) fn next_steps(name: &str) -> String {
    format!(
        "crates/stages/{name} is there and works: it moves a mesh along its normals. Next:\n\
         1. Say in its Cargo.toml what it does, reads and writes; then run `just drawings`.\n\
         2. Put your method in place of the example, file by file, and its laws into tests/properties.rs.\n\
         3. Run `cargo test -p {name}`, then `just test`. docs/CONTRIBUTING.md says more."
    )
}

/// Kebab-case: letters and digits in words joined by single hyphens, a letter first.
fn check_name(name: &str) -> anyhow::Result<()> {
    let word = |part: &str| {
        !part.is_empty() && part.bytes().all(|one| one.is_ascii_lowercase() || one.is_ascii_digit())
    };
    if name.split('-').all(word) && name.starts_with(|one: char| one.is_ascii_lowercase()) {
        return Ok(());
    }
    bail!("`{name}` is no name for a stage: use lower-case words joined by hyphens, e.g. wrinkle-track")
}

fn filled(template: &str, name: &str) -> String {
    template.replace("{{name}}", name).replace("{{crate}}", &name.replace('-', "_"))
}

fn with_manners(text: &str, name: &str) -> anyhow::Result<String> {
    let at = text
        .find(MANNERS_MARK)
        .with_context(|| format!("{MANNERS} lacks the line `{}`", MANNERS_MARK.trim()))?;
    let line =
        format!("    (\"{name}\", &[\"--mesh\", MESH, \"--unit\", \"mm\", \"--out\", \"out.obj\"]),\n");
    Ok(format!("{}{line}{}", &text[..at], &text[at..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_kebab_case() {
        for good in ["bake", "wrinkle-track", "pass-2"] {
            assert!(check_name(good).is_ok(), "{good}");
        }
        for bad in ["", "Bake", "a--b", "-a", "a_b", "2d", "../a", "a b"] {
            assert!(check_name(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn templates_leave_no_placeholder() {
        for (file, template) in TEMPLATES {
            let text = filled(template, "wrinkle-track");
            assert!(!text.contains("{{") || file.ends_with(".rs") && !text.contains("{{name"), "{file}");
            assert!(!text.contains("{{crate"), "{file}");
        }
    }

    #[test]
    fn the_suite_learns_the_call() {
        let text = with_manners(&format!("a\n{MANNERS_MARK}b\n"), "bake").unwrap();
        assert!(text.starts_with("a\n    (\"bake\", ") && text.ends_with(&format!("{MANNERS_MARK}b\n")));
        assert!(with_manners("a\n", "bake").is_err());
    }
}
