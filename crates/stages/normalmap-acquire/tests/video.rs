//! A film as a video file.
#![cfg(feature = "video")]
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "tests may")]

use artifact::{Landmark, Landmarks, write_document};
use assert_cmd::Command;
use footage::{Codec, VideoWriter};

const SIZE: [usize; 2] = [120, 96];

/// Skin whose row 48 is darker by a share; light as it is stored.
fn skin(depth: f64) -> Vec<u8> {
    let code = |i: usize| {
        let (x, y) = ((i % SIZE[0]) as f64, (i / SIZE[0]) as f64);
        let grain = 0.4 + 0.03 * (0.9 * x).sin() * (0.7 * y).cos();
        let light = grain * (1.0 - depth * (-((y - 48.0) / 4.0).powi(2)).exp());
        [(255.0 * (1.055 * light.powf(1.0 / 2.4) - 0.055)).round() as u8; 3]
    };
    (0..SIZE[0] * SIZE[1]).flat_map(code).collect()
}

#[test]
fn a_video_gives_what_its_pictures_give() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mut video =
        VideoWriter::create(&path("film.avi"), Codec::Ffv1, SIZE.map(|side| side as u32), (25, 1)).unwrap();
    for frame in 0..5i32 {
        let share = f64::from(frame) / 4.0;
        let rgb = skin(0.35 * share * share);
        video.write(&rgb).unwrap();
        let picture =
            artifact::picture::write_rgb8(&path(&format!("film{frame}.png")), SIZE[0], SIZE[1], &rgb);
        picture.unwrap().publish().unwrap();
        let mut marks = Landmarks { interocular_px: Some(250.0), ..Landmarks::default() };
        for i in 0..9 {
            let at = [
                10.0 + 50.0 * f64::from(i % 3),
                8.0 + 40.0 * f64::from(i / 3) + 4.0 * share * f64::from(i == 4),
            ];
            marks.points.insert(format!("p{i}"), Landmark { at, depth_px: None });
        }
        write_document(&path(&format!("film{frame}.json")), &marks).unwrap().publish().unwrap();
    }
    video.finish().unwrap();
    let frames = |neutral: &str, film: &str| {
        let run = Command::cargo_bin("normalmap-acquire")
            .unwrap()
            .current_dir(folder.path())
            .args(["fit-modulation", "--neutral", neutral, "--neutral-landmarks", "film0.json"])
            .args(["--frames", film, "--frame-landmarks", "film{frame}.json", "--out", "theta.json"])
            .output()
            .unwrap();
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        std::fs::read_to_string(path("theta.json")).unwrap()
    };
    let pictures = frames("film0.png", "film{frame}.png");
    assert_eq!(frames("film.avi", "film.avi"), pictures);
    assert_eq!(frames("film.avi#0", "film.avi"), pictures);
}
