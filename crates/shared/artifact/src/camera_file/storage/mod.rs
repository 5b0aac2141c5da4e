//! Text of OpenCV's `FileStorage`, YAML or JSON, into a tree.
//!
//! OpenCV's YAML is a dialect that no YAML reader takes as it stands: `%YAML:1.0`, `\'` within quotes; and so is its
//! JSON: `1.`, `.Nan`, comments, commas after comments. JSON's brackets are brackets in YAML, too, so that one reader takes
//! both, and the plain YAML that other programs write: blocks by indentation, lists, brackets, texts in quotes or without,
//! comments, tags (passed over). Not anchors, texts over several lines, several documents: they are refused.

mod scalar;

use super::tree::{Node, Value};
use crate::{Error, Result};
use std::path::Path;

/// Nested deeper than any calibration.
const MAX_DEPTH: usize = 32;

/// Reads a text; `path` is for messages.
pub(super) fn parse(path: &Path, text: &str) -> Result<Node> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim_start().starts_with('<') {
        return Err(Error::new(path, "is XML, which is not read here")
            .fix("write it as YAML or JSON: give FileStorage a name that ends in .yml or .json"));
    }
    let mut reader = Reader { path, text, at: 0, line: 1, line_start: 0, depth: 0 };
    reader.prologue()?;
    let root = match reader.peek() {
        None => return Err(Error::new(path, "is empty").fix("check that it was written wholly")),
        Some(_) => reader.block(None)?,
    };
    reader.blank()?;
    match reader.is_end() {
        true => Ok(root),
        false => Err(reader.refuse("is not understood here").fix("check the indentation and the brackets")),
    }
}

struct Reader<'a> {
    path: &'a Path,
    text: &'a str,
    at: usize,
    line: usize,
    line_start: usize,
    depth: usize,
}

impl<'a> Reader<'a> {
    fn refuse(&self, what: impl Into<String>) -> Error {
        let rest = self.rest().lines().next().unwrap_or_default();
        let shown: String = rest.chars().take(24).collect();
        let what = what.into();
        let said = if shown.is_empty() { what } else { format!("'{shown}' {what}") };
        Error::new(self.path, said).at(format!("line {}, column {}", self.line, self.column() + 1))
    }

    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    fn column(&self) -> usize {
        self.at - self.line_start
    }

    /// Passes over blanks of this line.
    fn spaces(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\r')) {
            self.at += 1;
        }
    }

    /// Passes over blanks, line ends and comments.
    fn blank(&mut self) -> Result<()> {
        loop {
            self.spaces();
            match self.peek() {
                Some(b'\n') => {
                    self.at += 1;
                    self.line += 1;
                    self.line_start = self.at;
                }
                Some(b'#') => self.skip_line(),
                Some(b'/') if self.rest().starts_with("//") => self.skip_line(),
                _ => return Ok(()),
            }
        }
    }

    fn skip_line(&mut self) {
        self.at += self.rest().find('\n').unwrap_or(self.rest().len());
    }

    /// Passes over directives and the mark where the document starts.
    fn prologue(&mut self) -> Result<()> {
        self.blank()?;
        while self.peek() == Some(b'%') {
            self.skip_line();
            self.blank()?;
        }
        if self.rest().starts_with("---") {
            self.at += 3;
        }
        self.blank()
    }

    /// Whether nothing is left but the mark where the document ends.
    fn is_end(&self) -> bool {
        self.rest().is_empty() || (self.column() == 0 && self.rest().trim_end() == "...")
    }

    /// Whether this is a word followed by a blank: `- `, `: `.
    fn is_mark(&self, mark: u8) -> bool {
        let next = self.text.as_bytes().get(self.at + 1);
        self.peek() == Some(mark) && matches!(next, None | Some(b' ' | b'\t' | b'\r' | b'\n'))
    }

    /// Goes one level down, which only so many times is allowed.
    fn deeper<T>(&mut self, read: impl FnOnce(&mut Self) -> Result<T>) -> Result<T> {
        if self.depth == MAX_DEPTH {
            return Err(self.refuse(format!("is nested more than {MAX_DEPTH} levels deep")));
        }
        self.depth += 1;
        let read = read(self);
        self.depth -= 1;
        read
    }

    /// A value whose first character is the next one; in a block deeper than `parent`, where there is one.
    fn block(&mut self, parent: Option<usize>) -> Result<Node> {
        self.tag()?;
        let (line, column) = (self.line, self.column());
        if parent.is_some_and(|parent| column <= parent) || self.is_end() {
            return Ok(Node { line, value: Value::Scalar(String::new()) });
        }
        if self.is_mark(b'-') {
            return self.deeper(|reader| reader.block_list(column));
        }
        if matches!(self.peek(), Some(b'[' | b'{')) {
            return self.flow();
        }
        let text = self.scalar(false)?;
        self.spaces();
        match self.is_mark(b':') {
            true => self.deeper(|reader| reader.block_map(line, column, text)),
            false => Ok(Node { line, value: Value::Scalar(text) }),
        }
    }

    /// Passes over a tag (`!!opencv-matrix`) and, where the line ends after it, to the next value.
    fn tag(&mut self) -> Result<()> {
        if self.peek() == Some(b'!') {
            self.at += self.rest().find(char::is_whitespace).unwrap_or(self.rest().len());
            self.blank()?;
        }
        Ok(())
    }

    fn block_list(&mut self, column: usize) -> Result<Node> {
        let (line, mut items) = (self.line, Vec::new());
        while self.column() == column && self.is_mark(b'-') {
            self.at += 1;
            self.blank()?;
            items.push(self.block(Some(column))?);
            self.blank()?;
        }
        self.end_of_block(column)?;
        Ok(Node { line, value: Value::List(items) })
    }

    /// After a block, only what stands further left may follow.
    fn end_of_block(&self, column: usize) -> Result<()> {
        match self.column() < column || self.rest().is_empty() || column == 0 && self.is_end() {
            true => Ok(()),
            false if self.text[self.line_start..self.at].contains('\t') => {
                Err(self.refuse("is indented with a tab").fix("indent with blanks"))
            }
            false => Err(self.refuse("is not understood here").fix("check the indentation")),
        }
    }

    fn block_map(&mut self, line: usize, column: usize, first: String) -> Result<Node> {
        let mut entries: Vec<(String, Node)> = Vec::new();
        let mut key = first;
        loop {
            let key_line = self.line;
            self.at += 1;
            if entries.iter().any(|(known, _)| *known == key) {
                return Err(Error::new(self.path, format!("'{key}' stands there twice"))
                    .at(format!("line {}", self.line))
                    .fix("remove one"));
            }
            self.blank()?;
            // A list may stand as far left as its key.
            let parent = if self.is_mark(b'-') { column.checked_sub(1) } else { Some(column) };
            let value = self.block(parent)?.value;
            entries.push((key, Node { line: key_line, value }));
            self.blank()?;
            if self.column() != column || self.is_end() {
                break;
            }
            key = self.scalar(false)?;
            self.spaces();
            if !self.is_mark(b':') {
                return Err(self.refuse(format!("follows '{key}', where ': ' was expected")));
            }
        }
        self.end_of_block(column)?;
        Ok(Node { line, value: Value::Map(entries) })
    }

    /// A value in brackets, or one within them.
    fn flow(&mut self) -> Result<Node> {
        let line = self.line;
        match self.peek() {
            Some(b'[') => self.deeper(|reader| {
                let items = reader.bracketed(b']', Reader::flow)?;
                Ok(Node { line, value: Value::List(items) })
            }),
            Some(b'{') => self.deeper(|reader| {
                let entries = reader.bracketed(b'}', Reader::flow_entry)?;
                Ok(Node { line, value: Value::Map(entries) })
            }),
            _ => self.scalar(true).map(|text| Node { line, value: Value::Scalar(text) }),
        }
    }

    fn flow_entry(&mut self) -> Result<(String, Node)> {
        let key = self.scalar(true)?;
        self.blank()?;
        if self.peek() != Some(b':') {
            return Err(self.refuse(format!("follows '{key}', where ':' was expected")));
        }
        self.at += 1;
        self.blank()?;
        Ok((key, self.flow()?))
    }

    /// Values up to a closing bracket, commas between them.
    fn bracketed<T>(&mut self, close: u8, value: impl Fn(&mut Self) -> Result<T>) -> Result<Vec<T>> {
        let opened = self.line;
        self.at += 1;
        let mut values = Vec::new();
        loop {
            self.blank()?;
            match self.peek() {
                None => {
                    return Err(Error::new(self.path, "a bracket is not closed; the file may be cut short")
                        .at(format!("line {opened}"))
                        .fix("copy or write it again"));
                }
                Some(byte) if byte == close => {
                    self.at += 1;
                    return Ok(values);
                }
                Some(_) => values.push(value(self)?),
            }
            self.blank()?;
            match self.peek() {
                Some(b',') => self.at += 1,
                Some(byte) if byte != close => {
                    return Err(self.refuse("stands where a comma was expected"));
                }
                _ => {}
            }
        }
    }
}
