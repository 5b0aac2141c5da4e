//! Direct solves or the response basis, behind one face.

use super::Arguments;
use super::arguments::{Mode, Reference};
use super::cache::Cache;
use linear_shell::{AffineReference, Basis, Completion, Constraints, Model, Shell, SoftShell, Surface};
use nalgebra::{Point3, Vector3};
use operators::Ordering;
use stage::Run;

/// Change by the last refinement, as a share of a handle's displacement, beyond which a solve is not trusted.
const LARGEST_CHANGE: f64 = 1e-4;

/// What turns handle displacements into frames.
pub(crate) struct Solver {
    method: Method,
    completion: Option<Completion>,
}

enum Method {
    Basis(Basis),
    Direct(Box<Direct>),
}

/// Solves frame by frame.
struct Direct {
    shell: Factored,
    reference: Option<(AffineReference, Vec<Point3<f64>>)>,
}

impl Direct {
    fn solve(&self, handles: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let Some((reference, points)) = &self.reference else { return self.shell.solve(handles) };
        let (left, motion) = reference.split(handles);
        let mut field = self.shell.solve(&left);
        reference.add(&motion, points, &mut field);
        field
    }

    fn completion(&self) -> Completion {
        let completion = self.shell.completion();
        match &self.reference {
            Some((reference, _)) => reference.completion(&completion),
            None => completion,
        }
    }
}

/// A shell of either model.
enum Factored {
    Paper(Box<Shell>),
    Soft(Box<SoftShell>),
}

impl Factored {
    fn new(
        run: &mut Run,
        model: Model,
        surface: &Surface,
        constraints: &Constraints,
        ordering: &Ordering,
    ) -> anyhow::Result<Self> {
        let shell = run.timed("factor", || match model {
            Model::Paper => {
                Shell::factor(surface, constraints, ordering).map(|shell| Self::Paper(Box::new(shell)))
            }
            Model::SoftOpenings => {
                SoftShell::factor(surface, constraints, ordering).map(|shell| Self::Soft(Box::new(shell)))
            }
        })?;
        if let Self::Soft(soft) = &shell {
            run.result("proxy_vertices", soft.proxy().vertices.len());
        }
        run.detail(&format!("the factor has {} entries", shell.entry_count()));
        Ok(shell)
    }

    fn entry_count(&self) -> usize {
        match self {
            Self::Paper(shell) => shell.factor_entry_count(),
            Self::Soft(shell) => shell.factor_entry_count(),
        }
    }

    fn solve(&self, handles: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        match self {
            Self::Paper(shell) => shell.solve(handles),
            Self::Soft(shell) => shell.solve(handles),
        }
    }

    fn completion(&self) -> Completion {
        match self {
            Self::Paper(shell) => shell.completion(),
            Self::Soft(shell) => shell.completion(),
        }
    }

    fn basis(&self, run: &mut Run) -> (Basis, Completion) {
        match self {
            Self::Paper(shell) => run.timed("basis", || shell.basis()),
            Self::Soft(shell) => {
                let (basis, completion, change) = run.timed("basis", || shell.basis());
                run.result("refinement_change", change);
                if change > LARGEST_CHANGE {
                    run.warn(format!(
                        "the last refinement still changed the responses by {change:.1e}: the scan's triangles are too \
                         uneven for a third-order solve; fewer --proxy-vertices help"
                    ));
                }
                (basis, completion)
            }
        }
    }
}

impl Solver {
    /// Takes the basis from the cache, or orders, factors and, in basis mode, solves for it.
    pub(crate) fn prepare(
        run: &mut Run,
        arguments: &Arguments,
        cache: &Cache,
        surface: &Surface,
        constraints: &Constraints,
    ) -> anyhow::Result<Self> {
        let basis_wanted = arguments.mode == Mode::Basis || arguments.basis.is_some();
        if basis_wanted && let Some((basis, completion)) = sound(run, cache.basis()) {
            run.say("the response basis was kept from an earlier run");
            return Ok(Self { method: Method::Basis(basis), completion: Some(completion) });
        }
        let ordering = match sound(run, cache.ordering()) {
            Some(ordering) => ordering,
            None => {
                let ordering = run.timed("ordering", || surface.ordering());
                cache.keep_ordering(&ordering)?;
                ordering
            }
        };
        let shell = Factored::new(run, arguments.params().model, surface, constraints, &ordering)?;
        let points = surface.points();
        let reference = (arguments.reference == Reference::Affine).then(|| {
            let places: Vec<Point3<f64>> =
                constraints.handles.iter().map(|&handle| points[handle as usize]).collect();
            AffineReference::new(&places)
        });
        if !basis_wanted {
            let reference = reference.map(|reference| (reference, points.to_vec()));
            return Ok(Self {
                method: Method::Direct(Box::new(Direct { shell, reference })),
                completion: None,
            });
        }
        let (basis, completion) = shell.basis(run);
        let (basis, completion) = match reference {
            Some(reference) => (reference.basis(points, &basis), reference.completion(&completion)),
            None => (basis, completion),
        };
        cache.keep_basis(&basis, &completion)?;
        Ok(Self { method: Method::Basis(basis), completion: Some(completion) })
    }

    /// Where missing and soft handles go; in direct mode found when first asked for.
    pub(crate) fn completion(&mut self) -> &Completion {
        let method = &self.method;
        self.completion.get_or_insert_with(|| match method {
            Method::Direct(shell) => shell.completion(),
            // A basis always comes with its completion.
            Method::Basis(_) => Completion::new(&[]),
        })
    }

    /// The completion, if it is known already.
    pub(crate) fn known_completion(&self) -> Option<&Completion> {
        self.completion.as_ref()
    }

    /// The basis and its completion, in basis mode.
    pub(crate) fn basis(&self) -> Option<(&Basis, &Completion)> {
        match &self.method {
            Method::Basis(basis) => self.completion.as_ref().map(|completion| (basis, completion)),
            Method::Direct(_) => None,
        }
    }

    /// Deformed coordinates of a batch of frames, `scale · (rest + d)`, into arrays that may have been used before.
    pub(crate) fn deform(
        &self,
        rest: &[f32],
        frames: &[Vec<Vector3<f64>>],
        scale: f64,
        out: &mut Vec<Vec<f32>>,
    ) {
        match &self.method {
            Method::Basis(basis) => basis.deform_into(rest, frames, scale, out),
            Method::Direct(shell) => {
                let placed = |handles: &Vec<Vector3<f64>>| place(rest, &flat(&shell.solve(handles)), scale);
                *out = frames.iter().map(placed).collect();
            }
        }
    }

    /// Displacements of a batch of frames, #V × 3, mm: as the direct solve finds them, or with the basis' f32.
    pub(crate) fn fields(&self, frames: &[Vec<Vector3<f64>>]) -> Vec<Vec<f64>> {
        match &self.method {
            Method::Basis(basis) => {
                let still = vec![0.0; basis.vertex_count() * 3];
                let widen = |field: Vec<f32>| field.into_iter().map(f64::from).collect();
                basis.deform(&still, frames, 1.0).into_iter().map(widen).collect()
            }
            Method::Direct(shell) => frames.iter().map(|handles| flat(&shell.solve(handles))).collect(),
        }
    }
}

/// What was kept, if it is whole; a damaged entry is made again.
fn sound<T>(run: &mut Run, kept: anyhow::Result<Option<T>>) -> Option<T> {
    kept.unwrap_or_else(|error| {
        run.warn(format!("{error:#}; it is made again"));
        None
    })
}

fn flat(field: &[Vector3<f64>]) -> Vec<f64> {
    field.iter().flat_map(|d| [d.x, d.y, d.z]).collect()
}

fn place(rest: &[f32], field: &[f64], scale: f64) -> Vec<f32> {
    rest.iter().zip(field).map(|(&rest, d)| ((f64::from(rest) + d) * scale) as f32).collect()
}
