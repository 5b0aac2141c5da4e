//! The README's table of stages, drawn from what the stages declare.

use crate::model::Crate;

/// Where the table stands.
pub(crate) const FILE: &str = "README.md";
/// The line before the table.
pub(crate) const BEGIN: &str = "<!-- stages: drawn by `house table --write` -->";
/// The line after it.
pub(crate) const END: &str = "<!-- end of stages -->";

/// The table of the stages, in the order given.
pub(crate) fn draw(stages: &[&Crate]) -> String {
    let mut table =
        String::from("| stage | what it does | reads | writes | paper |\n|---|---|---|---|---|\n");
    for stage in stages {
        let flow = &stage.flow;
        let reads = flow.reads.iter().map(|kind| format!("`{kind}`"));
        let feedback = flow.feedback.iter().map(|kind| format!("`{kind}` (second pass)"));
        let reads: Vec<String> = reads.chain(feedback).collect();
        let edits = flow.edits.iter().map(|kind| format!("edits `{kind}`"));
        let writes: Vec<String> = flow.writes.iter().map(|kind| format!("`{kind}`")).chain(edits).collect();
        table.push_str(&format!(
            "| [`{}`]({}) | {} | {} | {} | {} |\n",
            stage.name,
            stage.folder,
            stage.description,
            listed(&reads),
            listed(&writes),
            stage.paper
        ));
    }
    table
}

fn listed(names: &[String]) -> String {
    if names.is_empty() { "–".to_string() } else { names.join(", ") }
}

/// A text with the table between its markers replaced.
///
/// # Errors
/// If a marker is missing.
pub(crate) fn replace(text: &str, table: &str) -> Result<String, String> {
    let missing = || format!("lacks the markers `{BEGIN}` and `{END}`, between which the stage table stands");
    let (before, rest) = text.split_once(BEGIN).ok_or_else(missing)?;
    let (_, after) = rest.split_once(END).ok_or_else(missing)?;
    Ok(format!("{before}{BEGIN}\n{table}{END}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::samples::stage;

    #[test]
    fn every_flow_is_told() {
        let mut shell = stage("shell", &["mesh"], &["warp"]);
        shell.flow.edits.push("scan".into());
        shell.flow.feedback.push("take".into());
        let table = draw(&[&shell]);
        assert!(
            table.contains(
                "| [`shell`](crates/stages/shell) | Does one thing | `mesh`, `take` (second pass) |"
            )
        );
        assert!(table.contains("| `warp`, edits `scan` | – |"), "{table}");
        assert!(draw(&[&stage("diff", &["mesh"], &[])]).contains("| `mesh` | – | – |"));
    }

    #[test]
    fn replacing_keeps_the_rest_and_is_stable() {
        let text = format!("a\n{BEGIN}\nold\n{END}\nb\n");
        let once = replace(&text, "new\n").unwrap();
        assert_eq!(once, format!("a\n{BEGIN}\nnew\n{END}\nb\n"));
        assert_eq!(replace(&once, "new\n").unwrap(), once);
    }
}
