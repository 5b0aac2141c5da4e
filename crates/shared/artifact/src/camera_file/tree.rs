//! What the text formats of cameras have in common: named values, nested, each with its line.

use crate::{Error, Result};
use std::path::Path;

/// A value of a file, and the line where it starts (1-based).
#[derive(Debug)]
pub(crate) struct Node {
    pub(crate) line: usize,
    pub(crate) value: Value,
}

/// Values as they are written: numbers are read when they are asked for.
#[derive(Debug)]
pub(crate) enum Value {
    Scalar(String),
    List(Vec<Node>),
    Map(Vec<(String, Node)>),
}

/// A value with its name and file: what messages point at.
#[derive(Debug, Clone)]
pub(crate) struct Field<'a> {
    path: &'a Path,
    pub(crate) name: String,
    node: &'a Node,
}

/// Numbers in rows and columns.
#[derive(Debug, PartialEq)]
pub(crate) struct Table {
    pub(crate) shape: [usize; 2],
    /// Row by row.
    pub(crate) numbers: Vec<f64>,
}

impl<'a> Field<'a> {
    /// All that a file holds; it has no name.
    pub(crate) fn root(path: &'a Path, node: &'a Node) -> Self {
        Self { path, name: String::new(), node }
    }

    pub(crate) fn path(&self) -> &'a Path {
        self.path
    }

    /// An error at this place.
    pub(crate) fn refuse(&self, what: impl Into<String>) -> Error {
        let error = Error::new(self.path, what);
        match self.name.is_empty() {
            true => error,
            false => error.at(format!("line {}, {}", self.node.line, self.name)),
        }
    }

    fn within(&self, key: &str, node: &'a Node) -> Field<'a> {
        let name = if self.name.is_empty() { key.to_string() } else { format!("{}.{key}", self.name) };
        Field { path: self.path, name, node }
    }

    /// The named values of a map with their keys; none of anything else.
    pub(crate) fn entries(&self) -> Vec<(&'a str, Field<'a>)> {
        match &self.node.value {
            Value::Map(entries) => {
                entries.iter().map(|(key, node)| (key.as_str(), self.within(key, node))).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The values of a list; none of anything else.
    pub(crate) fn items(&self) -> Vec<Field<'a>> {
        match &self.node.value {
            Value::List(items) => items
                .iter()
                .enumerate()
                .map(|(index, node)| Field { path: self.path, name: format!("{}[{index}]", self.name), node })
                .collect(),
            _ => Vec::new(),
        }
    }

    /// The value of a key of a map.
    pub(crate) fn find(&self, key: &str) -> Option<Field<'a>> {
        self.entries().into_iter().find(|(known, _)| *known == key).map(|(_, field)| field)
    }

    /// The value of a key that must be there.
    pub(crate) fn need(&self, key: &str) -> Result<Field<'a>> {
        self.find(key).ok_or_else(|| self.refuse(format!("lacks {key}")))
    }

    pub(crate) fn is_map(&self) -> bool {
        matches!(self.node.value, Value::Map(_))
    }

    /// A text, or a number as text.
    pub(crate) fn text(&self) -> Result<&'a str> {
        match &self.node.value {
            Value::Scalar(text) => Ok(text),
            _ => Err(self.refuse("holds several values; one was expected")),
        }
    }

    /// A finite number.
    pub(crate) fn number(&self) -> Result<f64> {
        let text = self.text()?;
        match text.trim_start_matches(['+', '-']).to_ascii_lowercase().as_str() {
            "nan" | ".nan" | "inf" | ".inf" => Err(self.refuse(format!("'{text}' is not a finite number"))),
            _ => match text.parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(number),
                _ => Err(self.refuse(format!("'{text}' is not a number"))),
            },
        }
    }

    /// A whole number that is not negative; some writers put `640.0`.
    pub(crate) fn count(&self) -> Result<u32> {
        let number = self.number()?;
        match number.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&number) {
            true => Ok(number as u32),
            false => Err(self.refuse(format!("{number} is not a whole number from 0 on"))),
        }
    }

    /// Whether a switch is on: `true` or a number that is not 0.
    pub(crate) fn is_on(&self) -> Result<bool> {
        Ok(!matches!(self.text()?.to_ascii_lowercase().as_str(), "false" | "0" | "0." | "0.0" | "no" | ""))
    }

    /// A table of numbers: nested lists (a flat one is a column), or a map with `data` and its shape, OpenCV's form.
    pub(crate) fn table(&self) -> Result<Table> {
        match &self.node.value {
            Value::Map(_) => self.matrix(),
            Value::Scalar(_) => Ok(Table { shape: [1, 1], numbers: vec![self.number()?] }),
            Value::List(_) => {
                let rows = self.items();
                if rows.iter().all(|row| matches!(row.node.value, Value::Scalar(_))) {
                    let numbers = self.numbers()?;
                    return Ok(Table { shape: [numbers.len(), 1], numbers });
                }
                let rows: Vec<Vec<f64>> = rows.iter().map(Field::numbers).collect::<Result<_>>()?;
                let columns = rows[0].len();
                if let Some(row) = rows.iter().position(|row| row.len() != columns) {
                    let what = format!("row {} has {} numbers, not {columns}", row + 1, rows[row].len());
                    return Err(self.refuse(what));
                }
                Ok(Table { shape: [rows.len(), columns], numbers: rows.concat() })
            }
        }
    }

    /// A flat list of numbers.
    pub(crate) fn numbers(&self) -> Result<Vec<f64>> {
        match &self.node.value {
            Value::List(_) => self.items().iter().map(Field::number).collect(),
            _ => Err(self.refuse("is no list of numbers")),
        }
    }

    /// `rows`, `cols` (or `sizes`), `dt`, `data`.
    fn matrix(&self) -> Result<Table> {
        let data = self.need("data")?;
        if data.text().is_ok() {
            return Err(data
                .refuse("the numbers are not written out (base64)")
                .fix("write the file again without FileStorage::BASE64"));
        }
        let numbers = data.numbers()?;
        let side = |name: &str| self.need(name)?.count().map(|count| count as usize);
        let [rows, columns] = match self.find("sizes").map(|sizes| sizes.numbers()).transpose()? {
            None => [side("rows")?, side("cols")?],
            Some(sizes) => match sizes[..] {
                [rows] => [rows as usize, 1],
                [rows, columns] => [rows as usize, columns as usize],
                _ => return Err(self.refuse(format!("has {} dimensions; 2 were expected", sizes.len()))),
            },
        };
        // `3d`: three numbers per element. They are columns here.
        let element = self.find("dt").map(|dt| dt.text()).transpose()?.unwrap_or("d");
        let channels = element[..element.len().saturating_sub(1)].parse::<usize>().unwrap_or(1);
        let columns = columns.saturating_mul(channels);
        if rows.checked_mul(columns) != Some(numbers.len()) {
            let what = format!("has {} numbers, not {rows} × {columns}; it may be cut short", numbers.len());
            return Err(self.refuse(what));
        }
        Ok(Table { shape: [rows, columns], numbers })
    }
}
