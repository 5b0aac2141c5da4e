//! Results that must not be scored, by name.

use crate::perturb::*;
use virtual_rig::score::{self, ScoreError, Table};

#[test]
fn results_of_another_take_are_refused() {
    let truth = markers();
    let mut other = truth.clone();
    other.header.take = Some(take("t2"));
    let message = score::trajectories_3d(&truth, &other).unwrap_err().to_string();
    assert!(message.contains("take t2") && message.contains("take t1"), "{message}");

    let (header, frames) = tracks();
    let stranger = artifact::Tracks2dHeader { take: Some(take("t2")), ..header.clone() };
    assert!(matches!(
        score::tracks_2d((&header, &frames), (&stranger, &frames)),
        Err(ScoreError::OtherTake { .. })
    ));
    let (header, frames) = time_base();
    let stranger = artifact::SyncHeader { take: Some(take("t2")), ..header.clone() };
    assert!(matches!(
        score::sync((&header, &frames), (&stranger, &frames)),
        Err(ScoreError::OtherTake { .. })
    ));
    // A result that names no take is believed.
    other.header.take = None;
    assert!(score::trajectories_3d(&truth, &other).is_ok());
}

#[test]
fn unknown_ids_are_refused() {
    let truth = markers();
    let mut other = truth.clone();
    other.header.markers[2] = "nose".into();
    let message = score::trajectories_3d(&truth, &other).unwrap_err().to_string();
    assert!(message.contains("marker nose") && message.contains("p00"), "{message}");

    let truth = rig();
    let mut other = truth.clone();
    let camera = other.cameras["m1"].clone();
    other.cameras.insert("m9".into(), camera);
    let message = score::cameras(&truth, &other, &markers(), None).unwrap_err().to_string();
    assert!(message.contains("camera m9"), "{message}");
}

#[test]
fn other_sizes_units_rates_and_meshes_are_refused() {
    let truth = rig();
    let mut other = truth.clone();
    other.cameras.get_mut("m2").unwrap().camera.image_size = [1312, 980];
    let message = score::cameras(&truth, &other, &markers(), None).unwrap_err().to_string();
    assert!(message.contains("camera m2, image size") && message.contains("1312 × 980"), "{message}");

    let truth = markers();
    let mut other = truth.clone();
    other.header.rate = Some(artifact::Rate::per_second(100));
    assert!(score::trajectories_3d(&truth, &other).unwrap_err().to_string().contains("100 Hz"));

    let truth = sequence(3, &[1, 2]);
    let mut other = truth.clone();
    other.mesh.unit = artifact::Unit::Cm;
    let nothing = |_| -> Result<_, ScoreError> { Ok((Vec::new(), Vec::new())) };
    let message = score::large_scale(&truth, &other, nothing).unwrap_err().to_string();
    assert!(message.contains("unit of scan.obj") && message.contains("cm"), "{message}");
    other = truth.clone();
    other.mesh.file.sha256 = "b".repeat(64);
    assert!(score::large_scale(&truth, &other, nothing).unwrap_err().to_string().contains("mesh"));
}

#[test]
fn frames_numbered_from_elsewhere_are_refused() {
    let truth = markers();
    let mut other = truth.clone();
    other.frames.iter_mut().for_each(|frame| frame.frame -= 1000);
    let message = score::trajectories_3d(&truth, &other).unwrap_err().to_string();
    assert!(message.contains("1–40") && message.contains("1001–1040"), "{message}");
}

#[test]
fn a_table_has_both_forms() {
    let truth = markers();
    let mut result = truth.clone();
    shake_points(&mut result.frames, 0.05, 9);
    let metrics = score::trajectories_3d(&truth, &result).unwrap();
    let table = Table::new("triangulate", metrics).target("rms_mm", 0.07).target("filled_rms_mm", 1.0);
    assert!(!table.passes(), "what could not be measured has failed");
    let rows = table.to_json();
    assert_eq!(rows[0]["metric"], "triangulate/rms_mm");
    assert_eq!(
        (&rows[0]["pass"], &rows[0]["better"], &rows[0]["unit"]),
        (&true.into(), &"lower".into(), &"mm".into())
    );
    assert_eq!(rows[0]["context"]["measured"], 1920);
    let filled = rows.iter().find(|row| row["metric"] == "triangulate/filled_rms_mm").unwrap();
    assert!(filled["value"].is_null() && filled["pass"] == false && filled["reason"].is_string());
    let text = table.to_string();
    assert!(
        text.contains("pass (target ≤ 0.07") && text.contains("not measured: the result fills no sample"),
        "{text}"
    );
    assert!(
        !Table::new("x", Vec::new()).target("rms_mm", 1.0).passes(),
        "a target without a metric has failed"
    );
}
