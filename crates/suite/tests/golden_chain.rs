//! The golden chain: a tiny take that the virtual rig made, and what every stage makes of it.
//!
//! The take is made again; each stage is run on the golden inputs, so that a failure names the stage at fault; then the
//! whole chain is run end to end. With `FURROW_WRITE_GOLDEN=1` it writes `fixtures/tiny-face` anew.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "a test fails by panicking, in folders of its own, and says what it skips"
)]

mod support;

use std::fmt::Write;
use std::path::Path;
use support::likeness::{files, json_difference, picture_difference, table_difference};
use support::{call, succeed, tiny_face};

/// Markers, handles, poses and single meshes: double precision all the way, so only the order of sums may differ
/// between machines, and picometres would do; a nanometre leaves room for the warp's condition number.
const EXACT_MM: f64 = 1e-6;
/// Times in seconds and frames.
const EXACT_TIME: f64 = 1e-9;
/// Places in images.
const EXACT_PX: f64 = 1e-6;
/// Cameras of an adjustment, which ends where a step changes little.
const ADJUSTED: f64 = 1e-5;
/// Cross-sections of a fit, which ends where a step changes little; px, and shares.
const FITTED: f64 = 1e-3;
/// Sequences are single precision: half a unit in the last place of 128 mm is 4e-6 mm.
const SEQUENCE_MM: f64 = 1e-4;
/// Valleys on the face, which Newton's method carries to the cameras, mm and shares.
const LIFTED: f64 = 1e-5;
/// Wrinkled faces: a descent that ends where a step changes little, mm.
const FOLDED_MM: f64 = 1e-3;
/// Pictures: a value between two levels may be rounded either way.
const LEVELS: f64 = 2.0;

/// How far an artifact may be from the golden one.
#[derive(Clone, Copy)]
enum Yardstick {
    /// By `artifact-diff`, mm.
    Distance(f64),
    /// By `artifact-diff`, levels of 255.
    Levels(f64),
    /// JSON: the same words in the same places, and numbers this close.
    Numbers(f64),
    /// Warps: they carry the same points to places this close, mm. Their coefficients alone say nothing.
    Carried(f64),
}
use Yardstick::{Carried, Distance, Levels, Numbers};

/// Where the take is.
const TAKE: &str = "00-virtual-rig";
/// Makes it, in a folder with the scenario.
const RIG: &str =
    "virtual-rig make --scenario scenario.json --no-calibration --no-normals --out 00-virtual-rig";

struct Stage {
    folder: &'static str,
    calls: &'static [&'static str],
    artifacts: &'static [(&'static str, Yardstick)],
}

const STAGES: &[Stage] = &[
    Stage {
        folder: "01-capture-sync",
        calls: &["capture-sync run 00-virtual-rig/take/take.json --no-extract --out 01-capture-sync"],
        artifacts: &[("sync.jsonl", Numbers(EXACT_TIME))],
    },
    Stage {
        folder: "02-marker-track",
        calls: &[
            "marker-track track --take 00-virtual-rig/take/take.json --sync 01-capture-sync/sync.jsonl \
             --labels 00-virtual-rig/take/labels.json --out 02-marker-track/tracks.jsonl",
        ],
        artifacts: &[("tracks.jsonl", Numbers(EXACT_PX))],
    },
    Stage {
        folder: "03-calibrate",
        calls: &[
            "calibrate refine --cameras 00-virtual-rig/truth/cameras-calibrated.json --tracks 02-marker-track/tracks.jsonl \
             --free pose --out 03-calibrate/cameras.json",
        ],
        artifacts: &[("cameras.json", Numbers(ADJUSTED))],
    },
    Stage {
        folder: "04-triangulate",
        calls: &["triangulate --cameras 03-calibrate/cameras.json --tracks 02-marker-track/tracks.jsonl \
             --sync 01-capture-sync/sync.jsonl --out 04-triangulate/markers.jsonl"],
        artifacts: &[("markers.jsonl", Distance(EXACT_MM))],
    },
    Stage {
        folder: "05-stabilize",
        calls: &[
            "stabilize --markers 04-triangulate/markers.jsonl --take 00-virtual-rig/take/take.json --head-markers head_* \
             --out 05-stabilize/head.jsonl --pose 05-stabilize/pose.jsonl",
        ],
        artifacts: &[("head.jsonl", Distance(EXACT_MM)), ("pose.jsonl", Numbers(EXACT_MM))],
    },
    Stage {
        folder: "06-rbf-warp",
        calls: &[
            "rbf-warp correspond --mesh 00-virtual-rig/take/scan.obj --take 00-virtual-rig/take/take.json --picks 00-virtual-rig/take/picks.csv \
             --out 06-rbf-warp/correspondence.json",
            "rbf-warp fit --mesh 00-virtual-rig/take/scan.obj --markers 05-stabilize/head.jsonl \
             --correspondence 06-rbf-warp/correspondence.json --rest-frame 1001 --out 06-rbf-warp/warp.json",
            "rbf-warp handles --warp 06-rbf-warp/warp.json --markers 05-stabilize/head.jsonl \
             --out 06-rbf-warp/handles.jsonl",
        ],
        artifacts: &[
            ("correspondence.json", Numbers(EXACT_MM)),
            ("warp.json", Carried(EXACT_MM)),
            ("handles.jsonl", Distance(EXACT_MM)),
        ],
    },
    Stage {
        folder: "07-linear-shell",
        calls: &["linear-shell --mesh 00-virtual-rig/take/scan.obj --handles 06-rbf-warp/handles.jsonl \
             --out 07-linear-shell/large-scale.json"],
        artifacts: &[
            ("large-scale.json", Numbers(0.0)),
            ("large-scale.json", Distance(SEQUENCE_MM)),
            ("large-scale.pc2", Distance(SEQUENCE_MM)),
        ],
    },
    Stage {
        folder: "08-mesh-clip",
        calls: &["mesh-clip --mesh 00-virtual-rig/take/scan.obj --unit mm --keep-sphere 0,-20,50,80 \
             --keep-largest-component --out 08-mesh-clip/face.obj --map 08-mesh-clip/face-map.json"],
        artifacts: &[("face.obj", Distance(EXACT_MM)), ("face-map.json", Numbers(0.0))],
    },
    Stage {
        folder: "09-preview",
        calls: &[
            "preview --mesh 00-virtual-rig/take/scan.obj --unit mm --sequence 07-linear-shell/large-scale.json \
             --handles 06-rbf-warp/handles.jsonl --count 2 --size 160 --out 09-preview/frames.png",
        ],
        artifacts: &[("frames.png", Levels(LEVELS))],
    },
    // Of the model nothing is compared: which pixels support it may hang on rounding, what it says does not.
    Stage {
        folder: "10-wrinkle-track",
        calls: &[
            "wrinkle-track train --take 00-virtual-rig/take/take.json --sync 01-capture-sync/sync.jsonl \
             --masks 00-virtual-rig/take/paint-mask --c 10 --gamma 0.5 --out 10-wrinkle-track/paint.json",
            "wrinkle-track track --take 00-virtual-rig/take/take.json --sync 01-capture-sync/sync.jsonl \
             --masks 00-virtual-rig/take/paint-mask --model 10-wrinkle-track/paint.json --out 10-wrinkle-track/wrinkles.jsonl",
        ],
        artifacts: &[("wrinkles.jsonl", Numbers(EXACT_PX))],
    },
    Stage {
        folder: "11-cross-section",
        calls: &[
            "cross-section measure --take 00-virtual-rig/take/take.json --sync 01-capture-sync/sync.jsonl \
             --wrinkles 10-wrinkle-track/wrinkles.jsonl --step-px 8 --out 11-cross-section/sections.jsonl",
        ],
        artifacts: &[("sections.jsonl", Numbers(FITTED))],
    },
    Stage {
        folder: "12-wrinkle-edit",
        calls: &[
            "wrinkle-edit apply --sections 11-cross-section/sections.jsonl --scale-depth 2 --scale-width 0.5 \
             --out 12-wrinkle-edit/sections.jsonl",
        ],
        artifacts: &[("sections.jsonl", Numbers(EXACT_PX))],
    },
    Stage {
        folder: "13-wrinkle-lift",
        calls: &[
            "wrinkle-lift run --mesh 00-virtual-rig/take/scan.obj --unit mm --large-scale 07-linear-shell/large-scale.json \
             --warp 06-rbf-warp/warp.json --head-pose 05-stabilize/pose.jsonl --cameras 03-calibrate/cameras.json \
             --sync 01-capture-sync/sync.jsonl --sections 11-cross-section/sections.jsonl --step-mm 2 --out 13-wrinkle-lift/valleys.jsonl",
        ],
        artifacts: &[("valleys.jsonl", Numbers(LIFTED))],
    },
    Stage {
        folder: "14-shell-synth",
        calls: &[
            "shell-synth --mesh 00-virtual-rig/take/scan.obj --unit mm --large-scale 07-linear-shell/large-scale.json \
             --valleys 13-wrinkle-lift/valleys.jsonl --out 14-shell-synth/wrinkled.json",
        ],
        artifacts: &[
            ("wrinkled.json", Numbers(0.0)),
            ("wrinkled.json", Distance(FOLDED_MM)),
            ("wrinkled.pc2", Distance(FOLDED_MM)),
        ],
    },
];

/// Whether the golden files are to be written anew; then nothing is compared.
fn is_rewriting() -> bool {
    std::env::var_os("FURROW_WRITE_GOLDEN").is_some_and(|value| value == "1")
}

fn copy(name: &str, to: &Path) {
    copy_files(&tiny_face().join(name), &to.join(name));
}

/// Copies a folder, without side-cars.
fn copy_files(from: &Path, to: &Path) {
    for file in files(from) {
        let target = to.join(&file);
        std::fs::create_dir_all(target.parent().expect("its folder")).expect("a folder");
        std::fs::copy(from.join(&file), target).expect("a copy");
    }
}

fn make_take(folder: &Path) {
    std::fs::copy(tiny_face().join("scenario.json"), folder.join("scenario.json")).expect("a copy");
    succeed(folder, RIG);
}

/// How a file differs from the golden one, if it does more than it may. `folder` is a place for intermediate files.
fn difference(folder: &Path, golden: &Path, made: &Path, yardstick: Yardstick) -> Option<String> {
    let (first, second) = (golden.display(), made.display());
    match yardstick {
        Distance(mm) => {
            refusal(folder, &format!("artifact-diff {first} {second} --unit mm --strict --tolerance-mm {mm}"))
        }
        Levels(levels) => {
            refusal(folder, &format!("artifact-diff {first} {second} --strict --tolerance-levels {levels}"))
        }
        Numbers(tolerance) => json_difference(golden, made, tolerance, &[]),
        Carried(mm) => {
            let scan = tiny_face().join("00-virtual-rig/take/scan.obj");
            let apply = |warp: &Path, points: &str, out: &str| {
                let warp = warp.display();
                let back = if out == "mocap.obj" { "--inverse" } else { "" };
                succeed(
                    folder,
                    &format!("rbf-warp apply --warp {warp} --points {points} --unit mm --out {out} {back}"),
                );
            };
            apply(golden, &scan.display().to_string(), "mocap.obj");
            apply(golden, "mocap.obj", "golden.obj");
            apply(made, "mocap.obj", "made.obj");
            refusal(folder, &format!("artifact-diff golden.obj made.obj --unit mm --tolerance-mm {mm}"))
        }
    }
}

fn refusal(folder: &Path, line: &str) -> Option<String> {
    let said = call(folder, line);
    (said.code != Some(0)).then(|| format!("{}{}", said.stdout, said.stderr))
}

/// What differs in the folder of a stage.
fn faults(folder: &Path, stage: &Stage) -> String {
    let mut faults = String::new();
    for (name, yardstick) in stage.artifacts {
        let file = Path::new(stage.folder).join(name);
        let found = difference(folder, &tiny_face().join(&file), &folder.join(&file), *yardstick);
        if let Some(fault) = found {
            writeln!(faults, "{}: is not the golden one\n{fault}", file.display()).expect("a text");
        }
    }
    faults
}

/// Runs one stage on what the golden stages before it made.
fn alone(name: &str) {
    if is_rewriting() {
        println!("skipped: the golden files are being written anew");
        return;
    }
    let at = STAGES.iter().position(|stage| stage.folder == name).expect("a stage");
    let folder = tempfile::tempdir().expect("a folder");
    copy(TAKE, folder.path());
    STAGES[..at].iter().for_each(|stage| copy(stage.folder, folder.path()));
    STAGES[at].calls.iter().for_each(|line| drop(succeed(folder.path(), line)));
    let faults = faults(folder.path(), &STAGES[at]);
    assert!(faults.is_empty(), "\n{faults}");
}

/// How a file of a take differs from the golden one, if it does more than it may. Hashes follow the bytes, which may
/// differ where a sum was rounded another way.
fn difference_in_take(folder: &Path, golden: &Path, made: &Path) -> Option<String> {
    match golden.extension().and_then(|ending| ending.to_str()) {
        Some("json" | "jsonl") => json_difference(golden, made, EXACT_MM, &["sha256"]),
        Some("csv") => table_difference(golden, made, SEQUENCE_MM),
        Some("png") => picture_difference(golden, made),
        _ => difference(folder, golden, made, Distance(SEQUENCE_MM)),
    }
}

#[test]
fn virtual_rig_makes_the_golden_take() {
    if is_rewriting() {
        println!("skipped: the golden files are being written anew");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    make_take(folder.path());
    let (golden, made) = (tiny_face().join(TAKE), folder.path().join(TAKE));
    assert_eq!(files(&made), files(&golden));
    let mut faults = String::new();
    for file in files(&golden) {
        if let Some(fault) = difference_in_take(folder.path(), &golden.join(&file), &made.join(&file)) {
            writeln!(faults, "{}: is not the golden one\n{fault}", file.display()).expect("a text");
        }
    }
    assert!(faults.is_empty(), "\n{faults}");
}

#[test]
fn capture_sync_makes_the_golden_time_base() {
    alone("01-capture-sync");
}

#[test]
fn marker_track_makes_the_golden_tracks() {
    alone("02-marker-track");
}

#[test]
fn calibrate_makes_the_golden_cameras() {
    alone("03-calibrate");
}

#[test]
fn triangulate_makes_the_golden_markers() {
    alone("04-triangulate");
}

#[test]
fn stabilize_makes_the_golden_head() {
    alone("05-stabilize");
}

#[test]
fn rbf_warp_makes_the_golden_handles() {
    alone("06-rbf-warp");
}

#[test]
fn linear_shell_makes_the_golden_sequence() {
    alone("07-linear-shell");
}

#[test]
fn mesh_clip_makes_the_golden_face() {
    alone("08-mesh-clip");
}

#[test]
fn preview_makes_the_golden_picture() {
    alone("09-preview");
}

#[test]
fn wrinkle_track_makes_the_golden_curves() {
    alone("10-wrinkle-track");
}

#[test]
fn cross_section_makes_the_golden_sections() {
    alone("11-cross-section");
}

#[test]
fn wrinkle_edit_makes_the_golden_edit() {
    alone("12-wrinkle-edit");
}

#[test]
fn wrinkle_lift_makes_the_golden_valleys() {
    alone("13-wrinkle-lift");
}

#[test]
fn shell_synth_makes_the_golden_wrinkles() {
    alone("14-shell-synth");
}

#[test]
fn the_whole_chain_ends_in_the_golden_sequences() {
    let folder = tempfile::tempdir().expect("a folder");
    if is_rewriting() {
        make_take(folder.path());
        copy_files(&folder.path().join(TAKE), &tiny_face().join(TAKE));
    } else {
        copy(TAKE, folder.path());
    }
    for line in STAGES.iter().flat_map(|stage| stage.calls) {
        succeed(folder.path(), line);
    }
    for stage in STAGES {
        for (name, _) in stage.artifacts {
            let file = Path::new(stage.folder).join(name);
            let side_car = folder.path().join(format!("{}.prov.json", file.display()));
            assert!(side_car.exists(), "{} is missing", side_car.display());
            if is_rewriting() {
                std::fs::create_dir_all(tiny_face().join(stage.folder)).expect("a folder");
                std::fs::copy(folder.path().join(&file), tiny_face().join(&file)).expect("a copy");
            }
        }
    }
    for (file, mm) in
        [("07-linear-shell/large-scale.json", SEQUENCE_MM), ("14-shell-synth/wrinkled.json", FOLDED_MM)]
    {
        let (golden, made) = (tiny_face().join(file), folder.path().join(file));
        let fault = difference(folder.path(), &golden, &made, Distance(mm));
        assert!(fault.is_none(), "\n{}", fault.unwrap_or_default());
    }
}

/// A copy of a golden file in which the first fractional number after `after` is `by` larger.
fn nudged(folder: &Path, file: &str, after: &str, by: f64) -> std::path::PathBuf {
    let text = std::fs::read_to_string(tiny_face().join(file)).expect("a text");
    let from = text.find(after).expect("the place") + after.len();
    let digits = |c: char| c.is_ascii_digit() || matches!(c, '-' | '.' | 'e');
    let begin = from + text[from..].find(digits).expect("a number");
    let end = begin + text[begin..].find(|c| !digits(c)).expect("its end");
    let number: f64 = text[begin..end].parse().expect("a number");
    let path = folder.join(Path::new(file).file_name().expect("a name"));
    std::fs::write(&path, format!("{}{}{}", &text[..begin], number + by, &text[end..])).expect("a file");
    path
}

/// The comparisons above are worth something only if they can fail.
#[test]
fn the_yardsticks_see_what_is_off() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases = [
        ("01-capture-sync/sync.jsonl", "\"offset_frames\":", 3e-9, Numbers(EXACT_TIME)),
        ("02-marker-track/tracks.jsonl", "\"lip_upper_1\":[", 3e-6, Numbers(EXACT_PX)),
        ("03-calibrate/cameras.json", "\"translation_mm\":[", 3e-5, Numbers(ADJUSTED)),
        ("04-triangulate/markers.jsonl", "\"lip_upper_1\":[", 3e-6, Distance(EXACT_MM)),
        ("05-stabilize/head.jsonl", "\"lip_upper_1\":[", 3e-6, Distance(EXACT_MM)),
        (
            "05-stabilize/pose.jsonl",
            "\"frame\":1003,\"world_from_head\":{\"rotation_wxyz\":[",
            3e-6,
            Numbers(EXACT_MM),
        ),
        ("06-rbf-warp/handles.jsonl", "\"lip_upper_1\":[", 3e-6, Distance(EXACT_MM)),
        ("06-rbf-warp/warp.json", "\"weights\":[[", 1e-5, Carried(EXACT_MM)),
        ("07-linear-shell/large-scale.json", "\"frames\":[", 1.0, Numbers(0.0)),
        ("08-mesh-clip/face.obj", "v ", 3e-6, Distance(EXACT_MM)),
        ("10-wrinkle-track/wrinkles.jsonl", "\"controls\":[[", 3e-6, Numbers(EXACT_PX)),
        ("11-cross-section/sections.jsonl", "\"d_px\":", 3e-3, Numbers(FITTED)),
        ("12-wrinkle-edit/sections.jsonl", "\"w_px\":", 3e-6, Numbers(EXACT_PX)),
        ("13-wrinkle-lift/valleys.jsonl", "\"d_mm\":", 3e-5, Numbers(LIFTED)),
        ("14-shell-synth/wrinkled.json", "\"frames\":[", 1.0, Numbers(0.0)),
    ];
    for (file, after, by, yardstick) in cases {
        let golden = tiny_face().join(file);
        let same = difference(folder.path(), &golden, &golden, yardstick);
        assert_eq!(same, None, "{file}");
        let off = nudged(folder.path(), file, after, by);
        assert!(difference(folder.path(), &golden, &off, yardstick).is_some(), "{file}: {by} is not seen");
    }
}

/// The README beside the files tells the command lines that made them.
#[test]
fn the_readme_tells_how_the_files_were_made() {
    let readme = std::fs::read_to_string(tiny_face().join("README.md")).expect("a README");
    let said: Vec<&str> = readme.split_whitespace().filter(|word| *word != "\\").collect();
    let said = said.join(" ").replace('\'', "");
    for line in STAGES.iter().flat_map(|stage| stage.calls).chain([&RIG]) {
        let line = line.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains(&line), "the README does not tell: {line}");
    }
}
