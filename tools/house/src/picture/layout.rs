//! A layered drawing in the manner of Sugiyama: columns by the longest way from the start, an order in each column
//! by the mean place of the neighbours, then rows that pull neighbours level.

use crate::model::Crate;
use std::collections::BTreeMap;

/// Rounds of ordering and of levelling; the drawing is still long before.
const ROUNDS: usize = 24;
/// Columns that a line may bridge; what comes from farther is named below the stage's box, or the drawing is all lines.
const LONGEST: usize = 3;
/// Columns of a strip: the drawing goes on below, between what a stage writes and who takes it, so that a page can show it.
const STRIP: usize = 13;
/// Rows between strips.
const GAP: f64 = 0.6;
/// Letters on a line below a box, and what such a line takes of a row.
const NOTE_LETTERS: usize = 27;
const NOTE_ROWS: f64 = 0.28;

/// A box, or a gap that a long edge passes (without a name).
#[derive(Debug)]
pub(crate) struct Node {
    pub(crate) name: Option<String>,
    pub(crate) is_stage: bool,
    pub(crate) column: usize,
    /// Rows count from 0 at the top; fractions are fine.
    pub(crate) row: f64,
    /// Lines below the box: what the stage takes from afar.
    pub(crate) notes: Vec<String>,
}

/// A line between two boxes.
#[derive(Debug)]
pub(crate) struct Edge {
    /// The box it leaves, the gaps it passes, the box it enters.
    pub(crate) through: Vec<usize>,
    pub(crate) class: &'static str,
}

/// Boxes with places, and lines between them.
#[derive(Debug)]
pub(crate) struct Layout {
    pub(crate) nodes: Vec<Node>,
    pub(crate) edges: Vec<Edge>,
    pub(crate) columns: usize,
    /// The lowest row.
    pub(crate) height: f64,
}

impl Layout {
    /// Places stages and their kinds; producers come before readers in `stages`.
    pub(crate) fn of(stages: &[&Crate]) -> Self {
        let mut layout = Self { nodes: Vec::new(), edges: Vec::new(), columns: 0, height: 0.0 };
        layout.place_boxes(stages);
        let mut afar: BTreeMap<usize, Vec<String>> = BTreeMap::new();
        for (from, to, class) in links(stages) {
            layout.connect(&from, &to, class, &mut afar);
        }
        for (node, names) in afar {
            layout.nodes[node].notes = lines(&names);
        }
        layout.columns = layout.nodes.iter().map(|node| node.column + 1).max().unwrap_or(0);
        layout.arrange();
        layout.fold();
        layout
    }

    fn place_boxes(&mut self, stages: &[&Crate]) {
        let mut kinds: BTreeMap<&str, usize> = BTreeMap::new();
        let mut columns: Vec<usize> = vec![0; stages.len()];
        // Producers come first, but an editor may edit a kind whose producer comes after it: hence several times.
        for _ in 0..stages.len() {
            for (column, stage) in columns.iter_mut().zip(stages) {
                *column = column_of(stage, &mut kinds);
            }
        }
        for (kind, column) in &mut kinds {
            let name = kind.to_string();
            if stages.iter().any(|stage| stage.flow.writes.contains(&name)) {
                continue;
            }
            // What nobody makes stands before the first stage that takes it.
            let takers = stages
                .iter()
                .zip(&columns)
                .filter(|(stage, _)| stage.flow.reads.contains(&name) || stage.flow.edits.contains(&name));
            *column = takers.map(|(_, column)| column - 1).min().unwrap_or(*column);
        }
        let boxes = kinds.into_iter().map(|(kind, column)| (kind.to_string(), false, column));
        let named = stages.iter().zip(columns).map(|(stage, column)| (stage.name.clone(), true, column));
        for (name, is_stage, column) in boxes.chain(named) {
            self.nodes.push(Node { name: Some(name), is_stage, column, row: 0.0, notes: Vec::new() });
        }
    }

    /// Draws a line, or names in `afar` what a stage takes from too far.
    fn connect(
        &mut self,
        from: &Place,
        to: &Place,
        class: &'static str,
        afar: &mut BTreeMap<usize, Vec<String>>,
    ) {
        let kind = &from.0;
        let (Some(from), Some(to)) = (self.find(from), self.find(to)) else { return };
        let (start, end) = (self.nodes[from].column, self.nodes[to].column);
        if end <= start || end - start > LONGEST || start / STRIP != end / STRIP {
            let name = match class {
                "reads" => kind.clone(),
                _ => format!("{kind} ({class})"),
            };
            return afar.entry(to).or_default().push(name);
        }
        let mut through = vec![from];
        for column in self.nodes[from].column + 1..self.nodes[to].column {
            through.push(self.nodes.len());
            self.nodes.push(Node { name: None, is_stage: false, column, row: 0.0, notes: Vec::new() });
        }
        through.push(to);
        self.edges.push(Edge { through, class });
    }

    fn find(&self, (name, is_stage): &Place) -> Option<usize> {
        self.nodes.iter().position(|node| node.name.as_ref() == Some(name) && node.is_stage == *is_stage)
    }

    /// Orders each column by its neighbours' mean row, then levels the rows.
    fn arrange(&mut self) {
        let mut neighbours: Vec<Vec<usize>> = vec![Vec::new(); self.nodes.len()];
        for pair in self.edges.iter().flat_map(|edge| edge.through.windows(2)) {
            neighbours[pair[0]].push(pair[1]);
            neighbours[pair[1]].push(pair[0]);
        }
        let mut columns: Vec<Vec<usize>> = vec![Vec::new(); self.columns];
        (0..self.nodes.len()).for_each(|node| columns[self.nodes[node].column].push(node));
        for column in &columns {
            column.iter().enumerate().for_each(|(row, &node)| self.nodes[node].row = row as f64);
        }
        for round in 0..ROUNDS {
            for step in 0..columns.len() {
                let at = if round % 2 == 0 { step } else { columns.len() - 1 - step };
                let wish: BTreeMap<usize, f64> =
                    columns[at].iter().map(|&node| (node, self.mean_row(node, &neighbours[node]))).collect();
                if round < ROUNDS / 2 {
                    columns[at].sort_by(|a, b| wish[a].total_cmp(&wish[b]).then(a.cmp(b)));
                }
                self.level(&columns[at], &wish);
            }
        }
    }

    /// Lays the strips one below the other.
    fn fold(&mut self) {
        let mut below = 0.0;
        for strip in 0..self.columns.div_ceil(STRIP) {
            let mut nodes: Vec<&mut Node> =
                self.nodes.iter_mut().filter(|node| node.column / STRIP == strip).collect();
            let top = nodes.iter().map(|node| node.row).fold(f64::INFINITY, f64::min);
            for node in &mut nodes {
                node.row += below - top;
                node.column %= STRIP;
            }
            self.height = nodes.iter().map(|node| node.row + node.rows() - 1.0).fold(0.0, f64::max);
            below = self.height + 1.0 + GAP;
        }
        self.columns = self.columns.min(STRIP);
    }

    fn mean_row(&self, node: usize, neighbours: &[usize]) -> f64 {
        if neighbours.is_empty() {
            return self.nodes[node].row;
        }
        neighbours.iter().map(|&other| self.nodes[other].row).sum::<f64>() / neighbours.len() as f64
    }

    /// Gives each node of a column its wished row, or the nearest with one row between neighbours in the column.
    fn level(&mut self, column: &[usize], wish: &BTreeMap<usize, f64>) {
        let mut row = f64::NEG_INFINITY;
        for node in column {
            let place = wish[node].max(row);
            self.nodes[*node].row = place;
            row = place + self.nodes[*node].rows();
        }
        // Pushing down only would sink the column: the mean push goes back up.
        let push: f64 = column.iter().map(|node| self.nodes[*node].row - wish[node]).sum();
        let back = push / column.len().max(1) as f64;
        column.iter().for_each(|node| self.nodes[*node].row -= back);
    }
}

impl Node {
    /// Rows that the box and the lines below it take.
    fn rows(&self) -> f64 {
        1.0 + NOTE_ROWS * self.notes.len() as f64
    }
}

/// Names in lines of bearable length.
fn lines(names: &[String]) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for name in names {
        match lines.last_mut() {
            Some(line) if line.len() + name.len() + 2 <= NOTE_LETTERS => {
                line.push_str(", ");
                line.push_str(name);
            }
            _ => lines.push(format!("+ {name}")),
        }
    }
    lines
}

/// One right of everything it takes; notes that what it writes comes right of it.
fn column_of<'a>(stage: &'a Crate, kinds: &mut BTreeMap<&'a str, usize>) -> usize {
    let flow = &stage.flow;
    let taken = flow.reads.iter().chain(&flow.edits);
    let column = 1 + taken.map(|kind| *kinds.entry(kind).or_insert(0)).max().unwrap_or(0);
    for kind in &flow.writes {
        let place = kinds.entry(kind).or_insert(0);
        *place = (*place).max(column + 1);
    }
    column
}

/// A name, and whether it is a stage's.
type Place = (String, bool);

fn links(stages: &[&Crate]) -> Vec<(Place, Place, &'static str)> {
    let mut links = Vec::new();
    for stage in stages {
        let own = (stage.name.clone(), true);
        let kind = |kind: &String| (kind.clone(), false);
        let flow = &stage.flow;
        links.extend(flow.reads.iter().map(|read| (kind(read), own.clone(), "reads")));
        links.extend(flow.edits.iter().map(|edit| (kind(edit), own.clone(), "edits")));
        links.extend(flow.feedback.iter().map(|late| (kind(late), own.clone(), "feedback")));
        links.extend(flow.writes.iter().map(|write| (own.clone(), kind(write), "writes")));
    }
    links
}
