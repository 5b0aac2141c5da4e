//! `marker-track detect`.

use anyhow::bail;
use artifact::picture::write_rgb8;
use marker_track::{Canvas, Found, Paint, Params, detect, places_of_color};
use stage::{ImageSource, Run};
use std::path::PathBuf;

/// Enlargement of the picture with numbers.
const SCALE: usize = 3;
const INK: [u8; 3] = [255, 235, 60];

/// Numbers the dots of one image, so that labels can be written by hand
///
/// Writes a picture with the numbers drawn in, and a table of the dots (px, px²) with an empty column `marker` for their names.
/// Name the colour of the paint, or click on a dot or two.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: ImageSource,
    /// Camera whose image is searched
    #[arg(long, value_name = "ID")]
    camera: String,
    /// Frame to search [default: the camera's first]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    frame: Option<i64>,
    /// Colour of the paint, e.g. 2b479e
    #[arg(long, value_name = "RRGGBB", value_parser = hexadecimal, required_unless_present = "at")]
    color: Option<[u8; 3]>,
    /// A place on a dot, px; may be given several times
    #[arg(long, value_name = "X,Y", value_parser = place, conflicts_with = "color")]
    at: Vec<[f64; 2]>,
    /// Picture to write (PNG), three times as large as the image
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Table to write (CSV)
    #[arg(long, value_name = "FILE")]
    csv: PathBuf,
}

fn hexadecimal(text: &str) -> Result<[u8; 3], String> {
    let digits = text.trim_start_matches('#');
    match (digits.len(), u32::from_str_radix(digits, 16)) {
        (6, Ok(value)) => Ok([16, 8, 0].map(|shift| (value >> shift & 255) as u8)),
        _ => Err("write six hexadecimal digits: red, green, blue".into()),
    }
}

fn place(text: &str) -> Result<[f64; 2], String> {
    let numbers = text.split_once(',').map(|(x, y)| [x.trim().parse::<f64>(), y.trim().parse()]);
    match numbers {
        Some([Ok(x), Ok(y)]) if x.is_finite() && y.is_finite() => Ok([x, y]),
        _ => Err("write x and y with a comma between them".into()),
    }
}

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("detect");
    run.parameters(&Params::default())?;
    let footage = arguments.source.open(run)?;
    let images = footage.camera(&arguments.camera)?;
    let numbers = footage.numbers();
    let wanted = |(number, path): &(&i64, &Option<PathBuf>)| {
        path.is_some() && arguments.frame.is_none_or(|frame| frame == **number)
    };
    let found = numbers.iter().zip(&images.paths).find(wanted);
    let Some((&frame, Some(path))) = found else {
        let frame = arguments.frame.map_or("any frame".to_string(), |frame| format!("frame {frame}"));
        bail!("{}, camera {}: has no image of {frame}", footage.path().display(), arguments.camera);
    };
    let image = images.read_8_bits(path)?;
    run.input("image", path)?;
    let picture = image.picture();
    let places = match arguments.color {
        Some(color) => places_of_color(&picture, color)?,
        None => arguments.at.clone(),
    };
    let paint = Paint::learn(&picture, images.transfer, &places, Params::default().least_coverage)?;
    let dots = detect(&picture, &paint);
    run.result("dots", dots.len());
    if dots.is_empty() {
        run.warn(format!("camera {} sees no dot", arguments.camera));
    }
    let mut canvas = Canvas::enlarged(&picture, SCALE);
    for (index, dot) in dots.iter().enumerate() {
        canvas.cross(dot.at, 4, INK);
        canvas.number(dot.at, index + 1, INK)?;
    }
    let picture = write_rgb8(&arguments.out, canvas.width, canvas.height, &canvas.rgb)?;
    let table = artifact::stage_bytes(&arguments.csv, &table(&arguments.camera, frame, &dots)?)?;
    run.publish(vec![picture, table])
}

fn table(camera: &str, frame: i64, dots: &[Found]) -> anyhow::Result<Vec<u8>> {
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(["camera", "frame", "number", "x", "y", "area", "marker"])?;
    for (index, dot) in dots.iter().enumerate() {
        let [x, y, area] = [dot.at[0], dot.at[1], dot.area].map(|value| format!("{value:.2}"));
        table.write_record([camera, &frame.to_string(), &(index + 1).to_string(), &x, &y, &area, ""])?;
    }
    Ok(table.into_inner()?)
}
