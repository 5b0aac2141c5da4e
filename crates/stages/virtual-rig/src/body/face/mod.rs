//! A synthetic face: an open mask with eyes and mouth cut out, that can speak, smile and blink.
//!
//! It is the truth for tests of the whole chain: it shares no code with any stage.

mod expression;
mod markers;
pub(super) mod outline;
mod person;
mod profile;
mod sampling;
pub(super) mod surface;
mod triangulation;

pub use expression::Weights;
pub use markers::Marker;
pub use person::Person;

use expression::Fields;
use mesh::{Label, LabelKind, Mesh, Polygons};
use nalgebra::{Point2, Point3, Vector2};
use outline::Region;

/// A face: millimetres, y up, looking along +z, the subject's left at +x, the origin below the nose.
#[derive(Debug, Clone)]
pub struct Face {
    person: Person,
    /// Per vertex its place on the unrolled face, mm.
    domain: Vec<Point2<f64>>,
    mesh: Mesh,
    fields: Fields,
}

impl Face {
    /// Vertices of a face as scanned.
    pub const VERTEX_COUNT: usize = 30_000;

    /// The face of a seed with about `vertex_count` vertices (500 to 300 000; within 10 %). The same arguments give
    /// the same face; seed 0 is the average face.
    #[must_use]
    pub fn new(seed: u64, vertex_count: usize) -> Self {
        let person = Person::of_seed(seed);
        let samples = sampling::sample(&person, seed, vertex_count.clamp(500, 300_000));
        let triangles = triangulation::triangulate(&samples);
        let mesh = grouped_mesh(&person, &samples, triangles);
        let fields = Fields::of(&person, &samples);
        Self { person, domain: samples.domain, mesh, fields }
    }

    /// The rest pose: triangles, texture coordinates (the unrolled face), groups.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The true surface of an expression: one point per vertex, mm, the head at rest.
    #[must_use]
    pub fn deform(&self, weights: &Weights) -> Vec<Point3<f64>> {
        self.fields.deform(&self.mesh.positions, weights)
    }

    /// 85 markers on vertices: 8 on the lips, 4 on the lids, the rest spread over the face, closer around the mouth
    /// and the eyes.
    #[must_use]
    pub fn markers(&self) -> Vec<Marker> {
        markers::place(&self.person, &self.domain, &self.mesh.positions)
    }

    /// The rest positions of five markers on a headband over the forehead, mm; they move with the head only.
    #[must_use]
    pub fn headband(&self) -> Vec<(String, Point3<f64>)> {
        markers::headband(&self.person)
    }

    /// Whose face it is.
    #[must_use]
    pub fn person(&self) -> &Person {
        &self.person
    }
}

/// The mesh, its triangles ordered by group.
fn grouped_mesh(person: &Person, samples: &sampling::Samples, mut triangles: Vec<[u32; 3]>) -> Mesh {
    let region = |triangle: &[u32; 3]| {
        let middle =
            triangle.iter().fold(Vector2::zeros(), |sum, &i| sum + samples.domain[i as usize].coords / 3.0);
        Region::of(person, middle.into())
    };
    triangles.sort_by_cached_key(region);
    let mut labels: Vec<Label> = Vec::new();
    for (first_face, triangle) in triangles.iter().enumerate() {
        let name = region(triangle).name();
        if labels.last().is_none_or(|label| label.name != name) {
            labels.push(Label { first_face, kind: LabelKind::Group, name: name.to_string() });
        }
    }
    let mut polygons = Polygons::default();
    triangles.iter().for_each(|triangle| polygons.push(triangle));
    Mesh {
        positions: samples.space.clone(),
        polygons,
        uvs: samples.domain.iter().map(texture_coordinate).collect(),
        corner_uvs: triangles.into_iter().flatten().collect(),
        colors: Vec::new(),
        labels,
    }
}

/// The unrolled face on the unit square, one scale for both axes.
fn texture_coordinate(at: &Point2<f64>) -> Vector2<f64> {
    const SPAN: f64 = 215.0;
    Vector2::new(at.x / SPAN + 0.5, (at.y - 11.0) / SPAN + 0.5)
}
