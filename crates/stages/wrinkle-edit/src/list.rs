//! Lists of edits, as text that can be replayed.

use crate::edit::{Edit, Tally};
use crate::moment::{Head, Moment};
use crate::read::{Line, read};
use crate::read_drawn::KeyWords;
use crate::{Error, Params};
use artifact::FrameRange;

/// What a list begins with.
pub const VERSION: &str = "wrinkle-edits/1";

/// A list of edits.
#[derive(Debug, Clone, PartialEq)]
pub struct Edits {
    /// With the lines that they stand on.
    edits: Vec<(usize, Edit)>,
    /// The same as text, without comments.
    lines: Vec<String>,
}

/// A list of edits that is being replayed.
#[derive(Debug, Clone)]
pub struct Editor<'a> {
    edits: &'a Edits,
    tallies: Vec<Tally>,
    step_px: f64,
}

impl Edits {
    /// Reads a list: `wrinkle-edits/1`, then one edit per line; empty lines and what follows a `#` do not count, and a list without a
    /// word is an empty one. The wrinkle-edit README tells the edits. Ids are those of `head`, as the edits before leave it.
    ///
    /// # Errors
    /// [`Error::Edit`] with the line: another version, an unknown word, wrinkle or camera, a value out of its range, a name that is
    /// taken.
    pub fn parse(text: &str, head: &Head) -> Result<Self, Error> {
        let mut list = Self { edits: Vec::new(), lines: Vec::new() };
        let mut head = head.clone();
        let mut is_open = false;
        for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
            let words: Vec<&str> = line.split('#').next().unwrap_or("").split_whitespace().collect();
            let fault = |what| Error::Edit { line: index + 1, what };
            match words.as_slice() {
                [] => continue,
                _ if is_open => list.add(index + 1, &words, &mut head).map_err(fault)?,
                words => is_open = open(words).map_err(fault)?,
            }
        }
        Ok(list)
    }

    fn add(&mut self, line: usize, words: &[&str], head: &mut Head) -> Result<(), String> {
        match read(words, head)? {
            Line::Edit(edit) => {
                self.refuse_double(&edit)?;
                edit.edit_head(head);
                self.edits.push((line, edit));
            }
            Line::Key(id, camera, frame, key) => self.add_key(&id, &camera, frame, key)?,
        }
        self.lines.push(words.join(" "));
        Ok(())
    }

    fn refuse_double(&self, edit: &Edit) -> Result<(), String> {
        let Edit::Draw(drawn) = edit else { return Ok(()) };
        let is_same = |other: &Edit| matches!(other, Edit::Draw(other) if other.id() == drawn.id() && other.camera() == drawn.camera());
        match self.edits.iter().find(|(_, other)| is_same(other)) {
            Some((line, _)) => Err(format!(
                "{} was drawn in camera {} in line {line}; write key to say how it looks in another frame",
                drawn.id(),
                drawn.camera()
            )),
            None => Ok(()),
        }
    }

    fn add_key(&mut self, id: &str, camera: &str, frame: i64, key: KeyWords) -> Result<(), String> {
        let drawn = self.edits.iter_mut().rev().find_map(|(_, edit)| match edit {
            Edit::Draw(drawn) if drawn.id() == id && drawn.camera() == camera => Some(drawn),
            _ => None,
        });
        let drawn = drawn.ok_or_else(|| format!("no line before draws {id} in camera {camera}"))?;
        let (_, first) = drawn.keys.first_key_value().ok_or("there is no first key")?;
        let (wanted, count) = (first.controls.len(), key.controls.len());
        if wanted != count {
            return Err(format!(
                "it has {count} control points, but {wanted} in the line that draws it; give as many places"
            ));
        }
        let key = key.or(&first.shape.clone());
        match drawn.keys.insert(frame, key) {
            Some(_) => Err(format!("how {id} looks in frame {frame} is said twice")),
            None => Ok(()),
        }
    }

    /// How many edits there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.lines.len()
    }

    /// The edits as text, one by one, without comments.
    #[must_use]
    pub fn lines(&self) -> &[String] {
        &self.lines
    }

    /// What the edits make of what holds for all frames.
    #[must_use]
    pub fn edited(&self, head: &Head) -> Head {
        let mut head = head.clone();
        self.edits.iter().for_each(|(_, edit)| edit.edit_head(&mut head));
        head
    }

    /// The frames that must be handed to [`Editor::apply`] together, since something is carried between them; all others may come one
    /// by one.
    #[must_use]
    pub fn linked(&self) -> Option<FrameRange> {
        let ranges = self.edits.iter().filter_map(|(_, edit)| edit.linked());
        ranges.reduce(|a, b| FrameRange { first: a.first.min(b.first), last: a.last.max(b.last) })
    }
}

/// Whether a list begins as it should.
fn open(words: &[&str]) -> Result<bool, String> {
    match words {
        [VERSION] => Ok(true),
        [word, ..] if word.starts_with("wrinkle-edits/") => {
            Err(format!("is '{}'; this program reads {VERSION}", words.join(" ")))
        }
        _ => Err(format!("the list must begin with a line '{VERSION}'")),
    }
}

impl<'a> Editor<'a> {
    /// Begins to replay a list.
    ///
    /// # Errors
    /// [`Error::Parameter`].
    pub fn new(edits: &'a Edits, params: &Params) -> Result<Self, Error> {
        params.check()?;
        Ok(Self { edits, tallies: vec![Tally::default(); edits.edits.len()], step_px: params.step_px })
    }

    /// Makes all edits in some frames, in the order of the list.
    ///
    /// # Errors
    /// [`Error::Edit`] with the line, frame and camera: a name that is taken there, a depth without a width.
    pub fn apply(&mut self, moments: &mut [Moment]) -> Result<(), Error> {
        for ((line, edit), tally) in self.edits.edits.iter().zip(&mut self.tallies) {
            edit.apply(moments, tally, self.step_px).map_err(|what| Error::Edit { line: *line, what })?;
        }
        Ok(())
    }

    /// What there is to say after the last frame: edits that changed nothing, frames without the wrinkle to follow.
    ///
    /// # Errors
    /// [`Error::Edit`] with the line: none of its frames was there, or one that it names by itself was not.
    pub fn finish(&self) -> Result<Vec<String>, Error> {
        let mut warnings = Vec::new();
        for ((line, edit), tally) in self.edits.edits.iter().zip(&self.tallies) {
            missing(edit, tally).map_err(|what| Error::Edit { line: *line, what })?;
            if tally.lost > 0 {
                warnings.push(format!(
                    "line {line}: left out in {} images, in which what it follows is not to be seen",
                    tally.lost
                ));
            } else if tally.changed == 0 {
                warnings.push(format!(
                    "line {line}: changes nothing: the wrinkles are not to be seen in its frames"
                ));
            }
        }
        Ok(warnings)
    }

    /// How many wrinkles were changed, over edits, frames and cameras.
    #[must_use]
    pub fn changed(&self) -> usize {
        self.tallies.iter().map(|tally| tally.changed).sum()
    }
}

fn missing(edit: &Edit, tally: &Tally) -> Result<(), String> {
    let frames = edit.scope().frames;
    if tally.frames == 0 {
        return Err(format!(
            "there is no frame in {frames}; wrinkles are known in frames with an image only"
        ));
    }
    let needs = edit.needs();
    match tally.met < needs.len() {
        true => {
            let needs: Vec<String> = needs.iter().map(ToString::to_string).collect();
            let one = if needs.len() == 1 { "frame" } else { "one of the frames" };
            Err(format!(
                "there is no image of {one} {} in {}",
                needs.join(", "),
                edit.scope().cameras.join(", ")
            ))
        }
        false => Ok(()),
    }
}
