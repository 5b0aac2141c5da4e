//! From `cargo metadata` to crates.

use crate::model::{Crate, Dependency, Floor, Flow};
use anyhow::{Context as _, bail};
use serde_json::Value;

/// The crates of the workspace, by name, and the kinds that come from outside.
///
/// # Errors
/// If the JSON is not what `cargo metadata --no-deps` prints, or a furrow table holds an unknown key.
pub(crate) fn parse(metadata: &Value) -> anyhow::Result<(Vec<Crate>, Vec<String>)> {
    let root = metadata["workspace_root"].as_str().context("cargo metadata names no workspace root")?;
    let packages = metadata["packages"].as_array().context("cargo metadata lists no packages")?;
    let mut crates: Vec<Crate> =
        packages.iter().map(|package| package_of(package, root)).collect::<anyhow::Result<_>>()?;
    crates.sort_by(|a, b| a.name.cmp(&b.name));
    Ok((crates, strings(&metadata["metadata"]["furrow"]["sources"])))
}

fn package_of(package: &Value, root: &str) -> anyhow::Result<Crate> {
    let name = package["name"].as_str().context("a package without a name")?.to_string();
    let manifest = package["manifest_path"].as_str().unwrap_or_default().replace('\\', "/");
    let folder = manifest.trim_start_matches(&root.replace('\\', "/")).trim_end_matches("/Cargo.toml");
    let furrow = &package["metadata"]["furrow"];
    only_known_keys(&name, furrow)?;
    let flow = Flow {
        reads: strings(&furrow["reads"]),
        writes: strings(&furrow["writes"]),
        edits: strings(&furrow["edits"]),
        feedback: strings(&furrow["feedback"]),
        source: furrow["source"].as_bool().unwrap_or(false),
    };
    let mut dependencies: Vec<Dependency> =
        package["dependencies"].as_array().into_iter().flatten().filter_map(dependency_of).collect();
    dependencies.sort_by(|a, b| (&a.name, a.dev).cmp(&(&b.name, b.dev)));
    Ok(Crate {
        folder: folder.trim_start_matches('/').to_string(),
        description: package["description"].as_str().unwrap_or_default().to_string(),
        floor: Floor::parse(&furrow["floor"]),
        paper: furrow["paper"].as_str().unwrap_or("–").to_string(),
        flow,
        dependencies,
        lints: false,
        name,
    })
}

/// A key with a spelling mistake would otherwise switch a rule off in silence.
fn only_known_keys(name: &str, furrow: &Value) -> anyhow::Result<()> {
    const KNOWN: [&str; 7] = ["floor", "paper", "reads", "writes", "edits", "feedback", "source"];
    match furrow.as_object().and_then(|table| table.keys().find(|key| !KNOWN.contains(&key.as_str()))) {
        Some(key) => bail!("{name}: [package.metadata.furrow] has an unknown key `{key}`; known: {KNOWN:?}"),
        None => Ok(()),
    }
}

fn dependency_of(dependency: &Value) -> Option<Dependency> {
    let name = dependency["name"].as_str()?.to_string();
    Some(Dependency { name, dev: dependency["kind"].as_str() == Some("dev") })
}

fn strings(value: &Value) -> Vec<String> {
    value.as_array().into_iter().flatten().filter_map(|one| one.as_str().map(str::to_string)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn sample(furrow: Value) -> Value {
        json!({"workspace_root": "/h", "metadata": {"furrow": {"sources": ["mesh"]}}, "packages": [{
            "name": "shell", "description": "d", "manifest_path": "/h/crates/stages/shell/Cargo.toml",
            "metadata": {"furrow": furrow},
            "dependencies": [{"name": "mesh", "kind": null}, {"name": "testkit", "kind": "dev"}]}]})
    }

    #[test]
    fn reads_a_package() {
        let (crates, sources) = parse(&sample(json!({"floor": 4, "reads": ["mesh"]}))).unwrap();
        assert_eq!(sources, ["mesh"]);
        assert_eq!(crates[0].folder, "crates/stages/shell");
        assert!(crates[0].is_stage() && crates[0].flow.reads == ["mesh"]);
        let dev: Vec<bool> = crates[0].dependencies.iter().map(|one| one.dev).collect();
        assert_eq!(dev, [false, true]);
    }

    #[test]
    fn a_misspelt_key_is_refused() {
        let error = parse(&sample(json!({"floor": 4, "read": []}))).unwrap_err().to_string();
        assert!(error.contains("`read`"), "{error}");
    }
}
