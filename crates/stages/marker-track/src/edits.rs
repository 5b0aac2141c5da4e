//! Corrections by hand, as a list that can be replayed.
//!
//! One edit per line; empty lines and what follows a `#` do not count. Frames are absolute numbers, places pixels.
//!
//! ```text
//! relabel FRAME CAMERA A B      from FRAME on, A and B change names in CAMERA
//! split FRAME CAMERA MARKER     from FRAME on, the track is no longer MARKER's
//! fill FRAME CAMERA MARKER X Y  MARKER is at X, Y in FRAME
//! fill A-B CAMERA MARKER        from A to B, MARKER goes straight from its place before to its place after
//! ```

use crate::Error;
use artifact::{FrameRange, Sample2d, TrackState, Tracks2dFrame, Tracks2dHeader};
use nalgebra::Point2;

/// An edit, with markers and cameras by their places in the header.
#[derive(Debug, Clone, PartialEq)]
enum Edit {
    Relabel { frame: i64, camera: usize, markers: [usize; 2] },
    Split { frame: i64, camera: usize, marker: usize },
    Place { frame: i64, camera: usize, marker: usize, at: Point2<f64> },
    Fill { frames: FrameRange, camera: usize, marker: usize },
}

/// A list of edits.
#[derive(Debug, Clone, PartialEq)]
pub struct Edits {
    /// With the lines that they stand on.
    edits: Vec<(usize, Edit)>,
}

impl Edits {
    /// Reads a list; ids are those of the tracks' header, `sizes` the widths and heights of its cameras' images, px.
    ///
    /// # Errors
    /// [`Error::Edit`] with the line: an unknown word, camera or marker, too few or too many words, a place outside the image, a
    /// marker that would change names with itself.
    pub fn parse(text: &str, header: &Tracks2dHeader, sizes: &[[u32; 2]]) -> Result<Self, Error> {
        let mut edits = Vec::new();
        for (index, line) in text.lines().enumerate() {
            let line_number = index + 1;
            let words: Vec<&str> = line.split('#').next().unwrap_or("").split_whitespace().collect();
            if words.is_empty() {
                continue;
            }
            match read(&words, header).and_then(|edit| edit.check(sizes)) {
                Ok(edit) => edits.push((line_number, edit)),
                Err(what) => return Err(Error::Edit { line: line_number, what }),
            }
        }
        Ok(Self { edits })
    }

    /// How many edits there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.edits.len()
    }

    /// Applies the edits in their order.
    ///
    /// # Errors
    /// [`Error::Edit`] with the line: a frame or an image that is not there, a gap without ends.
    pub fn apply(&self, frames: &mut [Tracks2dFrame]) -> Result<(), Error> {
        for (line, edit) in &self.edits {
            edit.apply(frames).map_err(|what| Error::Edit { line: *line, what })?;
        }
        Ok(())
    }
}

fn read(words: &[&str], header: &Tracks2dHeader) -> Result<Edit, String> {
    let place = |list: &[String], thing: &str, id: &str| {
        list.iter().position(|other| other == id).ok_or_else(|| format!("the tracks have no {thing} '{id}'"))
    };
    let camera = |id| place(&header.cameras, "camera", id);
    let marker = |id| place(&header.markers, "marker", id);
    let frame = |text: &str| text.parse::<i64>().map_err(|_| format!("'{text}' is no frame number"));
    let number = |text: &str| {
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
        value.ok_or_else(|| format!("'{text}' is no number of pixels"))
    };
    match *words {
        ["relabel", at, id, a, b] => {
            Ok(Edit::Relabel { frame: frame(at)?, camera: camera(id)?, markers: [marker(a)?, marker(b)?] })
        }
        ["split", at, id, m] => {
            Ok(Edit::Split { frame: frame(at)?, camera: camera(id)?, marker: marker(m)? })
        }
        ["fill", at, id, m, x, y] => Ok(Edit::Place {
            frame: frame(at)?,
            camera: camera(id)?,
            marker: marker(m)?,
            at: Point2::new(number(x)?, number(y)?),
        }),
        ["fill", range, id, m] => Ok(Edit::Fill {
            frames: range
                .parse()
                .map_err(|_| format!("'{range}' is no range of frames such as 1010-1020"))?,
            camera: camera(id)?,
            marker: marker(m)?,
        }),
        ["relabel", ..] => Err("write: relabel FRAME CAMERA A B".into()),
        ["split", ..] => Err("write: split FRAME CAMERA MARKER".into()),
        ["fill", ..] => Err("write: fill FRAME CAMERA MARKER X Y, or fill A-B CAMERA MARKER".into()),
        [other, ..] => Err(format!("'{other}' is no edit; there are relabel, split and fill")),
        [] => Err("is empty".into()),
    }
}

fn edited(at: Point2<f64>) -> Sample2d {
    Sample2d { at, state: TrackState::Edited, confidence: 1.0 }
}

impl Edit {
    /// Refuses what cannot be meant.
    fn check(self, sizes: &[[u32; 2]]) -> Result<Self, String> {
        match self {
            Self::Relabel { markers: [a, b], .. } if a == b => {
                Err("the marker would change names with itself; name two markers".into())
            }
            Self::Place { camera, at, .. } => {
                let [width, height] = sizes[camera];
                let on = |x: f64, side: u32| (-0.5..f64::from(side) - 0.5).contains(&x);
                match on(at.x, width) && on(at.y, height) {
                    true => Ok(self),
                    false => Err(format!(
                        "the place lies outside the image of {width} × {height} px; give the marker's place in pixels"
                    )),
                }
            }
            _ => Ok(self),
        }
    }

    fn apply(&self, frames: &mut [Tracks2dFrame]) -> Result<(), String> {
        match *self {
            Self::Relabel { frame, camera, markers: [a, b] } => {
                later(frames, frame)?.filter_map(|f| f.cameras[camera].as_mut()).for_each(|s| s.swap(a, b));
            }
            Self::Split { frame, camera, marker } => {
                later(frames, frame)?
                    .filter_map(|f| f.cameras[camera].as_mut())
                    .for_each(|s| s[marker] = None);
            }
            Self::Place { frame, camera, marker, at } => {
                let found = frames.iter_mut().find(|f| f.frame == frame);
                let found = found.ok_or_else(|| format!("the tracks have no frame {frame}"))?;
                let samples = found.cameras[camera].as_mut();
                samples.ok_or_else(|| format!("the camera has no image of frame {frame}"))?[marker] =
                    Some(edited(at));
            }
            Self::Fill { frames: range, camera, marker } => fill(frames, range, camera, marker)?,
        }
        Ok(())
    }
}

/// The frames from a number on, of which there must be one.
fn later(
    frames: &mut [Tracks2dFrame],
    from: i64,
) -> Result<impl Iterator<Item = &mut Tracks2dFrame>, String> {
    match (frames.first(), frames.last()) {
        (Some(first), _) if first.frame > from => Err(format!(
            "the tracks begin with frame {}, after frame {from}; name the frame where it begins",
            first.frame
        )),
        (_, Some(last)) if last.frame >= from => Ok(frames.iter_mut().filter(move |f| f.frame >= from)),
        _ => Err(format!("the tracks end before frame {from}; name one of their frames")),
    }
}

fn fill(frames: &mut [Tracks2dFrame], range: FrameRange, camera: usize, marker: usize) -> Result<(), String> {
    let known = |f: &&Tracks2dFrame| {
        let sample = f.cameras[camera].as_ref().and_then(|samples| samples[marker]);
        sample.filter(|sample| sample.state != TrackState::Predicted).map(|sample| (f.frame, sample.at))
    };
    let first = frames.iter().find(|f| range.contains(f.frame)).map(|f| f.frame);
    let first = first.ok_or_else(|| format!("the tracks have no frame in {range}"))?;
    let before = frames.iter().filter(|f| f.frame < first).filter_map(|f| known(&f)).next_back();
    let after = frames.iter().filter(|f| f.frame > first && !range.contains(f.frame)).find_map(|f| known(&f));
    let (Some((start, from)), Some((end, to))) = (before, after) else {
        return Err(format!("the marker is not seen both before and after {range}"));
    };
    for f in frames.iter_mut().filter(|f| range.contains(f.frame)) {
        let share = (f.frame - start) as f64 / (end - start) as f64;
        if let Some(samples) = &mut f.cameras[camera] {
            samples[marker] = Some(edited(from + share * (to - from)));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZES: [[u32; 2]; 1] = [[200, 100]];

    fn header() -> Tracks2dHeader {
        let names = |list: &[&str]| list.iter().map(ToString::to_string).collect();
        Tracks2dHeader { cameras: names(&["m1"]), markers: names(&["a", "b"]), rate: None, take: None }
    }

    fn frames() -> Vec<Tracks2dFrame> {
        let sample = |x: f64| Some(Sample2d::seen(Point2::new(x, 0.0)));
        let frame = |i: i64| Tracks2dFrame {
            frame: 1001 + i,
            cameras: vec![Some(vec![sample(i as f64), sample(100.0 + i as f64)])],
        };
        (0..5).map(frame).collect()
    }

    fn at(frames: &[Tracks2dFrame], frame: usize, marker: usize) -> Option<(f64, TrackState)> {
        frames[frame].cameras[0].as_ref().unwrap()[marker].map(|sample| (sample.at.x, sample.state))
    }

    #[test]
    fn edits_are_replayed_in_their_order() {
        let text = "# a day's work\nrelabel 1003 m1 a b\n\nsplit 1005 m1 b\nfill 1002 m1 a 7.5 1\nfill 1003-1004 m1 b # gap\n";
        let edits = Edits::parse(text, &header(), &SIZES).unwrap();
        assert_eq!(edits.count(), 4);
        let mut tracks = frames();
        assert!(edits.apply(&mut tracks).is_err(), "b has no end after the gap");
        let edits = Edits::parse(&text.replace("split 1005", "split 1001"), &header(), &SIZES).unwrap();
        assert!(matches!(edits.apply(&mut frames()), Err(Error::Edit { line: 6, .. })));
        let mut tracks = frames();
        Edits::parse("relabel 1003 m1 a b\nfill 1002 m1 a 7.5 1\nsplit 1005 m1 b", &header(), &SIZES)
            .unwrap()
            .apply(&mut tracks)
            .unwrap();
        assert_eq!(at(&tracks, 1, 0), Some((7.5, TrackState::Edited)));
        assert_eq!(at(&tracks, 2, 0), Some((102.0, TrackState::Seen)));
        assert_eq!(at(&tracks, 4, 1), None);
        let mut tracks = frames();
        Edits::parse("fill 1002-1004 m1 a", &header(), &SIZES).unwrap().apply(&mut tracks).unwrap();
        assert_eq!(at(&tracks, 2, 0), Some((2.0, TrackState::Edited)));
    }

    #[test]
    fn faults_name_their_line() {
        for (text, line, word) in [
            ("relabel 1003 m9 a b", 1, "camera 'm9'"),
            ("\nsplit 1003 m1 c", 2, "marker 'c'"),
            ("merge a b", 1, "'merge'"),
            ("fill x m1 a 1 2", 1, "'x'"),
            ("fill 1003 m1 a 1", 1, "fill FRAME"),
            ("fill 1003 m1 a nan 2", 1, "'nan'"),
            ("fill 1003 m1 a 5000 1", 1, "200 × 100"),
            ("relabel 1003 m1 a a", 1, "itself"),
        ] {
            match Edits::parse(text, &header(), &SIZES) {
                Err(Error::Edit { line: found, what }) => {
                    assert_eq!(found, line, "{text}");
                    assert!(what.contains(word), "{text}: {what}");
                }
                other => panic!("{text}: {other:?}"),
            }
        }
        for beyond in ["split 1009 m1 a", "relabel 5 m1 a b"] {
            let replayed = Edits::parse(beyond, &header(), &SIZES).unwrap().apply(&mut frames());
            assert!(matches!(replayed, Err(Error::Edit { line: 1, .. })), "{beyond}");
        }
    }
}
