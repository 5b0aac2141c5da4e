//! A synthetic face: an open mask with eyes and mouth cut out, as a smooth map from the unrolled face.

mod markers;
mod noise;
mod order;
pub(super) mod outline;
mod person;
pub(super) mod profile;
mod refined;
pub use refined::Fineness;
pub(super) use refined::{BISECTED, Near};
mod sampling;
pub(super) mod skin;
pub(super) mod surface;
mod triangulation;

pub use markers::MarkerPlace;
pub use person::Person;

pub(super) use markers::{headband, markers};

use mesh::{Label, LabelKind, Mesh, Polygons};
use nalgebra::{Point2, Vector2};
use outline::Region;

/// A face at rest.
#[derive(Debug, Clone)]
pub(super) struct Face {
    pub(super) person: Person,
    /// Per vertex its place on the unrolled face, mm.
    pub(super) domain: Vec<Point2<f64>>,
    pub(super) mesh: Mesh,
}

impl Face {
    /// The face of a seed with about `vertex_count` vertices (within 10 %), spread evenly but for eyes and mouth.
    pub(super) fn new(seed: u64, vertex_count: usize) -> Self {
        let person = Person::of_seed(seed);
        let samples = sampling::sample(&person, seed, vertex_count.clamp(500, 300_000));
        let triangles = triangulation::triangulate(&samples);
        let mesh = grouped_mesh(&person, &samples, triangles);
        Self { person, domain: samples.domain, mesh }
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
