//! Numbers as other processors wrote them: the file is brought to Intel's encoding, then read like any other.

use super::layout::Storage;
use super::{BLOCK, INTEL, real, word};

/// A processor whose numbers are not Intel's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Foreign {
    /// DEC (VAX): integers as Intel's, reals of F format.
    Dec,
    /// SGI (MIPS): everything the other way round.
    Sgi,
}

/// Bytes of the header that are words and reals, up to the first event.
const HEADER_WORDS: [usize; 7] = [2, 4, 6, 8, 10, 16, 18];
const HEADER_REALS: [usize; 2] = [12, 20];

impl Foreign {
    /// The same file in Intel's encoding; `section` is where its parameter section starts. What is malformed stays so.
    pub(super) fn to_intel(self, bytes: &[u8], section: usize) -> Vec<u8> {
        let mut bytes = bytes.to_vec();
        HEADER_WORDS.into_iter().for_each(|at| self.integers(&mut bytes, at, at + 2));
        HEADER_REALS.into_iter().for_each(|at| self.reals(&mut bytes, at, at + 4));
        self.parameters(&mut bytes, section + 4);
        if let Some(processor) = bytes.get_mut(section + 3) {
            *processor = INTEL;
        }
        let start = usize::from(word(&bytes, 16)).saturating_sub(1) * BLOCK;
        let end = bytes.len();
        match Storage::of_scale(real(&bytes, 12)) {
            Storage::Integer => self.integers(&mut bytes, start, end),
            Storage::Real => self.reals(&mut bytes, start, end),
        }
        bytes
    }

    /// Follows the list as [`super::parameters`] does.
    fn parameters(self, bytes: &mut [u8], mut at: usize) {
        while let Some(&[length, id]) = bytes.get(at..at + 2) {
            let link = at + 2 + usize::from((length as i8).unsigned_abs());
            if length == 0 || bytes.len() < link + 4 {
                return;
            }
            self.integers(bytes, link, link + 2);
            let next = match usize::from(word(bytes, link)) {
                0 => bytes.len(),
                distance => link + distance,
            };
            if id as i8 > 0 {
                let (kind, start) = (bytes[link + 2], link + 4 + usize::from(bytes[link + 3]));
                let sizes = bytes.get(link + 4..start).unwrap_or_default();
                let count: usize = sizes.iter().map(|&size| usize::from(size)).product();
                match kind {
                    2 => self.integers(bytes, start, start.saturating_add(2 * count)),
                    4 => self.reals(bytes, start, start.saturating_add(4 * count)),
                    _ => {}
                }
            }
            if next <= at || next == bytes.len() {
                return;
            }
            at = next;
        }
    }

    fn integers(self, bytes: &mut [u8], start: usize, end: usize) {
        if self == Self::Sgi {
            within(bytes, start, end).chunks_exact_mut(2).for_each(<[u8]>::reverse);
        }
    }

    fn reals(self, bytes: &mut [u8], start: usize, end: usize) {
        let chunks = within(bytes, start, end).chunks_exact_mut(4);
        match self {
            Self::Sgi => chunks.for_each(<[u8]>::reverse),
            Self::Dec => chunks.for_each(|real| {
                // F format: 16-bit halves changed over, an exponent that is larger by 2; exponent 0 is the number 0.
                real.rotate_left(2);
                let value = f32::from_le_bytes([real[0], real[1], real[2], real[3]]);
                let value = if value.is_subnormal() { 0.0 } else { value / 4.0 };
                real.copy_from_slice(&value.to_le_bytes());
            }),
        }
    }
}

fn within(bytes: &mut [u8], start: usize, end: usize) -> &mut [u8] {
    let end = end.min(bytes.len());
    &mut bytes[start.min(end)..end]
}
