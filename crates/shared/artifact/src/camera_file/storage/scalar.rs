//! Single values.

use super::Reader;
use crate::Result;

impl Reader<'_> {
    /// A text in quotes, or one that ends at a mark; `in_flow`: within brackets.
    pub(super) fn scalar(&mut self, in_flow: bool) -> Result<String> {
        match self.peek() {
            Some(quote @ (b'"' | b'\'')) => self.quoted(char::from(quote)),
            Some(b'&' | b'*' | b'|' | b'>' | b'@' | b'`' | b'?') => {
                Err(self.refuse("is a part of YAML that is not read here").fix("write the value out"))
            }
            _ => self.plain(in_flow),
        }
    }

    fn plain(&mut self, in_flow: bool) -> Result<String> {
        let bytes = self.rest().as_bytes();
        let ends = |at: usize| {
            let before_blank = bytes.get(at + 1).is_none_or(u8::is_ascii_whitespace);
            match bytes[at] {
                b'\n' => true,
                b'#' => at > 0 && bytes[at - 1].is_ascii_whitespace(),
                b':' => before_blank,
                b',' | b']' | b'}' | b'[' | b'{' => in_flow,
                _ => false,
            }
        };
        let length = (0..bytes.len()).find(|&at| ends(at)).unwrap_or(bytes.len());
        let text = self.rest()[..length].trim_end();
        if text.is_empty() {
            return Err(self.refuse("stands where a value was expected"));
        }
        self.at += text.len();
        Ok(text.to_string())
    }

    fn quoted(&mut self, quote: char) -> Result<String> {
        let mut text = String::new();
        let mut characters = self.rest().char_indices().skip(1).peekable();
        while let Some((at, character)) = characters.next() {
            match character {
                '\n' => break,
                '\'' if quote == '\'' && characters.peek().is_some_and(|(_, next)| *next == '\'') => {
                    characters.next();
                    text.push('\'');
                }
                '\\' if quote == '"' => match characters.next() {
                    Some((_, 'n')) => text.push('\n'),
                    Some((_, 't')) => text.push('\t'),
                    Some((_, 'r')) => text.push('\r'),
                    Some((_, escaped @ ('"' | '\'' | '\\' | '/'))) => text.push(escaped),
                    _ => return Err(self.refuse("holds an escape that is not read here")),
                },
                _ if character == quote => {
                    self.at += at + 1;
                    return Ok(text);
                }
                _ => text.push(character),
            }
        }
        Err(self.refuse("opens a quote that is not closed in its line"))
    }
}
