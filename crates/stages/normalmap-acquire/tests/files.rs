//! Photographs and landmarks as other programs write them.
#![allow(clippy::unwrap_used, clippy::disallowed_methods, reason = "tests may")]

use artifact::picture::read_rgb;
use assert_cmd::Command;
use image::codecs::jpeg::JpegEncoder;
use image::{ExtendedColorType, ImageBuffer, ImageEncoder, Rgb, Rgba};
use std::path::Path;
use tempfile::TempDir;

const SIZE: [u32; 2] = [120, 96];

/// Stored light of skin whose row 48 is darker by a share, 0 to 1.
fn stored(depth: f64, x: u32, y: u32) -> f64 {
    let (x, y) = (f64::from(x), f64::from(y));
    let grain = 0.4 + 0.03 * (0.9 * x).sin() * (0.7 * y).cos();
    let light: f64 = grain * (1.0 - depth * (-((y - 48.0) / 4.0).powi(2)).exp());
    1.055 * light.powf(1.0 / 2.4) - 0.055
}

fn code(depth: f64, x: u32, y: u32) -> u8 {
    (255.0 * stored(depth, x, y)).round() as u8
}

fn photograph(depth: f64) -> ImageBuffer<Rgb<u8>, Vec<u8>> {
    ImageBuffer::from_fn(SIZE[0], SIZE[1], |x, y| Rgb([code(depth, x, y); 3]))
}

/// Where the landmarks are in both pictures.
fn places() -> impl Iterator<Item = [u32; 2]> {
    (0..9).map(|i| [10 + 50 * (i % 3), 8 + 40 * (i / 3)])
}

fn scene() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    photograph(0.0).save(path("rest.png")).unwrap();
    photograph(0.35).save(path("smile.png")).unwrap();
    let rows: String = places().enumerate().map(|(i, [x, y])| format!("{i},{x},{y}\n")).collect();
    std::fs::write(path("marks.csv"), format!("id,x,y\n{rows}")).unwrap();
    let rows: String = places().map(|[x, y]| format!("{x}\t{y}\n")).collect();
    std::fs::write(path("marks.tem"), format!("9\n{rows}0\n")).unwrap();
    // ibug counts pixels from 1.
    let rows: String = places().map(|[x, y]| format!("{} {}\n", x + 1, y + 1)).collect();
    std::fs::write(path("marks.pts"), format!("version: 1\nn_points: 9\n{{\n{rows}}}\n")).unwrap();
    folder
}

fn run(folder: &Path, [rest, smile]: [&str; 2], marks: &str, more: &[&str]) -> (Option<i32>, String) {
    let output = Command::cargo_bin("normalmap-acquire")
        .unwrap()
        .current_dir(folder)
        .args(["acquire", "--neutral", rest, "--neutral-landmarks", marks])
        .args(["--expression", smile, "--expression-landmarks", marks])
        .args(["--interocular-px", "250", "--out", "out.png", "--bits", "16"])
        .args(more)
        .output()
        .unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

/// Green over the map, which must have come out.
fn greens(folder: &Path, pictures: [&str; 2], marks: &str, more: &[&str]) -> Vec<f64> {
    let (code, said) = run(folder, pictures, marks, more);
    assert_eq!(code, Some(0), "{said}");
    let map = read_rgb(&folder.join("out.png")).unwrap();
    assert_eq!([map.width, map.height], SIZE.map(|side| side as usize));
    std::fs::remove_file(folder.join("out.png")).unwrap();
    (0..map.width * map.height).map(|i| map.at(i % map.width, i / map.width)[1]).collect()
}

fn refused(folder: &Path, pictures: [&str; 2], marks: &str) -> String {
    let (code, said) = run(folder, pictures, marks, &[]);
    assert_eq!(code, Some(1), "{said}");
    assert!(said.contains("to do:") && !folder.join("out.png").exists(), "{said}");
    said
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

const PLAIN: [&str; 2] = ["rest.png", "smile.png"];

#[test]
fn landmarks_of_any_form_give_the_same_map() {
    let folder = scene();
    let by = |marks: &str| greens(folder.path(), PLAIN, marks, &[]);
    let csv = by("marks.csv");
    assert!(csv[44 * 120 + 60] < 0.45 && csv[52 * 120 + 60] > 0.55);
    assert_eq!(by("marks.tem"), csv);
    assert_eq!(by("marks.pts"), csv);
}

#[test]
fn broken_landmark_files_are_named_with_their_line() {
    let folder = scene();
    std::fs::write(folder.path().join("short.tem"), "9\n10 20\n30 40\n").unwrap();
    let said = refused(folder.path(), PLAIN, "short.tem");
    assert!(said.contains("short.tem") && said.contains("2 points, not 9"), "{said}");
    std::fs::write(folder.path().join("odd.csv"), "id,x,y\n0,10,20\n1,left,30\n").unwrap();
    let said = refused(folder.path(), PLAIN, "odd.csv");
    assert!(said.contains("odd.csv") && said.contains("line 3") && said.contains("left"), "{said}");
    std::fs::write(folder.path().join("open.pts"), "version: 1\n10 20\n").unwrap();
    assert!(refused(folder.path(), PLAIN, "open.pts").contains("between { and }"));
    std::fs::write(folder.path().join("marks.xml"), "<a/>").unwrap();
    assert!(refused(folder.path(), PLAIN, "marks.xml").contains(".pts (ibug)"));
}

#[test]
fn deep_photographs_give_the_map_of_shallow_ones_and_do_not_mix_with_them() {
    let folder = scene();
    for (name, depth) in [("rest16.png", 0.0), ("smile16.png", 0.35)] {
        let picture: ImageBuffer<Rgb<u16>, Vec<u16>> = ImageBuffer::from_fn(SIZE[0], SIZE[1], |x, y| {
            Rgb([(65535.0 * stored(depth, x, y)).round() as u16; 3])
        });
        picture.save(folder.path().join(name)).unwrap();
    }
    let shallow = greens(folder.path(), PLAIN, "marks.csv", &[]);
    let deep = greens(folder.path(), ["rest16.png", "smile16.png"], "marks.csv", &[]);
    assert!(apart(&shallow, &deep) < 0.03, "{}", apart(&shallow, &deep));
    let said = refused(folder.path(), ["rest.png", "smile16.png"], "marks.csv");
    assert!(said.contains("16 bits") && said.contains("8 bits") && said.contains("--unlike"), "{said}");
    let mixed = greens(folder.path(), ["rest.png", "smile16.png"], "marks.csv", &["--unlike"]);
    assert!(apart(&shallow, &mixed) < 0.03);
}

#[test]
fn alpha_is_taken_where_it_hides_nothing_and_refused_where_it_does() {
    let folder = scene();
    let save = |name: &str, hole: bool| {
        let picture: ImageBuffer<Rgba<u8>, Vec<u8>> = ImageBuffer::from_fn(SIZE[0], SIZE[1], |x, y| {
            let code = code(0.35, x, y);
            Rgba([code, code, code, if hole && (x, y) == (7, 5) { 200 } else { 255 }])
        });
        picture.save(folder.path().join(name)).unwrap();
    };
    save("whole.png", false);
    save("hole.png", true);
    let plain = greens(folder.path(), PLAIN, "marks.csv", &[]);
    assert_eq!(greens(folder.path(), ["rest.png", "whole.png"], "marks.csv", &["--unlike"]), plain);
    let said = refused(folder.path(), ["rest.png", "hole.png"], "marks.csv");
    assert!(
        said.contains("hole.png") && said.contains("column 7, row 5") && said.contains("transparent"),
        "{said}"
    );
}

#[test]
fn pictures_for_print_are_refused() {
    let folder = scene();
    // The head of a JPEG with four channels, 120 × 96.
    let mut bytes = vec![0xff, 0xd8, 0xff, 0xc0, 0, 20, 8, 0, 96, 0, 120, 4];
    bytes.extend((1..=4u8).flat_map(|channel| [channel, 0x11, 0]));
    std::fs::write(folder.path().join("print.jpg"), bytes).unwrap();
    let said = refused(folder.path(), ["rest.png", "print.jpg"], "marks.csv");
    assert!(said.contains("print.jpg") && said.contains("CMYK") && said.contains("sRGB"), "{said}");
}

/// A JPEG that was taken with the camera held so that its top is at the right: EXIF orientation 6 turns it upright.
fn sideways(path: &Path, upright: &ImageBuffer<Rgb<u8>, Vec<u8>>) {
    let [width, height] = SIZE;
    let turned = ImageBuffer::from_fn(height, width, |x, y| *upright.get_pixel(y, height - 1 - x));
    // Little-endian TIFF with one entry: tag 0x0112, a short, the value 6.
    let exif = [&b"II*\0\x08\0\0\0\x01\0"[..], &[0x12, 0x01, 3, 0, 1, 0, 0, 0, 6, 0, 0, 0], &[0; 4]].concat();
    let mut bytes = Vec::new();
    let mut encoder = JpegEncoder::new_with_quality(&mut bytes, 100);
    encoder.set_exif_metadata(exif).unwrap();
    encoder.write_image(turned.as_raw(), height, width, ExtendedColorType::Rgb8).unwrap();
    std::fs::write(path, bytes).unwrap();
}

#[test]
fn photographs_are_turned_as_they_say_and_landmarks_count_upright() {
    let folder = scene();
    sideways(&folder.path().join("rest.jpg"), &photograph(0.0));
    sideways(&folder.path().join("smile.jpg"), &photograph(0.35));
    let plain = greens(folder.path(), PLAIN, "marks.csv", &[]);
    let turned = greens(folder.path(), ["rest.jpg", "smile.jpg"], "marks.csv", &[]);
    assert!(apart(&plain, &turned) < 0.1, "{}", apart(&plain, &turned));
    let (_, said) = run(folder.path(), ["rest.jpg", "smile.jpg"], "marks.csv", &["-v"]);
    assert!(said.contains("turned as its EXIF data says"), "{said}");
}
