//! Normal maps over the texture coordinates.

use crate::frames::Frames;
use crate::sampling::{Corners, corners, sample};
use crate::{Error, Measured, Space};
use artifact::GreenAxis;
use mesh::{Mesh, NO_UV};
use nalgebra::{Vector2, Vector3};

/// A picture of unit vectors, `n = 2 c − 1` of its code values as shares of white; never sRGB. Row 0 is the top, where v = 1;
/// coordinates beyond the unit square repeat it.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalMap {
    width: usize,
    height: usize,
    /// Row after row; zero where the map says nothing.
    vectors: Vec<Vector3<f32>>,
}

/// Shorter and longer vectors are no normals: black, white and mid-grey texels are unset.
const LENGTHS: std::ops::Range<f32> = 0.5..1.5;
/// A map whose vectors' median length is off by more was not stored as plain data.
const LENGTH_TOLERANCE: f64 = 0.1;
/// Vectors within this of their mean are a flat map, degrees: four steps of 8 bits are 1.8°.
const FLAT_DEGREES: f64 = 1.0;
/// The other space fits if its mean angle is smaller by this factor and by this many degrees.
const FITS: (f64, f64) = (0.6, 5.0);
/// Normals that are off by more in the mean belong elsewhere, degrees.
const STRANGE_DEGREES: f64 = 60.0;

impl NormalMap {
    /// A map from its code values as shares of white, red, green, blue of each texel, row after row.
    ///
    /// # Errors
    /// [`Error::MapSize`]; [`Error::NothingMeasured`] where every texel is unset (black, white or grey); [`Error::NotUnit`].
    pub fn new(
        width: usize,
        height: usize,
        shares: impl ExactSizeIterator<Item = [f64; 3]>,
    ) -> Result<Self, Error> {
        if width == 0 || height == 0 || shares.len() != width * height {
            return Err(Error::MapSize { width, height, values: shares.len() });
        }
        let vector = |share: [f64; 3]| {
            let vector = Vector3::from(share.map(|share| (2.0 * share - 1.0) as f32));
            if LENGTHS.contains(&vector.norm()) { vector } else { Vector3::zeros() }
        };
        let vectors: Vec<Vector3<f32>> = shares.map(vector).collect();
        let mut lengths: Vec<f32> =
            vectors.iter().map(Vector3::norm).filter(|&length| length > 0.0).collect();
        if lengths.is_empty() {
            return Err(Error::NothingMeasured { why: "the map is black, white or grey all over" });
        }
        let middle = lengths.len() / 2;
        let median = f64::from(*lengths.select_nth_unstable_by(middle, f32::total_cmp).1);
        match (median - 1.0).abs() <= LENGTH_TOLERANCE {
            true => Ok(Self { width, height, vectors }),
            false => Err(Error::NotUnit { median }),
        }
    }

    /// Texels in a row, and rows.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The vector at a place, between those of the four nearest texels that are set; none where they are not.
    pub(crate) fn at(&self, uv: Vector2<f64>) -> Option<Vector3<f64>> {
        let (x, y) = (uv.x * self.width as f64 - 0.5, (1.0 - uv.y) * self.height as f64 - 0.5);
        let wrap = |i: f64, count: usize| i.rem_euclid(count as f64) as usize % count;
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let mut sum = Vector3::zeros();
        for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
            let share = (if dx == 0.0 { 1.0 - fx } else { fx }) * (if dy == 0.0 { 1.0 - fy } else { fy });
            let (column, row) = (wrap(x.floor() + dx, self.width), wrap(y.floor() + dy, self.height));
            sum += share * self.vectors[row * self.width + column].cast::<f64>();
        }
        sum.try_normalize(0.25)
    }

    /// The normals that the map gives a mesh's vertices, in the axes of its coordinates.
    ///
    /// `green` counts for tangent space only. Where the map is finer than the mesh, its texels under a vertex's triangles are
    /// averaged. Tangent frames are those of the mesh: normals weighted by angle, tangents along growing u, both smooth except at
    /// seams.
    ///
    /// # Errors
    /// [`Error::NoTextureCoordinates`]; [`Error::NothingMeasured`] where no vertex falls on a set texel; [`Error::Flat`];
    /// [`Error::OtherSpace`] where the map fits the scan in the other space; [`Error::Disagree`] where in neither.
    pub fn measure(&self, mesh: &Mesh, space: Space, green: GreenAxis) -> Result<Measured, Error> {
        if mesh.corner_uvs.iter().all(|&uv| uv == NO_UV) {
            return Err(Error::NoTextureCoordinates);
        }
        let corners = corners(mesh);
        let normals = mesh::vertex_normals(&mesh.positions, &mesh.triangles());
        let frames = Frames::of(mesh, &corners, &normals, green);
        let measured = self.measure_in(mesh, &corners, space, &frames)?;
        self.check_flat(space)?;
        let other = if space == Space::Object { Space::Tangent } else { Space::Object };
        let stated_degrees = measured.mean_degrees(&normals);
        let other_degrees = self.measure_in(mesh, &corners, other, &frames)?.mean_degrees(&normals);
        if other_degrees < FITS.0 * stated_degrees && other_degrees < stated_degrees - FITS.1 {
            return Err(Error::OtherSpace { stated: space, other, stated_degrees, other_degrees });
        }
        match stated_degrees > STRANGE_DEGREES {
            true => Err(Error::Disagree { degrees: stated_degrees }),
            false => Ok(measured),
        }
    }

    fn measure_in(
        &self,
        mesh: &Mesh,
        corners: &Corners,
        space: Space,
        frames: &Frames,
    ) -> Result<Measured, Error> {
        let (sums, shares) = sample(self, mesh, corners, |triangle, at, vector| match space {
            Space::Object => vector,
            Space::Tangent => frames.turn(triangle, at, vector),
        });
        let mut measured = Measured::per_vertex(sums).map_err(|_| Error::NothingMeasured {
            why: "the mesh's texture coordinates fall on unset texels only",
        })?;
        measured.weigh(&shares)?;
        Ok(measured)
    }

    /// Refuses a map that says the same everywhere.
    fn check_flat(&self, space: Space) -> Result<(), Error> {
        let set =
            || self.vectors.iter().filter(|vector| vector.norm_squared() > 0.0).map(|v| v.cast::<f64>());
        let mean = match space {
            Space::Tangent => Vector3::z(),
            Space::Object => set().sum(),
        };
        let degrees = set().map(|vector| vector.angle(&mean).to_degrees()).fold(0.0, f64::max);
        if degrees < FLAT_DEGREES { Err(Error::Flat { degrees }) } else { Ok(()) }
    }
}
