//! Corners of boards in pictures.

use anyhow::{Context, bail};
use artifact::{FrameWriter, Take};
use calibrate::{
    Board, BoardCorners, Corners, CornersFrame, CornersHeader, Dictionary, Picture, find_corners,
};
use nalgebra::Point2;
use rayon::prelude::*;
use stage::Run;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Find the corners of a board in pictures
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    pictures: Pictures,
    /// Where to write the corners
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// Where pictures are, and what they show.
#[derive(clap::Args)]
pub(crate) struct Pictures {
    /// A folder with one folder of pictures per camera; what has the same number was taken at the same time
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
    /// Names of the pictures in each camera's folder
    #[arg(long, value_name = "PATTERN", default_value = "{frame:06}.png")]
    name: String,
    /// Pictures of one camera, e.g. m1=shots/left{frame:02}.jpg; may be repeated
    #[arg(long, value_name = "ID=PATTERN")]
    images: Vec<String>,
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
    #[arg(long, value_name = "MM")]
    square_mm: Option<f64>,
    /// Side of a ChArUco board's marker
    #[arg(long, value_name = "MM")]
    marker_mm: Option<f64>,
    /// Markers of a ChArUco board: 4x4_50 to 6x6_1000
    #[arg(long, value_name = "NAME", value_parser = dictionary, default_value = "4x4_50")]
    dictionary: Dictionary,
    /// The take that the pictures belong to: its cameras' image sizes are checked
    #[arg(long, value_name = "FILE")]
    take: Option<PathBuf>,
}

fn dictionary(text: &str) -> Result<Dictionary, String> {
    serde_json::from_value(serde_json::Value::String(text.to_string()))
        .map_err(|_| format!("'{text}' is not one of 4x4_, 5x5_, 6x6_ with 50, 100, 250 or 1000"))
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("detect");
    let corners = arguments.pictures.corners(run)?;
    run.parameters(&serde_json::json!({ "board": corners.header.board }))?;
    let mut writer = FrameWriter::<BoardCorners>::create(&arguments.out, corners.header)?;
    for frame in &corners.frames {
        writer.write(frame)?;
    }
    run.publish(vec![writer.finish()?])
}

/// A picture to look at.
struct Shot {
    camera: String,
    frame: i64,
    path: PathBuf,
}

/// What was found in it.
struct Found {
    size: [u32; 2],
    corners: BTreeMap<u32, Point2<f64>>,
}

impl Pictures {
    /// The corners in all pictures.
    pub(crate) fn corners(&self, run: &mut Run) -> anyhow::Result<Corners> {
        let board = self.board(run)?;
        let shots = self.shots()?;
        let take = self.take.as_deref().map(|path| stage::load_take(run, path)).transpose()?;
        let progress = std::sync::Mutex::new(run.progress("corners", Some(shots.len() as u64)));
        let look = |shot: &Shot| {
            let found = look(&shot.path, &board);
            if let Ok(mut progress) = progress.lock() {
                progress.step();
            }
            found
        };
        let found = shots.par_iter().map(look).collect::<anyhow::Result<Vec<Found>>>()?;
        drop(progress);
        let header = CornersHeader {
            board,
            cameras: sizes(&shots, &found, take.as_ref().map(|(take, _)| take))?,
            take: take.map(|(_, reference)| reference),
        };
        tell(run, &header, &shots, &found);
        let mut frames: BTreeMap<i64, CornersFrame> = BTreeMap::new();
        for (shot, found) in shots.iter().zip(found) {
            let empty = || CornersFrame { frame: shot.frame, seen: BTreeMap::new() };
            let frame = frames.entry(shot.frame).or_insert_with(empty);
            if !found.corners.is_empty() {
                frame.seen.insert(shot.camera.clone(), found.corners);
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
                let board =
                    Board::Charuco { columns, rows, square_mm, marker_mm, dictionary: self.dictionary };
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

    fn shots(&self) -> anyhow::Result<Vec<Shot>> {
        let mut patterns: BTreeMap<String, PathBuf> = BTreeMap::new();
        if let Some(folder) = &self.folder {
            for camera in artifact::subfolders(folder)? {
                patterns.insert(camera.clone(), folder.join(&camera).join(&self.name));
            }
        }
        for stated in &self.images {
            let Some((id, pattern)) = stated.split_once('=') else {
                bail!("--images {stated}: is not ID=PATTERN, e.g. m1=shots/m1/{{frame:06}}.png");
            };
            if patterns.insert(id.to_string(), pattern.into()).is_some() {
                bail!("--images {stated}: camera {id} has pictures already\n  to do: name each camera once");
            }
        }
        let mut shots = Vec::new();
        for (camera, pattern) in patterns {
            let folder = pattern.parent().unwrap_or(Path::new("")).to_path_buf();
            let name = artifact::file_name(&pattern);
            let numbers = artifact::image_numbers(&pattern)?;
            if numbers.is_empty() {
                bail!("{}: camera {camera} has no such pictures\n  to do: check --name", pattern.display());
            }
            let shot = |frame| Shot {
                camera: camera.clone(),
                frame,
                path: folder.join(artifact::image_path(&name, frame)),
            };
            shots.extend(numbers.into_iter().map(shot));
        }
        match shots.is_empty() {
            true => bail!("there are no pictures\n  to do: give --folder or --images"),
            false => Ok(shots),
        }
    }
}

fn look(path: &Path, board: &Board) -> anyhow::Result<Found> {
    let picture = artifact::picture::read_rgb(path)?;
    // Rec. 601, as OpenCV has it.
    let luma = |rgb: &[u8]| {
        let [r, g, b] = [rgb[0], rgb[1], rgb[2]].map(u32::from);
        ((299 * r + 587 * g + 114 * b + 500) / 1000) as u8
    };
    let gray: Vec<u8> = picture.to_8_bits().chunks_exact(3).map(luma).collect();
    let size = [picture.width as u32, picture.height as u32];
    let corners =
        find_corners(Picture { size, gray: &gray }, board).with_context(|| path.display().to_string())?;
    Ok(Found { size, corners })
}

/// The cameras' image sizes; refuses one whose pictures differ, or that the take says otherwise of.
fn sizes(shots: &[Shot], found: &[Found], take: Option<&Take>) -> anyhow::Result<BTreeMap<String, [u32; 2]>> {
    let mut sizes: BTreeMap<String, [u32; 2]> = BTreeMap::new();
    for (shot, Found { size, .. }) in shots.iter().zip(found) {
        let known = *sizes.entry(shot.camera.clone()).or_insert(*size);
        let stated = take
            .and_then(|take| take.cameras.iter().find(|camera| camera.id == shot.camera))
            .map(|camera| camera.image_size);
        for (by, [width, height]) in [("the pictures before it", Some(known)), ("the take", stated)]
            .into_iter()
            .filter_map(|(by, size)| Some((by, size?)))
        {
            if [width, height] != *size {
                bail!(
                    "{}: has {} × {} px, {by} {width} × {height}\n  to do: calibrate a camera with pictures of the size that it films with",
                    shot.path.display(),
                    size[0],
                    size[1]
                );
            }
        }
    }
    Ok(sizes)
}

fn tell(run: &mut Run, header: &CornersHeader, shots: &[Shot], found: &[Found]) {
    let mut shown = serde_json::Map::new();
    for id in header.cameras.keys() {
        let own = shots.iter().zip(found).filter(|(shot, _)| shot.camera == *id);
        let count = own.clone().filter(|(_, found)| !found.corners.is_empty()).count();
        if count == 0 {
            run.warn(format!("camera {id}: none of its {} pictures shows the board", own.count()));
        }
        shown.insert(id.clone(), count.into());
    }
    run.result("pictures", shots.len());
    run.result("pictures_with_board", found.iter().filter(|found| !found.corners.is_empty()).count());
    run.result("views", shown);
}

/// A board from the command line: from a file, or in words such as `8x6`.
fn grid(text: &str) -> Result<[u32; 2], String> {
    let parsed =
        text.split_once('x').and_then(|(columns, rows)| Some([columns.parse().ok()?, rows.parse().ok()?]));
    parsed.ok_or_else(|| format!("'{text}' is not COLUMNSxROWS, e.g. 8x6"))
}

/// Refuses a board that cannot be.
fn checked(board: Board, from: &str) -> anyhow::Result<Board> {
    if let Err(what) = board.check() {
        bail!("{from}: {what}");
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
