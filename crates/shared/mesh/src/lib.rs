//! Polygon meshes as scans and characters have them, and the triangulated view that the methods work on.
//!
//! A [`Mesh`] keeps what its file said: polygons of any size, texture coordinates per corner (UDIM tiles are
//! coordinates beyond 1), vertex colours, groups and materials. **Vertex order is identity**: nothing here adds,
//! drops or reorders vertices except [`Mesh::keep_faces`], which says how.
//!
//! Methods see triangles: [`Mesh::triangles`] splits each polygon as a fan from its first corner, and
//! [`Connectivity`] answers what lies beside what; [`openings()`] tells a mouth and eyes from the rims of the scan; [`RayTree`] says
//! what a ray meets.
//!
//! ```
//! use mesh::{Connectivity, Mesh};
//! let mesh = Mesh::from_triangles(vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], &[[0, 1, 2]]);
//! let triangles = mesh.triangles();
//! let around = Connectivity::of(mesh.positions.len(), &triangles);
//! assert_eq!(around.boundary_loops().len(), 1);
//! ```

mod around;
mod connectivity;
mod forest;
mod mask;
mod measure;
mod nearest;
mod openings;
mod polygons;
mod rays;
mod way;

pub use around::Around;
pub use connectivity::{Connectivity, Edge};
pub use forest::Forest;
pub use mask::VertexMap;
pub use measure::{
    bounding_box, edge_length_median, loop_length, mixed_voronoi_areas, triangle_areas, vertex_normals,
};
pub use nearest::nearest_in_triangle;
pub use openings::{distance_to_loops, openings};
pub use polygons::{Label, LabelKind, Mesh, NO_UV, Polygons};
pub use rays::{Hit, RayTree};
pub use way::shortest_way;
