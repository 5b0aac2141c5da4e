//! Where the wrinkles are: painted, listed, or along valleys that were measured.

use crate::Error;
use mesh::{Mesh, NO_UV};
use nalgebra::Vector2;

/// A grey picture over the texture coordinates, bright where wrinkles are. Row 0 is the top, where v = 1; coordinates beyond the
/// unit square repeat it.
#[derive(Debug, Clone, PartialEq)]
pub struct Mask {
    /// Texels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Brightness 0–1, row after row.
    pub texels: Vec<f64>,
}

impl Mask {
    /// Brightness at a place, between the four nearest texel centres.
    fn at(&self, uv: Vector2<f64>) -> f64 {
        let (x, y) = (uv.x * self.width as f64 - 0.5, (1.0 - uv.y) * self.height as f64 - 0.5);
        let wrap = |i: f64, count: usize| i.rem_euclid(count as f64) as usize % count;
        let texel = |dx: f64, dy: f64| {
            let (column, row) = (wrap(x.floor() + dx, self.width), wrap(y.floor() + dy, self.height));
            self.texels[row * self.width + column]
        };
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let row = |dy: f64| (1.0 - fx) * texel(0.0, dy) + fx * texel(1.0, dy);
        (1.0 - fy) * row(0.0) + fy * row(1.0)
    }
}

/// Brightness below this is the black of a lossy picture.
const BLACK: f64 = 4.0 / 255.0;

/// Weights of a painted region: per vertex the brightness at its texture coordinate, the greatest where a seam gives it several.
///
/// # Errors
/// [`Error::NoTextureCoordinates`], [`Error::MaskSize`]; [`Error::EmptyRegion`] where the mask is black at every vertex.
pub fn painted(mesh: &Mesh, mask: &Mask) -> Result<Vec<f64>, Error> {
    if mesh.corner_uvs.iter().all(|&uv| uv == NO_UV) {
        return Err(Error::NoTextureCoordinates);
    }
    if mask.width == 0 || mask.height == 0 || mask.width * mask.height != mask.texels.len() {
        let (width, height, texels) = (mask.width, mask.height, mask.texels.len());
        return Err(Error::MaskSize { width, height, texels });
    }
    let mut weights = vec![0.0f64; mesh.positions.len()];
    for (&vertex, &uv) in mesh.polygons.corners().iter().zip(&mesh.corner_uvs).filter(|(_, uv)| **uv != NO_UV)
    {
        let brightness = mask.at(mesh.uvs[uv as usize]);
        let weight = &mut weights[vertex as usize];
        *weight = if brightness > BLACK { weight.max(brightness) } else { *weight };
    }
    match weights.iter().any(|&weight| weight > 0.0) {
        true => Ok(weights),
        false => {
            Err(Error::EmptyRegion { why: "the mask is black at all of them; wrinkles are painted bright" })
        }
    }
}

/// Weights of a listed region: 1 at the vertices, 0-based.
///
/// # Errors
/// [`Error::UnknownVertex`], [`Error::EmptyRegion`].
pub fn listed(mesh: &Mesh, vertices: &[u32]) -> Result<Vec<f64>, Error> {
    let vertex_count = mesh.positions.len();
    if vertices.is_empty() {
        return Err(Error::EmptyRegion { why: "the list of vertices is empty" });
    }
    let mut weights = vec![0.0; vertex_count];
    for &vertex in vertices {
        *weights.get_mut(vertex as usize).ok_or(Error::UnknownVertex { vertex, vertex_count })? = 1.0;
    }
    Ok(weights)
}
