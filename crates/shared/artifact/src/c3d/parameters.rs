//! The parameter section: groups and parameters, chained by the offset of the next one.
//!
//! Only that offset is trusted to lead on; values and descriptions are decoded between two parameters when somebody
//! asks, so that a malformed one that nobody needs hurts nobody.

use super::text_of;
use crate::Violation;
use crate::markers::listed;

/// A parameter as it stands in the file.
pub(super) struct Parameter<'a> {
    group: u8,
    name: String,
    /// Where it starts in the file.
    offset: usize,
    /// From its type byte to the next parameter.
    body: &'a [u8],
}

/// All parameters of a file.
#[derive(Default)]
pub(super) struct Parameters<'a> {
    /// Number and name.
    groups: Vec<(u8, String)>,
    parameters: Vec<Parameter<'a>>,
}

type Refusable<T> = std::result::Result<T, Violation>;

impl<'a> Parameters<'a> {
    /// Reads the list that starts at byte `at`, after the four bytes of the section's own header.
    pub(super) fn parse(bytes: &'a [u8], mut at: usize) -> Refusable<Self> {
        let mut list = Self::default();
        while let Some(&[length, id]) = bytes.get(at..at + 2) {
            // A negative length means that the parameter is locked.
            let length = usize::from((length as i8).unsigned_abs());
            if length == 0 {
                break;
            }
            let link = at + 2 + length;
            let Some(&[low, high]) = bytes.get(link..link + 2) else {
                return Err(broken(at, "its name runs past the end of the file"));
            };
            let next = match usize::from(u16::from_le_bytes([low, high])) {
                0 => bytes.len(),
                1 => return Err(broken(at, "the offset of the next parameter points into this one")),
                distance => link + distance,
            };
            let Some(body) = bytes.get(link + 2..next) else {
                return Err(broken(at, "the offset of the next parameter points past the end of the file"));
            };
            list.add(id as i8, text_of(&bytes[at + 2..link]).to_ascii_uppercase(), at, body);
            at = next;
        }
        Ok(list)
    }

    fn add(&mut self, id: i8, name: String, offset: usize, body: &'a [u8]) {
        if id < 0 {
            self.groups.push((id.unsigned_abs(), name));
        } else {
            self.parameters.push(Parameter { group: id.unsigned_abs(), name, offset, body });
        }
    }

    /// The parameter `GROUP:NAME`.
    pub(super) fn get(&self, group: &str, name: &str) -> Option<&Parameter<'a>> {
        let (id, _) = self.groups.iter().find(|(_, known)| known == group)?;
        self.parameters.iter().find(|parameter| parameter.group == *id && parameter.name == name)
    }

    /// The first value of a parameter that counts something: 16-bit values are unsigned.
    pub(super) fn count(&self, group: &str, name: &str) -> Refusable<Option<u64>> {
        let Some(value) = self.numbers(group, name)?.first().copied() else { return Ok(None) };
        let value = if (-32768.0..0.0).contains(&value) { value + 65536.0 } else { value };
        // A float parameter may hold anything; what is no count is as good as absent.
        Ok((value >= 0.0 && value <= f64::from(u32::MAX)).then_some(value as u64))
    }

    /// The first value of a parameter.
    pub(super) fn number(&self, group: &str, name: &str) -> Refusable<Option<f64>> {
        Ok(self.numbers(group, name)?.first().copied())
    }

    /// All values of a parameter; none where it is absent.
    pub(super) fn numbers(&self, group: &str, name: &str) -> Refusable<Vec<f64>> {
        self.get(group, name).map_or(Ok(Vec::new()), |parameter| parameter.numbers())
    }

    /// All texts of a parameter; none where it is absent.
    pub(super) fn texts(&self, group: &str, name: &str) -> Refusable<Vec<String>> {
        self.get(group, name).map_or(Ok(Vec::new()), |parameter| parameter.texts())
    }

    /// What was read although it is malformed.
    pub(super) fn leniencies(&self) -> Vec<String> {
        let undescribed: Vec<String> = self
            .parameters
            .iter()
            .filter(|parameter| parameter.shape().is_ok_and(|shape| shape.end == parameter.body.len()))
            .map(|parameter| self.full_name(parameter))
            .collect();
        match undescribed.is_empty() {
            true => Vec::new(),
            false => vec![format!(
                "malformed parameters without the length byte of their description: {}; read by the offset of the \
                 next parameter",
                listed(&undescribed)
            )],
        }
    }

    fn full_name(&self, parameter: &Parameter) -> String {
        let group = self.groups.iter().find(|(id, _)| *id == parameter.group);
        format!("{}:{}", group.map_or("?", |(_, name)| name), parameter.name)
    }
}

fn broken(at: usize, what: &str) -> Violation {
    Violation::new(format!("parameter at byte {at}"), what)
}

/// How the values of a parameter lie in its body.
struct Shape {
    /// −1 text, 1 byte, 2 integer, 4 real.
    kind: i8,
    dimensions: Vec<usize>,
    /// Where the values start and end.
    start: usize,
    end: usize,
}

impl Parameter<'_> {
    fn shape(&self) -> Refusable<Shape> {
        let &[kind, dimension_count, ..] = self.body else {
            return Err(self.violation("ends before its type"));
        };
        let start = 2 + usize::from(dimension_count);
        let Some(dimensions) = self.body.get(2..start) else {
            return Err(self.violation("ends before its dimensions"));
        };
        let dimensions: Vec<usize> = dimensions.iter().map(|&byte| usize::from(byte)).collect();
        let count = dimensions.iter().try_fold(1usize, |count, &size| count.checked_mul(size));
        let size = usize::from((kind as i8).unsigned_abs());
        let end = count.and_then(|count| count.checked_mul(size)).and_then(|size| start.checked_add(size));
        match end.filter(|&end| end <= self.body.len()) {
            Some(end) => Ok(Shape { kind: kind as i8, dimensions, start, end }),
            None => Err(self.violation("says more values than there are bytes up to the next parameter")),
        }
    }

    fn numbers(&self) -> Refusable<Vec<f64>> {
        let shape = self.shape()?;
        let values = &self.body[shape.start..shape.end];
        match shape.kind {
            1 => Ok(values.iter().map(|&byte| f64::from(byte)).collect()),
            2 => Ok(values.chunks_exact(2).map(|x| f64::from(i16::from_le_bytes([x[0], x[1]]))).collect()),
            4 => Ok(values
                .chunks_exact(4)
                .map(|x| f64::from(f32::from_le_bytes([x[0], x[1], x[2], x[3]])))
                .collect()),
            kind => Err(self.violation(&format!("has values of type {kind} where numbers are expected"))),
        }
    }

    /// Texts lie along the first dimension; they are filled up with blanks.
    fn texts(&self) -> Refusable<Vec<String>> {
        let shape = self.shape()?;
        if shape.kind != -1 {
            return Err(self.violation(&format!("has values of type {} where text is expected", shape.kind)));
        }
        let values = &self.body[shape.start..shape.end];
        match shape.dimensions.first() {
            None => Ok(vec![text_of(values)]),
            Some(0) => Ok(Vec::new()),
            Some(&length) => Ok(values.chunks_exact(length).map(text_of).collect()),
        }
    }

    fn violation(&self, what: &str) -> Violation {
        Violation::new(format!("parameter {} at byte {}", self.name, self.offset), what)
    }
}
