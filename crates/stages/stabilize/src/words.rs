//! English for messages: one, or many.

/// `1 frame`, `2 frames`.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

/// `frame 5`, `frames 5-7`.
pub(crate) fn span([first, last]: [i64; 2]) -> String {
    match first == last {
        true => format!("frame {first}"),
        false => format!("frames {first}-{last}"),
    }
}

/// What a take that starts and ends at these frames does.
pub(crate) fn extent(first: i64, last: i64) -> String {
    match first == last {
        true => format!("holds frame {first} alone"),
        false => format!("runs from {first} to {last}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_singular() {
        assert_eq!([counted(1, "frame"), counted(0, "frame")], ["1 frame", "0 frames"]);
        assert_eq!([span([5, 5]), span([-5, 7])], ["frame 5", "frames -5-7"]);
        assert_eq!([extent(5, 5), extent(5, 7)], ["holds frame 5 alone", "runs from 5 to 7"]);
    }
}
