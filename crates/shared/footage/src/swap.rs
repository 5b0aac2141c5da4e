//! OpenCV's order of channels is blue, green, red.

/// Copies pixels with red and blue changed over.
pub(crate) fn swap_red_blue(from: &[u8], to: &mut [u8]) {
    for (from, to) in from.chunks_exact(3).zip(to.chunks_exact_mut(3)) {
        to.copy_from_slice(&[from[2], from[1], from[0]]);
    }
}
