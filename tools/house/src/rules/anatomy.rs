//! Every stage is built alike.

use crate::model::{Crate, Finding, House};

/// What every stage has.
const REQUIRED: [&str; 4] = ["README.md", "src/lib.rs", "src/main.rs", "tests/cli.rs"];
/// What a stage has unless there is a reason.
const USUAL: [&str; 3] = ["src/error.rs", "src/params.rs", "tests/properties.rs"];
/// What a stage's README speaks about.
const CHAPTERS: [&str; 5] = ["reads", "writes", "method", "parameters", "limits"];

pub(crate) fn check(house: &House) -> Vec<Finding> {
    house.stages().flat_map(|stage| check_stage(house, stage)).collect()
}

fn check_stage(house: &House, stage: &Crate) -> Vec<Finding> {
    let folder = &stage.folder;
    let lacks = |name: &&&str| !house.has(&format!("{folder}/{name}"));
    let mut findings: Vec<Finding> = REQUIRED
        .iter()
        .filter(lacks)
        .map(|name| Finding::fault(&stage.name, format!("has no {name}")))
        .collect();
    findings.extend(
        USUAL.iter().filter(lacks).map(|name| Finding::warning(&stage.name, format!("has no {name}"))),
    );
    if let Some(readme) = house.text(&format!("{folder}/README.md")) {
        let readme = readme.to_lowercase();
        let silent = CHAPTERS.iter().filter(|chapter| !readme.contains(**chapter));
        findings.extend(silent.map(|chapter| {
            Finding::warning(format!("{folder}/README.md"), format!("does not say its {chapter}"))
        }));
    }
    if folder != &format!("crates/stages/{}", stage.name) {
        findings.push(Finding::fault(
            &stage.name,
            format!("stands in {folder}, not in crates/stages/{}", stage.name),
        ));
    }
    if stage.description.is_empty() {
        findings.push(Finding::fault(&stage.name, "has no `description` in its Cargo.toml"));
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{SourceFile, Weight};
    use crate::rules::samples::{house, stage};

    fn sound() -> House {
        let mut house = house(vec![stage("shell", &["mesh"], &["warp"])]);
        house.paths =
            REQUIRED.iter().chain(&USUAL).map(|name| format!("crates/stages/shell/{name}")).collect();
        let readme = "Reads a. Writes b.\n## Method\n## Parameters\n## Limits";
        house.files.push(SourceFile::new("crates/stages/shell/README.md", readme));
        house
    }

    #[test]
    fn a_whole_stage_is_sound() {
        assert_eq!(check(&sound()), []);
    }

    #[test]
    fn each_missing_organ_is_found() {
        for (at, name) in REQUIRED.iter().chain(&USUAL).enumerate() {
            let mut house = sound();
            house.paths.remove(at);
            let findings = check(&house);
            let weight = if at < REQUIRED.len() { Weight::Fault } else { Weight::Warning };
            assert!(findings[0].message.contains(name) && findings[0].weight == weight, "{findings:?}");
        }
    }

    #[test]
    fn a_silent_readme_is_found() {
        let mut house = sound();
        house.files[0].text = "Reads a. Writes b. Method. Parameters.".into();
        assert!(check(&house)[0].message.contains("limits"));
    }

    #[test]
    fn a_stage_in_the_wrong_place_is_found() {
        let mut house = sound();
        house.crates[0].folder = "crates/shell".into();
        assert!(check(&house).iter().any(|finding| finding.message.contains("stands in crates/shell")));
    }

    #[test]
    fn a_stage_without_a_description_is_found() {
        let mut house = sound();
        house.crates[0].description.clear();
        assert!(check(&house)[0].message.contains("description"));
    }
}
