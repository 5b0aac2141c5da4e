//! `preview tile`.

use super::arguments::{BackdropName, parse_size};
use anyhow::{Context, bail};
use clap::Args;
use image::imageops::{self, FilterType};
use image::{DynamicImage, ImageFormat, Rgb, RgbImage};
use preview::Backdrop;
use preview::sheet::{self, Cell, Sheet};
use serde::Serialize;
use stage::Run;
use std::path::PathBuf;

/// Puts pictures side by side on a sheet, each in a cell of one size, with captions
#[derive(Debug, Args)]
pub(crate) struct Tile {
    /// Pictures (PNG), row after row; FILE@X,Y,W,H takes a part of one: left, top, width, height, pixels
    #[arg(value_name = "PNG", required = true, value_parser = parse_part)]
    pictures: Vec<Part>,
    /// What is written below a picture; once for each, in their order
    #[arg(long, value_name = "TEXT")]
    name: Vec<String>,
    /// Width and height of a cell, pixels, into which pictures are fitted [default: those of the first picture]
    #[arg(long, value_name = "PX", value_parser = parse_size)]
    size: Option<[u32; 2]>,
    /// Pictures per row [default: all in one]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000))]
    columns: Option<u32>,
    /// What stands behind
    #[arg(long, value_name = "SHADE", default_value = "light")]
    background: BackdropName,
    /// Written on top of the sheet
    #[arg(long, default_value = "")]
    title: String,
    /// The sheet, PNG
    #[arg(long, value_name = "PNG")]
    out: PathBuf,
}

/// A picture, or a part of it: left, top, width, height.
#[derive(Debug, Clone, Serialize)]
struct Part {
    #[serde(skip)]
    path: PathBuf,
    rectangle: Option<[u32; 4]>,
}

fn parse_part(text: &str) -> Result<Part, String> {
    let whole = || Part { path: text.into(), rectangle: None };
    let Some((path, numbers)) = text.rsplit_once('@') else { return Ok(whole()) };
    let sides: Vec<u32> = numbers.split(',').filter_map(|side| side.trim().parse().ok()).collect();
    match <[u32; 4]>::try_from(sides) {
        Ok([.., 0, _] | [.., 0]) => Err(format!("'{numbers}' is an empty part of a picture")),
        Ok(rectangle) if numbers.split(',').count() == 4 => {
            Ok(Part { path: path.into(), rectangle: Some(rectangle) })
        }
        _ => Ok(whole()),
    }
}

/// What stands in the side-car.
#[derive(Serialize)]
struct Parameters<'a> {
    pictures: &'a [Part],
    names: &'a [String],
    size: [u32; 2],
    columns: usize,
    title: &'a str,
}

pub(crate) fn tile(run: &mut Run, arguments: &Tile) -> anyhow::Result<()> {
    run.subcommand("tile");
    run.check_folders(&[&arguments.out])?;
    let count = arguments.pictures.len();
    if arguments.name.len() > count {
        let names = arguments.name.len();
        bail!(
            "--name is given {names} times for {count} pictures\n  to do: give it once for each picture at most"
        );
    }
    let pictures: Vec<RgbImage> = arguments
        .pictures
        .iter()
        .enumerate()
        .map(|(at, path)| read(run, at, path))
        .collect::<Result<_, _>>()?;
    let size =
        arguments.size.or_else(|| pictures.first().map(|first| first.dimensions().into())).unwrap_or([1, 1]);
    let columns = arguments.columns.map_or(count, |columns| columns as usize);
    run.parameters(&Parameters {
        pictures: &arguments.pictures,
        names: &arguments.name,
        size,
        columns,
        title: &arguments.title,
    })?;
    let [width, height] = size.map(|side| side as usize);
    sheet::check_size(columns.min(count) * width, count.div_ceil(columns) * height)
        .context("to do: choose a smaller --size")?;
    let backdrop = Backdrop::from(arguments.background);
    let names = arguments.name.iter().cloned().chain(std::iter::repeat(String::new()));
    let cells = pictures.iter().zip(names);
    let cells: Vec<Cell> = cells
        .map(|(picture, name)| Cell { picture: fitted(picture, size, backdrop), name, note: String::new() })
        .collect();
    let sheet = Sheet { columns, backdrop, title: arguments.title.clone(), bar: None };
    let picture = sheet::compose(&sheet, &cells)?;
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Png)?;
    run.result("pictures", count);
    run.publish(vec![artifact::stage_bytes(&arguments.out, bytes.get_ref())?])
}

fn read(run: &mut Run, at: usize, Part { path, rectangle }: &Part) -> anyhow::Result<RgbImage> {
    let bytes = artifact::read_bytes(path)?;
    run.input(&format!("picture_{}", at + 1), path)?;
    let picture = image::load_from_memory_with_format(&bytes, ImageFormat::Png);
    let picture =
        picture.with_context(|| format!("{}: is no PNG picture that can be read", path.display()))?;
    let picture = DynamicImage::into_rgb8(picture);
    let Some([x, y, width, height]) = *rectangle else { return Ok(picture) };
    let (across, down) = picture.dimensions();
    let is_within = |from: u32, side: u32, all: u32| from.checked_add(side).is_some_and(|end| end <= all);
    if !is_within(x, width, across) || !is_within(y, height, down) {
        let path = path.display();
        bail!("{path}: the part {x},{y},{width},{height} is not within its {across} × {down} pixels");
    }
    Ok(imageops::crop_imm(&picture, x, y, width, height).to_image())
}

/// A picture in the middle of a cell, as large as fits; one of the cell's size keeps its pixels.
fn fitted(picture: &RgbImage, [width, height]: [u32; 2], backdrop: Backdrop) -> RgbImage {
    let (across, down) = picture.dimensions();
    let factor =
        (f64::from(width) / f64::from(across.max(1))).min(f64::from(height) / f64::from(down.max(1)));
    let side = |pixels: u32| ((f64::from(pixels) * factor).round() as u32).max(1);
    let mut cell = RgbImage::from_pixel(width, height, Rgb(backdrop.color()));
    let scaled = match (side(across), side(down)) {
        same if same == (across, down) => picture.clone(),
        (w, h) => imageops::resize(picture, w, h, FilterType::CatmullRom),
    };
    let corner = [width - scaled.width().min(width), height - scaled.height().min(height)]
        .map(|room| i64::from(room / 2));
    imageops::replace(&mut cell, &scaled, corner[0], corner[1]);
    cell
}
