//! Every crate stands on a floor, and uses only what lies below.

use crate::model::{Crate, Finding, Floor, House};

/// Libraries that are at home on some floors only, and the lowest of these.
const AT_HOME_FROM: [(&str, u8); 8] = [
    ("clap", 3),
    ("anyhow", 3),
    ("indicatif", 3),
    ("ctrlc", 3),
    ("serde_json", 2),
    ("image", 2),
    ("sprs", 2),
    ("faer", 2),
];

pub(crate) fn check(house: &House) -> Vec<Finding> {
    house.crates.iter().flat_map(|one| check_crate(house, one)).collect()
}

fn check_crate(house: &House, one: &Crate) -> Vec<Finding> {
    let Some(floor) = one.floor else {
        let message =
            "declares no floor: say `floor = 1` … `5`, \"wing\" or \"tool\" in [package.metadata.furrow]";
        return vec![Finding::fault(&one.name, message)];
    };
    let mut findings = Vec::new();
    if !one.lints {
        findings.push(Finding::fault(
            &one.name,
            "does not inherit the lints: add `[lints]` with `workspace = true`",
        ));
    }
    for dependency in &one.dependencies {
        let used = match house.find(&dependency.name) {
            Some(inner) => inner_fault(floor, inner, dependency.dev),
            None => outer_fault(floor, &dependency.name, dependency.dev),
        };
        findings.extend(used.map(|message| Finding::fault(&one.name, message)));
    }
    findings
}

/// What is wrong with using a crate of the house.
fn inner_fault(floor: Floor, used: &Crate, dev: bool) -> Option<String> {
    let name = &used.name;
    match (floor, used.floor?, dev) {
        (Floor::Level(4), Floor::Level(4), _) => {
            Some(format!("depends on the stage {name}: stages meet only in artifacts"))
        }
        (_, _, true) => None,
        (_, Floor::Wing, false) => Some(format!("depends on {name}, which serves tests only")),
        (_, Floor::Tool, false) => Some(format!("depends on {name}, which serves the house only")),
        (_, Floor::Level(level), false) if level > floor.reach() => {
            Some(format!("stands on {floor} and depends on {name} on floor {level}: that does not go down"))
        }
        _ => None,
    }
}

/// What is wrong with using a library from outside.
fn outer_fault(floor: Floor, name: &str, dev: bool) -> Option<String> {
    let Floor::Level(level) = floor else { return None };
    let (_, from) = AT_HOME_FROM.iter().find(|(other, _)| *other == name)?;
    (!dev && level < *from)
        .then(|| format!("stands on {floor} and uses {name}, at home from floor {from} on"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::samples::{house, room, stage};

    fn messages(crates: Vec<Crate>) -> Vec<String> {
        check(&house(crates)).iter().map(ToString::to_string).collect()
    }

    fn rooms() -> Vec<Crate> {
        vec![
            room("mesh", Floor::Level(1), &["nalgebra"]),
            room("artifact", Floor::Level(2), &["mesh", "serde_json"]),
            room("testkit", Floor::Wing, &["mesh", "artifact"]),
            stage("warp", &["mesh"], &["warp"]),
        ]
    }

    fn found(change: impl FnOnce(&mut Vec<Crate>)) -> Vec<String> {
        let mut crates = rooms();
        change(&mut crates);
        messages(crates)
    }

    #[test]
    fn a_sound_house_has_no_fault() {
        assert_eq!(found(|_| ()), Vec::<String>::new());
    }

    #[test]
    fn a_floor_must_be_declared() {
        assert!(found(|crates| crates[0].floor = None)[0].contains("declares no floor"));
    }

    #[test]
    fn sideways_and_upwards_are_refused() {
        let sideways = found(|crates| crates.push(room("operators", Floor::Level(2), &["artifact"])));
        assert!(sideways[0].contains("operators") && sideways[0].contains("does not go down"));
        let upwards = found(|crates| crates.push(room("camera", Floor::Level(1), &["artifact"])));
        assert!(upwards[0].contains("does not go down"));
    }

    #[test]
    fn a_stage_never_uses_a_stage_not_even_in_tests() {
        for dev in [false, true] {
            let faults = found(|crates| {
                let mut other = stage("shell", &[], &[]);
                other.dependencies.push(crate::model::Dependency { name: "warp".into(), dev });
                crates.push(other);
            });
            assert!(faults[0].contains("stages meet only in artifacts"));
        }
    }

    #[test]
    fn the_wing_serves_tests_only() {
        let faults = found(|crates| crates.push(room("operators", Floor::Level(2), &["testkit"])));
        assert!(faults[0].contains("serves tests only"));
        let wing = found(|crates| crates.push(room("props", Floor::Wing, &["warp"])));
        assert!(wing[0].contains("does not go down"));
    }

    #[test]
    fn the_shells_libraries_stay_upstairs() {
        let faults = found(|crates| crates.push(room("camera", Floor::Level(1), &["anyhow"])));
        assert!(faults[0].contains("at home from floor 3"));
    }

    #[test]
    fn lints_are_inherited() {
        assert!(found(|crates| crates[1].lints = false)[0].contains("[lints]"));
    }
}
