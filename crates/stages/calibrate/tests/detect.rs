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

/// White paper with black squares before a dark room, 16 samples a pixel.
fn shot(image_from_board: &Matrix3<f64>) -> Vec<u8> {
    let board_from_image = image_from_board.try_inverse().unwrap();
    let light = |x: f64, y: f64| {
        let at = board_from_image * Vector3::new(x, y, 1.0);
        let [x, y] = [at.x / at.z / 16.0, at.y / at.z / 16.0];
        match (-1.6..8.6).contains(&x) && (-1.6..6.6).contains(&y) {
            false => 25.0,
            true if !(-1.0..8.0).contains(&x) || !(-1.0..6.0).contains(&y) => 225.0,
            true => [40.0, 225.0][(x.floor() + y.floor()).rem_euclid(2.0) as usize],
        }
    };
    let [width, height] = SIZE;
    let pixel = |i: u32| {
        let samples = (0..16).map(|s| {
            let [dx, dy] = [s % 4, s / 4].map(|s| 0.25 * (f64::from(s) + 0.5) - 0.5);
            light(f64::from(i % width) + dx, f64::from(i / width) + dy)
        });
        (samples.sum::<f64>() / 16.0).round() as u8
    };
    (0..width * height).map(pixel).collect()
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
