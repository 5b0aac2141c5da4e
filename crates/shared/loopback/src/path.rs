//! Paths of requests, taken apart and decoded.

/// The decoded names of a path, in order; none if it is not plainly a way down: `..`, `.`, an empty name in between, an encoded
/// slash, a backslash, a colon, a control character, broken or doubled encoding of any of these.
///
/// A last empty name (`/a/`) is kept.
pub(crate) fn names(path: &str) -> Option<Vec<String>> {
    let mut names: Vec<String> = path.strip_prefix('/')?.split('/').map(decoded).collect::<Option<_>>()?;
    let last = names.pop()?;
    let is_sound = names.iter().all(|name| is_name(name)) && (last.is_empty() || is_name(&last));
    names.push(last);
    is_sound.then_some(names)
}

/// Whether a name can be a file's, here and on other systems.
pub(crate) fn is_name(name: &str) -> bool {
    let odd = |letter: char| matches!(letter, '/' | '\\' | ':') || letter.is_control();
    !name.is_empty() && name != "." && name != ".." && !name.contains(odd)
}

fn decoded(name: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(name.len());
    let mut rest = name.as_bytes();
    while let Some((&first, behind)) = rest.split_first() {
        if first == b'%' {
            let [high, low] = [behind.first()?, behind.get(1)?].map(|digit| (*digit as char).to_digit(16));
            bytes.push((16 * high? + low?) as u8);
            rest = &behind[2..];
        } else {
            bytes.push(first);
            rest = behind;
        }
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_ways_down_are_taken_apart() {
        assert_eq!(names("/a/b%20c.png").unwrap(), ["a", "b c.png"]);
        assert_eq!(names("/a/").unwrap(), ["a", ""]);
        assert_eq!(names("/").unwrap(), [""]);
        assert_eq!(names("/%c3%a4").unwrap(), ["ä"]);
        assert_eq!(names("/..a/b..").unwrap(), ["..a", "b.."]);
    }

    #[test]
    fn other_ways_are_refused() {
        let ways = [
            "",
            "a",
            "//",
            "/a//b",
            "/..",
            "/a/../b",
            "/%2e%2e/b",
            "/%2E./b",
            "/.%2e",
            "/.",
            "/a/%2e/b",
            "/a%2fb",
            "/a%5cb",
            "/a\\b",
            "/c:/b",
            "/a%00",
            "/a%0ab",
            "/%",
            "/%2",
            "/%zz",
            "/%ff",
            "/a%",
        ];
        for way in ways {
            assert!(names(way).is_none(), "{way}");
        }
    }
}
