//! What the tests of wrinkle maps start from: photographs of a face, and a skinned character.
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "tests may")]

use artifact::{Landmarks, Poses, gltf, read_document};
use assert_cmd::Command;
use std::path::Path;
use virtual_rig::body::Body;
use virtual_rig::character::{
    character, muscles_of, pose_names, reference_names, reference_poses, wrinkle_map,
};
use virtual_rig::pair::face::{FaceDegradation, FacePair, FaceScenario, FaceStudio};

const SIDE: usize = 192;

fn small(expression: &str, flash_share: f64) -> FaceScenario {
    FaceScenario {
        muscles: muscles_of(expression).unwrap(),
        vertices: 8000,
        side_px: SIDE as u32,
        pixel_mm: 1.2,
        rays: 64,
        flash_share,
        degradation: FaceDegradation::none(),
        ..FaceScenario::default()
    }
}

fn shot(scenario: &FaceScenario) -> FacePair {
    FaceStudio::set_up(scenario, 3).unwrap().pair().unwrap()
}

/// How far a normal leans, degrees; none off the skin.
fn lean(normal: [f64; 3]) -> Option<f64> {
    (normal != [0.0; 3]).then(|| normal[2].min(1.0).acos().to_degrees())
}

#[test]
fn a_face_that_does_nothing_is_flat_and_unchanged() {
    let pair = shot(&FaceScenario { muscles: [("smile_l".to_string(), 0.0)].into(), ..small("smile", 0.5) });
    let skin: Vec<f64> = pair.normals.iter().filter_map(|normal| lean(*normal)).collect();
    assert!(skin.len() > SIDE * SIDE / 8 && skin.iter().all(|lean| *lean < 0.5));
    assert_eq!(pair.neutral, pair.expression);
    assert_eq!(pair.neutral_landmarks, pair.expression_landmarks);
    assert_eq!(pair.truth.deepest_mm, 0.0);
}

#[test]
fn raised_brows_fold_the_forehead_and_nothing_below_the_eyes() {
    let pair = shot(&small("brows-up", 0.0));
    let eyes = pair.neutral_landmarks.points["eye_l_01"].at[1];
    let steep: Vec<usize> =
        (0..SIDE * SIDE).filter(|i| lean(pair.normals[*i]).is_some_and(|lean| lean > 10.0)).collect();
    assert!(steep.len() > 30, "{}", steep.len());
    assert!(steep.iter().all(|i| ((i / SIDE) as f64) < eyes));
    // Above and below a valley skin leans to both sides.
    let ups = steep.iter().filter(|i| pair.normals[**i][1] > 0.0).count();
    assert!((0.2..0.8).contains(&(ups as f64 / steep.len() as f64)));
    let brow = |marks: &Landmarks| marks.points["brow_edge_l_06"].at[1];
    assert!(brow(&pair.expression_landmarks) < brow(&pair.neutral_landmarks) - 2.0);
}

#[test]
fn what_spoils_photographs_is_drawn_by_the_seed() {
    let spoilt = FaceScenario { degradation: FaceDegradation::default(), ..small("frown", 1.0) };
    let (one, again) = (shot(&spoilt), shot(&spoilt));
    assert_eq!(one.expression, again.expression);
    assert_eq!(one.neutral_landmarks, again.neutral_landmarks);
    let clean = shot(&small("frown", 1.0));
    let off = |id: &str| {
        let (a, b) = (one.neutral_landmarks.points[id].at, clean.neutral_landmarks.points[id].at);
        (a[0] - b[0]).hypot(a[1] - b[1])
    };
    let ids: Vec<&String> = clean.neutral_landmarks.points.keys().collect();
    let mean = ids.iter().map(|id| off(id)).sum::<f64>() / ids.len() as f64;
    assert!((0.6..2.0).contains(&mean), "{mean}");
    assert!((one.truth.exposure - 1.0).abs() > 0.04);
    // The pupils are some 62 mm apart.
    let apart = clean.neutral_landmarks.interocular_px.unwrap() * 1.2;
    assert!((52.0..72.0).contains(&apart), "{apart}");
}

#[test]
fn a_film_goes_from_nothing_to_all_of_the_wrinkles() {
    let studio = FaceStudio::set_up(&small("brows-up", 0.0), 3).unwrap();
    let (mut shown, mut pictures) = (Vec::new(), Vec::new());
    studio
        .film(4, |frame| {
            shown.push(frame.shown);
            pictures.push(frame.picture);
        })
        .unwrap();
    assert!(shown[0].abs() < 1e-9 && (shown[3] - 1.0).abs() < 1e-9 && shown.is_sorted(), "{shown:?}");
    assert_eq!(pictures[3], studio.pair().unwrap().expression);
}

#[test]
fn parameters_that_make_no_face_are_named() {
    let said = |change: &dyn Fn(&mut FaceScenario)| {
        let mut scenario = small("smile", 0.0);
        change(&mut scenario);
        scenario.check().unwrap_err().to_string()
    };
    assert!(said(&|s| s.muscles = [("grin".to_string(), 1.0)].into()).starts_with("muscles.grin"));
    assert!(said(&|s| s.flash_share = 1.5).starts_with("flash_share"));
    assert!(said(&|s| s.degradation.exposure = [0.2, 0.1]).starts_with("degradation.exposure"));
    assert!(said(&|s| s.pixel_mm = f64::NAN).starts_with("pixel_mm"));
}

#[test]
fn a_character_is_whole_and_its_poses_are_its_own() {
    let body = Body::parametric(2, 6000, &[], 0.0);
    let head = character(&body);
    let mesh = &head.meshes[0];
    assert!(
        mesh.triangles.len() >= 10_000 && mesh.joints.len() == 21 && mesh.uvs.len() == mesh.positions.len()
    );
    for influences in &mesh.influences {
        let sum: f64 = influences.iter().map(|pair| pair.1).sum();
        assert!((sum - 1.0).abs() < 1e-9 && influences.iter().all(|pair| pair.1 > 0.0));
    }
    let metres = mesh.positions.iter().map(|point| point.coords.norm()).fold(0.0, f64::max);
    assert!((0.08..0.3).contains(&metres), "{metres}");
    let poses = reference_poses(&head);
    assert_eq!(poses.poses.iter().map(|pose| pose.id.as_str()).collect::<Vec<_>>(), reference_names());
    assert!(poses.poses.iter().all(|pose| !pose.bones.is_empty()));
    assert_eq!(pose_names().count(), 10);
}

#[test]
fn a_pose_s_map_has_its_own_lines_only() {
    let leaning = |name: &str, rows: std::ops::Range<usize>| {
        let map = wrinkle_map(1, name, 256);
        rows.flat_map(|row| (0..256).map(move |column| 3 * (row * 256 + column)))
            .filter(|at| map.rgb[*at].abs_diff(128).max(map.rgb[at + 1].abs_diff(128)) > 12)
            .count()
    };
    // Row 0 is the top: the forehead is in the upper third.
    assert!(leaning("brows-up", 0..96) > 300 && leaning("brows-up", 128..256) == 0);
    assert!(leaning("smile", 128..256) > 100);
    assert_eq!(leaning("no such pose", 0..256), 0);
}

fn rig(folder: &Path, words: &[&str]) -> (Option<i32>, String) {
    let output = Command::cargo_bin("virtual-rig").unwrap().current_dir(folder).args(words).output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn the_commands_write_what_stages_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (code, said) =
        rig(folder.path(), &["character", "--vertices", "2000", "--map-size", "64", "--out", "head"]);
    assert_eq!(code, Some(0), "{said}");
    let (head, warnings) = gltf::read(&path("head/head.glb")).unwrap();
    assert!(warnings.is_empty() && head.meshes[0].joints.len() == 21);
    let poses: Poses = read_document(&path("head/poses.json")).unwrap();
    for pose in &poses.poses {
        let map = pose.map.as_ref().unwrap();
        assert_eq!(artifact::sha256(&path("head").join(&map.name)).unwrap(), map.sha256);
    }
    let words =
        ["pair", "--face", "smile", "--vertices", "4000", "--side", "128", "--frames", "2", "--out", "face"];
    let (code, said) = rig(folder.path(), &words);
    assert_eq!(code, Some(0), "{said}");
    for name in [
        "neutral.png",
        "expression.png",
        "truth/normals.png",
        "truth/pair.json",
        "truth/film.json",
        "frames/0001.png",
    ] {
        assert!(path("face").join(name).exists(), "{name}");
    }
    let marks: Landmarks = read_document(&path("face/expression-landmarks.json")).unwrap();
    assert!(marks.size == Some([128, 128]) && marks.points.len() > 100);
}

#[test]
fn a_face_that_cannot_be_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (code, said) = rig(folder.path(), &["pair", "--face", "grin", "--out", "face"]);
    assert!(code == Some(2) && said.contains("brows-up"), "{said}");
    std::fs::write(folder.path().join("odd.json"), "{\"muscles\": {\"grin\": 1}}").unwrap();
    let (code, said) =
        rig(folder.path(), &["pair", "--face", "smile", "--scenario", "odd.json", "--out", "face"]);
    assert!(code == Some(1) && said.contains("muscles.grin"), "{said}");
    let (code, said) = rig(folder.path(), &["pair", "--vertices", "5000", "--out", "face"]);
    assert!(code == Some(2) && said.contains("--face"), "{said}");
    assert!(!folder.path().join("face").exists());
}
