//! The mesh itself: positions, polygons, and what hangs on them.

use nalgebra::{Point3, Vector2};

/// Marks a corner without a texture coordinate in [`Mesh::corner_uvs`].
pub const NO_UV: u32 = u32::MAX;

/// Polygons as one list of corners, cut into faces.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Polygons {
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl Default for Polygons {
    fn default() -> Self {
        Self { starts: vec![0], corners: Vec::new() }
    }
}

impl Polygons {
    /// Appends one polygon, given as vertex indices (0-based).
    pub fn push(&mut self, polygon: &[u32]) {
        self.corners.extend_from_slice(polygon);
        self.starts.push(self.corners.len() as u32);
    }

    /// Number of polygons.
    #[must_use]
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there is no polygon.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The vertex indices of one polygon.
    #[must_use]
    pub fn face(&self, face: usize) -> &[u32] {
        &self.corners[self.corner_range(face)]
    }

    /// Where the corners of a polygon stand in the list of all corners.
    #[must_use]
    pub fn corner_range(&self, face: usize) -> std::ops::Range<usize> {
        self.starts[face] as usize..self.starts[face + 1] as usize
    }

    /// All polygons in order.
    pub fn iter(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.len()).map(|face| self.face(face))
    }

    /// The vertex indices of all corners, polygon after polygon.
    #[must_use]
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }
}

/// What a [`Label`] names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LabelKind {
    /// OBJ `o`
    Object,
    /// OBJ `g`
    Group,
    /// OBJ `usemtl`
    Material,
    /// OBJ `s`
    Smoothing,
    /// OBJ `mtllib`: where the materials are described
    MaterialLibrary,
}

/// A name that holds for all faces from `first_face` on, until the next label of its kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// First face that the name holds for.
    pub first_face: usize,
    /// What is named.
    pub kind: LabelKind,
    /// The name, as in the file.
    pub name: String,
}

/// A polygon mesh: #V vertices, #F polygons. Positions are in the unit that its reader was told (millimetres
/// everywhere inside Furrow).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// #V points.
    pub positions: Vec<Point3<f64>>,
    /// #F polygons.
    pub polygons: Polygons,
    /// Pool of texture coordinates, v up.
    pub uvs: Vec<Vector2<f64>>,
    /// Per corner an index into `uvs` or [`NO_UV`]; empty when the mesh has none.
    pub corner_uvs: Vec<u32>,
    /// Per vertex a colour (0–1); empty when the mesh has none.
    pub colors: Vec<[f32; 3]>,
    /// Objects, groups and materials, by first face.
    pub labels: Vec<Label>,
}

impl Mesh {
    /// A bare triangle mesh.
    #[must_use]
    pub fn from_triangles(positions: Vec<[f64; 3]>, triangles: &[[u32; 3]]) -> Self {
        let mut polygons = Polygons::default();
        triangles.iter().for_each(|triangle| polygons.push(triangle));
        Self { positions: positions.into_iter().map(Point3::from).collect(), polygons, ..Self::default() }
    }

    /// Every polygon split as a fan from its first corner: (0,1,2), (0,2,3), … Triangles that name a vertex twice
    /// have no area and are left out.
    #[must_use]
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        let fan = |polygon: &[u32]| -> Vec<[u32; 3]> {
            polygon[1..].windows(2).map(|pair| [polygon[0], pair[0], pair[1]]).collect()
        };
        let proper = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        self.polygons.iter().flat_map(fan).filter(proper).collect()
    }

    /// The same mesh at other positions (one per vertex), for a deformed frame.
    ///
    /// # Panics
    /// If the counts differ: that is a bug of the caller.
    #[must_use]
    pub fn with_positions(&self, positions: Vec<Point3<f64>>) -> Self {
        assert_eq!(positions.len(), self.positions.len(), "a deformed mesh keeps its vertices");
        Self { positions, ..self.clone() }
    }

    /// Scales all positions, for a change of unit.
    pub fn scale(&mut self, factor: f64) {
        self.positions.iter_mut().for_each(|point| point.coords *= factor);
    }
}
