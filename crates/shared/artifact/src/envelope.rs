//! The JSON forms: one envelope for static kinds, JSON Lines for kinds with frames.
//!
//! Static: `{"schema":"warp/1","data":{…}}`. With frames: a first line of that form whose data is the header, then
//! one object per line and frame, frame numbers rising. The schema is read before anything else, so that an unknown
//! kind or a newer version is refused by name.

use crate::source::{open, read_utf8};
use crate::{Error, Result, Sink, Staged, Violation, distinct};
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::io::{BufRead, Write};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

/// A kind of artifact: its name and the schema version that this code writes.
pub trait Kind {
    /// Kind name, e.g. `warp`.
    const NAME: &'static str;
    /// Newest schema version; older ones are read by the kind's own code.
    const VERSION: u32;
}

/// A kind without frames: one JSON object.
pub trait Document: Kind + Serialize + DeserializeOwned + JsonSchema {
    /// Whether the values make sense together; every reader and writer asks.
    ///
    /// # Errors
    /// What is wrong and where.
    fn check(&self) -> std::result::Result<(), Violation>;
}

/// A kind with frames: a header, then frames with rising numbers.
pub trait Stream: Kind {
    /// What holds for all frames.
    type Header: Serialize + DeserializeOwned + JsonSchema + Clone;
    /// A frame in memory.
    type Frame;
    /// A frame as it stands in the file.
    type Line: Serialize + DeserializeOwned + JsonSchema;

    /// Whether the header makes sense.
    ///
    /// # Errors
    /// What is wrong and where.
    fn check(header: &Self::Header) -> std::result::Result<(), Violation>;
    /// File form of a frame.
    ///
    /// # Errors
    /// What the frame holds that a file may not; the place starts with the frame.
    fn encode(header: &Self::Header, frame: &Self::Frame) -> std::result::Result<Self::Line, Violation>;
    /// Memory form of a frame.
    ///
    /// # Errors
    /// What the line says that the header does not allow; the place starts with the frame.
    fn decode(header: &Self::Header, line: Self::Line) -> std::result::Result<Self::Frame, Violation>;
    /// The frame's number.
    fn number(frame: &Self::Frame) -> i64;
}

#[derive(Serialize)]
struct Written<'a, T> {
    schema: String,
    data: &'a T,
}

/// What is asked first, whatever else the text holds.
#[derive(Deserialize)]
struct SchemaOnly {
    schema: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Opened<'a> {
    schema: String,
    #[serde(borrow)]
    data: &'a RawValue,
}

fn schema_name<K: Kind>() -> String {
    format!("{}/{}", K::NAME, K::VERSION)
}

/// Opens an envelope: checks kind and version, then reads the data. `line` is where the text starts in its file. A
/// byte-order mark, which some editors put there, is passed over.
fn open_envelope<K: Kind, T: DeserializeOwned>(path: &Path, text: &str, first_line: usize) -> Result<T> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let place = |error: &serde_json::Error| {
        format!("line {}, column {}", first_line + error.line().max(1) - 1, error.column())
    };
    let wanted = schema_name::<K>();
    let opened: Opened = serde_json::from_str(text).map_err(|error| {
        // A newer version may look different, so its name counts before its form.
        if let Some(refused) = serde_json::from_str(text)
            .ok()
            .and_then(|SchemaOnly { schema }| check_schema::<K>(path, &schema).err())
        {
            return refused;
        }
        Error::new(path, format!("is not a {wanted} artifact: {}", without_position(&error)))
            .at(place(&error))
            .fix(format!("the file must start with {{\"schema\":\"{wanted}\",\"data\":…}}"))
    })?;
    check_schema::<K>(path, &opened.schema)?;
    distinct::from_str(opened.data.get()).map_err(|error| {
        // The parser counts from where the data starts; the user counts from the start of the file.
        let offset = opened.data.get().as_ptr() as usize - text.as_ptr() as usize;
        let before = &text[..offset];
        let line = first_line + before.matches('\n').count() + error.line().max(1) - 1;
        let indent = before.rsplit('\n').next().map_or(0, str::len);
        let column = error.column() + if error.line() <= 1 { indent } else { 0 };
        Error::new(path, format!("does not follow {}: {}", opened.schema, without_position(&error)))
            .at(format!("line {line}, column {column}"))
    })
}

fn check_schema<K: Kind>(path: &Path, found: &str) -> Result<()> {
    let wanted = schema_name::<K>();
    let (kind, version) = found.split_once('/').unwrap_or((found, ""));
    if kind != K::NAME {
        return Err(Error::new(path, format!("holds '{found}', not '{wanted}'"))
            .at("schema")
            .fix(format!("give a {} artifact here", K::NAME)));
    }
    match version.parse::<u32>() {
        Ok(version) if (1..=K::VERSION).contains(&version) => Ok(()),
        Ok(version) if version > K::VERSION => {
            Err(Error::new(path, format!("is {found}; this program reads up to {wanted}"))
                .at("schema")
                .fix("use a newer Furrow, or write the file again with this one"))
        }
        _ => Err(Error::new(path, format!("'{found}' has no version that this program knows")).at("schema")),
    }
}

fn without_position(error: &serde_json::Error) -> String {
    let text = error.to_string();
    text.rsplit_once(" at line ").map_or(text.as_str(), |(what, _)| what).to_string()
}

/// Reads a static artifact.
///
/// # Errors
/// If the file is missing, of another kind or version, or does not make sense.
pub fn read_document<T: Document>(path: &Path) -> Result<T> {
    let text = read_utf8(path)?;
    let document: T = open_envelope::<T, T>(path, &text, 1)?;
    document.check().map_err(|violation| violation.in_file(path))?;
    Ok(document)
}

/// The kind that a static artifact says it is; none where it says nothing that can be read.
pub(crate) fn document_kind(path: &Path) -> Result<Option<String>> {
    let text = read_utf8(path)?;
    let opened = serde_json::from_str(text.strip_prefix('\u{feff}').unwrap_or(&text));
    Ok(opened.ok().and_then(|SchemaOnly { schema }| Some(schema.split_once('/')?.0.to_string())))
}

/// Writes a static artifact.
///
/// # Errors
/// If the values do not make sense or the file cannot be written.
pub fn write_document<T: Document>(path: &Path, document: &T) -> Result<Staged> {
    document.check().map_err(|violation| violation.in_file(path))?;
    let mut sink = Sink::create(path)?;
    write_json_line(&mut sink, &Written { schema: schema_name::<T>(), data: document })?;
    sink.finish()
}

fn write_json_line(sink: &mut Sink, value: &impl Serialize) -> Result<()> {
    let mut bytes = serde_json::to_vec(value)
        .map_err(|error| Error::new(sink.path(), format!("cannot be written as JSON: {error}")))?;
    bytes.push(b'\n');
    sink.write_all(&bytes).map_err(|cause| sink.failed(&cause))
}

/// Reads a JSON Lines artifact frame by frame, in constant memory. Iterates over the frames.
pub struct FrameReader<S: Stream> {
    path: PathBuf,
    lines: Box<dyn BufRead>,
    line_number: usize,
    last_frame: Option<i64>,
    header: S::Header,
    stream: PhantomData<S>,
}

impl<S: Stream> FrameReader<S> {
    /// Opens an artifact (`-`: standard input) and reads its header.
    ///
    /// # Errors
    /// If the file is missing, of another kind or version, or its header does not make sense.
    pub fn open(path: &Path) -> Result<Self> {
        let mut lines = open(path)?;
        let mut first = String::new();
        lines.read_line(&mut first).map_err(|cause| Error::io(path, "read", &cause).at("line 1"))?;
        let header: S::Header = open_envelope::<S, S::Header>(path, &first, 1)?;
        S::check(&header).map_err(|violation| violation.in_file(path))?;
        Ok(Self {
            path: path.to_path_buf(),
            lines,
            line_number: 1,
            last_frame: None,
            header,
            stream: PhantomData,
        })
    }

    /// What holds for all frames.
    #[must_use]
    pub fn header(&self) -> &S::Header {
        &self.header
    }

    /// The file that is being read, for messages.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn parse(&mut self, line: &str) -> Result<S::Frame> {
        let here = format!("line {}", self.line_number);
        let line: S::Line = distinct::from_str(line).map_err(|error| {
            let cut = if error.is_eof() { "; the file may have been cut short" } else { "" };
            Error::new(
                &self.path,
                format!("is not a frame of {}: {}{cut}", schema_name::<S>(), without_position(&error)),
            )
            .at(format!("{here}, column {}", error.column()))
        })?;
        let frame = S::decode(&self.header, line).map_err(|violation| {
            Error::new(&self.path, violation.what).at(format!("{here}, {}", violation.place))
        })?;
        let number = S::number(&frame);
        if let Some(last) = self.last_frame.filter(|&last| last >= number) {
            return Err(Error::new(&self.path, format!("frame {number} follows frame {last}"))
                .at(here)
                .fix("frame numbers must rise; sort the lines or remove the double"));
        }
        self.last_frame = Some(number);
        Ok(frame)
    }
}

impl<S: Stream> Iterator for FrameReader<S> {
    type Item = Result<S::Frame>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let mut line = String::new();
            self.line_number += 1;
            match self.lines.read_line(&mut line) {
                Ok(0) => return None,
                Ok(_) if line.trim().is_empty() => {}
                Ok(_) => return Some(self.parse(&line)),
                Err(cause) => {
                    let place = format!("line {}", self.line_number);
                    return Some(Err(Error::io(&self.path, "read", &cause).at(place)));
                }
            }
        }
    }
}

/// Writes a JSON Lines artifact frame by frame.
pub struct FrameWriter<S: Stream> {
    sink: Sink,
    header: S::Header,
    last_frame: Option<i64>,
    stream: PhantomData<S>,
}

impl<S: Stream> FrameWriter<S> {
    /// Starts an artifact (`-`: standard output) with its header line.
    ///
    /// # Errors
    /// If the header does not make sense or the file cannot be written.
    pub fn create(path: &Path, header: S::Header) -> Result<Self> {
        S::check(&header).map_err(|violation| violation.in_file(path))?;
        let mut sink = Sink::create(path)?;
        write_json_line(&mut sink, &Written { schema: schema_name::<S>(), data: &header })?;
        Ok(Self { sink, header, last_frame: None, stream: PhantomData })
    }

    /// Appends a frame.
    ///
    /// # Errors
    /// If the frame holds what the kind does not allow, does not follow the last one, or cannot be written.
    pub fn write(&mut self, frame: &S::Frame) -> Result<()> {
        let number = S::number(frame);
        let line = S::encode(&self.header, frame).map_err(|violation| violation.in_file(self.sink.path()))?;
        if let Some(last) = self.last_frame.filter(|&last| last >= number) {
            let what = format!("would follow frame {last}; frame numbers must rise");
            return Err(Error::new(self.sink.path(), what).at(format!("frame {number}")));
        }
        self.last_frame = Some(number);
        write_json_line(&mut self.sink, &line)
    }

    /// Completes the artifact.
    ///
    /// # Errors
    /// If the rest cannot be written.
    pub fn finish(self) -> Result<Staged> {
        self.sink.finish()
    }
}

/// The JSON Schema of a static artifact, envelope included.
#[must_use]
pub fn document_schema<T: Document>() -> serde_json::Value {
    let mut definitions = serde_json::Map::new();
    let data = without_definitions(schemars::schema_for!(T).to_value(), &mut definitions);
    finish_schema(schema_name::<T>(), envelope_schema(&schema_name::<T>(), data), definitions)
}

/// The JSON Schema of an artifact with frames: every line of the file follows it, the first as the header.
#[must_use]
pub fn stream_schema<S: Stream>() -> serde_json::Value {
    let mut definitions = serde_json::Map::new();
    let header = without_definitions(schemars::schema_for!(S::Header).to_value(), &mut definitions);
    let frame = without_definitions(schemars::schema_for!(S::Line).to_value(), &mut definitions);
    let lines = serde_json::json!({
        "description": "JSON Lines: the first line is the header, every other line a frame.",
        "anyOf": [envelope_schema(&schema_name::<S>(), header), frame],
    });
    finish_schema(schema_name::<S>(), lines, definitions)
}

fn envelope_schema(name: &str, data: serde_json::Value) -> serde_json::Value {
    serde_json::json!({
        "type": "object",
        "required": ["schema", "data"],
        "properties": { "schema": { "const": name }, "data": data },
        "additionalProperties": false,
    })
}

/// Takes the shared definitions out of a schema, since references count from the root.
fn without_definitions(
    mut schema: serde_json::Value,
    definitions: &mut serde_json::Map<String, serde_json::Value>,
) -> serde_json::Value {
    if let Some(object) = schema.as_object_mut() {
        object.shift_remove("$schema");
        if let Some(serde_json::Value::Object(own)) = object.shift_remove("$defs") {
            definitions.extend(own);
        }
    }
    schema
}

fn finish_schema(
    title: String,
    mut schema: serde_json::Value,
    definitions: serde_json::Map<String, serde_json::Value>,
) -> serde_json::Value {
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = title.into();
    if !definitions.is_empty() {
        schema["$defs"] = definitions.into();
    }
    schema
}
