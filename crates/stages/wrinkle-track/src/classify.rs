//! Which paint each pixel shows: the decision of a colour is made once, and looked up ever after.

use crate::Error;
use crate::bits::Bits;
use crate::light::{Picture, ratios};
use crate::svm::{Ratios, Svm};
use artifact::{LearntPaint, PaintModel};

/// The paints of a picture's pixels, row after row; 0 is none, k the k-th paint of the model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Classified {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Paint of each pixel.
    pub paints: Vec<u8>,
}

impl Classified {
    /// The pixels of a paint (1 is the first).
    #[must_use]
    pub fn of_paint(&self, paint: u8) -> Bits {
        Bits::of(self.width, self.height, |pixel| self.paints[pixel] == paint)
    }
}

/// Tells paints in the pictures of one camera.
pub struct Classifier {
    machines: Vec<Svm>,
    floor: f64,
    cells: Cells,
    /// Per colour its paint and 1; 0 where nobody asked.
    known: Vec<u8>,
    /// What the levels of the images mean; none before the first one.
    light: Option<[f64; 256]>,
    logs: [f64; 256],
}

/// More would not fit the tables.
const MOST_PAINTS: usize = 64;

impl Classifier {
    /// # Errors
    /// [`Error::ManyPaints`].
    pub fn new(model: &PaintModel) -> Result<Self, Error> {
        if model.paints.len() > MOST_PAINTS {
            return Err(Error::ManyPaints(model.paints.len()));
        }
        let machine = |paint: &LearntPaint| Svm::new(paint.gamma, paint.bias, paint.support.clone());
        let machines: Vec<Svm> = model.paints.iter().map(machine).collect();
        let cells = Cells::new(&machines, model.floor);
        let known = vec![0; 1 << 24];
        Ok(Self { machines, floor: model.floor, cells, known, light: None, logs: [0.0; 256] })
    }

    /// The paint of each pixel, by tables; the same as [`Classifier::paint_at`] says of each.
    #[must_use]
    pub fn classify(&mut self, picture: &Picture) -> Classified {
        if self.light != Some(picture.light) {
            // Another transfer function: what the colours mean changed.
            if self.light.is_some() {
                self.known.fill(0);
            }
            (self.light, self.logs) = (Some(picture.light), picture.logs(self.floor));
        }
        let mut paints = vec![0; picture.levels.len()];
        for (paint, levels) in paints.iter_mut().zip(&picture.levels) {
            let color = usize::from(levels[0]) << 16 | usize::from(levels[1]) << 8 | usize::from(levels[2]);
            let known = self.known[color];
            *paint = match known {
                0 => self.ask(color, *levels),
                known => known - 1,
            };
        }
        Classified { width: picture.width, height: picture.height, paints }
    }

    #[cold]
    fn ask(&mut self, color: usize, levels: [u8; 3]) -> u8 {
        let at = ratios(&self.logs, levels);
        let paint = self.cells.paint(at).unwrap_or_else(|| self.paint_at(at));
        self.known[color] = paint + 1;
        paint
    }

    /// The paint of a colour, straight from the decisions: the largest one above 0, 0 where there is none.
    #[must_use]
    pub fn paint_at(&self, at: Ratios) -> u8 {
        let mut best = (0, 0.0);
        for (index, machine) in self.machines.iter().enumerate() {
            let decision = machine.decide(at);
            if decision > best.1 {
                best = (index as u8 + 1, decision);
            }
        }
        best.0
    }
}

/// Cells of the plane of ratios in which all colours show the same paint, provably.
struct Cells {
    side: usize,
    low: f64,
    width: f64,
    paints: Vec<u8>,
}

/// Halvings of the plane.
const DEPTH: u32 = 8;
/// A cell in which colours may differ.
const UNSURE: u8 = u8::MAX;
/// Decisions are sums, whose rounding is far below this.
const ROUNDING: f64 = 1e-9;

impl Cells {
    fn new(machines: &[Svm], floor: f64) -> Self {
        // Ratios of any two lights from 0 to 1.
        let reach = ((1.0 + floor) / floor).ln() * (1.0 + 1e-9);
        let side = 1 << DEPTH;
        let mut cells =
            Self { side, low: -reach, width: 2.0 * reach / side as f64, paints: vec![UNSURE; side * side] };
        cells.divide(machines, [0, 0], side);
        cells
    }

    /// The paint of all colours in the cell of a place, if it is one.
    fn paint(&self, at: Ratios) -> Option<u8> {
        let [x, y] = at.map(|value| ((value - self.low) / self.width) as usize);
        if at.iter().any(|value| *value < self.low) || x >= self.side || y >= self.side {
            return None;
        }
        Some(self.paints[y * self.side + x]).filter(|paint| *paint != UNSURE)
    }

    /// Fills a square of cells where bounds say that all is one paint, or asks its quarters.
    fn divide(&mut self, machines: &[Svm], [x, y]: [usize; 2], side: usize) {
        let half = 0.5 * side as f64;
        let center = [x, y].map(|first| self.low + (first as f64 + half) * self.width);
        // A place that rounding puts into the cell lies in it but for so much.
        let radius = (half * self.width * std::f64::consts::SQRT_2) * (1.0 + 1e-9);
        if let Some(paint) = only_paint(machines, center, radius) {
            for row in y..y + side {
                self.paints[row * self.side + x..][..side].fill(paint);
            }
        } else if side > 1 {
            let half = side / 2;
            for (dx, dy) in [(0, 0), (half, 0), (0, half), (half, half)] {
                self.divide(machines, [x + dx, y + dy], half);
            }
        }
    }
}

/// The paint of all places within a radius, if bounds show that there is but one.
fn only_paint(machines: &[Svm], center: Ratios, radius: f64) -> Option<u8> {
    let bounds: Vec<[f64; 2]> = machines.iter().map(|machine| machine.bounds(center, radius)).collect();
    if bounds.iter().all(|[_, high]| *high < -ROUNDING) {
        return Some(0);
    }
    let best = bounds.iter().position(|[low, _]| *low > ROUNDING)?;
    let loses = |(index, bound): (usize, &[f64; 2])| index == best || bound[1] < bounds[best][0] - ROUNDING;
    bounds.iter().enumerate().all(loses).then_some(best as u8 + 1)
}
