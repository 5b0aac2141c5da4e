//! The outcome of a comparison.

use crate::Summary;
use serde::Serialize;
use std::fmt::Write;

/// Significant digits in the table.
const DIGITS: i64 = 4;
/// Details (markers) that the table shows, the largest first.
const DETAILS_SHOWN: usize = 10;

/// One line of the table.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// `all`, or the name of the region or marker.
    pub name: String,
    /// Its differences.
    #[serde(flatten)]
    pub summary: Summary,
}

/// How far two artifacts are apart.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Unit of the differences.
    pub unit: &'static str,
    /// Everything that was compared.
    pub all: Part,
    /// Regions that were asked for.
    pub regions: Vec<Part>,
    /// Every marker or channel, in order.
    pub details: Vec<Part>,
    /// What differs beside the numbers, one sentence each.
    pub structure: Vec<String>,
}

impl Report {
    pub(crate) fn new(unit: &'static str, all: Summary) -> Self {
        let all = Part { name: "all".to_string(), summary: all };
        Self { unit, all, regions: Vec::new(), details: Vec::new(), structure: Vec::new() }
    }

    /// The differences of everything that was compared.
    #[must_use]
    pub fn whole(&self) -> &Summary {
        &self.all.summary
    }

    /// What a verdict rests on: the regions where some were asked for, else everything.
    fn judged(&self) -> &[Part] {
        if self.regions.is_empty() { std::slice::from_ref(&self.all) } else { &self.regions }
    }

    /// The first part that a verdict would rest on although nothing was compared in it, as a sentence.
    #[must_use]
    pub fn uncompared(&self) -> Option<String> {
        let part = self.judged().iter().find(|part| part.summary.count == 0)?;
        Some(match self.regions.is_empty() {
            true => "nothing was compared".to_string(),
            false => format!("nothing was compared in region {}", part.name),
        })
    }

    /// Why the two do not pass for equal within `tolerance`, if they do not: they are further apart, or there was
    /// nothing to compare. Where regions were asked for, they decide; what lies outside them does not count.
    #[must_use]
    pub fn excess(&self, tolerance: f64) -> Option<String> {
        if let Some(nothing) = self.uncompared() {
            return Some(nothing);
        }
        let judged = self.judged();
        let beyond: Vec<&Part> = judged.iter().filter(|part| part.summary.max > tolerance).collect();
        let worst = beyond.iter().copied().max_by(|a, b| a.summary.max.total_cmp(&b.summary.max))?;
        let Summary { max, max_at, .. } = &worst.summary;
        let unit = self.unit;
        let place = if self.regions.is_empty() {
            max_at.clone()
        } else {
            format!("{max_at} of region {}", worst.name)
        };
        Some(format!(
            "{} {unit} at {place}: {} {unit} more than the {tolerance} {unit} allowed",
            number(*max),
            number(max - tolerance)
        ))
    }

    /// The report as text: a table, then what differs beside the numbers.
    #[must_use]
    pub fn table(&self) -> String {
        let mut details: Vec<&Part> = self.details.iter().collect();
        details.sort_by(|a, b| b.summary.max.total_cmp(&a.summary.max));
        let hidden = details.len().saturating_sub(DETAILS_SHOWN);
        details.truncate(DETAILS_SHOWN);
        let parts = std::iter::once(&self.all).chain(&self.regions).chain(details);
        let mut text = layout(self.unit, parts);
        if hidden > 0 {
            let _ = writeln!(text, "… and {hidden} with smaller differences (--json has all)");
        }
        for difference in &self.structure {
            let _ = writeln!(text, "also: {difference}");
        }
        text
    }
}

/// Columns that line up, numbers to the right.
fn layout<'a>(unit: &str, parts: impl Iterator<Item = &'a Part>) -> String {
    let head = ["", "count", "mean", "rms", "95 %", "max", "largest at"];
    let mut rows = vec![head.map(String::from)];
    for part in parts {
        let Summary { count, mean, rms, p95, max, max_at } = &part.summary;
        let [mean, rms, p95, max] = [mean, rms, p95, max].map(|value| number(*value));
        rows.push([part.name.clone(), count.to_string(), mean, rms, p95, max, max_at.clone()]);
    }
    rows[0][0] = format!("[{unit}]");
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let mut text = String::new();
    for row in &rows {
        let mut line = format!("{:<1$}", row[0], widths[0]);
        (1..6).for_each(|column| line.push_str(&format!("  {:>1$}", row[column], widths[column])));
        line.push_str(&format!("  {}", row[6]));
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// Four significant digits.
fn number(value: f64) -> String {
    if value == 0.0 {
        return "0".to_string();
    }
    match value.abs() {
        1e-4..1e6 => {
            let decimals = (DIGITS - 1 - value.abs().log10().floor() as i64).max(0) as usize;
            format!("{value:.decimals$}")
        }
        _ => format!("{value:.3e}"),
    }
}
