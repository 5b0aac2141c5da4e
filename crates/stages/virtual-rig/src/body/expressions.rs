//! A neutral scan and the same head with other expressions, vertex for vertex.

use super::scan::{Notes, Scan, ScanError, prepare};
use mesh::Mesh;
use nalgebra::Vector3;

/// No skin moves farther, mm; farther is another unit, or a head that stands elsewhere.
const FARTHEST_MM: f64 = 80.0;

/// One expression.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Its id, e.g. `smile`.
    pub name: String,
    /// The file that it comes from, for messages.
    pub file: String,
    /// The head with it at full strength, mm.
    pub mesh: Mesh,
}

/// A scan with its expressions.
#[derive(Debug, Clone)]
pub struct ExpressionSet {
    /// The neutral face.
    pub scan: Scan,
    /// Names of the expressions, in the order given.
    pub names: Vec<String>,
    /// Per expression and vertex of the scan how far it moves, mm.
    pub offsets: Vec<Vec<Vector3<f64>>>,
}

/// Why files do not make an expression set.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExpressionError {
    /// The neutral face is none.
    #[error(transparent)]
    Scan(#[from] ScanError),
    /// No expression at all.
    #[error("no expressions: a neutral face alone cannot move")]
    Empty,
    /// Another number of vertices.
    #[error("{file}: {count} vertices; the neutral face has {neutral}: an expression set has one topology")]
    VertexCount {
        /// The file.
        file: String,
        /// Its vertices.
        count: usize,
        /// The neutral face's.
        neutral: usize,
    },
    /// Other polygons.
    #[error(
        "{file}: face {face} joins other vertices than the neutral face's: an expression set has one topology"
    )]
    Faces {
        /// The file.
        file: String,
        /// The first face that differs, counted from 0.
        face: usize,
    },
    /// A vertex that goes too far.
    #[error(
        "{file}: vertex {vertex} moves by {distance_mm:.0} mm: is the file in another unit, or the head elsewhere?"
    )]
    TooFar {
        /// The file.
        file: String,
        /// The vertex that moves farthest.
        vertex: usize,
        /// How far.
        distance_mm: f64,
    },
    /// Two files with one name.
    #[error("{file}: there are two expressions called {name}")]
    Twice {
        /// The second file.
        file: String,
        /// The name.
        name: String,
    },
}

/// Makes a neutral scan and its expressions ready to act; all in mm.
///
/// # Errors
/// As [`super::scan::scan`] for the neutral face; for an expression, another topology, a name used twice, or skin that
/// moves too far, naming its file.
pub fn expressions(
    neutral: &Mesh,
    shapes: &[Shape],
    notes: &Notes,
) -> Result<ExpressionSet, ExpressionError> {
    if shapes.is_empty() {
        return Err(ExpressionError::Empty);
    }
    for (i, shape) in shapes.iter().enumerate() {
        check(neutral, shape)?;
        if shapes[..i].iter().any(|other| other.name == shape.name) {
            return Err(ExpressionError::Twice { file: shape.file.clone(), name: shape.name.clone() });
        }
    }
    let (scan, refined) = prepare(neutral, notes)?;
    Ok(ExpressionSet {
        scan,
        names: shapes.iter().map(|shape| shape.name.clone()).collect(),
        offsets: shapes.iter().map(|shape| refined.field(&offsets(neutral, shape))).collect(),
    })
}

fn offsets(neutral: &Mesh, shape: &Shape) -> Vec<Vector3<f64>> {
    shape.mesh.positions.iter().zip(&neutral.positions).map(|(moved, rest)| moved - rest).collect()
}

fn check(neutral: &Mesh, shape: &Shape) -> Result<(), ExpressionError> {
    let file = || shape.file.clone();
    let (count, expected) = (shape.mesh.positions.len(), neutral.positions.len());
    if count != expected {
        return Err(ExpressionError::VertexCount { file: file(), count, neutral: expected });
    }
    if shape.mesh.polygons != neutral.polygons {
        let same =
            shape.mesh.polygons.iter().zip(neutral.polygons.iter()).take_while(|(one, other)| one == other);
        return Err(ExpressionError::Faces { file: file(), face: same.count() });
    }
    let distances = offsets(neutral, shape).into_iter().map(|offset| offset.norm()).enumerate();
    match distances.max_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((vertex, distance_mm)) if distance_mm > FARTHEST_MM => {
            Err(ExpressionError::TooFar { file: file(), vertex, distance_mm })
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::place::test_head;
    use artifact::Unit;

    fn raised(neutral: &Mesh) -> Shape {
        let raise =
            |point: &nalgebra::Point3<f64>| point + Vector3::new(0.0, 5.0 * (point.y / 40.0).tanh(), 0.0);
        let mesh = neutral.with_positions(neutral.positions.iter().map(raise).collect());
        Shape { name: "raise".into(), file: "raise.obj".into(), mesh }
    }

    fn error(change: impl Fn(&mut Shape)) -> String {
        let (neutral, landmarks) = test_head(false);
        let notes = Notes { unit: Unit::Mm, landmarks: &landmarks, texture: None, levels: 0 };
        let mut shape = raised(&neutral);
        change(&mut shape);
        expressions(&neutral, &[shape], &notes).expect_err("refused").to_string()
    }

    /// Refining is linear: the refined expression is the refined neutral face and its refined offsets.
    #[test]
    fn offsets_lead_to_the_refined_expression() {
        let (neutral, landmarks) = test_head(true);
        let notes = Notes { unit: Unit::Mm, landmarks: &landmarks, texture: None, levels: 2 };
        let shape = raised(&neutral);
        let set = expressions(&neutral, std::slice::from_ref(&shape), &notes).expect("a set");
        let refined = crate::body::subdivide::Refined::of(&shape.mesh, 2).mesh;
        for (i, point) in refined.positions.iter().enumerate() {
            assert!((set.scan.mesh.positions[i] + set.offsets[0][i] - point).norm() < 1e-9);
        }
    }

    #[test]
    fn another_topology_is_named() {
        let said = error(|shape| shape.mesh.positions.push(nalgebra::Point3::origin()));
        assert!(
            said.starts_with("raise.obj: ") && said.ends_with("an expression set has one topology"),
            "{said}"
        );
        let said = error(|shape| {
            let faces: Vec<Vec<u32>> = shape.mesh.polygons.iter().map(<[u32]>::to_vec).collect();
            shape.mesh.polygons = mesh::Polygons::default();
            for (i, face) in faces.iter().enumerate() {
                let turned = [face[1], face[0], face[2], face[3]];
                shape.mesh.polygons.push(if i == 17 { &turned } else { face });
            }
        });
        assert!(said.starts_with("raise.obj: face 17 joins other vertices"), "{said}");
    }

    #[test]
    fn a_head_elsewhere_is_named() {
        let said = error(|shape| shape.mesh.scale(0.1));
        assert!(said.starts_with("raise.obj: vertex "), "{said}");
        let (neutral, landmarks) = test_head(false);
        let notes = Notes { unit: Unit::Mm, landmarks: &landmarks, texture: None, levels: 0 };
        let twice = [raised(&neutral), raised(&neutral)];
        let said = expressions(&neutral, &twice, &notes).expect_err("twice").to_string();
        assert_eq!(said, "raise.obj: there are two expressions called raise");
        assert_eq!(expressions(&neutral, &[], &notes).expect_err("none"), ExpressionError::Empty);
    }
}
