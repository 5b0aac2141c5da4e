//! Every key of a scenario does something: changed, it changes a take, or it is refused.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use camera::Camera;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::hash::{DefaultHasher, Hash, Hasher};
use virtual_rig::Error;
use virtual_rig::calibration::{BoardCamera, board_poses, common_volume, render_led, wand_path};
use virtual_rig::scenario::{Scenario, preset};
use virtual_rig::take::{Given, Studio};

/// A small scenario in which all that can be left out is there: two cameras, of which both film the frame 2, at 0.2 s.
fn full() -> Value {
    let mut scenario = serde_json::to_value(preset("standard").unwrap()).unwrap();
    let event = |action: &str| json!({"action": action, "start_s": 0.0, "rise_s": 0.1, "hold_s": 0.02, "fall_s": 0.2, "strength": 0.9});
    let camera = |role: &str, azimuth_deg: f64| {
        json!({"role": role, "image_size": [328, 245], "focal_px": 725.0, "distance_mm": 720.0, "azimuth_deg": azimuth_deg,
            "elevation_deg": 4.0, "roll_deg": 1.0, "target_mm": [1.0, 12.0, 45.0], "distortion": [-0.1, 0.05, 0.0, 0.0, 0.0]})
    };
    for (pointer, value) in [
        (
            "/extent",
            json!({"frames": 3, "first_frame": 1001, "rate": {"frames": 10, "seconds": 1}, "wrinkle_every": 4,
            "wrinkle_phase": 2, "pace": 1.0}),
        ),
        ("/vertices", json!(1000)),
        ("/pores_mm", json!(0.02)),
        ("/performance", json!({"events": {"events": [event("brow_raise"), event("speech")], "seed": 3}})),
        ("/events", json!([event("smile")])),
        ("/folds/d_over_w_max", json!(0.1)),
        ("/hands/count", json!(3)),
        ("/cameras", json!({"m1": camera("mocap", -10.0), "w1": camera("wrinkle", 15.0)})),
        ("/image_scale", json!(0.25)),
        ("/light/rays", json!(64)),
        ("/light/cheap_rays", json!(16)),
        ("/light/interreflection", json!({"bounces": 1})),
        (
            "/film/gloss",
            json!({"strength": 0.2, "exponent": 24.0, "rim": 0.25, "toward_key": [0.3, 0.8, 0.6]}),
        ),
        ("/gain_drift", json!(0.1)),
        ("/calibration/boards/board", json!({"chessboard": {"columns": 8, "rows": 6, "square_mm": 15.0}})),
        ("/calibration/boards/count", json!(1)),
        ("/calibration/boards/samples", json!(16)),
        ("/calibration/wand/frames", json!(2)),
        ("/flash", json!({"mocap_frame": 2, "length_s": 0.001, "factor": 1.5})),
        ("/faults", json!([{"kind": "rotated", "amount": 0.2, "camera": "w1"}])),
    ] {
        *scenario.pointer_mut(pointer).unwrap() = value;
    }
    scenario
}

/// Another value for a key, where the general rule would make no sense or too little of a difference.
fn other(pointer: &str) -> Option<Value> {
    Some(match pointer {
        "/extent/wrinkle_phase" => json!(1),
        "/extent/wrinkle_every" => json!(5),
        "/vertices" => json!(1300),
        "/folds/smoothing_mm" => json!(15.0),
        _ if pointer.contains("/image_size/") => json!(340),
        "/light/epsilon_mm" => json!(0.05),
        "/light/crease_deg" => json!(40.0),
        "/film/samples_per_side" => json!(8),
        "/folds/family" => json!("s"),
        "/lines/paints/0" => json!("violet"),
        "/lines/paints/1" => json!("green"),
        "/sensor/transfer" => json!("linear"),
        "/sensor/bits" => json!(16),
        "/cameras/m1/role" => json!("wrinkle"),
        "/cameras/w1/role" => json!("mocap"),
        "/faults/0/kind" => json!("defocused"),
        "/faults/0/camera" => json!("m1"),
        _ if pointer.ends_with("/action") => json!("blink"),
        _ => return None,
    })
}

fn perturbed(pointer: &str, value: &Value) -> Value {
    other(pointer).unwrap_or_else(|| match value {
        Value::Bool(is) => json!(!is),
        Value::Number(number) if number.is_f64() => match number.as_f64().unwrap() {
            0.0 => json!(0.02),
            value => json!(value * 1.05),
        },
        Value::Number(number) => json!(number.as_i64().unwrap() + 1),
        _ => panic!("{pointer}: how to change {value}?"),
    })
}

/// The name is all that a take need not hold; the section of all wrinkles alike would take the place of what folds do.
const LEFT_OUT: [&str; 2] = ["/name", "/folds/fixed"];
/// What can say nothing but one value for now.
const REFUSED: [&str; 2] = ["/paint/texture", "/sensor/bits"];

fn leaves(value: &Value, pointer: String, found: &mut Vec<String>) {
    match value {
        Value::Object(object) => {
            object.iter().for_each(|(key, value)| leaves(value, format!("{pointer}/{key}"), found));
        }
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, value)| leaves(value, format!("{pointer}/{i}"), found));
        }
        _ => found.push(pointer),
    }
}

/// A hash of what is filmed: the calibration, the clocks, and both cameras' images of one frame.
fn take(value: &Value) -> Result<u64, Error> {
    let scenario: Scenario = serde_json::from_str(&value.to_string()).unwrap();
    let studio = Studio::set_up(scenario, Given::default())?;
    let mut hash = DefaultHasher::new();
    let schedule = studio.schedule()?;
    for (id, entries) in &schedule.cameras {
        let station = &studio.stations()[id];
        format!("{entries:?} {:?}", studio.sync_of(id, station)).hash(&mut hash);
        let set = studio.set(2.0 / 10.0, station.exposure_s, true);
        set.pose.skin.iter().flat_map(|point| point.iter()).for_each(|x| x.to_bits().hash(&mut hash));
        let exposure = studio.expose(&set, station)?;
        exposure.radiance.iter().flatten().for_each(|x| x.to_bits().hash(&mut hash));
        studio.develop(&exposure, station, 2, 0.2)?.hash(&mut hash);
    }
    calibration(&studio)?.hash(&mut hash);
    Ok(hash.finish())
}

fn calibration(studio: &Studio) -> Result<(String, Vec<u32>), Error> {
    let (params, seed) = (&studio.scenario().calibration, studio.scenario().seed);
    let stations = studio.stations().iter();
    let cameras: Vec<(&str, &Camera)> =
        stations.map(|(id, station)| (id.as_str(), &station.calibrated)).collect();
    let boards = &params.boards;
    let poses = board_poses(&cameras, boards, seed)?;
    let board =
        BoardCamera::new(cameras[0].1).render(&boards.board, &poses[0], &boards.light, boards.samples);
    let all: Vec<Camera> = cameras.iter().map(|(_, camera)| (*camera).clone()).collect();
    let volume = common_volume(&all).unwrap();
    let wand = &params.wand;
    let reach = virtual_rig::calibration::Volume { radius_mm: volume.radius_mm * wand.reach, ..volume };
    let path = wand_path(&reach, wand.frames, wand.frames_per_sweep, seed);
    let led = render_led(cameras[0].1, &path[1], wand.radius_mm, wand.radiance, wand.room);
    let light = board.radiance.iter().chain(&led.radiance).flatten();
    Ok((format!("{poses:?} {path:?}"), light.map(|x| x.to_bits()).collect()))
}

#[test]
fn every_key_changes_the_take_or_is_refused() {
    let full = full();
    let mut keys = Vec::new();
    leaves(&full, String::new(), &mut keys);
    keys.retain(|key| !LEFT_OUT.contains(&key.as_str()));
    assert!(keys.len() > 130, "{}", keys.len());
    let whole = take(&full).unwrap();
    assert_eq!(take(&full).unwrap(), whole, "the same again");
    let changes = |key: &&String| {
        let mut value = full.clone();
        let leaf = value.pointer_mut(key).unwrap();
        *leaf = perturbed(key, leaf);
        match (take(&value), key.as_str()) {
            (taken, "/extent/pace") => {
                // The pace is that of the standard performance.
                value["performance"] = json!("standard");
                let faster = take(&value).unwrap();
                value["extent"]["pace"] = full["extent"]["pace"].clone();
                taken.is_ok() && faster != take(&value).unwrap()
            }
            // No other frame is filmed by all cameras.
            (Err(Error::Parameter { place, .. }), "/flash/mocap_frame" | "/extent/wrinkle_phase") => {
                place == "flash.mocap_frame"
            }
            (Err(Error::Parameter { place, .. }), key) => {
                REFUSED.contains(&key) && key[1..].replace('/', ".") == place
            }
            (Ok(taken), _) => taken != whole,
        }
    };
    let idle: Vec<&String> = keys.par_iter().filter(|key| !changes(key)).collect();
    assert!(idle.is_empty(), "these change nothing: {idle:?}");
}
