//! A block of numbers beside a document that says where each list begins.

use serde::Serialize;

/// Where a list stands in the block.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Span {
    /// First byte, a multiple of four.
    pub offset: usize,
    /// How many numbers of 32 bits.
    pub length: usize,
}

/// Lists of 32-bit numbers, little end first, one behind the other.
#[derive(Debug, Default)]
pub(crate) struct Block(pub(crate) Vec<u8>);

impl Block {
    pub(crate) fn floats(&mut self, values: impl IntoIterator<Item = f64>) -> Span {
        self.words(values.into_iter().map(|value| (value as f32).to_bits()))
    }

    pub(crate) fn words(&mut self, values: impl IntoIterator<Item = u32>) -> Span {
        let offset = self.0.len();
        values.into_iter().for_each(|value| self.0.extend(value.to_le_bytes()));
        Span { offset, length: (self.0.len() - offset) / 4 }
    }
}
