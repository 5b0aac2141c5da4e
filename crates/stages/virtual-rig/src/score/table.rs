//! The metrics of a comparison, for people and for programs.

use super::Metric;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::fmt;

/// Metrics under the name of what was scored, with targets where there are some.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// What stands before the slash of each name: a stage or a kind.
    pub of: String,
    /// The metrics, in the order of measuring.
    pub metrics: Vec<Metric>,
    /// Targets by metric name without what is before the slash.
    pub targets: BTreeMap<String, f64>,
}

impl Table {
    /// A table without targets.
    #[must_use]
    pub fn new(of: &str, metrics: Vec<Metric>) -> Self {
        Self { of: of.to_string(), metrics, targets: BTreeMap::new() }
    }

    /// Sets the target of a metric.
    #[must_use]
    pub fn target(mut self, name: &str, target: f64) -> Self {
        self.targets.insert(name.to_string(), target);
        self
    }

    /// Whether every metric with a target reaches it, and no target is without a metric.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.targets.iter().all(|(name, &target)| {
            self.metrics.iter().any(|metric| metric.name == name)
                && self
                    .metrics
                    .iter()
                    .filter(|metric| metric.name == name)
                    .all(|metric| metric.reaches(target))
        })
    }

    /// One JSON object per metric: `metric`, `value` (null with a `reason` where it could not be measured), `target`
    /// and `pass` where there is a target, `better`, `unit`, `context`.
    #[must_use]
    pub fn to_json(&self) -> Vec<Value> {
        self.metrics.iter().map(|metric| self.row(metric)).collect()
    }

    fn row(&self, metric: &Metric) -> Value {
        let mut row = Map::new();
        row.insert("metric".into(), format!("{}/{}", self.of, metric.name).into());
        row.insert("value".into(), metric.value.into());
        if let Some(reason) = &metric.reason {
            row.insert("reason".into(), reason.as_str().into());
        }
        if let Some(&target) = self.targets.get(metric.name) {
            row.insert("target".into(), target.into());
            row.insert("pass".into(), metric.reaches(target).into());
        }
        row.insert("better".into(), json!(metric.better));
        row.insert("unit".into(), metric.unit.into());
        row.insert("context".into(), Value::Object(metric.context.clone()));
        Value::Object(row)
    }

    fn cells(&self, metric: &Metric) -> [String; 3] {
        let value = metric.value.map_or_else(|| "–".to_string(), rounded);
        let verdict = match (self.targets.get(metric.name), &metric.reason) {
            (_, Some(reason)) => format!("not measured: {reason}"),
            (None, None) => counts(metric),
            (Some(&target), None) => {
                let sign = if metric.better == super::Better::Lower { '≤' } else { '≥' };
                let word = if metric.reaches(target) { "pass" } else { "FAIL" };
                format!("{word} (target {sign} {}) {}", rounded(target), counts(metric))
            }
        };
        [format!("{}/{}", self.of, metric.name), format!("{value} {}", metric.unit), verdict]
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows: Vec<[String; 3]> = self.metrics.iter().map(|metric| self.cells(metric)).collect();
        let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let (names, values) = (width(0), width(1));
        for [name, value, verdict] in &rows {
            let line = format!("{name:<names$}  {value:>values$}  {verdict}");
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

/// Four significant digits, whole numbers whole.
fn rounded(value: f64) -> String {
    if value == value.trunc() && value.abs() < 1e9 {
        return format!("{value:.0}");
    }
    match value.abs() {
        size if !(1e-4..1e6).contains(&size) => format!("{value:.3e}"),
        size => format!("{value:.*}", (3 - size.log10().floor() as i32).max(0) as usize),
    }
}

/// The plain counts of the context; what is nested stays in the JSON form.
fn counts(metric: &Metric) -> String {
    let plain = |(key, value): (&String, &Value)| match value {
        Value::Number(number) => {
            let number = number
                .as_u64()
                .map_or_else(|| rounded(number.as_f64().unwrap_or(f64::NAN)), |n| n.to_string());
            Some(format!("{key} {number}"))
        }
        _ => None,
    };
    metric.context.iter().filter_map(plain).collect::<Vec<_>>().join(", ")
}
