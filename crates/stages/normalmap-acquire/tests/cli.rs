//! The program: a pair of photographs from files to maps, a film, and bad input.
#![allow(clippy::unwrap_used, clippy::panic, clippy::disallowed_methods, reason = "tests may")]

use artifact::picture::{read_gray, read_rgb, write_rgb8};
use artifact::{Landmark, Landmarks, write_document};
use assert_cmd::Command;
use std::path::Path;
use tempfile::TempDir;

const SIZE: [usize; 2] = [120, 96];

fn code(light: f64) -> u8 {
    let light = light.clamp(0.0, 1.0);
    let stored = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    (255.0 * stored).round() as u8
}

/// Skin whose row 48 is darker by a share.
fn skin(depth: f64) -> Vec<u8> {
    let light = |i: usize| {
        let (x, y) = ((i % SIZE[0]) as f64, (i / SIZE[0]) as f64);
        let grain = 0.4 + 0.03 * (0.9 * x).sin() * (0.7 * y).cos();
        [code(grain * (1.0 - depth * (-((y - 48.0) / 4.0).powi(2)).exp())); 3]
    };
    (0..SIZE[0] * SIZE[1]).flat_map(light).collect()
}

fn mark(folder: &Path, name: &str, change: impl Fn(&mut Landmarks)) {
    let mut landmarks = Landmarks { interocular_px: Some(250.0), ..Landmarks::default() };
    for i in 0..9 {
        let at = [10.0 + 50.0 * f64::from(i % 3), 8.0 + 40.0 * f64::from(i / 3)];
        landmarks.points.insert(format!("p{i}"), Landmark { at, depth_px: None });
    }
    change(&mut landmarks);
    write_document(&folder.join(name), &landmarks).unwrap().publish().unwrap();
}

fn paint(folder: &Path, name: &str, rgb: &[u8]) {
    write_rgb8(&folder.join(name), SIZE[0], SIZE[1], rgb).unwrap().publish().unwrap();
}

fn scene() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    paint(folder.path(), "rest.png", &skin(0.0));
    paint(folder.path(), "smile.png", &skin(0.35));
    mark(folder.path(), "rest.json", |_| {});
    mark(folder.path(), "smile.json", |_| {});
    folder
}

const PAIR: [&str; 9] = [
    "acquire",
    "--neutral",
    "rest.png",
    "--neutral-landmarks",
    "rest.json",
    "--expression",
    "smile.png",
    "--expression-landmarks",
    "smile.json",
];

fn command(folder: &Path, more: &[&str]) -> std::process::Output {
    let mut command = Command::cargo_bin("normalmap-acquire").unwrap();
    command.current_dir(folder).args(PAIR).args(["--out", "out.png"]).args(more).output().unwrap()
}

fn works(folder: &Path, more: &[&str]) -> String {
    let output = command(folder, more);
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{said}");
    said
}

/// What the program says of input that it refuses; nothing may be left.
fn refused(folder: &Path, more: &[&str]) -> String {
    let output = command(folder, more);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("to do:") && !folder.join("out.png").exists(), "{said}");
    said
}

#[test]
fn a_wrinkle_comes_out_with_its_walls_towards_each_other() {
    let folder = scene();
    works(folder.path(), &["--displacement", "height.png", "--debug", "steps", "--npy", "normals.npy"]);
    let map = read_rgb(&folder.path().join("out.png")).unwrap();
    let green = |row: usize| map.at(60, row)[1];
    assert!(green(44) < 0.45 && green(52) > 0.55, "{} {}", green(44), green(52));
    assert!((green(20) - 0.5).abs() < 0.03);
    let height = read_gray(&folder.path().join("height.png")).unwrap();
    assert!(height.pixels[48 * SIZE[0] + 60] < 0.1);
    assert!(
        folder.path().join("height.scale.json").exists() && folder.path().join("steps/ratio.png").exists()
    );
    works(folder.path(), &["--green", "directx", "--bits", "16"]);
    let down = read_rgb(&folder.path().join("out.png")).unwrap();
    assert!(down.at(60, 44)[1] > 0.55);
}

#[test]
fn nothing_changes_outside_a_mask_and_a_texture_takes_the_map() {
    let folder = scene();
    let mask: Vec<u8> =
        (0..SIZE[0] * SIZE[1]).flat_map(|i| [if i % SIZE[0] < 60 { 255 } else { 0 }; 3]).collect();
    paint(folder.path(), "mask.png", &mask);
    works(folder.path(), &["--mask", "mask.png", "--bits", "16"]);
    let map = read_rgb(&folder.path().join("out.png")).unwrap();
    for row in 0..SIZE[1] {
        assert_eq!(map.at(80, row)[2], 1.0, "row {row}");
    }
    assert!(map.at(30, 44)[1] < 0.45);
    // In the texture the face lies on its side: up in the photograph is left there.
    let rows: String = (0..9)
        .map(|i| format!("p{i},{},{}\n", 0.1 + 0.3 * f64::from(i / 3), 0.1 + 0.3 * f64::from(i % 3)))
        .collect();
    std::fs::write(folder.path().join("uv.csv"), format!("id,u,v\n{rows}")).unwrap();
    works(folder.path(), &["--texture-landmarks", "uv.csv", "--texture-size", "128"]);
    let map = read_rgb(&folder.path().join("out.png")).unwrap();
    let reds: Vec<f64> = (20..80).map(|column| map.at(column, 78)[0]).collect();
    let (low, high) = reds.iter().fold((1.0f64, 0.0f64), |(low, high), red| (low.min(*red), high.max(*red)));
    assert!(low < 0.45 && high > 0.55, "{low} {high}");
    // A landmark on another chart would tear the map.
    let stray = rows.replace("p8,0.7,0.7", "p8,0.1,0.95");
    assert_ne!(stray, rows);
    std::fs::write(folder.path().join("uv.csv"), format!("id,u,v\n{stray}")).unwrap();
    std::fs::remove_file(folder.path().join("out.png")).unwrap();
    mark(folder.path(), "rest.json", |marks| marks.interocular_px = Some(60.0));
    let said = refused(folder.path(), &["--texture-landmarks", "uv.csv", "--texture-size", "128"]);
    assert!(said.contains("uv.csv, landmark p"), "{said}");
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let folder = scene();
    let bytes = |threads: &str| {
        works(folder.path(), &["--threads", threads, "--bits", "16"]);
        std::fs::read(folder.path().join("out.png")).unwrap()
    };
    assert_eq!(bytes("1"), bytes("3"));
}

#[test]
fn photographs_that_do_not_go_together_are_refused() {
    let folder = scene();
    paint(folder.path(), "smile.png", &skin(0.0));
    assert!(refused(folder.path(), &[]).contains("same pixels"));
    paint(folder.path(), "smile.png", &vec![2; 3 * SIZE[0] * SIZE[1]]);
    let said = refused(folder.path(), &[]);
    assert!(said.contains("smile.png") && said.contains("unlit"), "{said}");
    write_rgb8(&folder.path().join("smile.png"), 60, 48, &[90; 60 * 48 * 3]).unwrap().publish().unwrap();
    mark(folder.path(), "smile.json", |marks| {
        marks.points.values_mut().for_each(|mark| mark.at = mark.at.map(|x| 0.4 * x));
    });
    let said = refused(folder.path(), &[]);
    assert!(said.contains("60 × 48") && said.contains("--unlike"), "{said}");
}

#[test]
fn landmarks_that_cannot_be_are_refused() {
    let folder = scene();
    let path = folder.path();
    mark(path, "smile.json", |marks| {
        marks.points.get_mut("p4").unwrap().at[0] = 400.0;
    });
    let said = refused(path, &[]);
    assert!(said.contains("smile.json") && said.contains("p4") && said.contains("outside"), "{said}");
    mark(path, "smile.json", |marks| {
        marks.points.remove("p3");
    });
    let said = refused(path, &[]);
    assert!(said.contains("p3") && said.contains("--common-landmarks"), "{said}");
    works(path, &["--common-landmarks"]);
    std::fs::remove_file(path.join("out.png")).unwrap();
    mark(path, "smile.json", |marks| marks.points.retain(|id, _| id < &"p3".to_string()));
    assert!(refused(path, &[]).contains("at least 4"));
    mark(path, "smile.json", |marks| {
        let (a, b) = (marks.points["p0"], marks.points["p8"]);
        marks.points.insert("p0".into(), b);
        marks.points.insert("p8".into(), a);
    });
    mark(path, "rest.json", |marks| marks.interocular_px = Some(80.0));
    let said = refused(path, &[]);
    assert!(said.contains("landmark p") && said.contains("crossed"), "{said}");
    mark(path, "smile.json", |marks| marks.size = Some([96, 120]));
    assert!(refused(path, &[]).contains("96 × 120"));
}

#[test]
fn masks_of_another_size_and_missing_scales_are_refused() {
    let folder = scene();
    write_rgb8(&folder.path().join("mask.png"), 8, 8, &[255; 192]).unwrap().publish().unwrap();
    let said = refused(folder.path(), &["--mask", "mask.png"]);
    assert!(said.contains("mask.png") && said.contains("8 × 8"), "{said}");
    mark(folder.path(), "rest.json", |marks| marks.interocular_px = None);
    assert!(refused(folder.path(), &[]).contains("--interocular-px"));
    works(folder.path(), &["--interocular-px", "250"]);
    let output = command(folder.path(), &["--light", "dim"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_film_tells_how_wrinkles_come() {
    let folder = scene();
    let path = folder.path();
    for frame in 0..5 {
        let share = f64::from(frame) / 4.0;
        // Never the neutral picture itself.
        paint(path, &format!("film{frame}.png"), &skin(0.01 + 0.34 * share * share));
        mark(path, &format!("film{frame}.json"), |marks| {
            marks.points.get_mut("p4").unwrap().at[1] += 4.0 * share;
        });
    }
    let words = ["fit-modulation", "--neutral", "rest.png", "--neutral-landmarks", "rest.json"];
    let film =
        ["--frames", "film{frame}.png", "--frame-landmarks", "film{frame}.json", "--out", "theta.json"];
    let run = Command::cargo_bin("normalmap-acquire")
        .unwrap()
        .current_dir(path)
        .args(words)
        .args(film)
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let found: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path.join("theta.json")).unwrap()).unwrap();
    let curve = found["modulation"].as_array().unwrap();
    assert_eq!(curve.first().unwrap()[0], 0.0);
    assert_eq!(curve.last().unwrap()[1], 1.0);
    let middle = found["frames"][2][1].as_f64().unwrap();
    assert!((0.05..0.5).contains(&middle), "{middle}");
    let run = Command::cargo_bin("normalmap-acquire")
        .unwrap()
        .current_dir(path)
        .args(words)
        .args(film)
        .args(["--range", "2-4", "--by", "frames", "--maps", "maps/{frame}.png"])
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let found: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path.join("theta.json")).unwrap()).unwrap();
    assert_eq!(found["frames"].as_array().unwrap().len(), 3);
    assert_eq!(found["frames"][1][0], 0.5);
    assert!(path.join("maps/2.png").exists() && !path.join("maps/1.png").exists());
}

#[test]
fn a_film_may_begin_with_the_neutral_picture_itself() {
    let folder = scene();
    let path = folder.path();
    for (frame, depth) in [0.0, 0.1, 0.2, 0.35].into_iter().enumerate() {
        paint(path, &format!("film{frame}.png"), &skin(depth));
        mark(path, &format!("film{frame}.json"), |marks| {
            marks.points.get_mut("p4").unwrap().at[1] += frame as f64;
        });
    }
    let run = Command::cargo_bin("normalmap-acquire")
        .unwrap()
        .current_dir(path)
        .args(["fit-modulation", "--neutral", "film0.png", "--neutral-landmarks", "film0.json"])
        .args(["--frames", "film{frame}.png", "--frame-landmarks", "film{frame}.json", "--out", "theta.json"])
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let found: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(path.join("theta.json")).unwrap()).unwrap();
    let shares: Vec<f64> = (0..4).map(|i| found["frames"][i][1].as_f64().unwrap()).collect();
    assert!(shares[0] == 0.0 && shares[3] == 1.0 && shares.is_sorted(), "{shares:?}");
}

#[cfg(not(feature = "video"))]
#[test]
fn a_video_is_refused_by_a_build_without_videos() {
    let folder = scene();
    std::fs::write(folder.path().join("film.mp4"), b"film").unwrap();
    let run = Command::cargo_bin("normalmap-acquire")
        .unwrap()
        .current_dir(folder.path())
        .args(["fit-modulation", "--neutral", "rest.png", "--neutral-landmarks", "rest.json"])
        .args(["--frames", "film.mp4", "--frame-landmarks", "film{frame}.json", "--out", "theta.json"])
        .output()
        .unwrap();
    let said = String::from_utf8(run.stderr).unwrap();
    assert_eq!(run.status.code(), Some(1));
    assert!(said.contains("film.mp4") && said.contains("--features video"), "{said}");
    assert!(!folder.path().join("theta.json").exists());
}

#[test]
fn help_reads_well() {
    let help = |words: &[&str]| {
        let mut command = Command::cargo_bin("normalmap-acquire").unwrap();
        String::from_utf8(command.args(words).arg("--help").env("COLUMNS", "100").output().unwrap().stdout)
            .unwrap()
    };
    insta::assert_snapshot!("help", help(&[]));
    insta::assert_snapshot!("acquire-help", help(&["acquire"]));
    insta::assert_snapshot!("fit-modulation-help", help(&["fit-modulation"]));
}
