//! Reading the workspace and writing into it: the only room of this tool that touches the disk.

use crate::metadata;
use crate::model::{House, SourceFile};
use anyhow::{Context as _, bail};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Endings of the files whose text the rules look at; files without one are scripts.
const TEXTS: [&str; 7] = ["rs", "md", "py", "toml", "bib", "svg", "sh"];

/// The root of the workspace that the current folder is in.
///
/// # Errors
/// If there is none.
pub(crate) fn root() -> anyhow::Result<PathBuf> {
    let printed =
        run("cargo", &["locate-project", "--workspace", "--message-format", "plain"], Path::new("."))?;
    let root = Path::new(printed.trim()).parent().context("the workspace's Cargo.toml stands nowhere")?;
    Ok(root.to_path_buf())
}

/// Reads the whole house.
///
/// # Errors
/// If `cargo metadata` or `git` fails, or a file cannot be read.
pub(crate) fn read_house(root: &Path) -> anyhow::Result<House> {
    let printed = run("cargo", &["metadata", "--format-version", "1", "--no-deps"], root)?;
    let (mut crates, sources) = metadata::parse(&serde_json::from_str(&printed)?)?;
    let paths = paths(root)?;
    let files: Vec<SourceFile> = paths
        .iter()
        .filter(|path| is_text(path))
        .map(|path| Ok(SourceFile::new(path.as_str(), read(&root.join(path))?)))
        .collect::<anyhow::Result<_>>()?;
    for one in &mut crates {
        let manifest = read(&root.join(&one.folder).join("Cargo.toml"))?;
        one.lints = manifest
            .split("[lints]")
            .nth(1)
            .is_some_and(|rest| rest.trim_start().starts_with("workspace = true"));
    }
    Ok(House { crates, sources, paths, files })
}

fn is_text(path: &str) -> bool {
    let ending = Path::new(path).extension().map(|ending| ending.to_string_lossy().to_string());
    // Templates of the skeleton are no Rust of ours, and snapshots are nobody's prose.
    ending.is_some_and(|ending| TEXTS.contains(&ending.as_str())) && !path.starts_with("fixtures/")
}

/// What git tracks or would take, without what was deleted.
fn paths(root: &Path) -> anyhow::Result<Vec<String>> {
    let listed = run("git", &["ls-files", "-z", "--cached", "--others", "--exclude-standard"], root)?;
    let mut paths: Vec<String> = listed
        .split('\0')
        .filter(|path| !path.is_empty() && root.join(path).is_file())
        .map(str::to_string)
        .collect();
    paths.sort();
    paths.dedup();
    Ok(paths)
}

/// Runs a program and returns what it prints.
///
/// # Errors
/// If it cannot be started or fails.
pub(crate) fn run(program: &str, arguments: &[&str], folder: &Path) -> anyhow::Result<String> {
    let output = Command::new(program)
        .args(arguments)
        .current_dir(folder)
        .output()
        .with_context(|| format!("{program} cannot be started"))?;
    if !output.status.success() {
        bail!("{program} {}: {}", arguments.join(" "), String::from_utf8_lossy(&output.stderr).trim());
    }
    Ok(String::from_utf8(output.stdout)?)
}

/// Reads a text.
///
/// # Errors
/// If it cannot be read.
#[allow(clippy::disallowed_methods, reason = "this tool reads sources, not artifacts")]
pub(crate) fn read(path: &Path) -> anyhow::Result<String> {
    std::fs::read_to_string(path).with_context(|| path.display().to_string())
}

/// Writes a text, and the folders it stands in.
///
/// # Errors
/// If it cannot be written.
#[allow(clippy::disallowed_methods, reason = "this tool writes sources, not artifacts")]
pub(crate) fn write(path: &Path, text: &str) -> anyhow::Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    std::fs::write(path, text).with_context(|| path.display().to_string())
}
