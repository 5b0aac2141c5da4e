//! The pipeline as a picture: artifacts and stages from left to right, drawn from what the stages declare.
//! The same stages give the same bytes.

mod layout;

use crate::model::Crate;
use crate::rules::is_inspection;
use layout::{Edge, Layout, Node};
use std::fmt::Write as _;

/// Where the picture stands.
pub(crate) const FILE: &str = "docs/pipeline.svg";

/// Distance between columns and between rows, and the margin, in pixels.
const COLUMN: f64 = 178.0;
const ROW: f64 = 46.0;
const MARGIN: f64 = 24.0;
/// Half the size of a box.
const HALF_WIDTH: f64 = 66.0;
const HALF_HEIGHT: f64 = 15.0;
/// Distance of the lines below a box.
const NOTE: f64 = 12.0;

const STYLE: &str = "text{font:13px ui-sans-serif,Helvetica,Arial,sans-serif;fill:#1d2733;text-anchor:middle}\
    .stage rect{fill:#1f5f8b;stroke:#163f5c}.stage text{fill:#fff;font-weight:600}\
    .kind rect{fill:#f3ead7;stroke:#b99b62}\
    path{fill:none;stroke:#6b7886;stroke-width:1.5;marker-end:url(#tip)}\
    .edits{stroke-dasharray:5 3;marker-start:url(#tip)}.feedback{stroke-dasharray:2 3}\
    .note{fill:#55616e;text-anchor:start}.afar{font-size:10.5px;fill:#55616e}";

/// The picture of the stages, in the order given.
pub(crate) fn draw(stages: &[&Crate]) -> String {
    let (inspecting, working): (Vec<&Crate>, Vec<&Crate>) =
        stages.iter().copied().partition(|stage| is_inspection(stage));
    let layout = Layout::of(&working);
    let width = 2.0 * (MARGIN + HALF_WIDTH) + layout.columns.saturating_sub(1) as f64 * COLUMN;
    let bottom = 2.0 * MARGIN + 2.0 * HALF_HEIGHT + layout.height * ROW;
    let height = bottom + if inspecting.is_empty() { 0.0 } else { MARGIN };
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
         height=\"{height:.0}\" role=\"img\">\n<title>Stages (blue) and the artifacts they read and write; with a +, those that come from farther away</title>\n\
         <style>{STYLE}</style>\n<defs><marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" \
         markerWidth=\"7\" markerHeight=\"7\" orient=\"auto-start-reverse\"><path d=\"M0 0L8 4L0 8z\" \
         style=\"fill:#6b7886;stroke:none;marker-end:none\"/></marker></defs>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    layout.edges.iter().for_each(|edge| draw_edge(&mut svg, &layout, edge));
    layout.nodes.iter().for_each(|node| draw_node(&mut svg, node));
    if !inspecting.is_empty() {
        let names: Vec<&str> = inspecting.iter().map(|stage| stage.name.as_str()).collect();
        let y = bottom;
        let _ = writeln!(
            svg,
            "<text class=\"note\" x=\"{MARGIN:.0}\" y=\"{y:.0}\">Beside the pipeline, to look at artifacts: {}</text>",
            names.join(", ")
        );
    }
    svg.push_str("</svg>\n");
    svg
}

fn centre(column: usize, row: f64) -> (f64, f64) {
    (MARGIN + HALF_WIDTH + column as f64 * COLUMN, MARGIN + HALF_HEIGHT + row * ROW)
}

fn draw_node(svg: &mut String, node: &Node) {
    let Some(name) = &node.name else { return };
    let (x, y) = centre(node.column, node.row);
    let (class, round) = if node.is_stage { ("stage", 4) } else { ("kind", 14) };
    let _ = writeln!(
        svg,
        "<g class=\"{class}\"><rect x=\"{:.0}\" y=\"{:.0}\" width=\"{:.0}\" height=\"{:.0}\" rx=\"{round}\"/>\
         <text x=\"{x:.0}\" y=\"{:.0}\">{name}</text></g>",
        x - HALF_WIDTH,
        y - HALF_HEIGHT,
        2.0 * HALF_WIDTH,
        2.0 * HALF_HEIGHT,
        y + 4.5
    );
    for (line, note) in node.notes.iter().enumerate() {
        let below = y + HALF_HEIGHT + NOTE * (line + 1) as f64;
        let _ = writeln!(svg, "<text class=\"afar\" x=\"{x:.0}\" y=\"{below:.0}\">{note}</text>");
    }
}

/// A smooth line from the right side of one box, through the gaps it passes, to the left side of another.
fn draw_edge(svg: &mut String, layout: &Layout, edge: &Edge) {
    let at = |node: usize| centre(layout.nodes[node].column, layout.nodes[node].row);
    let last = edge.through.len() - 1;
    let (x, y) = at(edge.through[0]);
    let mut line = format!("M{:.0} {y:.0}", x + HALF_WIDTH);
    for (k, pair) in edge.through.windows(2).enumerate() {
        let ((ax, ay), (bx, by)) = (at(pair[0]), at(pair[1]));
        let (ax, bx) = (ax + HALF_WIDTH, bx - HALF_WIDTH);
        let bend = (bx - ax).abs().max(30.0) / 2.0;
        let _ = write!(line, "C{:.0} {ay:.0} {:.0} {by:.0} {bx:.0} {by:.0}", ax + bend, bx - bend);
        if k + 1 < last {
            let _ = write!(line, "H{:.0}", bx + 2.0 * HALF_WIDTH);
        }
    }
    let _ = writeln!(svg, "<path class=\"{}\" d=\"{line}\"/>", edge.class);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::samples::stage;

    #[test]
    fn everything_is_drawn_once_and_repeatably() {
        let mut clip = stage("clip", &[], &["map"]);
        clip.flow.edits.push("mesh".into());
        let stages = [clip, stage("warp", &["take", "mesh"], &["warp"]), stage("diff", &["mesh"], &[])];
        let stages: Vec<&Crate> = stages.iter().collect();
        let svg = draw(&stages);
        for name in ["clip", "map", "mesh", "take"] {
            assert_eq!(svg.matches(&format!(">{name}</text>")).count(), 1, "{name}");
        }
        assert_eq!(svg.matches(">warp</text>").count(), 2, "a stage and a kind may share a name");
        assert_eq!(svg.matches("<path class=").count(), 5);
        assert_eq!(svg.matches("class=\"edits\"").count(), 1);
        assert!(svg.contains("to look at artifacts: diff"));
        assert_eq!(svg, draw(&stages));
    }

    #[test]
    fn what_comes_from_afar_is_named_and_strips_are_cut_before_a_stage() {
        let kinds: Vec<String> = (0..9).map(|i| format!("k{i}")).collect();
        let chain = |i: usize| stage(&format!("s{i}"), &[&kinds[i], "k0"], &[&kinds[i + 1]]);
        let stages: Vec<Crate> = (0..8).map(chain).collect();
        let stages: Vec<&Crate> = stages.iter().collect();
        let layout = Layout::of(&stages);
        let notes = |name: &str| {
            let mut nodes = layout.nodes.iter();
            nodes.find(|node| node.name.as_deref() == Some(name)).map(|node| node.notes.clone())
        };
        assert_eq!(notes("s1"), Some(vec![]), "a line reaches so far");
        assert_eq!(notes("s4"), Some(vec!["+ k0".to_string()]));
        assert_eq!(notes("s6"), Some(vec!["+ k6, k0".to_string()]), "the first stage of the second strip");
        assert_eq!(layout.columns, 13);
    }

    #[test]
    fn no_two_boxes_overlap() {
        let stages = [stage("a", &["m", "n", "o"], &["p", "q", "r"]), stage("b", &["p", "m"], &["s"])];
        let layout = Layout::of(&stages.iter().collect::<Vec<_>>());
        for (k, one) in layout.nodes.iter().enumerate() {
            for two in &layout.nodes[k + 1..] {
                assert!(one.column != two.column || (one.row - two.row).abs() > 0.9, "{one:?} {two:?}");
            }
        }
    }
}
