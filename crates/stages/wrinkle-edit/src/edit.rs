//! The edits, and what each does to frames.

use crate::carry::Motion;
use crate::change::{self, Quantity};
use crate::draw::Drawn;
use crate::moment::{Head, Moment};
use crate::names;
use crate::scope::Scope;
use artifact::{CurveState, FrameRange, Section};

/// An edit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Edit {
    Scale { what: Quantity, by: f64, scope: Scope },
    Set { what: Quantity, to: f64, scope: Scope },
    Draw(Drawn),
    Delete { scope: Scope, everywhere: bool },
    Rename { to: String, scope: Scope, everywhere: bool },
    Swap { scope: Scope, everywhere: bool },
    Copy { from: i64, scope: Scope, follow: Vec<String> },
}

/// What an edit has met with so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Tally {
    /// Frames in its range.
    pub(crate) frames: usize,
    /// Wrinkles that it changed, over frames and cameras.
    pub(crate) changed: usize,
    /// Frames in which the wrinkles that it follows were not to be seen.
    pub(crate) lost: usize,
    /// Frames that it needs and that were there.
    pub(crate) met: usize,
}

impl Edit {
    pub(crate) fn scope(&self) -> &Scope {
        match self {
            Self::Draw(drawn) => &drawn.scope,
            Self::Scale { scope, .. }
            | Self::Set { scope, .. }
            | Self::Delete { scope, .. }
            | Self::Rename { scope, .. }
            | Self::Swap { scope, .. }
            | Self::Copy { scope, .. } => scope,
        }
    }

    /// Frames that must be there, each with an image of the edit's camera.
    pub(crate) fn needs(&self) -> Vec<i64> {
        match self {
            Self::Draw(drawn) => drawn.keys.keys().copied().collect(),
            Self::Copy { from, .. } => vec![*from],
            _ => Vec::new(),
        }
    }

    /// The frames that must be edited together, if the edit carries something from one frame to another.
    pub(crate) fn linked(&self) -> Option<FrameRange> {
        let is_linked = match self {
            Self::Copy { .. } => true,
            Self::Draw(drawn) => !drawn.follow.is_empty(),
            _ => false,
        };
        let FrameRange { first, last } = self.scope().frames;
        let needs = self.needs();
        is_linked.then(|| FrameRange {
            first: needs.iter().copied().fold(first, i64::min),
            last: needs.iter().copied().fold(last, i64::max),
        })
    }

    /// What it does to the list of wrinkles.
    pub(crate) fn edit_head(&self, head: &mut Head) {
        let wrinkles = &mut head.wrinkles;
        match self {
            Self::Draw(drawn) => names::add(wrinkles, drawn.id(), None),
            Self::Delete { scope, everywhere: true } => {
                wrinkles.retain(|wrinkle| !scope.ids.contains(&wrinkle.id));
            }
            Self::Rename { to, scope, everywhere } => names::rename(wrinkles, &scope.ids[0], to, *everywhere),
            Self::Swap { scope, everywhere: true } => names::swap(wrinkles, &scope.ids),
            _ => {}
        }
    }

    /// Edits frames that belong together, and counts.
    pub(crate) fn apply(
        &self,
        moments: &mut [Moment],
        tally: &mut Tally,
        step_px: f64,
    ) -> Result<(), String> {
        let has = |moment: &Moment| self.scope().cameras.iter().any(|camera| moment.has(camera));
        let needs = self.needs();
        tally.met += moments.iter().filter(|moment| needs.contains(&moment.frame) && has(moment)).count();
        let all = if self.linked().is_some() { moments.to_vec() } else { Vec::new() };
        for moment in moments.iter_mut().filter(|moment| self.scope().frames.contains(moment.frame)) {
            tally.frames += 1;
            for camera in &self.scope().cameras {
                if !moment.has(camera) {
                    continue;
                }
                self.edit_image(moment, camera, &all, tally, step_px)
                    .map_err(|what| format!("frame {}, camera {camera}: {what}", moment.frame))?;
            }
        }
        Ok(())
    }

    fn edit_image(
        &self,
        moment: &mut Moment,
        camera: &str,
        all: &[Moment],
        tally: &mut Tally,
        step_px: f64,
    ) -> Result<(), String> {
        let strength = self.scope().strength(moment.frame);
        match self {
            Self::Scale { what, by, scope } => each(moment, camera, scope, tally, |sections| {
                sections.iter_mut().for_each(|section| change::scale(section, *what, *by, strength));
                Ok(())
            }),
            Self::Set { what, to, scope } => {
                each(moment, camera, scope, tally, |sections| change::set(sections, *what, *to, strength))
            }
            Self::Draw(drawn) => {
                names::refuse_taken(moment, camera, drawn.id(), "delete it there first")?;
                match drawn.draw(moment, all, step_px) {
                    true => tally.changed += 1,
                    false => tally.lost += 1,
                }
                Ok(())
            }
            Self::Delete { scope, .. } => {
                tally.changed += names::delete_in(moment, camera, &scope.ids);
                Ok(())
            }
            Self::Rename { to, scope, .. } => {
                tally.changed += names::rename_in(moment, camera, &scope.ids[0], to)?;
                Ok(())
            }
            Self::Swap { scope, .. } => {
                tally.changed += names::swap_in(moment, camera, &scope.ids);
                Ok(())
            }
            Self::Copy { from, scope, follow } => {
                let source = all.iter().find(|other| other.frame == *from && moment.frame != *from);
                let Some(source) = source else { return Ok(()) };
                for id in &scope.ids {
                    copied(source, moment, camera, id, (follow, strength), tally);
                }
                Ok(())
            }
        }
    }
}

/// Changes the sections of each wrinkle of a scope in an image.
fn each(
    moment: &mut Moment,
    camera: &str,
    scope: &Scope,
    tally: &mut Tally,
    change: impl Fn(&mut Vec<Section>) -> Result<(), String>,
) -> Result<(), String> {
    let Some(here) = moment.sections.as_mut().and_then(|all| all.get_mut(camera)) else { return Ok(()) };
    for id in &scope.ids {
        let Some(sections) = here.get_mut(id).filter(|sections| !sections.is_empty()) else { continue };
        change(sections).map_err(|what| format!("wrinkle {id}: {what}"))?;
        tally.changed += 1;
    }
    Ok(())
}

/// Takes a wrinkle over from another frame: its profile, or all of it where it is not to be seen.
fn copied(
    source: &Moment,
    moment: &mut Moment,
    camera: &str,
    id: &str,
    (follow, strength): (&[String], f64),
    tally: &mut Tally,
) {
    let Some(sections) = source.sections_of(camera, id) else { return };
    let here = moment.sections.as_mut().and_then(|all| all.get_mut(camera)?.get_mut(id));
    if let Some(here) = here.filter(|here| !here.is_empty()) {
        change::copy(sections, here, strength);
        tally.changed += 1;
        return;
    }
    let motion = match follow {
        [] => Some(Motion::none()),
        follow => Motion::of(source, moment, camera, follow),
    };
    let Some(motion) = motion else {
        tally.lost += 1;
        return;
    };
    let carried = sections.iter().map(|section| {
        let section = motion.section(section);
        let d_px = strength * section.d_px;
        Section { d_px, state: change::state(d_px), deviation: None, residual: None, ..section }
    });
    let curve = source.curve_of(camera, id).map(|curve| {
        let mut curve = curve.clone();
        curve.controls.iter_mut().for_each(|control| *control = motion.place((*control).into()).into());
        (curve.state, curve.confidence) = (CurveState::Edited, 1.0);
        curve
    });
    moment.put(camera, id, Some(carried.collect()), curve);
    tally.changed += 1;
}
