//! Marker dots: discs on vertices that the camera sees.

use crate::occlusion::Depth;
use crate::raster::Projected;
use camera::Pinhole;
use image::{Rgb, RgbImage};

/// Radius as a share of the picture's smaller side, and its least value in pixels.
const RADIUS_SHARE: f64 = 0.0058;
const RADIUS_PX: f64 = 2.2;
/// Width of the pale ring, as a share of the radius.
const RING: f64 = 0.35;
const DOT: [u8; 3] = [214, 40, 57];
const PALE: [u8; 3] = [255, 255, 255];
/// A vertex counts as seen up to this share of its depth behind what the pixel sees.
const BEHIND: f32 = 0.004;
/// Least cosine between normal and view: dots at the silhouette would hang in the air.
const COSINE_MIN: f32 = 0.08;

pub(crate) fn draw(picture: &mut RgbImage, projected: &Projected, depth: &[Depth], camera: &Pinhole) {
    let (width, height) = picture.dimensions();
    let radius = (RADIUS_SHARE * f64::from(width.min(height))).max(RADIUS_PX);
    for &vertex in &projected.surface.dots {
        let point = projected.points[vertex as usize];
        let image = point.xy().coords / point.z * camera.focal_px + camera.center_px;
        let inside = image.x >= 0.0 && image.y >= 0.0;
        let (column, row) = (image.x.round() as u32, image.y.round() as u32);
        if point.z <= 0.0 || !inside || column >= width || row >= height {
            continue;
        }
        let toward_camera = -point.coords.cast::<f32>().normalize();
        let faces = projected.normals[vertex as usize].dot(&toward_camera) > COSINE_MIN;
        let seen = depth[(row * width + column) as usize].z;
        if faces && seen > 0.0 && point.z as f32 <= seen * (1.0 + BEHIND) {
            disc(picture, [image.x, image.y], radius * (1.0 + RING), PALE);
            disc(picture, [image.x, image.y], radius, DOT);
        }
    }
}

/// A filled circle with soft edges.
fn disc(picture: &mut RgbImage, center: [f64; 2], radius: f64, color: [u8; 3]) {
    let first = |middle: f64| (middle - radius - 1.0).floor().max(0.0) as u32;
    let last = |middle: f64, side: u32| ((middle + radius + 1.0).ceil() as u32).min(side - 1);
    for row in first(center[1])..=last(center[1], picture.height()) {
        for column in first(center[0])..=last(center[0], picture.width()) {
            let distance = (f64::from(column) - center[0]).hypot(f64::from(row) - center[1]);
            let cover = (radius + 0.5 - distance).clamp(0.0, 1.0);
            blend(picture.get_pixel_mut(column, row), color, cover);
        }
    }
}

/// Covers a share of a pixel with a colour.
pub(crate) fn blend(pixel: &mut Rgb<u8>, color: [u8; 3], cover: f64) {
    for (value, target) in pixel.0.iter_mut().zip(color) {
        *value = (f64::from(*value) + (f64::from(target) - f64::from(*value)) * cover).round() as u8;
    }
}
