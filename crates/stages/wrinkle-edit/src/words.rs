//! The words of a line: clauses that begin with a key word, in any order.

use crate::scope::Ease;
use crate::spline::Place;
use artifact::FrameRange;

/// The clauses of a line, each with its words.
pub(crate) struct Clauses<'a>(Vec<(&'a str, Vec<&'a str>)>);

impl<'a> Clauses<'a> {
    /// Splits words into clauses.
    ///
    /// # Errors
    /// A word before the first clause, a clause that stands twice or has no words.
    pub(crate) fn of(words: &[&'a str], known: &[&str]) -> Result<Self, String> {
        let mut clauses: Vec<(&str, Vec<&str>)> = Vec::new();
        for word in words {
            if known.contains(word) {
                if clauses.iter().any(|(other, _)| other == word) {
                    return Err(format!("'{word}' stands twice"));
                }
                clauses.push((word, Vec::new()));
            } else {
                let unexpected =
                    || format!("'{word}' is not expected here; write one of {}", known.join(", "));
                clauses.last_mut().ok_or_else(unexpected)?.1.push(word);
            }
        }
        match clauses.iter().find(|(_, words)| words.is_empty()) {
            Some((key, _)) => Err(format!("nothing follows '{key}'")),
            None => Ok(Self(clauses)),
        }
    }

    /// The words of a clause, if it is there.
    pub(crate) fn words(&self, key: &str) -> Option<&[&'a str]> {
        self.0.iter().find(|(other, _)| *other == key).map(|(_, words)| words.as_slice())
    }

    /// The one word of a clause.
    pub(crate) fn word(&self, key: &str) -> Result<Option<&'a str>, String> {
        match self.words(key) {
            None => Ok(None),
            Some([word]) => Ok(Some(word)),
            Some([_, more, ..]) => Err(format!("'{more}' after '{key}' is one word too many")),
            Some([]) => Err(format!("nothing follows '{key}'")),
        }
    }

    /// The one word of a clause that must be there.
    pub(crate) fn needed(&self, key: &str) -> Result<&'a str, String> {
        self.word(key)?.ok_or_else(|| format!("'{key}' is missing"))
    }

    /// A list of words between commas.
    pub(crate) fn list(&self, key: &str) -> Result<Option<Vec<String>>, String> {
        Ok(self.word(key)?.map(|word| word.split(',').map(String::from).collect()))
    }

    /// A list of numbers between commas.
    pub(crate) fn numbers(&self, key: &str) -> Result<Option<Vec<f64>>, String> {
        self.word(key)?.map(|word| word.split(',').map(number).collect()).transpose()
    }

    /// The frames of the clause `frames`.
    pub(crate) fn frames(&self) -> Result<Option<FrameRange>, String> {
        let range = |word: &str| {
            word.parse::<FrameRange>()
                .map_err(|_| format!("'{word}' is no range of frames such as 1010-1020"))
        };
        self.word("frames")?.map(range).transpose()
    }

    /// The clause `ease`: `N` or `IN,OUT` frames, then `linear` or `smooth`.
    pub(crate) fn ease(&self, frames: FrameRange) -> Result<Ease, String> {
        let Some(words) = self.words("ease") else { return Ok(Ease::default()) };
        let (lengths, smooth) = match words {
            [lengths] | [lengths, "linear"] => (lengths, false),
            [lengths, "smooth"] => (lengths, true),
            _ => return Err("after 'ease' write N or IN,OUT frames, then linear or smooth".into()),
        };
        let length = |text: &str| {
            text.parse::<u32>().map_err(|_| format!("'{text}' is no number of frames to ease over"))
        };
        let (rise, fall) = match lengths.split_once(',') {
            Some((rise, fall)) => (length(rise)?, length(fall)?),
            None => (length(lengths)?, length(lengths)?),
        };
        if rise > 0 && frames.first == i64::MIN || fall > 0 && frames.last == i64::MAX {
            return Err("an edit eases from its first or to its last frame; name them: frames A-B".into());
        }
        let ends = [frames.first.max(-BEYOND), frames.last.min(BEYOND)];
        if i64::from(rise) + i64::from(fall) > ends[1] - ends[0] + 1 {
            return Err(format!("it eases over {} frames, but holds for fewer: {frames}", rise + fall));
        }
        Ok(Ease { rise, fall, smooth })
    }

    /// Places: `X,Y X,Y …`.
    pub(crate) fn places(&self, key: &str) -> Result<Option<Vec<Place>>, String> {
        let place = |word: &&str| {
            let wrong = || format!("'{word}' is no place; write X,Y in px");
            let (x, y) = word.split_once(',').ok_or_else(wrong)?;
            Ok(Place::new(number(x).map_err(|_| wrong())?, number(y).map_err(|_| wrong())?))
        };
        self.words(key).map(|words| words.iter().map(place).collect()).transpose()
    }
}

/// No take has frames beyond.
const BEYOND: i64 = 1 << 53;

/// A number, finite.
pub(crate) fn number(text: &str) -> Result<f64, String> {
    text.parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(|| format!("'{text}' is no number"))
}
