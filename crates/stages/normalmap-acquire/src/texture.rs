//! The map brought into a character's texture [DutreveMeyer2011, Sec. 3.2].

use crate::Error;
use crate::acquire::Acquired;
use crate::plane::Plane;
use crate::warp::{Field, Pair, Warp};
use nalgebra::Vector2;

/// A normal map in texture space.
#[derive(Debug, Clone)]
pub struct Textured {
    /// Unit normals: x along u, y along v (up), z outwards.
    pub normals: [Plane; 3],
    /// Heights, px of the photograph.
    pub height: Plane,
    /// Texels to which the photograph has something to say, 0–1.
    pub weight: Plane,
    /// Texels among them in which the warp folds; they are left flat.
    pub folded: usize,
}

/// Looks the map up for each texel of a texture.
///
/// `pairs` lead from texels to the photograph. With J the Jacobian of that warp, slopes become `Jᵀ ∇h / √|det J|`: normals transform by the inverse
/// transpose of the way from photograph to texture, and a mere change of scale leaves them as they are.
///
/// # Errors
/// If landmarks are too few or lie on a line.
pub fn textured(
    found: &Acquired,
    pairs: &[Pair],
    width: usize,
    height: usize,
    smoothing: f64,
) -> Result<Textured, Error> {
    let scale = texture_spread(pairs);
    let field = Field::of(&Warp::fit(pairs, scale, smoothing)?, [0, 0], width, height);
    let size = [found.weight.width, found.weight.height];
    let covered = field.covered(size[0], size[1]);
    let places: Vec<[f64; 2]> = pairs.iter().map(|pair| pair.from).collect();
    let outline = crate::mask::inside(&crate::mask::hull(&places), [0, 0], width, height);
    let inner = covered.with(&outline, |covered, inside| covered * inside);
    let folds = field.folds().with(&inner, |fold, inner| fold * inner);
    let weight = Plane::from_fn(width, height, |column, row| {
        let shown = inner.at(column, row) * (1.0 - folds.at(column, row));
        if shown > 0.0 {
            found.weight.bilinear(field.x.at(column, row), field.y.at(column, row))
        } else {
            0.0
        }
    });
    let [nx, ny, nz] = &found.normals;
    let slope = |axis: usize| {
        Plane::from_fn(width, height, |column, row| {
            if weight.at(column, row) <= 0.0 {
                return 0.0;
            }
            let (x, y) = (field.x.at(column, row), field.y.at(column, row));
            let z = nz.bilinear(x, y).max(0.05);
            // Of the photograph: x right, y down.
            let there = Vector2::new(-nx.bilinear(x, y) / z, ny.bilinear(x, y) / z);
            let jacobian = field.jacobian(column, row);
            let here = jacobian.transpose() * there / jacobian.determinant().abs().sqrt().max(1e-9);
            here[axis]
        })
    };
    let (x, y) = (slope(0), slope(1));
    let z = x.with(&y, |x, y| 1.0 / (1.0 + x * x + y * y).sqrt());
    let lift = |column: usize, row: usize| match (&found.height, weight.at(column, row) > 0.0) {
        (Some(height), true) => height.bilinear(field.x.at(column, row), field.y.at(column, row)),
        _ => 0.0,
    };
    Ok(Textured {
        height: Plane::from_fn(width, height, lift),
        normals: [x.with(&z, |x, z| -x * z), y.with(&z, |y, z| y * z), z],
        folded: folds.values.iter().filter(|fold| **fold > 0.0).count(),
        weight,
    })
}

/// Root mean square distance of the landmarks from their middle in the texture, texels.
#[must_use]
pub fn texture_spread(pairs: &[Pair]) -> f64 {
    let count = pairs.len().max(1) as f64;
    let middle = [0, 1].map(|axis| pairs.iter().map(|pair| pair.from[axis]).sum::<f64>() / count);
    let square = |pair: &Pair| (pair.from[0] - middle[0]).powi(2) + (pair.from[1] - middle[1]).powi(2);
    (pairs.iter().map(square).sum::<f64>() / count).sqrt().max(1e-9)
}
