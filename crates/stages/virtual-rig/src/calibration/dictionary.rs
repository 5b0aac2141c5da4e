//! The markers of ArUco's dictionary `4X4_50`.

/// Cells along a marker: 4 bits between two black borders.
pub(super) const MARKER_CELLS: usize = 6;

/// The 16 bits of each marker, row after row from the top left, most significant bit first, 1 is white: OpenCV's
/// `DICT_4X4_50`, as its `generateImageMarker` draws it.
const BITS: [u16; 50] = [
    0xb532, 0x0f9a, 0x332d, 0x9946, 0x549e, 0x79cd, 0x9e2e, 0xc4f2, 0xfeda, 0xcf56, 0xf991, 0x11a7, 0x0eb7,
    0x2a0f, 0x24b1, 0x263e, 0x4665, 0x6600, 0x6c5e, 0x76af, 0x868b, 0xb02b, 0xccd5, 0xdd82, 0xfe47, 0x9471,
    0xace4, 0xa554, 0x2123, 0x346f, 0x4415, 0x57b2, 0x9ecf, 0xf0cb, 0x08ae, 0x0929, 0x1875, 0x04ff, 0x0df6,
    0x1c5a, 0x1718, 0x2a28, 0x328c, 0x38b2, 0x24e8, 0x2eeb, 0x2d3f, 0x4b64, 0x502e, 0x5013,
];

/// How many markers there are.
pub(super) const MARKER_COUNT: usize = BITS.len();

/// Whether a cell of a marker is white; `column` and `row` from 0 at the top left, the border included.
pub(super) fn is_white(marker: usize, column: usize, row: usize) -> bool {
    let inside = 1..MARKER_CELLS - 1;
    let bit = |x: usize, y: usize| BITS[marker] >> (15 - (4 * y + x)) & 1 == 1;
    inside.contains(&column) && inside.contains(&row) && bit(column - 1, row - 1)
}
