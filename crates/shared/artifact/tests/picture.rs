//! Pictures: what is written comes back, what others wrote is read, what is none is refused.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]
#![allow(clippy::disallowed_methods, reason = "tests look at what is on the disk")]

mod support;

use artifact::Staged;
use artifact::picture::{self, Codes, Rgb};
use image::{ImageFormat, RgbImage};
use proptest::prelude::*;
use support::{Place, bytes, refusal, says};

/// What another program writes.
fn encoded(picture: &image::DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

#[test]
fn a_grey_picture_is_read_as_shares_of_white() {
    let place = Place::new();
    let picture = image::GrayImage::from_raw(2, 1, vec![0, 51]).unwrap().into();
    let whole = encoded(&picture, ImageFormat::Png);
    let gray = picture::read_gray(&place.file("mask.png", &whole)).unwrap();
    assert_eq!((gray.width, gray.height), (2, 1));
    assert!(gray.pixels[0] == 0.0 && (gray.pixels[1] - 0.2).abs() < 1e-4);
    let message = refusal(picture::read_gray(&place.file("mask.png", &whole[..40])));
    says(&message, &["mask.png: is not a PNG picture", "save it as PNG again"]);
}

#[test]
fn what_is_transparent_or_black_is_not_marked() {
    let place = Place::new();
    let codes = vec![9, 0, 0, 255, 255, 0, 0, 127, 0, 0, 0, 255, 0, 255, 0, 128];
    let picture = image::RgbaImage::from_raw(4, 1, codes).unwrap().into();
    let marked = picture::read_marked(&place.file("w1.png", encoded(&picture, ImageFormat::Png))).unwrap();
    assert_eq!((marked.width, marked.height), (4, 1));
    assert_eq!(marked.marks, [Some([9, 0, 0]), None, None, Some([0, 255, 0])]);
    says(&refusal(picture::read_marked(&place.file("w1.png", "v 0 0 0"))), &["w1.png: is not a PNG picture"]);
}

#[test]
fn codes_of_8_and_16_bits_come_as_they_stand() {
    let place = Place::new();
    let eight = [255, 0, 51, 1, 2, 3];
    let path = place
        .file("8.png", encoded(&RgbImage::from_raw(1, 2, eight.to_vec()).unwrap().into(), ImageFormat::Png));
    let read = picture::read_rgb(&path).unwrap();
    assert_eq!(read, Rgb { width: 1, height: 2, codes: Codes::Bits8(eight.to_vec()) });
    assert_eq!(read.at(0, 0), [1.0, 0.0, 0.2]);

    let path = place.path("16.png");
    let sixteen = [65535, 0, 258, 1, 256, 7];
    picture::write_rgb16(&path, 2, 1, &sixteen).and_then(Staged::publish).unwrap();
    let read = picture::read_rgb(&path).unwrap();
    assert_eq!(read, Rgb { width: 2, height: 1, codes: Codes::Bits16(sixteen.to_vec()) });
    assert_eq!(read.at(1, 0)[1], 256.0 / 65535.0);
    // Independently of our reader: the encoder was given the right byte order.
    assert_eq!(image::load_from_memory(&bytes(&path)).unwrap().into_rgb16().into_raw(), sixteen);
}

#[test]
fn grey_and_transparent_pictures_become_colours() {
    let place = Place::new();
    let gray = image::GrayImage::from_raw(1, 1, vec![7]).unwrap().into();
    let read = picture::read_rgb(&place.file("a.png", encoded(&gray, ImageFormat::Png))).unwrap();
    assert_eq!(read.codes, Codes::Bits8(vec![7, 7, 7]));
    let clear = image::RgbaImage::from_raw(1, 1, vec![9, 8, 7, 0]).unwrap().into();
    let read = picture::read_rgb(&place.file("a.png", encoded(&clear, ImageFormat::Png))).unwrap();
    assert_eq!(read.codes, Codes::Bits8(vec![9, 8, 7]), "what is transparent keeps its colour");
}

#[test]
fn a_jpeg_is_read_whatever_its_name() {
    let place = Place::new();
    let even = RgbImage::from_pixel(16, 8, image::Rgb([200, 100, 50])).into();
    let whole = encoded(&even, ImageFormat::Jpeg);
    let read = picture::read_rgb(&place.file("albedo.png", &whole)).unwrap();
    assert_eq!((read.width, read.height), (16, 8));
    let Codes::Bits8(codes) = &read.codes else { panic!("a JPEG has 8 bits") };
    for (code, wanted) in codes.iter().zip([200_u8, 100, 50].into_iter().cycle()) {
        assert!(code.abs_diff(wanted) <= 2, "{code} is not {wanted}");
    }
    says(&refusal(picture::read_rgb(&place.file("a.jpg", &whole[..60]))), &["a.jpg: is not a JPEG picture"]);
    says(&refusal(picture::read_rgb(&place.file("a.txt", "v 0 0 0"))), &["a.txt: is not a PNG picture"]);
}

#[test]
fn values_that_make_no_picture_are_refused() {
    let place = Place::new();
    let path = place.path("a.png");
    for (width, height, values) in [(0, 3, 0), (2, 0, 0), (2, 2, 11), (2, 2, 4), (usize::MAX, 3, 9)] {
        let message = refusal(picture::write_rgb8(&path, width, height, &vec![0; values]));
        let wanted = format!("a.png: {values} values make no picture of {width} × {height} pixels");
        assert_eq!(message, wanted);
        says(&refusal(picture::write_rgb16(&path, width, height, &vec![0; values])), &["make no picture"]);
    }
    drop(picture::write_rgb8(&path, 1, 1, &[1, 2, 3]).unwrap());
    assert!(place.names().is_empty(), "unpublished, it does not show");
}

fn any_picture() -> impl Strategy<Value = (usize, usize, Vec<u16>)> {
    (1..9usize, 1..9usize).prop_flat_map(|(width, height)| {
        (Just(width), Just(height), proptest::collection::vec(any::<u16>(), 3 * width * height))
    })
}

proptest! {
    #[test]
    fn what_is_written_is_read((width, height, codes) in any_picture()) {
        let place = Place::new();
        let path = place.path("a.png");
        picture::write_rgb16(&path, width, height, &codes).and_then(Staged::publish).unwrap();
        let wanted = Rgb { width, height, codes: Codes::Bits16(codes.clone()) };
        prop_assert_eq!(picture::read_rgb(&path).unwrap(), wanted);
        let codes: Vec<u8> = codes.iter().map(|&code| code as u8).collect();
        picture::write_rgb8(&path, width, height, &codes).and_then(Staged::publish).unwrap();
        prop_assert_eq!(picture::read_rgb(&path).unwrap(), Rgb { width, height, codes: Codes::Bits8(codes) });
    }

    #[test]
    fn a_changed_byte_never_panics(at in 0..1000usize, byte in any::<u8>()) {
        let place = Place::new();
        let path = place.path("a.png");
        picture::write_rgb8(&path, 4, 2, &[90; 24]).and_then(Staged::publish).unwrap();
        let mut file = bytes(&path);
        let at = at % file.len();
        file[at] = byte;
        let _ = picture::read_rgb(&place.file("b.png", &file));
    }
}

#[test]
fn a_head_says_size_and_depth_and_whether_the_end_is_there() {
    let place = Place::new();
    let picture = image::RgbImage::from_pixel(70, 30, image::Rgb([9, 90, 200])).into();
    let deep =
        image::DynamicImage::ImageRgb16(image::ImageBuffer::from_pixel(70, 30, image::Rgb([9, 90, 200])));
    for (name, picture, format, bits) in [
        ("a.png", &picture, ImageFormat::Png, 8),
        ("a.jpg", &picture, ImageFormat::Jpeg, 8),
        ("b.png", &deep, ImageFormat::Png, 16),
    ] {
        let bytes = encoded(picture, format);
        let head = picture::read_head(&place.file(name, &bytes)).unwrap();
        assert_eq!(head, picture::Head { size: [70, 30], bits }, "{name}");
        for length in [0, 30, bytes.len() / 2, bytes.len() - 6] {
            assert!(
                picture::read_head(&place.file(name, &bytes[..length])).is_err(),
                "{length} bytes of {name}"
            );
        }
    }
}
