//! What flows where: kinds of artifacts have one producer each, and nothing flows in a circle.

use crate::model::{Crate, Finding, House};
use std::collections::{BTreeMap, BTreeSet};

pub(crate) fn check(house: &House) -> Vec<Finding> {
    let mut findings = producers(house);
    findings.extend(orphans(house));
    if let Err(stuck) = order(house) {
        let message = format!(
            "what they read and write runs in a circle; mark what a second pass takes back as `feedback`: {}",
            stuck.join(", ")
        );
        findings.push(Finding::fault("stages", message));
    }
    findings
}

/// Kinds by who writes them; sources are exempt.
fn writers(house: &House) -> BTreeMap<&str, Vec<&str>> {
    let mut writers: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for stage in house.stages().filter(|stage| !stage.flow.source) {
        for kind in &stage.flow.writes {
            writers.entry(kind).or_default().push(&stage.name);
        }
    }
    writers
}

fn producers(house: &House) -> Vec<Finding> {
    let two = writers(house).into_iter().filter(|(_, stages)| stages.len() > 1);
    two.map(|(kind, stages)| {
        Finding::fault(format!("kind {kind}"), format!("has two producers: {}", stages.join(", ")))
    })
    .collect()
}

fn orphans(house: &House) -> Vec<Finding> {
    let mut known: BTreeSet<&str> = house.sources.iter().map(String::as_str).collect();
    known.extend(house.stages().flat_map(|stage| stage.flow.writes.iter().map(String::as_str)));
    let mut findings = Vec::new();
    for stage in house.stages() {
        let flow = &stage.flow;
        let taken = flow.reads.iter().chain(&flow.edits).chain(&flow.feedback);
        findings.extend(taken.filter(|kind| !known.contains(kind.as_str())).map(|kind| {
            let message =
                format!("takes {kind}, which no stage writes and which is no source of the workspace");
            Finding::fault(&stage.name, message)
        }));
    }
    findings
}

/// The stages in the order in which a pipeline runs them: a reader after the producer, by name where both may come
/// first. Editors and sources come as early as they can, those that only inspect last.
///
/// # Errors
/// The stages that wait for each other, if something flows in a circle.
pub(crate) fn order(house: &House) -> Result<Vec<&Crate>, Vec<String>> {
    let (inspecting, mut waiting): (Vec<&Crate>, Vec<&Crate>) =
        house.stages().partition(|stage| is_inspection(stage));
    let mut ordered: Vec<&Crate> = Vec::new();
    while !waiting.is_empty() {
        let to_come: BTreeSet<&str> = waiting
            .iter()
            .filter(|stage| !stage.flow.source)
            .flat_map(|stage| stage.flow.writes.iter().map(String::as_str))
            .collect();
        let ready = waiting.iter().position(|stage| {
            stage.flow.source || !stage.flow.reads.iter().any(|kind| to_come.contains(kind.as_str()))
        });
        match ready {
            Some(at) => ordered.push(waiting.remove(at)),
            None => return Err(waiting.iter().map(|stage| stage.name.clone()).collect()),
        }
    }
    ordered.extend(inspecting);
    Ok(ordered)
}

/// Whether a stage only looks at artifacts.
pub(crate) fn is_inspection(stage: &Crate) -> bool {
    stage.flow.writes.is_empty() && stage.flow.edits.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Flow;
    use crate::rules::samples::{house, stage};

    fn chain() -> Vec<Crate> {
        vec![
            stage("bake", &["wrinkled"], &["map"]),
            stage("diff", &["map", "mesh"], &[]),
            stage("shell", &["mesh", "warp"], &["wrinkled"]),
            stage("warp", &["take"], &["warp"]),
        ]
    }

    fn found(change: impl FnOnce(&mut Vec<Crate>)) -> Vec<String> {
        let mut crates = chain();
        change(&mut crates);
        check(&house(crates)).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn a_chain_is_sound_and_ordered() {
        assert_eq!(found(|_| ()), Vec::<String>::new());
        let sound = house(chain());
        let names: Vec<&str> = order(&sound).unwrap().iter().map(|stage| stage.name.as_str()).collect();
        assert_eq!(names, ["warp", "shell", "bake", "diff"]);
    }

    #[test]
    fn a_circle_is_found() {
        let faults = found(|crates| crates[3].flow.reads.push("map".into()));
        assert!(faults[0].contains("circle") && faults[0].contains("bake, shell, warp"), "{faults:?}");
    }

    #[test]
    fn a_circle_of_one_is_found() {
        assert!(found(|crates| crates[3].flow.reads.push("warp".into()))[0].contains("circle"));
    }

    #[test]
    fn feedback_edits_and_sources_may_turn_back() {
        let faults = found(|crates| {
            crates[3].flow.feedback.push("map".into());
            crates[3].flow.edits.push("warp".into());
            let mut rig = stage("rig", &["map"], &["take", "warp"]);
            rig.flow.source = true;
            crates.push(rig);
        });
        assert_eq!(faults, Vec::<String>::new());
    }

    #[test]
    fn two_producers_are_found() {
        let faults = found(|crates| crates[0].flow.writes.push("warp".into()));
        assert!(faults.iter().any(|fault| fault.contains("two producers: bake, warp")), "{faults:?}");
    }

    #[test]
    fn an_orphan_is_found() {
        let plant: [fn(&mut Flow) -> &mut Vec<String>; 3] =
            [|flow| &mut flow.reads, |flow| &mut flow.edits, |flow| &mut flow.feedback];
        for list in plant {
            let faults = found(|crates| list(&mut crates[2].flow).push("cameras".into()));
            assert!(faults[0].contains("shell: takes cameras"), "{faults:?}");
        }
    }
}
