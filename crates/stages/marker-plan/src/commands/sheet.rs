//! The picture for whoever paints: the face from three sides, with numbered dots.

use artifact::Staged;
use artifact::canvas::{Canvas, Color};
use marker_plan::{NOTHING, Plan, Raster, View};
use mesh::Mesh;
use nalgebra::{Point3, Vector3};
use std::path::Path;

/// Yaw of the views, degrees: the face's own right side, front, left side.
const YAWS: [f64; 3] = [-50.0, 0.0, 50.0];
/// Pixel, mm.
const PIXEL_MM: f64 = 0.33;
/// What is shown, in eye distances from the point between the eyes: to either side, up, down.
const REACH: [f64; 3] = [1.75, 1.35, 2.45];
/// Dots, px: half their width.
const DOT: f64 = 4.6;
/// Room above the views, px.
const HEAD: usize = 34;

const INK: Color = [30, 34, 40];
const SKIN: [f64; 3] = [232.0, 216.0, 204.0];
const FEATURE: Color = [196, 52, 48];
const OTHER: Color = [32, 84, 190];

/// Draws the plan.
pub(crate) fn draw(path: &Path, plan: &Plan, mesh: &Mesh) -> anyhow::Result<Staged> {
    let triangles = mesh.triangles();
    let normals = mesh::vertex_normals(&mesh.positions, &triangles);
    let normals: Vec<Vector3<f64>> = normals.iter().map(|normal| plan.frame.turn(normal)).collect();
    let eyes = plan.frame.eye_distance_mm;
    let bounds = [[-REACH[0] * eyes, -REACH[2] * eyes], [REACH[0] * eyes, REACH[1] * eyes]];
    let rasters: Vec<Raster> = YAWS
        .iter()
        .map(|&yaw| {
            Raster::new(&mesh.positions, &triangles, &plan.frame, View::degrees(yaw, 0.0), bounds, PIXEL_MM)
        })
        .collect();
    let (width, height) = (rasters.iter().map(|raster| raster.width).sum(), rasters[0].height + HEAD);
    let mut canvas = Canvas::new(width, height)?;
    let mut left = 0;
    for (raster, title) in rasters.iter().zip(["the face's right", "front", "the face's left"]) {
        shade(&mut canvas, raster, &triangles, &normals, left);
        canvas.write(title, [left + 10, 8], INK);
        for (number, marker) in plan.markers.iter().enumerate() {
            if raster.facing(&normals[marker.vertex as usize]) > 0.2
                && raster.sees(marker.vertex, &normals[marker.vertex as usize])
            {
                let color = if marker.marker.starts_with("li") { FEATURE } else { OTHER };
                dot(&mut canvas, raster.places[marker.vertex as usize], (number + 1, color), left);
            }
        }
        left += raster.width;
    }
    let note = format!(
        "{} markers; red: beside the edges of lips and lids, blue: the rest; numbers are the lines of the list",
        plan.markers.len()
    );
    canvas.write(&note, [rasters[0].width + 60, 8], INK);
    Ok(artifact::picture::write_rgb8(path, canvas.width, canvas.height, &canvas.rgb)?)
}

/// The skin under a light from the upper left.
fn shade(
    canvas: &mut Canvas,
    raster: &Raster,
    triangles: &[[u32; 3]],
    normals: &[Vector3<f64>],
    left: usize,
) {
    let light = Vector3::new(-0.35, 0.5, 0.8).normalize();
    for (at, &triangle) in raster.triangles.iter().enumerate() {
        if triangle == NOTHING {
            continue;
        }
        let pixel = [at % raster.width, at / raster.width];
        let shares = shares(raster, triangles[triangle as usize], pixel);
        let corners = triangles[triangle as usize];
        let normal: Vector3<f64> = (0..3).map(|i| shares[i] * normals[corners[i] as usize]).sum();
        let normal = normal.try_normalize(0.0).unwrap_or_default();
        let level = 0.42 + 0.58 * raster.turn(&normal).dot(&light).max(0.0);
        let color = SKIN.map(|channel| (channel * level).clamp(0.0, 255.0) as u8);
        canvas.fill([left + pixel[0], HEAD + pixel[1]], [1, 1], color);
    }
}

/// Barycentric coordinates of a pixel's middle.
fn shares(raster: &Raster, corners: [u32; 3], [column, row]: [usize; 2]) -> [f64; 3] {
    let [a, b, c] = corners.map(|vertex| raster.places[vertex as usize]);
    let at = Point3::new(column as f64 + 0.5, row as f64 + 0.5, 0.0);
    let area = |p: Vector3<f64>, q: Vector3<f64>| (p.x - at.x) * (q.y - at.y) - (p.y - at.y) * (q.x - at.x);
    let areas = [area(b, c), area(c, a), area(a, b)];
    let sum: f64 = areas.iter().sum();
    areas.map(|area| area / sum)
}

/// A dot with its number beside it.
fn dot(canvas: &mut Canvas, place: Vector3<f64>, (number, color): (usize, Color), left: usize) {
    let middle = [place.x + left as f64, place.y + HEAD as f64];
    let reach = DOT.ceil() as i64 + 1;
    for dy in -reach..=reach {
        for dx in -reach..=reach {
            let (x, y) = (middle[0].floor() as i64 + dx, middle[1].floor() as i64 + dy);
            let far = (x as f64 + 0.5 - middle[0]).hypot(y as f64 + 0.5 - middle[1]);
            if x >= 0 && y >= 0 && far <= DOT + 1.0 {
                let color = if far <= DOT { color } else { [255, 255, 255] };
                canvas.fill([x as usize, y as usize], [1, 1], color);
            }
        }
    }
    let text = number.to_string();
    let at = [(middle[0] + DOT + 2.0).max(0.0) as usize, (middle[1] - 8.0).max(0.0) as usize];
    canvas.write(&text, at, INK);
}
