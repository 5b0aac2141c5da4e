//! Corners of boards in pictures.

use super::footage::{Footage, check_outputs};
use super::number;
use super::shots::{self, Choice, Looked, Shot, Shots};
use anyhow::{Context, bail};
use artifact::FrameWriter;
use calibrate::{
    Board, BoardCorners, Corners, CornersFrame, CornersHeader, Dictionary, Picture, find_corners,
};
use nalgebra::Point2;
use stage::Run;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Find the corners of a board in pictures or videos
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pictures: Pictures,
    #[command(flatten)]
    footage: Footage,
    /// Where to write the corners
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// Where pictures are, and what they show.
#[derive(clap::Args)]
pub(crate) struct Pictures {
    /// A folder with a folder of pictures or a video per camera, named by the camera's id; what has the same number was taken at
    /// the same time
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
    /// Names of the pictures in each camera's folder
    #[arg(long, value_name = "PATTERN", default_value = "{frame:06}.png")]
    name: String,
    /// Pictures or a video of one camera, e.g. m1=shots/left{frame:02}.jpg or m1=left.mp4; may be repeated
    #[arg(long, value_name = "ID=PATH", value_parser = of_camera)]
    images: Vec<(String, PathBuf)>,
    /// Look only at pictures whose number this divides, e.g. at each tenth frame of a video
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    every: u32,
    /// The board: a file as virtual-rig writes it [default: board.json beside the folder]
    #[arg(long, value_name = "FILE", conflicts_with_all = ["chessboard", "charuco"])]
    board: Option<PathBuf>,
    /// The board: a chessboard of so many inner corners, e.g. 8x6
    #[arg(long, value_name = "CxR", value_parser = grid, conflicts_with = "charuco", requires = "square_mm")]
    chessboard: Option<[u32; 2]>,
    /// The board: a ChArUco board of so many squares, e.g. 4x5
    #[arg(long, value_name = "CxR", value_parser = grid, requires_all = ["square_mm", "marker_mm"])]
    charuco: Option<[u32; 2]>,
    /// Side of a square
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = number::positive)]
    square_mm: Option<f64>,
    /// Side of a ChArUco board's marker
    #[arg(long, value_name = "MM", allow_negative_numbers = true, value_parser = number::positive)]
    marker_mm: Option<f64>,
    /// Markers of a ChArUco board: 4x4_50 to 6x6_1000
    #[arg(long, value_name = "NAME", value_parser = dictionary, default_value = "4x4_50")]
    dictionary: Dictionary,
    /// A ChArUco board that cameras may see from behind, as one of glass
    #[arg(long, conflicts_with_all = ["board", "chessboard"])]
    see_through: bool,
}

fn of_camera(text: &str) -> Result<(String, PathBuf), String> {
    let parts = text.split_once('=').filter(|(id, path)| !id.is_empty() && !path.is_empty());
    let (id, path) =
        parts.ok_or_else(|| format!("'{text}' is not ID=PATH, e.g. m1=shots/m1/{{frame:06}}.png"))?;
    Ok((id.to_string(), path.into()))
}

fn dictionary(text: &str) -> Result<Dictionary, String> {
    serde_json::from_value(serde_json::Value::String(text.to_string()))
        .map_err(|_| format!("'{text}' is not one of 4x4_, 5x5_, 6x6_ with 50, 100, 250 or 1000"))
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("detect");
    let corners = arguments.pictures.corners(run, &arguments.footage, &[Some(&arguments.out)])?;
    run.parameters(&serde_json::json!({ "board": corners.header.board }))?;
    let mut writer = FrameWriter::<BoardCorners>::create(&arguments.out, corners.header)?;
    for frame in &corners.frames {
        writer.write(frame)?;
    }
    run.publish(vec![writer.finish()?])
}

/// Corners by number.
type Found = BTreeMap<u32, Point2<f64>>;

impl Pictures {
    pub(crate) fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// The corners in all pictures. Instants at which no camera sees the board are left out. `outputs` are what will be
    /// written: they are checked before the search.
    pub(crate) fn corners(
        &self,
        run: &mut Run,
        footage: &Footage,
        outputs: &[Option<&Path>],
    ) -> anyhow::Result<Corners> {
        let board = self.board(run)?;
        let shots = self.shots(footage)?;
        let take = footage.load(run)?;
        check_outputs(run, outputs)?;
        let choice = Choice { every: self.every, take: take.as_ref().map(|(take, _)| take) };
        let look =
            |shot: &Shot| Ok(find_corners(Picture { size: shot.size, gray: &gray(shot.rgb) }, &board)?);
        let looked = shots::look(run, &shots, &choice, look)?;
        tell(run, &looked, matches!(board, Board::Charuco { .. }));
        if looked.iter().all(|looked| looked.shown.iter().all(|(_, corners)| corners.is_empty())) {
            bail!(
                "no picture of any camera shows the board\n  to do: check that the board described is the one in the pictures (the corners of a chessboard are counted inside, the squares of a ChArUco board all)"
            );
        }
        let cameras = looked.iter().map(|looked| (looked.camera.clone(), looked.size)).collect();
        let header = CornersHeader { board, cameras, take: take.map(|(_, reference)| reference) };
        let mut frames: BTreeMap<i64, CornersFrame> = BTreeMap::new();
        for Looked { camera, shown, .. } in looked {
            for (number, corners) in shown.into_iter().filter(|(_, corners)| !corners.is_empty()) {
                let empty = || CornersFrame { frame: number, seen: BTreeMap::new() };
                frames.entry(number).or_insert_with(empty).seen.insert(camera.clone(), corners);
            }
        }
        Ok(Corners { header, frames: frames.into_values().collect() })
    }

    fn board(&self, run: &mut Run) -> anyhow::Result<Board> {
        let square_mm = self.square_mm.unwrap_or_default();
        match (self.chessboard, self.charuco) {
            (Some([columns, rows]), _) => {
                checked(Board::Chessboard { columns, rows, square_mm }, "--chessboard")
            }
            (None, Some([columns, rows])) => {
                let marker_mm = self.marker_mm.unwrap_or_default();
                let board = Board::Charuco {
                    columns,
                    rows,
                    square_mm,
                    marker_mm,
                    dictionary: self.dictionary,
                    see_through: self.see_through,
                };
                checked(board, "--charuco")
            }
            (None, None) => {
                let beside = || Some(self.folder.as_ref()?.parent()?.join("board.json"));
                let Some(path) = self.board.clone().or_else(beside) else {
                    bail!("the board is not described\n  to do: give --board, --chessboard or --charuco")
                };
                read_board(run, &path)
            }
        }
    }

    fn shots(&self, footage: &Footage) -> anyhow::Result<Vec<Shots>> {
        let mut all = match &self.folder {
            Some(folder) => shots::in_folder(folder, &self.name)?,
            None => BTreeMap::new(),
        };
        for (id, path) in &self.images {
            if all.insert(id.clone(), shots::of_camera(id, path)?).is_some() {
                bail!("--images: camera {id} has pictures already\n  to do: name each camera once");
            }
        }
        footage.leave_out(self.folder().unwrap_or(Path::new("--images")), &mut all)?;
        match all.is_empty() {
            true => bail!("there are no pictures\n  to do: give --folder or --images"),
            false => Ok(all.into_values().collect()),
        }
    }
}

/// Grey values: Rec. 601, as OpenCV has it.
fn gray(rgb: &[u8]) -> Vec<u8> {
    let luma = |rgb: &[u8]| {
        let [r, g, b] = [rgb[0], rgb[1], rgb[2]].map(u32::from);
        ((299 * r + 587 * g + 114 * b + 500) / 1000) as u8
    };
    rgb.chunks_exact(3).map(luma).collect()
}

fn tell(run: &mut Run, looked: &[Looked<Found>], sees_markers: bool) {
    let (mut views, mut images) = (serde_json::Map::new(), serde_json::Map::new());
    for Looked { camera, shown, sha256, .. } in looked {
        let count = shown.iter().filter(|(_, corners)| !corners.is_empty()).count();
        if count == 0 {
            run.warn(format!(
                "camera {camera}: none of its {} pictures shows the board{}",
                shown.len(),
                if sees_markers { "; if it looks through the board from behind, say --see-through; its video may be mirrored" } else { "" }
            ));
        }
        views.insert(camera.clone(), count.into());
        images.insert(camera.clone(), serde_json::json!({ "images": shown.len(), "sha256": sha256 }));
    }
    let shown = looked.iter().flat_map(|looked| &looked.shown);
    run.result("pictures", shown.clone().count());
    run.result("pictures_with_board", shown.filter(|(_, corners)| !corners.is_empty()).count());
    run.result("views", views);
    run.result("images", images);
}

/// Corners or squares along a board's side.
const SIDES: std::ops::RangeInclusive<u32> = 2..=1000;

/// A board from the command line: from a file, or in words such as `8x6`.
fn grid(text: &str) -> Result<[u32; 2], String> {
    let parsed: Option<[u32; 2]> =
        text.split_once('x').and_then(|(columns, rows)| Some([columns.parse().ok()?, rows.parse().ok()?]));
    match parsed {
        None => Err(format!("'{text}' is not COLUMNSxROWS, e.g. 8x6")),
        Some(sides) if sides.iter().any(|side| !SIDES.contains(side)) => {
            Err(format!("'{text}': a board has {} to {} each way", SIDES.start(), SIDES.end()))
        }
        Some(sides) => Ok(sides),
    }
}

/// Refuses a board that cannot be.
fn checked(board: Board, from: &str) -> anyhow::Result<Board> {
    if let Err(what) = board.check() {
        bail!("{from}: {what}\n  to do: describe the board as it is printed");
    }
    Ok(board)
}

/// Reads `board.json`.
fn read_board(run: &mut Run, path: &Path) -> anyhow::Result<Board> {
    let text = artifact::read_text(path)?;
    let file: calibrate::BoardFile =
        serde_json::from_str(&text).with_context(|| format!("{}: describes no board", path.display()))?;
    run.input("board", path)?;
    checked(file.board, &path.display().to_string())
}
