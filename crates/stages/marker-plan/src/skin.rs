//! Where a dot can be painted and seen: open skin of the face.

use crate::face::Rims;
use crate::geodesic;
use crate::raster::{Raster, View};
use crate::{Frame, Params};
use mesh::{Connectivity, Mesh};
use nalgebra::Vector3;
use rayon::prelude::*;

/// The face within a head, in eye distances from the point between the eyes: half its width, …
const HALF_WIDTH: f64 = 1.2;
/// … how far it reaches up to the hair line, …
const UP: f64 = 1.05;
/// … down over the chin, …
const DOWN: f64 = 2.25;
/// … and how far it reaches back, to the ears.
const BACK: f64 = 1.0;
/// Its outskirts begin this far back, beside the ears, …
const BESIDE: f64 = 0.75;
/// … and at the throat: below this height, …
const JAW: f64 = 1.0;
/// … where the upward part of the normal falls below this, and below all of the chin.
const THROAT: f64 = -0.5;
const CHIN: f64 = 1.95;
/// Views that skin is looked at from, degrees of yaw and pitch.
const VIEWS: [[f64; 2]; 9] = [
    [0., 0.],
    [35., 0.],
    [-35., 0.],
    [65., 0.],
    [-65., 0.],
    [0., 30.],
    [0., -30.],
    [35., -25.],
    [-35., -25.],
];
/// Cosine of the largest angle to a view from which a dot is measured well.
const FACING: f64 = 0.34;
/// Share of the views it faces from which a place must be seen; nostrils and folds are hidden from most.
const OPENNESS: f64 = 0.85;
/// Pixel of the views, mm.
const PIXEL_MM: f64 = 0.5;

/// What is known of a scan's skin.
pub(crate) struct Skin {
    /// Vertices of the face that can be painted on and seen, away from the scan's border; rising.
    pub(crate) open: Vec<u32>,
    /// Per vertex whether it can be seen from the front.
    pub(crate) frontal: Vec<bool>,
    /// Per vertex whether it lies beside the face proper: at the throat, the jaw's angle, before the ears.
    pub(crate) outskirts: Vec<bool>,
}

/// Looks at the face from several sides.
pub(crate) fn look(
    mesh: &Mesh,
    triangles: &[[u32; 3]],
    around: &Connectivity,
    normals: &[Vector3<f64>],
    (rims, frame): (&Rims, &Frame),
    params: &Params,
) -> Skin {
    let points = &mesh.positions;
    let reach = 2.6 * frame.eye_distance_mm;
    let bounds = [[-reach, -reach - frame.eye_distance_mm], [reach, reach]];
    let normals: Vec<Vector3<f64>> = normals.iter().map(|normal| frame.turn(normal)).collect();
    let views: Vec<Vec<Option<bool>>> = VIEWS
        .par_iter()
        .map(|&[yaw, pitch]| {
            let raster = Raster::new(points, triangles, frame, View::degrees(yaw, pitch), bounds, PIXEL_MM);
            let seen = |(vertex, normal): (usize, &Vector3<f64>)| {
                (raster.facing(normal) > FACING).then(|| raster.sees(vertex as u32, normal))
            };
            normals.iter().enumerate().map(seen).collect()
        })
        .collect();
    let frontal: Vec<bool> = views[0].iter().map(|seen| *seen == Some(true)).collect();
    let rim = geodesic::outer_rims(around, &[&rims.mouth, &rims.eyes[0], &rims.eyes[1]]);
    let from_rim = geodesic::distances(points, triangles, &rim);
    let in_face = |vertex: usize| {
        let place = frame.place(&points[vertex]) / frame.eye_distance_mm;
        let [x, y] = [place.x, place.y];
        if place.z < -BACK {
            return false;
        }
        // An oval below, a bow above.
        let height = if y > 0.0 { y / UP } else { y / DOWN };
        (x / HALF_WIDTH).powi(4) + height.powi(4) <= 1.0
    };
    let open_skin = |vertex: &u32| {
        let at = *vertex as usize;
        let faced: Vec<bool> = views.iter().filter_map(|view| view[at]).collect();
        let seen = faced.iter().filter(|&&seen| seen).count();
        let open = !faced.is_empty() && seen as f64 >= OPENNESS * faced.len() as f64;
        open && from_rim[at] >= params.border_mm && from_rim[at] > 0.0 && in_face(at)
    };
    let open: Vec<u32> = (0..points.len() as u32).filter(open_skin).collect();
    let outskirts = (0..points.len())
        .map(|vertex| {
            let place = frame.place(&points[vertex]) / frame.eye_distance_mm;
            let throat = place.y < -CHIN || (place.y < -JAW && normals[vertex].y < THROAT);
            throat || place.z < -BESIDE
        })
        .collect();
    Skin { open, frontal, outskirts }
}
