//! Contact sheets: pictures in a grid, with a title, captions and a colour bar.

use crate::dots::blend;
use crate::{Backdrop, ColorMap, Error, ValueRange};
use artifact::canvas::Pen;
use image::{Rgb, RgbImage, imageops};

/// The longest side of a sheet, pixels.
const SIDE_MAX: usize = 30_000;

/// One picture and what is written below it.
pub struct Cell {
    /// The picture.
    pub picture: RgbImage,
    /// Written in full ink at the left; may be empty.
    pub name: String,
    /// Written after the name in paler ink; may be empty.
    pub note: String,
}

/// The bar that says what the colours mean.
#[derive(Debug, Clone, PartialEq)]
pub struct ColorBar {
    /// Its colours.
    pub map: ColorMap,
    /// Values of its ends.
    pub range: ValueRange,
    /// Whether some values lie beyond the high end.
    pub is_exceeded: bool,
    /// What the values are, with their unit, e.g. `error, mm`.
    pub caption: String,
}

/// How pictures are arranged.
#[derive(Debug, Clone, PartialEq)]
pub struct Sheet {
    /// Pictures per row.
    pub columns: usize,
    /// Paper and ink.
    pub backdrop: Backdrop,
    /// Written on top; may be empty.
    pub title: String,
    /// The colour bar on the right, if the colours mean something.
    pub bar: Option<ColorBar>,
}

/// Sizes of a sheet, pixels.
struct Plan {
    cell: [usize; 2],
    text: f32,
    caption: usize,
    title: usize,
    gap: usize,
    bar: usize,
    columns: usize,
    rows: usize,
}

impl Plan {
    fn of(sheet: &Sheet, cells: &[Cell], cell: [usize; 2], pen: &Pen) -> Self {
        let text = (cell[0] as f32 / 30.0).clamp(12.0, 26.0);
        let line = (text * 1.7).ceil() as usize;
        let has_caption = cells.iter().any(|cell| !cell.name.is_empty() || !cell.note.is_empty());
        let label = |value: f64| pen.width(&bar_label(value, sheet, false), text);
        let bar = sheet.bar.as_ref().map_or(0.0, |bar| {
            let labels =
                ticks(bar.range).into_iter().map(label).fold(pen.width(&bar.caption, text), f32::max);
            4.0 * text + labels
        });
        Self {
            cell,
            text,
            caption: if has_caption { line } else { 0 },
            title: if sheet.title.is_empty() { 0 } else { (text * 2.4).ceil() as usize },
            gap: if cells.len() > 1 { (text * 0.4).ceil() as usize } else { 0 },
            bar: bar.ceil() as usize,
            columns: sheet.columns.clamp(1, cells.len().max(1)),
            rows: cells.len().div_ceil(sheet.columns.clamp(1, cells.len().max(1))),
        }
    }

    fn corner(&self, cell: usize) -> [usize; 2] {
        let (column, row) = (cell % self.columns, cell / self.columns);
        let across = self.gap + column * (self.cell[0] + self.gap);
        [across, self.title + self.gap + row * (self.cell[1] + self.caption + self.gap)]
    }

    fn size(&self) -> [usize; 2] {
        let past = self.corner(self.columns * self.rows);
        let width = self.gap + self.columns * (self.cell[0] + self.gap) + self.bar;
        [width, past[1]]
    }
}

/// Puts pictures of one size on a sheet, row after row.
///
/// # Errors
/// [`Error::SheetSize`] where a side would be longer than 30,000 pixels; [`Error::Font`].
pub fn compose(sheet: &Sheet, cells: &[Cell]) -> Result<RgbImage, Error> {
    let pen = Pen::new()?;
    let cell = cells.first().map_or([1, 1], |cell| {
        let (width, height) = cell.picture.dimensions();
        [width as usize, height as usize]
    });
    let plan = Plan::of(sheet, cells, cell, &pen);
    let [width, height] = plan.size();
    check_size(width, height)?;
    let mut paper = RgbImage::from_pixel(width as u32, height as u32, Rgb(sheet.backdrop.color()));
    for (index, cell) in cells.iter().enumerate() {
        let [x, y] = plan.corner(index);
        imageops::replace(&mut paper, &cell.picture, x as i64, y as i64);
        write_caption(&mut paper, &pen, &plan, cell, [x, y + plan.cell[1]], sheet.backdrop);
    }
    let margin = plan.gap as f32 + plan.text * 0.6;
    write(&mut paper, &pen, &sheet.title, [margin, plan.text * 0.6], plan.text * 1.3, sheet.backdrop.ink());
    if let Some(bar) = &sheet.bar {
        draw_bar(&mut paper, &pen, &plan, sheet, bar);
    }
    Ok(paper)
}

/// Refuses a sheet before its pictures are drawn.
///
/// # Errors
/// [`Error::SheetSize`] where a side would be longer than 30,000 pixels.
pub fn check_size(width: usize, height: usize) -> Result<(), Error> {
    match width.max(height) <= SIDE_MAX {
        true => Ok(()),
        false => Err(Error::SheetSize { width, height, limit: SIDE_MAX }),
    }
}

/// Writes a text from its upper left corner on, lines `height` pixels high; what lies beyond the paper is cut off.
fn write(paper: &mut RgbImage, pen: &Pen, text: &str, at: [f32; 2], height: f32, color: [u8; 3]) {
    pen.write(text, at, height, |x, y, cover| {
        let [Ok(x), Ok(y)] = [x, y].map(u32::try_from) else { return };
        if let Some(pixel) = paper.get_pixel_mut_checked(x, y) {
            blend(pixel, color, cover);
        }
    });
}

fn write_caption(
    paper: &mut RgbImage,
    pen: &Pen,
    plan: &Plan,
    cell: &Cell,
    at: [usize; 2],
    backdrop: Backdrop,
) {
    let (ink, ground) = (backdrop.ink(), backdrop.color());
    let pale = std::array::from_fn(|i| ((u16::from(ink[i]) * 7 + u16::from(ground[i]) * 3) / 10) as u8);
    let indent = plan.text * 0.6;
    let start = [at[0] as f32 + indent, at[1] as f32 + plan.text * 0.2];
    let room = plan.cell[0] as f32 - 2.0 * indent;
    let name = pen.fitted(&cell.name, plan.text, room);
    write(paper, pen, &name, start, plan.text, ink);
    let used = if name.is_empty() { 0.0 } else { pen.width(&name, plan.text) + plan.text * 0.8 };
    let note = pen.fitted(&cell.note, plan.text, room - used);
    write(paper, pen, &note, [start[0] + used, start[1]], plan.text, pale);
}

/// Upright, in the middle of the right side, high end on top.
fn draw_bar(paper: &mut RgbImage, pen: &Pen, plan: &Plan, sheet: &Sheet, bar: &ColorBar) {
    let text = plan.text;
    let ink = sheet.backdrop.ink();
    let (width, height) = ((text * 0.9) as u32, ((plan.cell[1] as f32 * 0.62) as u32).max(2));
    let left = (plan.size()[0] - plan.bar) as u32 + (text * 1.2) as u32;
    let top = (plan.corner(0)[1] as f32 + plan.cell[1] as f32 * 0.19) as u32;
    for row in 0..height {
        let color = bar.map.at(1.0 - f64::from(row) / f64::from(height - 1)).map(|value| value.round() as u8);
        (0..width).for_each(|column| mark(paper, left + column, top + row, color));
    }
    write(paper, pen, &bar.caption, [left as f32, top as f32 - text * 1.9], text, ink);
    let high = bar.range.high;
    for value in ticks(bar.range) {
        let y = (f64::from(top) + (1.0 - bar.range.place(value)) * f64::from(height - 1)).round() as u32;
        let start = left + width;
        (0..(text * 0.35) as u32).for_each(|k| mark(paper, start + k, y, ink));
        let label = bar_label(value, sheet, value == high);
        write(paper, pen, &label, [start as f32 + text * 0.6, y as f32 - text * 0.55], text, ink);
    }
}

/// Colours a pixel, if the paper has it.
fn mark(paper: &mut RgbImage, column: u32, row: u32, color: [u8; 3]) {
    if let Some(pixel) = paper.get_pixel_mut_checked(column, row) {
        *pixel = Rgb(color);
    }
}

fn bar_label(value: f64, sheet: &Sheet, is_end: bool) -> String {
    let exceeded = sheet.bar.as_ref().is_some_and(|bar| bar.is_exceeded);
    let sign = if is_end && exceeded { "≥ " } else { "" };
    format!("{sign}{}", short(value))
}

/// Six even marks, both ends among them.
fn ticks(range: ValueRange) -> Vec<f64> {
    (0..=5)
        .map(|k| if k == 5 { range.high } else { range.low + (range.high - range.low) * f64::from(k) / 5.0 })
        .collect()
}

/// A number for people: three significant digits, without trailing zeros.
#[must_use]
pub fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_string();
    }
    let decimals = (2 - value.abs().log10().floor() as i64).clamp(0, 9) as usize;
    let text = format!("{value:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        false => text,
    }
}
