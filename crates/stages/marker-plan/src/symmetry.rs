//! The plane that a face is most nearly the mirror image of itself across.

use crate::Frame;
use mesh::Mesh;
use nalgebra::{Matrix3, Point3, Vector3};
use rayon::prelude::*;

/// Rounds of matching.
const ROUNDS: usize = 8;
/// Points that are mirrored.
const SAMPLES: usize = 400;
/// Points among which their images are looked for.
const AGAINST: usize = 20_000;
/// Share of the pairs that count: the nearest ones, so that a scar or a mole turns nothing.
const SHARE: f64 = 0.8;

/// Turns and shifts the frame so that its plane x = 0 mirrors the skin best, by matching mirrored points to nearest points
/// [BeslMcKay1992]; returns the root mean square distance that is left, mm.
pub(crate) fn refine(mesh: &Mesh, skin: &[u32], frame: Frame) -> (Frame, f64) {
    let thin = |most: usize| skin.iter().step_by(skin.len().div_ceil(most).max(1)).copied();
    let mut frame = frame;
    let mut rms = 0.0;
    for _ in 0..ROUNDS {
        let places = |vertices: Vec<u32>| -> Vec<Vector3<f64>> {
            vertices.into_iter().map(|vertex| frame.place(&mesh.positions[vertex as usize])).collect()
        };
        let (samples, against) = (places(thin(SAMPLES).collect()), places(thin(AGAINST).collect()));
        let pair = |p: &Vector3<f64>| {
            let image = mirrored(*p);
            let nearest = against
                .iter()
                .min_by(|a, b| (*a - image).norm_squared().total_cmp(&(*b - image).norm_squared()));
            nearest.map(|q| ((q - image).norm_squared(), *p, *q))
        };
        let mut pairs: Vec<_> = samples.par_iter().filter_map(pair).collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        pairs.truncate(((pairs.len() as f64 * SHARE).ceil() as usize).max(1));
        rms = (pairs.iter().map(|pair| pair.0).sum::<f64>() / pairs.len() as f64).sqrt();
        let (normal, offset) = plane(&pairs);
        frame = frame.with_mirror(normal, offset);
    }
    (frame, rms)
}

/// The mirror plane between points and their partners: the direction in which their products are most negative.
fn plane(pairs: &[(f64, Vector3<f64>, Vector3<f64>)]) -> (Vector3<f64>, f64) {
    let count = pairs.len() as f64;
    let p = pairs.iter().map(|pair| pair.1).sum::<Vector3<f64>>() / count;
    let q = pairs.iter().map(|pair| pair.2).sum::<Vector3<f64>>() / count;
    let products: Matrix3<f64> = pairs
        .iter()
        .map(|pair| (pair.1 - p) * (pair.2 - q).transpose())
        .fold(Matrix3::zeros(), |sum, x| sum + x);
    let eigen = (products + products.transpose()).symmetric_eigen();
    let normal: Vector3<f64> = eigen.eigenvectors.column(eigen.eigenvalues.imin()).into();
    let normal = if normal.x < 0.0 { -normal } else { normal };
    (normal, 0.5 * normal.dot(&(p + q)))
}

/// The mirror image, in the face's coordinates.
pub(crate) fn mirrored(place: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(-place.x, place.y, place.z)
}

/// The nearest of some vertices to a place in the face's coordinates, with its distance, mm.
pub(crate) fn nearest(
    points: &[Point3<f64>],
    among: &[u32],
    frame: &Frame,
    place: Vector3<f64>,
) -> Option<(u32, f64)> {
    let apart = |&vertex: &u32| (vertex, (frame.place(&points[vertex as usize]) - place).norm());
    among.iter().map(apart).min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)))
}
