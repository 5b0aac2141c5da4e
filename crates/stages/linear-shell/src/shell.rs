//! The factored shell, and the direct solve.

use crate::{Basis, Completion, Error, Surface};
use nalgebra::Vector3;
use operators::{CsMat, Dirichlet, Ordering};
use std::collections::HashSet;
use std::sync::Arc;

/// The vertices whose displacement is known.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Constraints {
    /// Handle vertices, told where to go in every frame.
    pub handles: Vec<u32>,
    /// Vertices that stay still, e.g. the neck.
    pub held: Vec<u32>,
}

impl Constraints {
    /// Whether the vertices exist and no two handles share one.
    pub(crate) fn check(&self, vertex_count: usize) -> Result<(), Error> {
        if self.handles.is_empty() {
            return Err(Error::NoHandles);
        }
        let beyond = |vertex: &&u32| **vertex as usize >= vertex_count;
        if let Some(&vertex) = self.handles.iter().chain(&self.held).find(beyond) {
            return Err(Error::UnknownVertex { vertex, vertex_count });
        }
        let mut seen = HashSet::new();
        match self.handles.iter().find(|&&handle| !seen.insert(handle)) {
            Some(&vertex) => Err(Error::SharedVertex { vertex }),
            None => Ok(()),
        }
    }
}

/// A shell with its handles eliminated and factored: solve as often as there are frames.
pub struct Shell {
    system: Dirichlet,
    stiffness: Arc<CsMat<f64>>,
}

impl Shell {
    /// Factors the shell of a surface. `ordering` may come from another run on the same mesh.
    ///
    /// # Errors
    /// [`Error::Factor`] where the constraints do not determine the surface, or memory is short.
    pub fn factor(surface: &Surface, constraints: &Constraints, ordering: &Ordering) -> Result<Self, Error> {
        let still: Vec<u32> = constraints.held.iter().chain(&surface.still).copied().collect();
        let system = Dirichlet::factor(&surface.stiffness, &constraints.handles, &still, ordering)?;
        Ok(Self { system, stiffness: Arc::clone(&surface.stiffness) })
    }

    /// Displacement of every vertex, mm, from those of all handles, mm: three substitutions, and three more that
    /// refine them, so that needles among the triangles cost no digits.
    ///
    /// # Panics
    /// If there is not one displacement per handle.
    #[must_use]
    pub fn solve(&self, handles: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let columns: Vec<Vec<f64>> =
            (0..3).map(|axis| handles.iter().map(|displacement| displacement[axis]).collect()).collect();
        let solved = self.system.solve_refined(&self.stiffness, &columns);
        let (x, y, z) = (&solved[0], &solved[1], &solved[2]);
        x.iter().zip(y).zip(z).map(|((&x, &y), &z)| Vector3::new(x, y, z)).collect()
    }

    /// The responses of the surface to every handle, and what completes frames with missing handles: one substitution per
    /// handle.
    #[must_use]
    pub fn basis(&self) -> (Basis, Completion) {
        let responses = self.system.responses(true);
        let basis = Basis::new(responses.values, responses.schur.len());
        (basis, Completion::new(&responses.schur))
    }

    /// Only what completes frames with missing handles, without keeping the responses.
    #[must_use]
    pub fn completion(&self) -> Completion {
        Completion::new(&self.system.responses(false).schur)
    }

    /// Stored entries of the factor, padding included; 8 bytes each.
    #[must_use]
    pub fn factor_entry_count(&self) -> usize {
        self.system.free_factor().stored_count()
    }
}
