//! Frames of sections and of curves, read side by side.

use anyhow::bail;
use artifact::{FrameReader, Sections, SectionsFrame, Wrinkle, Wrinkles2d, Wrinkles2dFrame};
use std::iter::Peekable;
use std::path::Path;
use wrinkle_edit::{Head, Moment};

/// Sections and, where they are given, curves.
pub(crate) struct Moments {
    sections: Peekable<FrameReader<Sections>>,
    curves: Option<Peekable<FrameReader<Wrinkles2d>>>,
}

impl Moments {
    pub(crate) fn new(sections: FrameReader<Sections>, curves: Option<FrameReader<Wrinkles2d>>) -> Self {
        Self { sections: sections.peekable(), curves: curves.map(Iterator::peekable) }
    }
}

/// What holds for all frames of the sections; curves must say the same.
pub(crate) fn head(
    sections: &FrameReader<Sections>,
    curves: Option<&FrameReader<Wrinkles2d>>,
) -> anyhow::Result<Head> {
    let header = sections.header();
    let head =
        Head { cameras: header.cameras.clone(), wrinkles: header.wrinkles.clone(), profile: header.profile };
    if let Some(curves) = curves {
        check_same(sections.path(), &head.wrinkles, curves)?;
        if let Some(camera) = head.cameras.iter().find(|id| !curves.header().cameras.contains(id)) {
            bail!(
                "{}: has no camera {camera}, which {} has\n  to do: give the curves that the sections were measured on",
                curves.path().display(),
                sections.path().display()
            );
        }
    }
    Ok(head)
}

fn check_same(sections: &Path, known: &[Wrinkle], curves: &FrameReader<Wrinkles2d>) -> anyhow::Result<()> {
    let mut ids = [known, &curves.header().wrinkles]
        .map(|list| list.iter().map(|wrinkle| wrinkle.id.as_str()).collect::<Vec<_>>());
    ids.iter_mut().for_each(|list| list.sort_unstable());
    if ids[0] != ids[1] {
        bail!(
            "{}: has the wrinkles {}, but {} has {}\n  to do: give the curves that the sections were measured on",
            curves.path().display(),
            ids[1].join(", "),
            sections.display(),
            ids[0].join(", ")
        );
    }
    Ok(())
}

impl Iterator for Moments {
    type Item = artifact::Result<Moment>;

    fn next(&mut self) -> Option<Self::Item> {
        let number = |next: Option<&artifact::Result<_>>, of: fn(&_) -> i64| {
            next.map(|frame| frame.as_ref().map_or(i64::MIN, of))
        };
        let section = number(self.sections.peek(), |frame: &SectionsFrame| frame.frame);
        let curve = self
            .curves
            .as_mut()
            .and_then(|curves| curves.peek())
            .map(|frame| frame.as_ref().map_or(i64::MIN, |frame: &Wrinkles2dFrame| frame.frame));
        // A line that cannot be read comes first, and ends the run.
        let frame = section.into_iter().chain(curve).min()?;
        let mut moment = Moment { frame, sections: None, curves: None };
        if section == Some(frame) {
            match self.sections.next()? {
                Ok(found) => moment.sections = Some(found.sections),
                Err(error) => return Some(Err(error)),
            }
        }
        if curve == Some(frame) {
            match self.curves.as_mut()?.next()? {
                Ok(found) => moment.curves = Some(found.curves),
                Err(error) => return Some(Err(error)),
            }
        }
        Some(Ok(moment))
    }
}
