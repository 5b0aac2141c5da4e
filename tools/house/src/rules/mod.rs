//! The rules of the house: pure functions from the house to what is wrong in it, one file each.

mod anatomy;
mod citations;
mod drawings;
mod floors;
mod kinds;
mod lengths;
mod purity;
mod reasons;
mod top_level;

use crate::model::{Finding, House};

pub(crate) use kinds::{is_inspection, order};

type Rule = fn(&House) -> Vec<Finding>;

/// Every rule, with the name it is reported under.
const RULES: [(&str, Rule); 9] = [
    ("floors", floors::check),
    ("kinds", kinds::check),
    ("top level", top_level::check),
    ("anatomy", anatomy::check),
    ("purity", purity::check),
    ("reasons", reasons::check),
    ("citations", citations::check),
    ("drawings", drawings::check),
    ("lengths", lengths::check),
];

/// What all rules find, under their names.
pub(crate) fn check(house: &House) -> Vec<(&'static str, Finding)> {
    let mut findings: Vec<(&str, Finding)> = RULES
        .iter()
        .flat_map(|(name, rule)| rule(house).into_iter().map(|finding| (*name, finding)))
        .collect();
    findings.sort_by_key(|(_, finding)| finding.weight);
    findings
}

#[cfg(test)]
pub(crate) mod samples {
    //! A small sound house to break.

    use crate::model::{Crate, Dependency, Floor, Flow, House, SourceFile};

    pub(crate) fn room(name: &str, floor: Floor, uses: &[&str]) -> Crate {
        let folder = if floor == crate::model::STAGES { "stages" } else { "shared" };
        Crate {
            name: name.into(),
            folder: format!("crates/{folder}/{name}"),
            description: "Does one thing".into(),
            floor: Some(floor),
            paper: "–".into(),
            flow: Flow::default(),
            dependencies: uses.iter().map(|name| Dependency { name: (*name).into(), dev: false }).collect(),
            lints: true,
        }
    }

    pub(crate) fn stage(name: &str, reads: &[&str], writes: &[&str]) -> Crate {
        let own = |names: &[&str]| names.iter().map(|name| (*name).to_string()).collect();
        let flow = Flow { reads: own(reads), writes: own(writes), ..Flow::default() };
        Crate { flow, ..room(name, Floor::Level(4), &["mesh", "clap"]) }
    }

    pub(crate) fn house(crates: Vec<Crate>) -> House {
        House { crates, sources: vec!["mesh".into(), "take".into()], ..House::default() }
    }

    /// A house with one file.
    pub(crate) fn with_file(path: &str, text: &str) -> House {
        let mut sound = house(vec![room("mesh", Floor::Level(1), &[]), stage("shell", &["mesh"], &["warp"])]);
        sound.files.push(SourceFile::new(path, text));
        sound.paths.push(path.into());
        sound
    }
}
