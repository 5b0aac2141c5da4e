//! Images of one bit: morphology on 64 pixels at a time, and connected patches.

/// Which pixels of an image are meant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Bits {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Words of a row; the lowest bit of the first is the leftmost pixel. Bits beyond the width are 0.
    row_words: usize,
    words: Vec<u64>,
}

/// Neighbouring pixels of a row, the last one included.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Run {
    /// Row.
    pub row: usize,
    /// First column.
    pub from: usize,
    /// Last column.
    pub to: usize,
}

/// A patch of pixels that hang together.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Patch {
    /// Its pixels, row after row.
    pub runs: Vec<Run>,
}

impl Patch {
    /// Number of pixels.
    #[must_use]
    pub fn area(&self) -> usize {
        self.runs.iter().map(|run| run.to - run.from + 1).sum()
    }

    /// Column and row of each pixel.
    pub fn pixels(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        self.runs.iter().flat_map(|run| (run.from..=run.to).map(|column| [column, run.row]))
    }
}

impl Bits {
    /// No pixel at all.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        let row_words = width.div_ceil(64);
        Self { width, height, row_words, words: vec![0; row_words * height] }
    }

    /// The pixels for which `is_meant` holds, by their number.
    #[must_use]
    pub fn of(width: usize, height: usize, is_meant: impl Fn(usize) -> bool) -> Self {
        let mut bits = Self::new(width, height);
        for row in 0..height {
            for (index, word) in bits.words[row * bits.row_words..][..bits.row_words].iter_mut().enumerate() {
                let first = 64 * index;
                for column in first..(first + 64).min(width) {
                    *word |= u64::from(is_meant(row * width + column)) << (column - first);
                }
            }
        }
        bits
    }

    /// Adds a pixel.
    pub fn set(&mut self, column: usize, row: usize) {
        self.words[row * self.row_words + column / 64] |= 1 << (column % 64);
    }

    /// Whether a pixel is meant; outside the image none is.
    #[must_use]
    pub fn get(&self, column: i64, row: i64) -> bool {
        if column < 0 || row < 0 || column >= self.width as i64 || row >= self.height as i64 {
            return false;
        }
        let (column, row) = (column as usize, row as usize);
        self.words[row * self.row_words + column / 64] >> (column % 64) & 1 == 1
    }

    /// Number of pixels.
    #[must_use]
    pub fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }

    /// Pixels that are meant, or a neighbour of which is: above, below, left or right.
    #[must_use]
    pub fn dilated(&self) -> Self {
        self.combined(0, |at, around| around.into_iter().fold(at, |all, word| all | word))
    }

    /// Pixels that are meant, as are their four neighbours; beyond the image's edge all counts as meant.
    #[must_use]
    pub fn eroded(&self) -> Self {
        self.combined(u64::MAX, |at, around| around.into_iter().fold(at, |all, word| all & word))
    }

    /// What is left of an erosion, grown again: thin and small things go.
    #[must_use]
    pub fn opened(&self, steps: usize) -> Self {
        let small = (0..steps).fold(self.clone(), |bits, _| bits.eroded());
        (0..steps).fold(small, |bits, _| bits.dilated())
    }

    /// What is left of a dilation, shrunk again: small holes go.
    #[must_use]
    pub fn closed(&self, steps: usize) -> Self {
        let large = (0..steps).fold(self.clone(), |bits, _| bits.dilated());
        (0..steps).fold(large, |bits, _| bits.eroded())
    }

    /// Each word combined with those of the pixels above, below, left and right; `outside` stands for what is beyond.
    fn combined(&self, outside: u64, combine: impl Fn(u64, [u64; 4]) -> u64) -> Self {
        let mut combined = Self::new(self.width, self.height);
        let last_bits = match self.width % 64 {
            0 => u64::MAX,
            rest => (1 << rest) - 1,
        };
        let word = |row: Option<usize>, index: usize| match row {
            Some(row) if row < self.height => {
                let beyond = if index + 1 == self.row_words { outside & !last_bits } else { 0 };
                self.words[row * self.row_words + index] | beyond
            }
            _ => outside,
        };
        for row in 0..self.height {
            for index in 0..self.row_words {
                let at = word(Some(row), index);
                let before = if index > 0 { word(Some(row), index - 1) } else { outside };
                let after = if index + 1 < self.row_words { word(Some(row), index + 1) } else { outside };
                let sides = [at << 1 | before >> 63, at >> 1 | after << 63];
                let rows = [word(row.checked_sub(1), index), word(Some(row + 1), index)];
                let value = combine(at, [sides[0], sides[1], rows[0], rows[1]]);
                let kept = if index + 1 == self.row_words { last_bits } else { u64::MAX };
                combined.words[row * self.row_words + index] = value & kept;
            }
        }
        combined
    }

    /// The patches of at least `least` pixels that hang together by sides or corners, in the order of their first pixels.
    #[must_use]
    pub fn patches(&self, least: usize) -> Vec<Patch> {
        let runs = self.runs();
        let mut roots: Vec<usize> = (0..runs.len()).collect();
        let mut above = 0..0;
        let mut start = 0;
        while start < runs.len() {
            let row = runs[start].row;
            let end = start + runs[start..].iter().take_while(|run| run.row == row).count();
            if above.end > above.start && runs[above.start].row + 1 == row {
                join_rows(&runs, above, start..end, &mut roots);
            }
            above = start..end;
            start = end;
        }
        let mut patches: Vec<Patch> = Vec::new();
        let mut place = vec![usize::MAX; runs.len()];
        for (index, run) in runs.iter().enumerate() {
            let root = root_of(&mut roots, index);
            if place[root] == usize::MAX {
                place[root] = patches.len();
                patches.push(Patch::default());
            }
            patches[place[root]].runs.push(*run);
        }
        patches.retain(|patch| patch.area() >= least);
        patches
    }

    fn runs(&self) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        for row in 0..self.height {
            for index in 0..self.row_words {
                let mut word = self.words[row * self.row_words + index];
                while word != 0 {
                    let skipped = word.trailing_zeros() as usize;
                    let length = (word >> skipped).trailing_ones() as usize;
                    let from = 64 * index + skipped;
                    match runs.last_mut() {
                        Some(run) if run.row == row && run.to + 1 == from => run.to += length,
                        _ => runs.push(Run { row, from, to: from + length - 1 }),
                    }
                    word = if skipped + length == 64 {
                        0
                    } else {
                        word >> (skipped + length) << (skipped + length)
                    };
                }
            }
        }
        runs
    }
}

/// Joins runs of two neighbouring rows that touch, also by a corner.
fn join_rows(
    runs: &[Run],
    above: std::ops::Range<usize>,
    below: std::ops::Range<usize>,
    roots: &mut [usize],
) {
    let (mut a, mut b) = (above.start, below.start);
    while a < above.end && b < below.end {
        if runs[a].from <= runs[b].to + 1 && runs[b].from <= runs[a].to + 1 {
            let (one, other) = (root_of(roots, a), root_of(roots, b));
            roots[one.max(other)] = one.min(other);
        }
        if runs[a].to < runs[b].to { a += 1 } else { b += 1 }
    }
}

fn root_of(roots: &mut [usize], mut index: usize) -> usize {
    while roots[index] != index {
        roots[index] = roots[roots[index]];
        index = roots[index];
    }
    index
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bits(rows: &[&str]) -> Bits {
        let width = rows[0].len();
        let text: Vec<u8> = rows.iter().flat_map(|row| row.bytes()).collect();
        Bits::of(width, rows.len(), |pixel| text[pixel] == b'#')
    }

    #[test]
    fn opening_takes_specks_and_keeps_what_reaches_the_edge() {
        let found = bits(&["##....", "##..#.", "##....", "......"]).opened(1);
        assert_eq!(found, bits(&["##....", "##....", "#.....", "......"]));
    }

    #[test]
    fn closing_fills_pinholes() {
        let found =
            bits(&[".......", ".......", "..###..", "..#.#..", "..###..", ".......", "......."]).closed(1);
        assert!(found.get(3, 3) && found.count() == 9);
    }

    #[test]
    fn dilation_is_erosion_of_the_rest() {
        for width in [3, 63, 64, 65, 130] {
            let some = Bits::of(width, 7, |pixel| pixel * 2654435761 % 7 < 2);
            let rest = Bits::of(width, 7, |pixel| pixel * 2654435761 % 7 >= 2);
            let (grown, shrunk) = (some.dilated(), rest.eroded());
            for pixel in 0..7 * width {
                let at = [(pixel % width) as i64, (pixel / width) as i64];
                assert_ne!(grown.get(at[0], at[1]), shrunk.get(at[0], at[1]), "{width}: {at:?}");
            }
        }
    }

    #[test]
    fn patches_hang_together_by_corners_too() {
        let found = bits(&["#..##", ".#...", "....#", "##..#"]).patches(2);
        let areas: Vec<usize> = found.iter().map(Patch::area).collect();
        assert_eq!(areas, [2, 2, 2, 2]);
        let fork = bits(&["#.#.#", "#.#.#", "#####"]).patches(1);
        assert_eq!((fork.len(), fork[0].area()), (1, 11));
        assert_eq!(bits(&["#.#", "...", "#.."]).patches(2), []);
    }

    #[test]
    fn runs_go_on_over_words() {
        let all = Bits::of(200, 1, |pixel| (60..140).contains(&pixel)).patches(1);
        assert_eq!(all[0].runs, [Run { row: 0, from: 60, to: 139 }]);
    }
}
