//! Pictures to look at: curves and profiles over an image.

use crate::Error;
use crate::carry::lengths;
use crate::spline::Place;
use artifact::canvas::{Canvas, Color};
use artifact::picture::Picture;
use artifact::{Section, SectionState};
use std::collections::BTreeMap;

const MEASURED: Color = [90, 255, 90];
const EDITED: Color = [80, 220, 255];
const FLAT: Color = [255, 220, 60];
const FAILED: Color = [255, 70, 60];
const INK: Color = [255, 255, 255];
const PAPER: Color = [24, 24, 24];
/// Distance of the profiles that are drawn along a wrinkle, px, and what is added of the depth there: they must not run into each other.
const APART_PX: f64 = 8.0;
const APART_DEPTHS: f64 = 1.2;
/// A profile is drawn from rim to rim and so much further, in widths.
const REACH: f64 = 1.25;
/// Steps of a profile.
const STEPS: usize = 32;
/// Room around what is drawn, px.
const MARGIN_PX: f64 = 16.0;
/// Height of a caption, px.
const CAPTION: usize = 18;

/// A part of an image, px.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// Its upper left pixel.
    pub corner: [usize; 2],
    /// Width, height.
    pub size: [usize; 2],
}

impl Window {
    /// The part of an image in which sections lie, with room around them; all of it where there are none.
    #[must_use]
    pub fn around<'a>(size: [usize; 2], sections: impl Iterator<Item = &'a Section> + Clone) -> Self {
        let side = |axis: usize| {
            let reach = |section: &Section| {
                MARGIN_PX + REACH * section.w_px * section.normal[axis].abs() + section.d_px
            };
            let last = size[axis].saturating_sub(1);
            let bound = |value: f64| (value.max(0.0) as usize).min(last);
            let low = sections.clone().map(|section| section.at[axis] - reach(section)).reduce(f64::min);
            let high = sections.clone().map(|section| section.at[axis] + reach(section)).reduce(f64::max);
            (bound(low.unwrap_or(0.0)), bound(high.unwrap_or(last as f64)))
        };
        let [(left, right), (top, bottom)] = [side(0), side(1)];
        Self { corner: [left, top], size: [right + 1 - left, bottom + 1 - top] }
    }
}

/// How sections are shown: a part of an image, enlarged.
#[derive(Debug, Clone, Copy)]
pub struct Show<'a> {
    /// The image.
    pub picture: Picture<'a>,
    /// What of it is shown.
    pub window: Window,
    /// Size of an image's pixel in the picture.
    pub scale: usize,
}

impl Show<'_> {
    /// A picture with a panel for each set of sections, wide ones one below the other, others side by side: creases, and profiles across
    /// them as if cut there and tipped over, in the image's own scale. Measured sections are green, edited ones blue, flat ones yellow,
    /// failed ones red.
    ///
    /// # Errors
    /// [`Error::Font`].
    pub fn panels(&self, panels: &[(&str, &BTreeMap<String, Vec<Section>>)]) -> Result<Canvas, Error> {
        let [width, height] = self.window.size.map(|side| side * self.scale);
        let height = height + CAPTION;
        let is_wide = width > height;
        let [columns, rows] = if is_wide { [1, panels.len()] } else { [panels.len(), 1] };
        let mut canvas = Canvas::new(columns * width, rows * height)?;
        for (number, (title, sections)) in panels.iter().enumerate() {
            let corner = if is_wide { [0, number * height] } else { [number * width, 0] };
            self.panel(&mut canvas, corner, title, sections);
        }
        Ok(canvas)
    }

    fn panel(
        &self,
        canvas: &mut Canvas,
        corner: [usize; 2],
        title: &str,
        wrinkles: &BTreeMap<String, Vec<Section>>,
    ) {
        self.image(canvas, [corner[0], corner[1] + CAPTION]);
        canvas.fill(corner, [self.window.size[0] * self.scale, CAPTION], PAPER);
        canvas.write(title, [corner[0] + 4, corner[1] + 1], INK);
        let draw = Panel { show: self, corner: [corner[0], corner[1] + CAPTION] };
        for (id, sections) in wrinkles {
            draw.wrinkle(canvas, sections);
            draw.caption(canvas, id, sections);
        }
    }

    fn image(&self, canvas: &mut Canvas, corner: [usize; 2]) {
        for y in 0..self.window.size[1] {
            for x in 0..self.window.size[0] {
                let [column, row] = [self.window.corner[0] + x, self.window.corner[1] + y];
                let at = [corner[0] + x * self.scale, corner[1] + y * self.scale];
                canvas.fill(at, [self.scale; 2], self.picture.at(column, row));
            }
        }
    }
}

/// A panel that is being drawn.
struct Panel<'a> {
    show: &'a Show<'a>,
    corner: [usize; 2],
}

fn color(section: &Section) -> Color {
    match section.state {
        SectionState::Measured => MEASURED,
        SectionState::Edited => EDITED,
        SectionState::Flat => FLAT,
        SectionState::Failed => FAILED,
    }
}

impl Panel<'_> {
    /// A place of the image in the picture.
    fn place(&self, at: Place) -> [f64; 2] {
        let scale = self.show.scale as f64;
        [0, 1].map(|axis| {
            self.corner[axis] as f64 + (at[axis] - self.show.window.corner[axis] as f64 + 0.5) * scale - 0.5
        })
    }

    fn line(&self, canvas: &mut Canvas, from: Place, to: Place, color: Color) {
        let size = self.show.window.size.map(|side| (side * self.show.scale) as f64);
        let ends = [self.place(from), self.place(to)];
        let inside = |at: [f64; 2]| {
            (0..2).all(|axis| (0.0..size[axis] - 1.0).contains(&(at[axis] - self.corner[axis] as f64)))
        };
        if ends.into_iter().all(inside) {
            canvas.line(ends[0], ends[1], color);
        }
    }

    fn wrinkle(&self, canvas: &mut Canvas, sections: &[Section]) {
        for pair in sections.windows(2) {
            self.line(canvas, pair[0].at.into(), pair[1].at.into(), color(&pair[0]));
        }
        let mut next = 0.0;
        for (section, length) in sections.iter().zip(lengths(sections)) {
            if length >= next && section.d_px > 0.0 {
                self.profile(canvas, section);
                next = length + APART_PX + APART_DEPTHS * section.d_px;
            }
        }
    }

    /// The profile, its heights laid along the wrinkle.
    fn profile(&self, canvas: &mut Canvas, section: &Section) {
        let across = Place::from(section.normal);
        let along = Place::new(across.y, -across.x);
        let reach = REACH * section.w_px * (1.0 + section.kappa.abs());
        let place = |step: usize| {
            let p = reach * (2.0 * step as f64 / STEPS as f64 - 1.0);
            Place::from(section.at) + p * across - section.shape().at(p).0 * along
        };
        for step in 0..STEPS {
            self.line(canvas, place(step), place(step + 1), color(section));
        }
    }

    /// Id, mean width and largest depth, at the wrinkle's end.
    fn caption(&self, canvas: &mut Canvas, id: &str, sections: &[Section]) {
        let valleys: Vec<&Section> = sections.iter().filter(|section| section.d_px > 0.0).collect();
        let Some(end) = sections.last() else { return };
        let width = valleys.iter().map(|section| section.w_px).sum::<f64>() / valleys.len().max(1) as f64;
        let depth = valleys.iter().map(|section| section.d_px).fold(0.0, f64::max);
        let text = match valleys.is_empty() {
            true => id.to_string(),
            false => format!("{id}: w {width:.1}, d up to {depth:.1} px"),
        };
        let room = [6 * text.chars().count() + 6, 16];
        let at = self.place(end.at.into());
        let spot = [0, 1].map(|axis| {
            let last = self.corner[axis] + self.show.window.size[axis] * self.show.scale;
            (at[axis].max(0.0) as usize + 4)
                .clamp(self.corner[axis], last.saturating_sub(room[axis]).max(self.corner[axis]))
        });
        canvas.fill(spot, room, PAPER);
        canvas.write(
            &text,
            [spot[0] + 2, spot[1]],
            color(valleys.first().copied().unwrap_or(&sections[sections.len() / 2])),
        );
    }
}
