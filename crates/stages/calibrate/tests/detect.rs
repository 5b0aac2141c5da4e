//! Laws of finding boards.
#![cfg(feature = "detect")]
#![allow(clippy::unwrap_used, reason = "a scene that cannot be made is a broken test")]

use calibrate::{Board, Picture, find_corners};
use nalgebra::{Matrix3, Point2, Vector3};

const BOARD: Board = Board::Chessboard { columns: 8, rows: 6, square_mm: 16.0 };
const SIZE: [u32; 2] = [656, 490];

/// The way from a board to the image: turned about the upright axis by `lean`, in the board's plane by `turn`, rad.
fn image_from_board(lean: f64, turn: f64, middle: [f64; 2]) -> Matrix3<f64> {
    let rotation = nalgebra::Rotation3::from_euler_angles(0.0, lean, turn);
    let [x, y, _] = [0, 1, 2].map(|axis| rotation.matrix().column(axis).into_owned());
    let center = Vector3::new(0.0, 0.0, 850.0);
    let lens = Matrix3::new(1450.0, 0.0, middle[0], 0.0, 1450.0, middle[1], 0.0, 0.0, 1.0);
    lens * Matrix3::from_columns(&[x, y, center - 56.0 * x - 40.0 * y])
}

/// The grey codes of a scene, 16 samples a pixel and a lens that blurs as lenses do.
fn filmed(light: impl Fn(f64, f64) -> f64) -> Vec<u8> {
    let [width, height] = SIZE.map(|side| side as usize);
    let pixel = |i: usize| {
        let samples = (0..16).map(|s| {
            let [dx, dy] = [s % 4, s / 4].map(|s| 0.25 * (f64::from(s) + 0.5) - 0.5);
            light((i % width) as f64 + dx, (i / width) as f64 + dy)
        });
        samples.sum::<f64>() / 16.0
    };
    let sharp: Vec<f64> = (0..width * height).map(pixel).collect();
    let blurred = |i: usize| {
        let (x, y) = (i % width, i / width);
        let tap = |k: usize| {
            let (dx, dy) = (k % 5, k / 5);
            let (column, row) = ((x + dx).clamp(2, width + 1) - 2, (y + dy).clamp(2, height + 1) - 2);
            let [a, b] = [dx, dy].map(|d| d as f64 - 2.0);
            ((-(a * a + b * b) / (2.0 * 0.7 * 0.7)).exp(), sharp[row * width + column])
        };
        let (weights, values): (Vec<f64>, Vec<f64>) = (0..25).map(tap).map(|(w, v)| (w, w * v)).unzip();
        (values.iter().sum::<f64>() / weights.iter().sum::<f64>()).round() as u8
    };
    (0..width * height).map(blurred).collect()
}

/// White paper with black squares before a dark room.
fn shot(image_from_board: &Matrix3<f64>) -> Vec<u8> {
    let board_from_image = image_from_board.try_inverse().unwrap();
    filmed(|x, y| {
        let at = board_from_image * Vector3::new(x, y, 1.0);
        let [x, y] = [at.x / at.z / 16.0, at.y / at.z / 16.0];
        match (-1.6..8.6).contains(&x) && (-1.6..6.6).contains(&y) {
            false => 25.0,
            true if !(-1.0..8.0).contains(&x) || !(-1.0..6.0).contains(&y) => 225.0,
            true => [40.0, 225.0][(x.floor() + y.floor()).rem_euclid(2.0) as usize],
        }
    })
}

/// RMS distance of the found corners from the true ones, px, whichever end they are counted from; none if they are not found.
fn error(image_from_board: &Matrix3<f64>) -> Option<f64> {
    let found = find_corners(Picture { size: SIZE, gray: &shot(image_from_board) }, &BOARD).unwrap();
    let truth: Vec<Point2<f64>> = BOARD
        .corners()
        .iter()
        .map(|corner| Point2::from_homogeneous(image_from_board * corner.xy().to_homogeneous()).unwrap())
        .collect();
    let squares = |way: &Vec<u32>| -> f64 {
        found.iter().map(|(id, at)| (at - truth[way[*id as usize] as usize]).norm_squared()).sum()
    };
    let least = BOARD.numberings().iter().map(squares).fold(f64::INFINITY, f64::min);
    (found.len() == truth.len()).then(|| (least / truth.len() as f64).sqrt())
}

#[test]
fn boards_are_found_however_they_lean() {
    for degrees in [0.0, 30.0, 50.0, 60.0, 66.0, 70.0_f64] {
        for turn in [0.1, 0.5] {
            let error = error(&image_from_board(degrees.to_radians(), turn, [328.0, 245.0]));
            assert!(error.is_some_and(|error| error < 0.15), "{degrees} {turn} {error:?}");
        }
    }
}

#[test]
fn a_board_whose_outer_squares_are_cut_is_found() {
    let error = error(&image_from_board(0.2, 0.05, [105.0, 245.0]));
    assert!(error.is_some_and(|error| error < 0.08), "{error:?}");
}

#[test]
fn a_board_that_is_cut_is_not_invented() {
    assert_eq!(error(&image_from_board(0.2, 0.05, [70.0, 245.0])), None);
    let dark = vec![20; (SIZE[0] * SIZE[1]) as usize];
    assert!(find_corners(Picture { size: SIZE, gray: &dark }, &BOARD).unwrap().is_empty());
}

/// A ChArUco board as OpenCV prints it, so many pixels to a square, before a grey wall.
fn charuco_shot(board: &Board, image_from_board: &Matrix3<f64>) -> Vec<u8> {
    use opencv::core::Mat;
    use opencv::prelude::*;
    let &Board::Charuco { columns, rows, square_mm, marker_mm, .. } = board else { unreachable!() };
    let dictionary = opencv::aruco::get_predefined_dictionary_i32(opencv::aruco::DICT_4X4_50).unwrap();
    let [square, marker] = [square_mm, marker_mm].map(|side| side as f32);
    let (columns, rows) = (columns as i32, rows as i32);
    let mut pattern =
        opencv::aruco::CharucoBoard::create(columns, rows, square, marker, &dictionary).unwrap();
    let (mut print, px) = (Mat::default(), 96);
    pattern.draw(opencv::core::Size::new(columns * px, rows * px), &mut print, 0, 1).unwrap();
    let codes = print.data_typed::<u8>().unwrap();
    let board_from_image = image_from_board.try_inverse().unwrap();
    let [width, height] = [columns, rows].map(|count| i64::from(count * px));
    filmed(|x, y| {
        let at = board_from_image * Vector3::new(x, y, 1.0);
        let [x, y] = [at.x / at.z, at.y / at.z].map(|mm| (mm / square_mm * f64::from(px)).floor() as i64);
        let is_board = (0..width).contains(&x) && (0..height).contains(&y);
        if is_board { 40.0 + 0.7 * f64::from(codes[(y * width + x) as usize]) } else { 120.0 }
    })
}

/// RMS error of the corners found, px, and how many there are.
fn charuco_error(lean: f64, turn: f64) -> (f64, usize) {
    let dictionary = calibrate::Dictionary::FourByFour50;
    let board = Board::Charuco {
        columns: 8,
        rows: 6,
        square_mm: 16.0,
        marker_mm: 12.0,
        dictionary,
        see_through: false,
    };
    let map = image_from_board(lean, turn, [328.0, 245.0]);
    let found = find_corners(Picture { size: SIZE, gray: &charuco_shot(&board, &map) }, &board).unwrap();
    let places = board.corners();
    let square = |(id, at): (&u32, &Point2<f64>)| {
        let truth = map * places[*id as usize].xy().to_homogeneous();
        (at - Point2::from_homogeneous(truth).unwrap()).norm_squared()
    };
    ((found.iter().map(square).sum::<f64>() / found.len() as f64).sqrt(), found.len())
}

#[test]
fn markers_do_not_draw_away_the_corners_between_them() {
    for (lean, turn) in [(0.0, 0.1), (0.4, 0.3), (0.8, 0.2)] {
        let (rms_px, count) = charuco_error(lean, turn);
        assert!(rms_px < 0.02 && count >= 33, "{lean} {turn}: {rms_px} px, {count} corners");
    }
}

#[test]
fn corners_of_chessboards_are_placed_to_a_hundredth_of_a_pixel() {
    let rms_px = error(&image_from_board(0.3, 0.2, [328.0, 245.0])).unwrap();
    assert!(rms_px < 0.01, "{rms_px}");
}
