//! `board-corners/1`: the corners of a board, as cameras saw them. What finds corners and what calibrates meet here, so that
//! either can be somebody else's.

use crate::Board;
use artifact::{Kind, Stream, TakeRef, Violation, finite};
use nalgebra::Point2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The kind of found corners.
pub struct BoardCorners;

/// What holds for all frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CornersHeader {
    /// The board.
    pub board: Board,
    /// Per camera id its image's width and height, px.
    pub cameras: BTreeMap<String, [u32; 2]>,
    /// The take that the pictures belong to.
    pub take: Option<TakeRef>,
}

/// The corners of one instant.
#[derive(Debug, Clone, PartialEq)]
pub struct CornersFrame {
    /// The instant's number: what has the same number was seen at the same time.
    pub frame: i64,
    /// Per camera id the corners that it saw: by number, in pixels; pixel (0, 0) is the centre of the top-left pixel.
    pub seen: BTreeMap<String, BTreeMap<u32, Point2<f64>>>,
}

/// A line of the file.
#[derive(Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CornersLine {
    frame: i64,
    /// Per camera id the corners that it saw: number, x, y in pixels.
    corners: BTreeMap<String, Vec<(u32, f64, f64)>>,
}

impl Kind for BoardCorners {
    const NAME: &'static str = "board-corners";
    const VERSION: u32 = 1;
}

impl Stream for BoardCorners {
    type Header = CornersHeader;
    type Frame = CornersFrame;
    type Line = CornersLine;

    fn check(header: &CornersHeader) -> Result<(), Violation> {
        header.board.check().map_err(|what| Violation::new("board", what))?;
        for (id, size) in &header.cameras {
            if id.is_empty() || size.contains(&0) {
                let what = format!("the id '{id}' or the size {} × {} px is empty", size[0], size[1]);
                return Err(Violation::new("cameras", what));
            }
        }
        Ok(())
    }

    fn encode(header: &CornersHeader, frame: &CornersFrame) -> Result<CornersLine, Violation> {
        let listed =
            |corners: &BTreeMap<u32, Point2<f64>>| corners.iter().map(|(&id, at)| (id, at.x, at.y)).collect();
        let corners = frame.seen.iter().map(|(camera, seen)| (camera.clone(), listed(seen))).collect();
        let line = CornersLine { frame: frame.frame, corners };
        check_line(header, &line)?;
        Ok(line)
    }

    fn decode(header: &CornersHeader, line: CornersLine) -> Result<CornersFrame, Violation> {
        check_line(header, &line)?;
        let seen =
            |list: Vec<(u32, f64, f64)>| list.into_iter().map(|(id, x, y)| (id, Point2::new(x, y))).collect();
        let seen = line.corners.into_iter().map(|(camera, list)| (camera, seen(list))).collect();
        Ok(CornersFrame { frame: line.frame, seen })
    }

    fn number(frame: &CornersFrame) -> i64 {
        frame.frame
    }
}

/// Corners may lie outside the image by so much, px: they are placed between pixels, from what is seen around them.
const BEYOND_PX: f64 = 2.0;

fn check_line(header: &CornersHeader, line: &CornersLine) -> Result<(), Violation> {
    let [columns, rows] = header.board.grid();
    for (camera, corners) in &line.corners {
        let place = format!("frame {}, camera {camera}", line.frame);
        let Some(size) = header.cameras.get(camera) else {
            return Err(Violation::new(place, "is not among the header's cameras"));
        };
        let mut ids = std::collections::BTreeSet::new();
        for &(id, x, y) in corners {
            let place = format!("{place}, corner {id}");
            finite(&place, &[x, y])?;
            let ends = size.map(|side| f64::from(side) - 1.0 + BEYOND_PX);
            if x < -BEYOND_PX || y < -BEYOND_PX || x > ends[0] || y > ends[1] {
                let what =
                    format!("({x:.1}, {y:.1}) is outside of the image of {} × {} px", size[0], size[1]);
                return Err(Violation::new(place, what));
            }
            if id >= columns * rows {
                return Err(Violation::new(
                    place,
                    format!("the board has {columns} × {rows} corners, counted from 0"),
                ));
            }
            if !ids.insert(id) {
                return Err(Violation::new(place, "stands twice"));
            }
        }
    }
    Ok(())
}

/// A whole file of found corners.
#[derive(Debug, Clone, PartialEq)]
pub struct Corners {
    /// The board and the cameras.
    pub header: CornersHeader,
    /// Instants, their numbers rising.
    pub frames: Vec<CornersFrame>,
}

/// `board.json` of a take: the board whose pictures lie beside it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BoardFile {
    /// The board.
    pub board: Board,
}
