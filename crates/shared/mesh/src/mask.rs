//! Cutting faces out of a mesh, with the way back.

use crate::polygons::{Label, Mesh, NO_UV, Polygons};

/// Which vertex became which when faces were cut out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VertexMap {
    /// Per old vertex its new index, or `None` where it went.
    pub new_from_old: Vec<Option<u32>>,
    /// Per new vertex its old index; rising.
    pub old_from_new: Vec<u32>,
}

impl VertexMap {
    /// Keeps the vertices for which `keep` holds, in their order.
    #[must_use]
    pub fn keeping(keep: &[bool]) -> Self {
        let old_from_new: Vec<u32> = (0..keep.len() as u32).filter(|&old| keep[old as usize]).collect();
        let mut new_from_old = vec![None; keep.len()];
        for (new, &old) in old_from_new.iter().enumerate() {
            new_from_old[old as usize] = Some(new as u32);
        }
        Self { new_from_old, old_from_new }
    }
}

impl Mesh {
    /// The mesh without the faces for which `keep` is false, and without the vertices that no kept face uses.
    /// Order, texture coordinates, colours and labels of the rest stay.
    ///
    /// # Panics
    /// If `keep` does not have one entry per face.
    #[must_use]
    pub fn keep_faces(&self, keep: &[bool]) -> (Self, VertexMap) {
        assert_eq!(keep.len(), self.polygons.len(), "one flag per face");
        let kept: Vec<usize> = (0..keep.len()).filter(|&face| keep[face]).collect();
        let mut used = vec![false; self.positions.len()];
        for &face in &kept {
            self.polygons.face(face).iter().for_each(|&vertex| used[vertex as usize] = true);
        }
        let map = VertexMap::keeping(&used);
        let mut polygons = Polygons::default();
        for &face in &kept {
            let renamed: Vec<u32> =
                self.polygons.face(face).iter().filter_map(|&old| map.new_from_old[old as usize]).collect();
            polygons.push(&renamed);
        }
        let (uvs, corner_uvs) = self.kept_uvs(&kept);
        let mesh = Self {
            positions: map.old_from_new.iter().map(|&old| self.positions[old as usize]).collect(),
            polygons,
            uvs,
            corner_uvs,
            colors: match self.colors.is_empty() {
                true => Vec::new(),
                false => map.old_from_new.iter().map(|&old| self.colors[old as usize]).collect(),
            },
            labels: self.kept_labels(keep),
        };
        (mesh, map)
    }

    fn kept_uvs(&self, kept: &[usize]) -> (Vec<nalgebra::Vector2<f64>>, Vec<u32>) {
        if self.corner_uvs.is_empty() {
            return (Vec::new(), Vec::new());
        }
        let corners: Vec<u32> = kept
            .iter()
            .flat_map(|&face| self.corner_uvs[self.polygons.corner_range(face)].iter().copied())
            .collect();
        let mut used = vec![false; self.uvs.len()];
        corners.iter().filter(|&&uv| uv != NO_UV).for_each(|&uv| used[uv as usize] = true);
        let map = VertexMap::keeping(&used);
        let rename = |uv: u32| match uv {
            NO_UV => NO_UV,
            old => map.new_from_old[old as usize].unwrap_or(NO_UV),
        };
        let uvs = map.old_from_new.iter().map(|&old| self.uvs[old as usize]).collect();
        (uvs, corners.into_iter().map(rename).collect())
    }

    /// Labels move to the first kept face at or after theirs; a label that no face is left for goes.
    fn kept_labels(&self, keep: &[bool]) -> Vec<Label> {
        let mut kept_before = vec![0usize; keep.len() + 1];
        for (face, &kept) in keep.iter().enumerate() {
            kept_before[face + 1] = kept_before[face] + usize::from(kept);
        }
        let total = kept_before[keep.len()];
        let mut labels: Vec<Label> = Vec::new();
        for label in &self.labels {
            let first_face = kept_before[label.first_face.min(keep.len())];
            labels.retain(|earlier| earlier.kind != label.kind || earlier.first_face != first_face);
            labels.push(Label { first_face, ..label.clone() });
        }
        labels.retain(|label| label.first_face < total);
        labels
    }
}
