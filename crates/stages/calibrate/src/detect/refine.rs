//! Corners to where the gradients around them meet.

use super::DetectError;
use opencv::core::{Point2f, Size, TermCriteria, TermCriteria_Type, ToInputArray, Vector};
use opencv::imgproc::corner_sub_pix;
use opencv::prelude::VectorToVec;

/// Share of the distance to the nearest neighbour that the window around a corner of plain squares reaches.
pub(super) const OF_SQUARES: f32 = 0.4;
/// Reach of the window, px: fewer pixels are all noise, more only cost time.
const WINDOW_PX: std::ops::RangeInclusive<i32> = 2..=8;

/// The least distance between two corners, px.
pub(super) fn nearest(corners: &[Point2f]) -> f32 {
    let apart = |(i, at): (usize, &Point2f)| {
        let distance = |other: &Point2f| (other.x - at.x).hypot(other.y - at.y);
        corners[i + 1..].iter().map(distance).fold(f32::INFINITY, f32::min)
    };
    corners.iter().enumerate().map(apart).fold(f32::INFINITY, f32::min)
}

/// Corners moved to where the gradients in a window around them, which reaches a share of the way to the nearest neighbour, are
/// at right angles to the way to them.
pub(super) fn refine(
    image: &impl ToInputArray,
    corners: &[Point2f],
    share: f32,
) -> Result<Vec<Point2f>, DetectError> {
    if corners.is_empty() {
        return Ok(Vec::new());
    }
    let reach = (share * nearest(corners)) as i32;
    let reach = reach.clamp(*WINDOW_PX.start(), *WINDOW_PX.end());
    let (steps, enough) = (100, 1e-4);
    let kind = TermCriteria_Type::COUNT as i32 + TermCriteria_Type::EPS as i32;
    let stop = TermCriteria::new(kind, steps, enough)?;
    let mut fine: Vector<Point2f> = corners.iter().copied().collect();
    corner_sub_pix(image, &mut fine, Size::new(reach, reach), Size::new(-1, -1), stop)?;
    Ok(fine.to_vec())
}
