//! What a run says about what it found.

use super::run::Unused;
use anyhow::bail;
use artifact::ValleysFrame;
use stage::Run;
use std::collections::BTreeMap;
use std::path::Path;
use wrinkle_lift::{CameraTally, Lost, Tally, percentile};

/// Sections of a camera from which on their misses mean something, …
const ENOUGH: usize = 20;
/// … and shares that miss the face: worth a warning, or an end.
const DOUBTFUL: f64 = 0.2;
const HOPELESS: f64 = 0.95;
/// Deeper than this no wrinkle of a face is, mm.
const DEEP_MM: f64 = 4.0;
/// A wrinkle that cameras put this far apart in the median is worth a warning, mm.
const APART_MM: f64 = 0.5;

pub(super) fn report(run: &mut Run, tally: &Tally, unused: &Unused, drift: &[f64], unmapped: usize) {
    let sum = |count: fn(&CameraTally) -> usize| tally.cameras.values().map(count).sum::<usize>();
    run.result("sections", sum(|camera| camera.lifted + camera.lost.values().sum::<usize>()));
    run.result("lifted", sum(|camera| camera.lifted));
    for (why, name) in NAMES {
        let count: usize = tally.cameras.values().filter_map(|camera| camera.lost.get(&why)).sum();
        run.result(name, count);
    }
    run.result("strays", sum(|camera| camera.strays));
    run.result("points", tally.points);
    run.result("bridged_mm", tally.bridged_mm);
    run.result("split_mm", tally.split_mm);
    run.result("unmapped_vertices", unmapped);
    let all: Vec<f64> = tally.apart_mm.values().flatten().copied().collect();
    for (name, values, share) in [
        ("apart_mm", &all[..], 0.5),
        ("apart_p90_mm", &all[..], 0.9),
        ("drift_mm", drift, 0.5),
        ("drift_p90_mm", drift, 0.9),
    ] {
        run.result(name, percentile(values, share));
    }
    warn(run, tally, unused);
}

const NAMES: [(Lost, &str); 5] = [
    (Lost::Unmeasured, "unmeasured"),
    (Lost::Missed, "missed"),
    (Lost::Hidden, "hidden"),
    (Lost::Grazing, "grazing"),
    (Lost::Unsteady, "unsteady"),
];

fn warn(run: &mut Run, tally: &Tally, unused: &Unused) {
    for (frames, why) in [
        (&unused.unsynced, "the time base has no image of them"),
        (&unused.poseless, "the head has no pose there"),
        (&unused.faceless, "the large-scale sequence has no such frames"),
    ] {
        if let Some(first) = frames.first() {
            run.warn(format!(
                "sections of {} images were left out, the first in frame {first}: {why}",
                frames.len()
            ));
        }
    }
    for (id, camera) in &tally.cameras {
        let off = off_face(camera);
        if camera.cast() >= ENOUGH && off > DOUBTFUL {
            run.warn(format!(
                "camera {id}: {:.0} % of its sections miss the face; is its calibration, the pose and the warp of this take?",
                100.0 * off
            ));
        }
        if let Some(wrinkle) = &camera.example {
            run.warn(format!(
                "camera {id}: {} times a measured wrinkle has no place on the face, e.g. {wrinkle}",
                camera.gone
            ));
        }
    }
    for (id, apart) in &tally.apart_mm {
        if let Some(median) = percentile(apart, 0.5).filter(|median| *median > APART_MM) {
            run.warn(format!(
                "wrinkle {id}: cameras put it {median:.2} mm apart in the median; look at its curves, or at the calibration"
            ));
        }
    }
    if tally.coarse > 0 {
        run.warn(format!(
            "{} of {} points are on valleys with fewer than four edges of the mesh across (2w): refine the mesh there, or they lose their form",
            tally.coarse, tally.points
        ));
    }
}

/// Warns of valleys that are deeper than faces have them: their sections are wrong.
pub(super) fn warn_of_depth(run: &mut Run, frames: &[ValleysFrame]) {
    let mut deepest: BTreeMap<&String, (f64, i64)> = BTreeMap::new();
    for frame in frames {
        for (id, points) in &frame.valleys {
            let depth = points.iter().map(|point| point.d_mm).fold(0.0, f64::max);
            let most = deepest.entry(id).or_insert((depth, frame.frame));
            *most = if depth > most.0 { (depth, frame.frame) } else { *most };
        }
    }
    for (id, (depth, frame)) in deepest.iter().filter(|(_, (depth, _))| *depth > DEEP_MM) {
        run.warn(format!(
            "wrinkle {id} is {depth:.1} mm deep in frame {frame}: look at its curve and sections there; does its paint touch another's?"
        ));
    }
}

/// Share of a camera's sections whose rays miss the face or meet its back.
fn off_face(camera: &CameraTally) -> f64 {
    let off: usize =
        [Lost::Missed, Lost::Hidden].iter().filter_map(|why| camera.lost.get(why)).copied().sum();
    off as f64 / camera.cast().max(1) as f64
}

/// Refuses a camera of which hardly a section meets the face.
pub(super) fn check(tally: &Tally, sections: &Path) -> anyhow::Result<()> {
    for (id, camera) in &tally.cameras {
        if camera.cast() >= ENOUGH && off_face(camera) >= HOPELESS {
            bail!(
                "{}, camera {id}: {:.0} % of {} sections miss the face\n  to do: give the calibration, the pose and the warp of this take",
                sections.display(),
                100.0 * off_face(camera),
                camera.cast()
            );
        }
    }
    Ok(())
}
