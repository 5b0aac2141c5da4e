//! `wrinkle-edit show`.

use anyhow::bail;
use artifact::picture::write_rgb8;
use artifact::{FrameReader, Section, Sections};
use stage::{ImageSource, Run, check_take};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use wrinkle_edit::{Show, Window};

/// Draws curves and profiles of a frame over its image: before and after an edit, or one of the two
///
/// Profiles are cut across the wrinkle and tipped over, in the image's own scale. Measured sections are green, edited ones blue, flat
/// ones yellow, failed ones red.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("what").multiple(true).required(true))]
pub(crate) struct Arguments {
    #[command(flatten)]
    source: ImageSource,
    /// Sections before the edits (sections)
    #[arg(long, value_name = "FILE", group = "what")]
    before: Option<PathBuf>,
    /// Sections after them (sections)
    #[arg(long, value_name = "FILE", group = "what")]
    after: Option<PathBuf>,
    /// Camera whose image is drawn
    #[arg(long, value_name = "ID")]
    camera: String,
    /// Frame to draw
    #[arg(long, value_name = "FRAME", allow_negative_numbers = true)]
    frame: i64,
    /// Draw only these wrinkles, and what of the image they need; * and ? stand for letters
    #[arg(long, value_name = "ID,...", value_delimiter = ',')]
    wrinkle: Vec<String>,
    /// Enlargement of the image
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=8))]
    scale: u8,
    /// Picture to write, PNG
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

type Wrinkles = BTreeMap<String, Vec<Section>>;

pub(crate) fn run(run: &mut Run, arguments: &Arguments) -> anyhow::Result<()> {
    run.subcommand("show");
    let footage = arguments.source.open(run)?;
    let mut panels: Vec<(&str, Wrinkles)> = Vec::new();
    for (name, path) in [("before", &arguments.before), ("after", &arguments.after)] {
        let Some(path) = path else { continue };
        let reader = FrameReader::<Sections>::open(path)?;
        run.input(name, path)?;
        check_take(run, path, reader.header().take.as_ref(), footage.take.as_ref())?;
        panels.push((name, arguments.wrinkles(path, reader)?));
    }
    let (id, number) = (&arguments.camera, arguments.frame);
    let camera = footage.camera(id)?;
    let index = footage.numbers().iter().position(|other| *other == number);
    let Some(path) = index.and_then(|index| camera.paths[index].as_deref()) else {
        bail!("{}, camera {id}: has no image of frame {number}", footage.path().display());
    };
    let image = camera.read_8_bits(path)?;
    let picture = image.picture();
    let size = [picture.width, picture.height];
    let window = Window::around(size, panels.iter().flat_map(|(_, wrinkles)| wrinkles.values().flatten()));
    let title = |name: &str| match panels.len() {
        1 => format!("{id}, frame {number}"),
        _ => format!("{name}: {id}, frame {number}"),
    };
    let titled: Vec<(String, &Wrinkles)> =
        panels.iter().map(|(name, wrinkles)| (title(name), wrinkles)).collect();
    let titled: Vec<(&str, &Wrinkles)> =
        titled.iter().map(|(title, wrinkles)| (title.as_str(), *wrinkles)).collect();
    let canvas = Show { picture, window, scale: arguments.scale.into() }.panels(&titled)?;
    run.result("wrinkles", panels.iter().map(|(_, wrinkles)| wrinkles.len()).max());
    run.publish(vec![write_rgb8(&arguments.out, canvas.width, canvas.height, &canvas.rgb)?])
}

impl Arguments {
    /// The wrinkles of the frame that are asked for.
    fn wrinkles(&self, path: &Path, mut reader: FrameReader<Sections>) -> anyhow::Result<Wrinkles> {
        let (id, file) = (&self.camera, path.display());
        let known = reader.header().cameras.clone();
        if !known.contains(id) {
            bail!("{file}: has no camera {id}\n  to do: name one of {}", known.join(", "));
        }
        let is_wanted = |id: &String| {
            self.wrinkle.is_empty() || self.wrinkle.iter().any(|pattern| artifact::matches(pattern, id))
        };
        let frame = reader.find(|frame| frame.as_ref().map_or(true, |frame| frame.frame >= self.frame));
        let found = frame.transpose()?.filter(|frame| frame.frame == self.frame);
        let Some(mut wrinkles) = found.and_then(|mut frame| frame.sections.remove(id)) else {
            bail!("{file}, camera {id}: has no sections of frame {}", self.frame);
        };
        wrinkles.retain(|id, _| is_wanted(id));
        Ok(wrinkles)
    }
}
