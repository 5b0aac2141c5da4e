//! The drawings in the README show the house as it is.

use crate::model::{Finding, House};
use crate::{picture, table};

pub(crate) fn check(house: &House) -> Vec<Finding> {
    // A circle has no order to draw in; its own rule reports it.
    let Ok(stages) = super::order(house) else { return Vec::new() };
    let mut findings = Vec::new();
    match house.text(table::FILE).map(|readme| table::replace(readme, &table::draw(&stages))) {
        None => findings.push(Finding::fault(table::FILE, "is missing")),
        Some(Err(message)) => findings.push(Finding::fault(table::FILE, message)),
        Some(Ok(fresh)) if Some(fresh.as_str()) != house.text(table::FILE) => {
            let message = "its stage table is out of date: run `cargo run -q -p house -- table --write`";
            findings.push(Finding::fault(table::FILE, message));
        }
        Some(Ok(_)) => (),
    }
    if house.text(picture::FILE) != Some(picture::draw(&stages).as_str()) {
        let message = "is out of date: run `cargo run -q -p house -- picture --write`";
        findings.push(Finding::fault(picture::FILE, message));
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::SourceFile;
    use crate::rules::samples::{house, stage};

    fn sound() -> House {
        let mut house = house(vec![stage("shell", &["mesh"], &["warp"])]);
        let stages = super::super::order(&house).unwrap();
        let frame = format!("# A\n{}\n{}\n", table::BEGIN, table::END);
        let readme = table::replace(&frame, &table::draw(&stages)).unwrap();
        let picture = picture::draw(&stages);
        house.files = vec![SourceFile::new(table::FILE, readme), SourceFile::new(picture::FILE, picture)];
        house
    }

    #[test]
    fn fresh_drawings_are_sound() {
        assert_eq!(check(&sound()), []);
    }

    #[test]
    fn a_changed_stage_makes_both_stale() {
        let mut house = sound();
        house.crates[0].flow.writes.push("handles".into());
        assert_eq!(check(&house).len(), 2);
    }

    #[test]
    fn missing_markers_are_found() {
        let mut house = sound();
        house.files[0].text = "# A\n".into();
        assert!(check(&house)[0].message.contains(table::BEGIN));
    }
}
