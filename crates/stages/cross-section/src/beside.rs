//! What bare skin beside the paint says: the same valley shades it.

use crate::problem::{Block, Ends, LOCAL, Problem, Row, huber};
use crate::skin::Group;

/// What the model says of a cell, and its derivatives.
type Said = (f64, [f64; LOCAL]);

impl Problem<'_> {
    /// The cost of a group of skin: how bright skin is there is its own, so that the best level is taken, and out of the derivatives
    /// what it takes up [Kaufman1975].
    pub(crate) fn beside(&self, group: &Group, ends: &Ends<'_>, block: Option<&mut Block>) -> f64 {
        let seen: Vec<Said> = group.iter().map(|row| self.model(row, ends)).collect();
        let sum = |value: &dyn Fn(&Row, &Said) -> f64| -> f64 {
            group.iter().zip(&seen).map(|(row, seen)| row.weight * value(row, seen)).sum()
        };
        let square = sum(&|_, (light, _)| light * light).max(1e-12);
        let level = sum(&|row, (light, _)| row.light * light) / square;
        let residual = |row: &Row, light: f64| (row.light - level * light) / self.skin_noise;
        let cost = sum(&|row, (light, _)| huber(residual(row, *light)).0);
        if let Some(block) = block {
            let shares: [f64; LOCAL] = std::array::from_fn(|k| sum(&|_, (light, by)| light * by[k]) / square);
            for (row, (light, by)) in group.iter().zip(&seen) {
                let by = std::array::from_fn(|k| level * (by[k] - light * shares[k]));
                let off = residual(row, *light);
                block.add(&by, off / self.skin_noise, row.weight * huber(off).1, self.skin_noise);
            }
        }
        cost
    }

    /// What is left of the skin's light, as shares of it.
    pub(crate) fn left_of_skin(&self, unknowns: &[f64]) -> Vec<f64> {
        let tables = self.tables(unknowns);
        let mut left = Vec::new();
        for group in self.skin {
            let ends = self.ends(unknowns, &tables, group[0].station);
            let seen: Vec<f64> = group.iter().map(|row| self.model(row, &ends).0).collect();
            let square: f64 = seen.iter().map(|light| light * light).sum();
            let level = group.iter().zip(&seen).map(|(row, light)| row.light * light).sum::<f64>()
                / square.max(1e-12);
            // The level takes one degree of freedom.
            let few = (group.len() as f64 / (group.len() as f64 - 1.0)).sqrt();
            left.extend(group.iter().zip(&seen).map(|(row, light)| few * (row.light - level * light)));
        }
        left
    }
}
