//! Rust source with its code and its comments apart, line for line.

/// The two halves of a Rust file. Both have the file's lines; what belongs to the other half is blank.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct RustText {
    /// Code without comments; the insides of strings and characters are blank.
    pub(crate) code: String,
    /// Comments without code.
    pub(crate) comments: String,
}

#[derive(Clone, Copy)]
enum State {
    Code,
    Line,
    Block(usize),
    Text,
    /// A raw string that this many `#` end.
    Raw(usize),
}

impl RustText {
    /// Takes a file apart.
    pub(crate) fn of(text: &str) -> Self {
        let letters: Vec<char> = text.chars().collect();
        let mut parts = Self { code: String::new(), comments: String::new() };
        let (mut state, mut at) = (State::Code, 0);
        while at < letters.len() {
            let (width, next, keep) = step(&letters, at, state);
            for &letter in &letters[at..(at + width).min(letters.len())] {
                parts.push(letter, keep);
            }
            (state, at) = (next, at + width);
        }
        parts
    }

    fn push(&mut self, letter: char, keep: Keep) {
        let blank = if letter == '\n' { '\n' } else { ' ' };
        self.code.push(if keep == Keep::Code { letter } else { blank });
        self.comments.push(if keep == Keep::Comment { letter } else { blank });
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Keep {
    Code,
    Comment,
    Nothing,
}

/// How many letters belong together at `at`, the state after them, and where they go.
fn step(letters: &[char], at: usize, state: State) -> (usize, State, Keep) {
    let starts = |what: &str| what.chars().enumerate().all(|(k, one)| letters.get(at + k) == Some(&one));
    match state {
        State::Code if starts("//") => (2, State::Line, Keep::Comment),
        State::Code if starts("/*") => (2, State::Block(1), Keep::Comment),
        State::Code if starts("\"") => (1, State::Text, Keep::Code),
        State::Code => code_step(letters, at),
        State::Line if starts("\n") => (1, State::Code, Keep::Code),
        State::Line => (1, State::Line, Keep::Comment),
        State::Block(1) if starts("*/") => (2, State::Code, Keep::Comment),
        State::Block(depth) if starts("*/") => (2, State::Block(depth - 1), Keep::Comment),
        State::Block(depth) if starts("/*") => (2, State::Block(depth + 1), Keep::Comment),
        State::Block(depth) => (1, State::Block(depth), Keep::Comment),
        State::Text if starts("\\") => (2, State::Text, Keep::Nothing),
        State::Text if starts("\"") => (1, State::Code, Keep::Code),
        State::Text => (1, State::Text, Keep::Nothing),
        State::Raw(hashes) if starts(&format!("\"{}", "#".repeat(hashes))) => {
            (1 + hashes, State::Code, Keep::Code)
        }
        State::Raw(hashes) => (1, State::Raw(hashes), Keep::Nothing),
    }
}

/// Raw strings and character literals; everything else is one letter of code.
fn code_step(letters: &[char], at: usize) -> (usize, State, Keep) {
    let letter = |k: usize| letters.get(at + k).copied().unwrap_or(' ');
    let inside_word = at > 0 && (letters[at - 1].is_alphanumeric() || letters[at - 1] == '_');
    if letter(0) == 'r' && (!inside_word || letters[at - 1] == 'b') {
        let hashes = letters[at + 1..].iter().take_while(|&&one| one == '#').count();
        if letter(1 + hashes) == '"' {
            return (2 + hashes, State::Raw(hashes), Keep::Code);
        }
    }
    if letter(0) == '\'' {
        // A character ends with a quote; a lifetime does not.
        if letter(1) == '\\' {
            let end = letters[at + 3..].iter().position(|&one| one == '\'').unwrap_or(0);
            return (4 + end, State::Code, Keep::Nothing);
        }
        if letter(2) == '\'' {
            return (3, State::Code, Keep::Nothing);
        }
    }
    (1, State::Code, Keep::Code)
}

/// The line, from 1, of a byte of a text.
pub(crate) fn line_of(text: &str, byte: usize) -> usize {
    1 + text.as_bytes().iter().take(byte).filter(|&&one| one == b'\n').count()
}

/// Where the bracket that opens at byte `open` of `code` closes.
pub(crate) fn closing(code: &str, open: usize) -> Option<usize> {
    let bytes = code.as_bytes();
    let (opens, closes) = match bytes.get(open)? {
        b'{' => (b'{', b'}'),
        b'[' => (b'[', b']'),
        b'(' => (b'(', b')'),
        _ => return None,
    };
    let mut depth = 0_usize;
    for (at, &one) in bytes.iter().enumerate().skip(open) {
        if one == opens {
            depth += 1;
        } else if one == closes {
            depth -= 1;
            if depth == 0 {
                return Some(at);
            }
        }
    }
    None
}

/// Code without its `#[cfg(test)]` modules: they are blank.
pub(crate) fn without_tests(code: &str) -> String {
    let mut rest = code.to_string();
    while let Some(start) = rest.find("#[cfg(test)]") {
        let end = rest[start..].find('{').and_then(|open| closing(&rest, start + open));
        let end = end.unwrap_or(rest.len() - 1);
        let blank: String =
            rest[start..=end].chars().map(|one| if one == '\n' { '\n' } else { ' ' }).collect();
        rest.replace_range(start..=end, &blank);
    }
    rest
}

/// Where `word` stands in `code` as a word of its own, in bytes.
pub(crate) fn words<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let part_of_word = |one: char| one.is_alphanumeric() || one == '_';
    code.match_indices(word).map(|(at, _)| at).filter(move |&at| {
        !code[..at].ends_with(part_of_word) && !code[at + word.len()..].starts_with(part_of_word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strings_and_comments_leave_the_code() {
        let parts = RustText::of(
            "let a = \"std::fs\"; // std::env\nlet b = r#\"\"std::time\"\"#; /* x /* y */ z */ c\n",
        );
        assert!(!parts.code.contains("std::"));
        assert!(parts.comments.contains("std::env") && !parts.comments.contains("std::fs"));
        assert!(parts.comments.contains("z */") && parts.code.contains(" c\n"));
    }

    #[test]
    fn characters_are_blank_and_lifetimes_stay() {
        let parts = RustText::of("fn f<'a>(x: &'a str) { x.find('\"'); y('\\''); g('{'); } // end");
        assert!(parts.code.contains("<'a>") && parts.code.contains("&'a str"));
        assert!(!parts.code.contains('"') && parts.comments.contains("// end"));
        assert_eq!(parts.code.matches('{').count(), 1);
    }

    #[test]
    fn lines_stay_where_they_are() {
        let text = "a\n\"b\nc\" /* d\n e */ f\ng";
        let parts = RustText::of(text);
        assert_eq!(parts.code.lines().count(), text.lines().count());
        assert_eq!(line_of(&parts.code, parts.code.find('g').unwrap()), 5);
    }

    #[test]
    fn test_modules_are_left_out() {
        let code = without_tests("fn a() {}\n#[cfg(test)]\nmod tests { fn b() { std::fs } }\nfn c() {}");
        assert!(!code.contains("std::fs") && code.contains("fn a()") && code.contains("fn c()"));
    }

    #[test]
    fn words_stand_alone() {
        assert_eq!(words("clap eclap clap_derive clap::x", "clap").collect::<Vec<_>>(), [0, 23]);
    }
}
