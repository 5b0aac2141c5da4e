//! Boards: where their corners are, and what they look like.

use super::dictionary::{MARKER_CELLS, MARKER_COUNT, is_white};
use crate::Error;
use nalgebra::{Point2, Point3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A flat pattern with corners of known places.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Board {
    /// Black and white squares; the top-left one is black.
    Chessboard {
        /// *Inner* corners in a row, as OpenCV counts.
        columns: u32,
        /// Rows of inner corners.
        rows: u32,
        /// Side of a square, mm.
        square_mm: f64,
    },
    /// A chessboard with ArUco markers in its white squares, numbered row after row. OpenCV before 4.6 coloured boards of
    /// an even number of rows the other way round; an odd number is the same for all.
    Charuco {
        /// *Squares* in a row, as OpenCV counts.
        columns: u32,
        /// Rows of squares.
        rows: u32,
        /// Side of a square, mm.
        square_mm: f64,
        /// Side of a marker, mm.
        marker_mm: f64,
        /// Which markers.
        dictionary: Dictionary,
    },
}

/// Sets of markers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum Dictionary {
    /// OpenCV's `DICT_4X4_50`.
    #[default]
    #[serde(rename = "4x4_50")]
    FourByFour50,
}

impl Default for Board {
    fn default() -> Self {
        Self::Chessboard { columns: 8, rows: 6, square_mm: 16.0 }
    }
}

/// A corner of a board.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Its number: row after row from the top left, as OpenCV counts.
    pub id: u32,
    /// Its place, mm.
    pub point_in_board: Point3<f64>,
}

/// A piece of one colour of a board's picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quad {
    /// Its corners, clockwise seen from before the board, from the top left, mm.
    pub corners_in_board: [Point3<f64>; 4],
    /// Linear reflectance.
    pub reflectance: [f32; 3],
}

/// White paper around the pattern, in squares.
const MARGIN_SQUARES: f64 = 0.6;
/// Pieces along a square of a chessboard, so that a lens can bend its edges.
const PIECES: usize = 4;
/// Reflectance of printing paper and of toner on it.
const WHITE: [f32; 3] = [0.78, 0.78, 0.76];
const BLACK: [f32; 3] = [0.035, 0.035, 0.037];

impl Board {
    /// Squares along x and y.
    #[must_use]
    pub fn squares(&self) -> [u32; 2] {
        match *self {
            Self::Chessboard { columns, rows, .. } => [columns + 1, rows + 1],
            Self::Charuco { columns, rows, .. } => [columns, rows],
        }
    }

    /// Side of a square, mm.
    #[must_use]
    pub fn square_mm(&self) -> f64 {
        match *self {
            Self::Chessboard { square_mm, .. } | Self::Charuco { square_mm, .. } => square_mm,
        }
    }

    /// The inner corners, row after row.
    #[must_use]
    pub fn corners(&self) -> Vec<Corner> {
        let [columns, rows] = self.squares().map(|count| count - 1);
        let side = self.square_mm();
        let corner = |id: u32| {
            let [x, y] = [id % columns + 1, id / columns + 1].map(|step| f64::from(step) * side);
            Corner { id, point_in_board: Point3::new(x, y, 0.0) }
        };
        (0..columns * rows).map(corner).collect()
    }

    /// The four corners of the paper, clockwise from the top left, mm.
    #[must_use]
    pub fn outline(&self) -> [Point3<f64>; 4] {
        let margin = MARGIN_SQUARES * self.square_mm();
        let [right, bottom] = self.squares().map(|count| f64::from(count) * self.square_mm() + margin);
        [[-margin, -margin], [right, -margin], [right, bottom], [-margin, bottom]]
            .map(|[x, y]| Point3::new(x, y, 0.0))
    }

    /// The middle of the pattern, mm.
    #[must_use]
    pub fn middle(&self) -> Point3<f64> {
        let [x, y] = self.squares().map(|count| 0.5 * f64::from(count) * self.square_mm());
        Point3::new(x, y, 0.0)
    }

    /// The board's picture in pieces of one colour, none overlapping: margin and squares, each of these in at least 4×4
    /// pieces.
    #[must_use]
    pub fn quads(&self) -> Vec<Quad> {
        let pattern = Pattern::new(self);
        let [columns, rows] = pattern.breaks.each_ref().map(|breaks| breaks.len() - 1);
        let quad = |column: usize, row: usize| {
            let at = |i: usize, j: usize| Point3::new(pattern.breaks[0][i], pattern.breaks[1][j], 0.0);
            let (i, j) = (column, row);
            let corners_in_board = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let reflectance = pattern.reflectance([column + 1, row + 1]).unwrap_or(WHITE);
            Quad { corners_in_board, reflectance }
        };
        (0..rows)
            .flat_map(|row| (0..columns).map(move |column| [column, row]))
            .map(|[i, j]| quad(i, j))
            .collect()
    }

    /// Refuses boards that cannot be printed.
    ///
    /// # Errors
    /// Names the parameter.
    pub fn check(&self, place: &str) -> Result<(), Error> {
        let refuse =
            |key: &str, what: String| Err(Error::Parameter { place: format!("{place}.{key}"), what });
        let [columns, rows] = self.squares();
        if columns < 3 || rows < 3 || columns > 100 || rows > 100 {
            let what = format!("a board of {columns}×{rows} squares; 3 to 100 along each side will do");
            return refuse("columns, rows", what);
        }
        let side = self.square_mm();
        if !(side.is_finite() && side > 0.0) {
            return refuse("square_mm", format!("{side} mm is no side of a square"));
        }
        let Self::Charuco { marker_mm, .. } = *self else { return Ok(()) };
        if !(marker_mm > 0.0 && marker_mm < side) {
            return refuse("marker_mm", format!("a marker of {marker_mm} mm in a square of {side} mm"));
        }
        match (columns * rows / 2) as usize > MARKER_COUNT {
            true => {
                let needed = columns * rows / 2;
                refuse("columns, rows", format!("needs {needed} markers, the dictionary has {MARKER_COUNT}"))
            }
            false => Ok(()),
        }
    }
}

/// A board's picture as a grid of uneven lines with one colour per cell.
pub(super) struct Pattern {
    /// Where the lines are along x and y, mm, rising; the first and last are the paper's edges.
    breaks: [Vec<f64>; 2],
    /// Colour per cell, row after row.
    white: Vec<bool>,
}

impl Pattern {
    pub(super) fn new(board: &Board) -> Self {
        let squares = board.squares().map(|count| count as usize);
        let inner = board.lines_in_square();
        let breaks = squares.map(|count| breaks(count, board.square_mm(), &inner));
        let pieces = inner.len();
        let [columns, rows] = breaks.each_ref().map(|breaks| breaks.len() - 1);
        let mut white = Vec::with_capacity(columns * rows);
        for row in 0..rows {
            for column in 0..columns {
                let in_margin = column == 0 || row == 0 || column == columns - 1 || row == rows - 1;
                white.push(in_margin || board.is_white([column - 1, row - 1], pieces));
            }
        }
        Self { breaks, white }
    }

    /// The cell of a point: column and row, 0 and the last ones being outside the paper.
    pub(super) fn cell(&self, point: Point2<f64>) -> [usize; 2] {
        [0, 1].map(|axis| self.breaks[axis].partition_point(|&line| line <= point[axis]))
    }

    /// The colour of a cell; none outside the paper.
    pub(super) fn reflectance(&self, [column, row]: [usize; 2]) -> Option<[f32; 3]> {
        let [columns, rows] = self.breaks.each_ref().map(|breaks| breaks.len() - 1);
        let on_paper = (1..=columns).contains(&column) && (1..=rows).contains(&row);
        on_paper.then(|| if self.white[(row - 1) * columns + column - 1] { WHITE } else { BLACK })
    }
}

impl Board {
    /// Where lines run in a square, mm from its start, the start included.
    fn lines_in_square(&self) -> Vec<f64> {
        match *self {
            Self::Chessboard { square_mm, .. } => {
                (0..PIECES).map(|i| square_mm * i as f64 / PIECES as f64).collect()
            }
            Self::Charuco { square_mm, marker_mm, .. } => {
                let start = 0.5 * (square_mm - marker_mm);
                let in_marker = |i: usize| start + marker_mm * i as f64 / MARKER_CELLS as f64;
                std::iter::once(0.0).chain((0..=MARKER_CELLS).map(in_marker)).collect()
            }
        }
    }

    /// Whether a piece of the pattern (without the margin) is white; `pieces` along a square.
    fn is_white(&self, piece: [usize; 2], pieces: usize) -> bool {
        let [column, row] = piece.map(|index| index / pieces);
        let [i, j] = piece.map(|index| index % pieces);
        let square_is_white = (column + row) % 2 == 1;
        let Self::Charuco { columns, .. } = self else { return square_is_white };
        let marker = (row * *columns as usize + column) / 2;
        let in_marker = 1..=MARKER_CELLS;
        match square_is_white && in_marker.contains(&i) && in_marker.contains(&j) {
            true => is_white(marker, i - 1, j - 1),
            false => square_is_white,
        }
    }
}

/// Lines along an axis: the paper's edge, the squares with their inner lines, the pattern's end, the paper's other edge.
fn breaks(squares: usize, side: f64, inner: &[f64]) -> Vec<f64> {
    let margin = MARGIN_SQUARES * side;
    let end = squares as f64 * side;
    let square = |i: usize| inner.iter().map(move |line| i as f64 * side + line);
    std::iter::once(-margin).chain((0..squares).flat_map(square)).chain([end, end + margin]).collect()
}
