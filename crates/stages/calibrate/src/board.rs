//! Boards: flat patterns with corners of known places.

use nalgebra::{Point2, Point3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A flat pattern with corners of known places. Its space: x along the rows of corners, y down the columns, z into the board;
/// mm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Board {
    /// Black and white squares.
    Chessboard {
        /// *Inner* corners in a row, as OpenCV counts.
        columns: u32,
        /// Rows of inner corners.
        rows: u32,
        /// Side of a square, mm.
        square_mm: f64,
    },
    /// A chessboard with ArUco markers in its white squares.
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
        /// Whether cameras may see it from behind, as a board of glass: mirrored.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        see_through: bool,
    },
}

/// Sets of markers, named like OpenCV's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[allow(missing_docs, reason = "the names say it: cells along a marker's side, how many markers")]
pub enum Dictionary {
    #[serde(rename = "4x4_50")]
    FourByFour50,
    #[serde(rename = "4x4_100")]
    FourByFour100,
    #[serde(rename = "4x4_250")]
    FourByFour250,
    #[serde(rename = "4x4_1000")]
    FourByFour1000,
    #[serde(rename = "5x5_50")]
    FiveByFive50,
    #[serde(rename = "5x5_100")]
    FiveByFive100,
    #[serde(rename = "5x5_250")]
    FiveByFive250,
    #[serde(rename = "5x5_1000")]
    FiveByFive1000,
    #[serde(rename = "6x6_50")]
    SixBySix50,
    #[serde(rename = "6x6_100")]
    SixBySix100,
    #[serde(rename = "6x6_250")]
    SixBySix250,
    #[serde(rename = "6x6_1000")]
    SixBySix1000,
}

/// Most corners along a side: what any printer prints.
const MOST: u32 = 1000;
/// Sides of squares, mm: anything else is a slip of the unit or the pen.
const SIDES_MM: std::ops::RangeInclusive<f64> = 0.1..=10_000.0;

impl Dictionary {
    /// How many markers it has.
    #[must_use]
    pub fn markers(self) -> u32 {
        match self {
            Self::FourByFour50 | Self::FiveByFive50 | Self::SixBySix50 => 50,
            Self::FourByFour100 | Self::FiveByFive100 | Self::SixBySix100 => 100,
            Self::FourByFour250 | Self::FiveByFive250 | Self::SixBySix250 => 250,
            Self::FourByFour1000 | Self::FiveByFive1000 | Self::SixBySix1000 => 1000,
        }
    }
}

impl Board {
    /// Inner corners in a row, and rows.
    #[must_use]
    pub fn grid(&self) -> [u32; 2] {
        match *self {
            Self::Chessboard { columns, rows, .. } => [columns, rows],
            Self::Charuco { columns, rows, .. } => [columns.saturating_sub(1), rows.saturating_sub(1)],
        }
    }

    /// Side of a square, mm.
    #[must_use]
    pub fn square_mm(&self) -> f64 {
        match *self {
            Self::Chessboard { square_mm, .. } | Self::Charuco { square_mm, .. } => square_mm,
        }
    }

    /// The places of the inner corners, by their number: row after row, as OpenCV counts; the first one is the origin of a
    /// chessboard's space, and one square from it of a ChArUco board's.
    #[must_use]
    pub fn corners(&self) -> Vec<Point3<f64>> {
        let [columns, rows] = self.grid();
        let first = if matches!(self, Self::Charuco { .. }) { 1 } else { 0 };
        let place = |id: u32| {
            let [x, y] = [id % columns + first, id / columns + first];
            Point3::new(f64::from(x) * self.square_mm(), f64::from(y) * self.square_mm(), 0.0)
        };
        (0..columns * rows).map(place).collect()
    }

    /// The middle of the corners, mm.
    #[must_use]
    pub fn middle(&self) -> Point2<f64> {
        let corners = self.corners();
        match (corners.first(), corners.last()) {
            (Some(first), Some(last)) => nalgebra::center(first, last).xy(),
            _ => Point2::origin(),
        }
    }

    /// The ways in which the corners of a chessboard can be numbered and still make the same picture: a list per way, that
    /// gives for each number of a found corner the number that it has in the first. A detector cannot tell a chessboard
    /// that stands on its head; a ChArUco board has one way only.
    #[must_use]
    pub fn numberings(&self) -> Vec<Vec<u32>> {
        let [columns, rows] = self.grid();
        let count = columns * rows;
        let mut ways = vec![(0..count).collect::<Vec<u32>>()];
        if matches!(self, Self::Charuco { .. }) {
            return ways;
        }
        ways.push((0..count).rev().collect());
        if columns == rows {
            let quarter: Vec<u32> =
                (0..count).map(|id| (id % columns) * columns + columns - 1 - id / columns).collect();
            let back = quarter.iter().map(|id| count - 1 - id).collect();
            ways.extend([quarter, back]);
        }
        ways
    }

    /// Refuses boards that cannot be.
    ///
    /// # Errors
    /// What is wrong.
    pub fn check(&self) -> Result<(), String> {
        let [columns, rows] = self.grid();
        if !(2..=MOST).contains(&columns) || !(2..=MOST).contains(&rows) {
            return Err(format!(
                "a board of {columns} × {rows} inner corners; it needs 2 × 2 at least, {MOST} × {MOST} at most"
            ));
        }
        let side = self.square_mm();
        if !SIDES_MM.contains(&side) {
            let [least, most] = [SIDES_MM.start(), SIDES_MM.end()];
            return Err(format!("squares of {side:e} mm; they have from {least} to {most} mm"));
        }
        match *self {
            Self::Charuco { marker_mm, .. } if !(marker_mm > 0.0 && marker_mm < side) => {
                Err(format!("markers of {marker_mm} mm in squares of {side} mm"))
            }
            Self::Charuco { columns, rows, dictionary, .. } if columns * rows / 2 > dictionary.markers() => {
                Err(format!("{} markers; its dictionary has {}", columns * rows / 2, dictionary.markers()))
            }
            _ => Ok(()),
        }
    }
}
