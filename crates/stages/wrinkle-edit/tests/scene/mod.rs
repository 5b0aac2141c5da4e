//! A few frames of measured wrinkles in two cameras.
#![allow(dead_code, reason = "each test takes what it needs")]

use artifact::{Curve2d, CurveState, PerCamera, Profile, Section, SectionDeviation, SectionState, Wrinkle};
use wrinkle_edit::{Editor, Edits, Error, Head, Moment, Params};

/// Frames with images.
pub(crate) const FRAMES: [i64; 5] = [1001, 1005, 1009, 1013, 1017];

pub(crate) fn head() -> Head {
    let wrinkle = |id: &str| Wrinkle { id: id.into(), paint: Some("green".into()) };
    let wrinkles = ["brow_1", "brow_2", "smile"].map(wrinkle).to_vec();
    Head { cameras: vec!["w1".into(), "w2".into()], wrinkles, profile: Profile::Rounded }
}

/// A straight wrinkle that moves by a pixel to the right and two down per frame.
pub(crate) fn curve(number: usize, frame: i64) -> Curve2d {
    let by = (frame - 1001) as f64;
    let controls = (0..6).map(|i| [20.0 + 10.0 * f64::from(i) + by, 30.0 + 40.0 * number as f64 + 2.0 * by]);
    Curve2d { controls: controls.collect(), state: CurveState::Seen, confidence: 0.9, paint: vec![] }
}

/// Its sections: the first is flat, the last has failed.
pub(crate) fn sections(number: usize, frame: i64) -> Vec<Section> {
    let curve = curve(number, frame);
    let section = |i: usize| {
        let state = match i {
            0 => SectionState::Flat,
            9 => SectionState::Failed,
            _ => SectionState::Measured,
        };
        let is_valley = state == SectionState::Measured;
        let u = curve.end() * i as f64 / 9.0;
        Section {
            u,
            at: curve.at(u),
            normal: [0.0, 1.0],
            w_px: if i == 9 { 0.0 } else { 5.0 + 0.1 * i as f64 },
            d_px: if is_valley { 2.0 + 0.2 * i as f64 + 0.01 * (frame - 1001) as f64 } else { 0.0 },
            epsilon: if is_valley { 0.2 } else { 0.0 },
            kappa: if is_valley { -0.1 } else { 0.0 },
            tilt_rad: None,
            deviation: is_valley.then_some(SectionDeviation { w_px: 0.5, d_px: 0.25 }),
            residual: is_valley.then_some(0.01),
            state,
        }
    };
    (0..10).map(section).collect()
}

/// All frames; `smile` is not to be seen by w2, nor by w1 in frame 1009.
pub(crate) fn moments() -> Vec<Moment> {
    let ids = ["brow_1", "brow_2", "smile"];
    let is_seen = |camera: &str, id: &str, frame: i64| id != "smile" || camera == "w1" && frame != 1009;
    let moment = |frame: i64| {
        let (mut all, mut curves) = (PerCamera::new(), PerCamera::new());
        for camera in ["w1", "w2"] {
            let seen = ids.iter().enumerate().filter(|(_, id)| is_seen(camera, id, frame));
            let here = seen.clone().map(|(number, id)| (id.to_string(), sections(number, frame)));
            all.insert(camera.to_string(), here.collect());
            let here = seen.map(|(number, id)| (id.to_string(), curve(number, frame)));
            curves.insert(camera.to_string(), here.collect());
        }
        Moment { frame, sections: Some(all), curves: Some(curves) }
    };
    FRAMES.map(moment).to_vec()
}

/// What a list, without its first line, makes of the frames, and what it warns of.
pub(crate) fn edited(list: &str) -> Result<(Vec<Moment>, Vec<String>), Error> {
    let edits = Edits::parse(&format!("wrinkle-edits/1\n{list}"), &head())?;
    let mut moments = moments();
    let mut editor = Editor::new(&edits, &Params::default())?;
    editor.apply(&mut moments)?;
    Ok((moments, editor.finish()?))
}

pub(crate) fn done(list: &str) -> Vec<Moment> {
    edited(list).unwrap_or_else(|error| panic!("{list}: {error}")).0
}

/// The sections of a wrinkle in a frame.
pub(crate) fn of<'a>(moments: &'a [Moment], frame: i64, camera: &str, id: &str) -> Option<&'a Vec<Section>> {
    let moment = moments.iter().find(|moment| moment.frame == frame)?;
    moment.sections.as_ref()?.get(camera)?.get(id)
}
