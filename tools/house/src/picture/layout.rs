//! A layered drawing in the manner of Sugiyama: columns by the longest way from the start, an order in each column
//! by the mean place of the neighbours, then rows that pull neighbours level.

use crate::model::Crate;
use std::collections::BTreeMap;

/// Rounds of ordering and of levelling; the drawing is still long before.
const ROUNDS: usize = 24;

/// A box, or a gap that a long edge passes (without a name).
#[derive(Debug)]
pub(crate) struct Node {
    pub(crate) name: Option<String>,
    pub(crate) is_stage: bool,
    pub(crate) column: usize,
    /// Rows count from 0 at the top; fractions are fine.
    pub(crate) row: f64,
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
        let links = links(stages);
        for (from, to, class) in links {
            layout.connect(&from, &to, class);
        }
        layout.columns = layout.nodes.iter().map(|node| node.column + 1).max().unwrap_or(0);
        layout.arrange();
        layout
    }

    fn place_boxes(&mut self, stages: &[&Crate]) {
        let mut kinds: BTreeMap<&str, usize> = BTreeMap::new();
        let mut columns: Vec<usize> = vec![0; stages.len()];
        // Producers come first, but an editor may edit a kind whose producer comes after it: hence twice.
        for _ in 0..2 {
            for (column, stage) in columns.iter_mut().zip(stages) {
                *column = column_of(stage, &mut kinds);
            }
        }
        let boxes = kinds.into_iter().map(|(kind, column)| (kind.to_string(), false, column));
        let named = stages.iter().zip(columns).map(|(stage, column)| (stage.name.clone(), true, column));
        for (name, is_stage, column) in boxes.chain(named) {
            self.nodes.push(Node { name: Some(name), is_stage, column, row: 0.0 });
        }
    }

    fn connect(&mut self, from: &Place, to: &Place, class: &'static str) {
        let (Some(from), Some(to)) = (self.find(from), self.find(to)) else { return };
        let mut through = vec![from];
        for column in self.nodes[from].column + 1..self.nodes[to].column {
            through.push(self.nodes.len());
            self.nodes.push(Node { name: None, is_stage: false, column, row: 0.0 });
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
        let top = self.nodes.iter().map(|node| node.row).fold(f64::INFINITY, f64::min);
        self.nodes.iter_mut().for_each(|node| node.row -= top);
        self.height = self.nodes.iter().map(|node| node.row).fold(0.0, f64::max);
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
            row = wish[node].max(row + 1.0);
            self.nodes[*node].row = row;
        }
        // Pushing down only would sink the column: the mean push goes back up.
        let push: f64 = column.iter().map(|node| self.nodes[*node].row - wish[node]).sum();
        let back = push / column.len().max(1) as f64;
        column.iter().for_each(|node| self.nodes[*node].row -= back);
    }
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
