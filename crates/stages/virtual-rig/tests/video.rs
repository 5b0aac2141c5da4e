//! Takes with one video per camera instead of PNG pictures.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

use assert_cmd::Command;
use std::path::Path;
use std::process::Output;

const TINY: &str = "make --scenario clean --length tiny --no-calibration --no-normals";

fn make(folder: &Path, arguments: &str) -> Output {
    let mut command = Command::cargo_bin("virtual-rig").unwrap();
    command.current_dir(folder).args(TINY.split(' ')).args(arguments.split_whitespace()).output().unwrap()
}

/// Expects exit code 1, a message with all `words`, and nothing made.
fn refuse(arguments: &str, words: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let output = make(folder.path(), arguments);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1), "{arguments}: {message}");
    for word in words.iter().chain(&["to do: "]) {
        assert!(message.contains(word), "{arguments}: '{word}' is not in: {message}");
    }
    assert!(!folder.path().join("out").exists(), "{arguments}: something was made");
}

#[cfg(not(feature = "video"))]
#[test]
fn a_build_without_video_says_how_to_get_one_with_it() {
    refuse("--video ffv1 --out out", &["cannot write video", "--features video", "OpenCV", "--video out"]);
}

#[cfg(feature = "video")]
mod with_opencv {
    use super::{make, refuse};
    use artifact::{Take, picture};
    use footage::VideoReader;
    use std::path::Path;

    fn made(folder: &Path, arguments: &str) -> Take {
        let output = make(folder, arguments);
        assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
        let (_, out) = arguments.rsplit_once(' ').unwrap();
        artifact::read_document(&folder.join(out).join("take/take.json")).unwrap()
    }

    #[test]
    fn a_lossless_video_holds_the_pictures_bit_by_bit() {
        let folder = tempfile::tempdir().unwrap();
        let pictures = made(folder.path(), "--image-scale 0.22 --fault doubled=0.5@m2 --out pictures");
        let video = made(folder.path(), "--image-scale 0.22 --fault doubled=0.5@m2 --video ffv1 --out video");
        assert_eq!(pictures.cameras.len(), video.cameras.len());
        let mut doubled = 0;
        for (pictured, filmed) in pictures.cameras.iter().zip(&video.cameras) {
            let (pictured_as, filmed_as) =
                (pictured.footage.as_ref().unwrap(), filmed.footage.as_ref().unwrap());
            assert_eq!(filmed_as.file, Some(format!("footage/{}.avi", filmed.id)));
            assert_eq!((&filmed_as.images, &pictured_as.file), (&None, &None));
            assert_eq!((filmed_as.first, &filmed_as.timestamps), (0, &pictured_as.timestamps));
            let file = folder.path().join("video/take").join(filmed_as.file.as_ref().unwrap());
            let reader = VideoReader::open(&file).unwrap();
            assert_eq!(reader.image_size(), pictured.image_size);
            let (frames, seconds) = reader.rate();
            assert_eq!(frames * pictured.rate.seconds, pictured.rate.frames * seconds, "{}", filmed.id);
            let mut count = 0;
            for frame in reader {
                let image = pictured_as.image(count).unwrap();
                let picture = picture::read_rgb(&folder.path().join("pictures/take").join(image)).unwrap();
                assert_eq!(frame.unwrap().rgb, picture.to_8_bits(), "{}, image {count}", filmed.id);
                count += 1;
            }
            let folder_of = |take: &str| folder.path().join(take).join("take/footage").join(&filmed.id);
            assert_eq!(std::fs::read_dir(folder_of("pictures")).unwrap().count() as i64, count);
            doubled += i64::from(filmed.id == "m2") * (count - 3);
            assert!(!folder_of("video").exists());
            assert!(!folder.path().join("pictures/take").join(filmed_as.file.as_ref().unwrap()).exists());
        }
        assert!(doubled > 0, "the test wants images that stand twice in the footage");
    }

    #[test]
    fn lossy_videos_hold_as_many_frames() {
        for (codec, ending) in [("h264", "mp4"), ("mjpg", "avi")] {
            let folder = tempfile::tempdir().unwrap();
            made(folder.path(), &format!("--image-scale 0.22 --video {codec} --out out"));
            let file = folder.path().join(format!("out/take/footage/m1.{ending}"));
            assert_eq!(VideoReader::open(&file).unwrap().count(), 3, "{codec}");
        }
    }

    #[test]
    fn what_no_video_can_hold_is_refused_before_anything_is_made() {
        refuse(
            "--image-scale 0.22 --frames 1002- --video ffv1 --out out",
            &["--frames 1002-", "leaves out the first image of"],
        );
        refuse(
            "--image-scale 0.5 --video mjpg --out out",
            &["out/take/footage/m1.avi", "328×245", "--image-scale"],
        );
    }
}
