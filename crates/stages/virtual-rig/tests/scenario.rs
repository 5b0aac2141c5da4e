//! Published scenarios are frozen, and the kind has its schema.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

use artifact::{Document, document_schema, read_document, sha256_of};
use serde_json::{Value, json};
use std::path::PathBuf;
use virtual_rig::scenario::{Length, PRESETS, Scenario, preset};

fn in_repository(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../..").join(path)
}

fn validator() -> jsonschema::Validator {
    jsonschema::validator_for(&document_schema::<Scenario>()).unwrap()
}

fn frozen() -> Value {
    serde_json::from_slice(&std::fs::read(in_repository("fixtures/schema/scenario-1/scenario.json")).unwrap())
        .unwrap()
}

/// A change makes a new version beside these.
const HASHES: [(&str, &str); 3] = [
    ("clean", "2010cb9190d5c8bb0adfc60d04badcce412585641c33bad5046b6f9e634f4adf"),
    ("standard", "a370314d247ab5fd73aeb65c940108a3d5a0605c07be1bb9360be92a2ee2244d"),
    ("hard", "7aaf32f80f8784be4a5087c1a483ce59996d7a91c899656935144a737527c3ce"),
];

#[test]
fn published_scenarios_never_change() {
    let found = PRESETS.map(|(name, text)| (name, sha256_of(text.as_bytes())));
    let wanted = HASHES.map(|(name, hash)| (name, hash.to_string()));
    assert_eq!(found, wanted, "a published scenario has changed: make a new version of it instead");
}

#[test]
fn published_scenarios_are_sound_and_survive_writing() {
    for (name, text) in PRESETS {
        let scenario = preset(name).unwrap();
        scenario.check().unwrap();
        assert_eq!(scenario.name, format!("{name}-1"));
        assert_eq!(preset(&scenario.name).unwrap(), scenario);
        let written = serde_json::to_string(&scenario).unwrap();
        assert_eq!(serde_json::from_str::<Scenario>(&written).unwrap(), scenario, "{name}");
        let errors: Vec<String> = validator()
            .iter_errors(&serde_json::from_str(text).unwrap())
            .map(|error| error.to_string())
            .collect();
        assert!(errors.is_empty(), "{name}: {errors:?}");
        let whole = json!({ "schema": "scenario/1", "data": serde_json::to_value(&scenario).unwrap() });
        assert!(validator().is_valid(&whole), "{name}, written in full");
    }
    assert!(preset("standard-2").is_none() && preset("standardish").is_none());
}

#[test]
fn lengths_are_what_they_say() {
    for (length, frames, wrinkle_frames) in [("tiny", 3, 1), ("short", 25, 7), ("long", 500, 125)] {
        let mut scenario = preset("standard").unwrap();
        length.parse::<Length>().unwrap().apply(&mut scenario);
        scenario.check().unwrap();
        let extent = scenario.extent;
        let filmed = (extent.wrinkle_phase..extent.frames).step_by(extent.wrinkle_every as usize).count();
        assert_eq!((extent.frames, filmed), (frames, wrinkle_frames), "{length}");
    }
    assert!("endless".parse::<Length>().unwrap_err().contains("tiny, short or long"));
}

fn of_length(mut scenario: Scenario, length: &str) -> Scenario {
    length.parse::<Length>().unwrap().apply(&mut scenario);
    scenario.check().unwrap();
    scenario
}

/// A length leaves nothing of another one, nor of a scenario's own; `short` is what is published.
#[test]
fn a_length_sets_all_that_it_owns() {
    for (name, _) in PRESETS {
        let published = preset(name).unwrap();
        let mut own = published.clone();
        own.extent.wrinkle_every = 1;
        (own.extent.pace, own.image_scale, own.vertices) = (3.0, 0.31, 777);
        (own.calibration.boards.count, own.calibration.wand.frames) = (3, 4);
        assert_eq!(of_length(published.clone(), "short"), published);
        for length in ["tiny", "short", "long"] {
            let wanted = of_length(published.clone(), length);
            assert_eq!(of_length(own.clone(), length), wanted, "{length}");
            for before in ["tiny", "short", "long"] {
                assert_eq!(
                    of_length(of_length(published.clone(), before), length),
                    wanted,
                    "{before}, {length}"
                );
            }
        }
    }
}

/// Videos need even sides.
#[test]
fn images_of_all_lengths_have_even_sides() {
    for length in ["tiny", "short", "long"] {
        for (id, camera) in of_length(preset("standard").unwrap(), length).placements() {
            let [width, height] = camera.image_size;
            assert!(width % 2 == 0 && height % 2 == 0, "{length}, {id}: {width} × {height}");
        }
    }
}

/// Scenarios of one name and seed are the same.
#[test]
fn a_changed_scenario_changes_its_name() {
    let published = preset("standard").unwrap();
    let named = |change: &dyn Fn(&mut Scenario)| {
        let mut scenario = published.clone();
        change(&mut scenario);
        scenario.mark_changes(&published);
        scenario.name
    };
    assert_eq!(named(&|_| {}), "standard-1");
    assert_eq!(named(&|scenario| *scenario = scenario.clone().with_seed(2)), "standard-1");
    assert_eq!(named(&|scenario| scenario.seed = 2), "standard-1+", "the head's motion did not follow");
    assert_eq!(named(&|scenario| scenario.faults.push("rotated=2@m2".parse().unwrap())), "standard-1+");
    assert_eq!(named(&|scenario| *scenario = of_length(scenario.clone(), "tiny")), "standard-1+");
    assert_eq!(published.clone().with_seed(1), published, "its own seed");

    let mut own = Scenario { name: "standard-1".into(), ..of_length(published.clone(), "tiny") };
    let read = own.clone();
    own.mark_changes(&read);
    assert_eq!(own.name, "standard-1+", "a published name on another scenario");
    let read = own.clone();
    own.vertices += 1;
    own.mark_changes(&read);
    assert_eq!(own.name, "standard-1+", "one mark is enough");
}

#[test]
fn the_schema_in_the_docs_is_that_of_the_code() {
    let path = in_repository("docs/schema/scenario-1.json");
    let wanted = serde_json::to_string_pretty(&document_schema::<Scenario>()).unwrap() + "\n";
    if std::env::var("FURROW_WRITE_SCHEMA").is_ok_and(|value| value == "1") {
        std::fs::write(&path, &wanted).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        found == wanted,
        "docs/schema/scenario-1.json is not what the code says. If the change only adds an optional field or a comment, \
         run the test with FURROW_WRITE_SCHEMA=1; otherwise the kind needs a new version."
    );
}

#[test]
fn the_frozen_file_follows_the_schema_and_is_read_for_ever() {
    let value = frozen();
    let errors: Vec<String> = validator().iter_errors(&value).map(|error| error.to_string()).collect();
    assert!(errors.is_empty(), "{errors:?}");
    let read: Scenario = read_document(&in_repository("fixtures/schema/scenario-1/scenario.json")).unwrap();
    // As text: colours are single precision, and a value would widen them.
    let written: Value = serde_json::from_str(&serde_json::to_string(&read).unwrap()).unwrap();
    assert!(holds(&written, &value["data"]), "{written}");
}

/// Whether a value says all that another one says; parameters that came later may stand beside it.
fn holds(now: &Value, then: &Value) -> bool {
    match (now, then) {
        (Value::Object(now), Value::Object(then)) => {
            then.iter().all(|(key, then)| now.get(key).is_some_and(|now| holds(now, then)))
        }
        _ => now == then,
    }
}

#[test]
fn the_schema_refuses_what_the_reader_refuses() {
    for (pointer, wrong) in
        [("/schema", json!("scenario/9")), ("/data/seed", json!("one")), ("/data/extent/frames", json!(null))]
    {
        let mut value = frozen();
        *value.pointer_mut(pointer).unwrap() = wrong;
        assert!(!validator().is_valid(&value), "{pointer}");
    }
    let mut value = frozen();
    value["data"]["colour"] = json!(1);
    assert!(!validator().is_valid(&value), "an unknown field");
}
