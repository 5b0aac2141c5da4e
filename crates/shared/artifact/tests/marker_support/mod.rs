//! What the tests of marker formats share.
#![allow(dead_code, reason = "each test binary uses some of it")]
#![allow(clippy::expect_used, clippy::print_stdout, reason = "tests")]

use artifact::{MarkerFrame, MarkerHeader, Rate, Result, SampleStatus, Staged, Trajectories, Unit};
use nalgebra::Point3;
use proptest::prelude::*;
use std::path::Path;

/// The bytes that a writer makes.
pub(crate) fn written(name: &str, write: impl Fn(&Path) -> Result<Staged>) -> Result<Vec<u8>> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join(name);
    write(&path)?.publish()?;
    artifact::read_bytes(&path)
}

pub(crate) fn trajectories(
    rate: Rate,
    markers: &[&str],
    frames: &[(i64, &[Option<[f64; 3]>])],
) -> Trajectories {
    let markers: Vec<String> = markers.iter().map(ToString::to_string).collect();
    let frames = frames.iter().map(|(frame, points)| MarkerFrame {
        frame: *frame,
        points: points.iter().map(|point| point.map(Point3::from)).collect(),
        status: vec![SampleStatus::Measured; points.len()],
    });
    let frames = frames.collect();
    Trajectories { header: MarkerHeader { unit: Unit::Mm, rate: Some(rate), markers, take: None }, frames }
}

/// Two markers in three frames from 1001 on, one sample missing.
pub(crate) fn small() -> Trajectories {
    let (a, b) = ([1.5, -2.25, 300.0], [-40.125, 5.0, 0.5]);
    trajectories(
        Rate::per_second(120),
        &["brow_l", "brow_r"],
        &[(1001, &[Some(a), Some(b)]), (1002, &[Some(b), None]), (1003, &[Some(b), Some(a)])],
    )
}

/// Any markers, rates, gaps in samples and in frame numbers; coordinates that 32-bit floats hold.
pub(crate) fn any_trajectories() -> impl Strategy<Value = Trajectories> {
    let rates = prop_oneof![
        (1u32..2000).prop_map(Rate::per_second),
        (1u32..16).prop_map(|tens| Rate { frames: tens * 30_000, seconds: 1001 })
    ];
    let point = prop::option::weighted(0.8, prop::array::uniform3(-3000f32..3000f32));
    (1usize..8, 1usize..12, rates, 0i64..100_000).prop_flat_map(move |(markers, frames, rate, first)| {
        let points = prop::collection::vec(prop::collection::vec(point.clone(), markers), frames);
        let steps = prop::collection::vec(1i64..4, frames);
        let labels = prop::collection::hash_set("[A-Za-z_][A-Za-z0-9_:.-]{0,14}|[äöü]{1,3}", markers);
        (points, steps, labels).prop_map(move |(points, steps, labels)| {
            let mut labels: Vec<String> = labels.into_iter().collect();
            labels.sort();
            let mut number = first;
            let frames = points.into_iter().zip(steps).map(|(points, step)| {
                number += step;
                let points = points.into_iter().map(|point| point.map(|p| Point3::from(p.map(f64::from))));
                let points: Vec<_> = points.collect();
                let status = vec![SampleStatus::Measured; points.len()];
                MarkerFrame { frame: number, points, status }
            });
            let frames = frames.collect();
            let header = MarkerHeader { unit: Unit::Mm, rate: Some(rate), markers: labels, take: None };
            Trajectories { header, frames }
        })
    })
}

/// The same with frames for all numbers in between, all samples missing: what C3D makes of gaps.
pub(crate) fn without_gaps(mut trajectories: Trajectories) -> Trajectories {
    let markers = trajectories.header.markers.len();
    let (first, last) =
        (trajectories.frames[0].frame, trajectories.frames[trajectories.frames.len() - 1].frame);
    let mut frames = std::mem::take(&mut trajectories.frames).into_iter().peekable();
    trajectories.frames = (first..=last)
        .map(|number| {
            frames.next_if(|frame| frame.frame == number).unwrap_or_else(|| MarkerFrame {
                frame: number,
                points: vec![None; markers],
                status: vec![SampleStatus::Measured; markers],
            })
        })
        .collect();
    trajectories
}
