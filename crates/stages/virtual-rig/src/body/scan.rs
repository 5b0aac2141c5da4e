//! A scan of anybody, made ready to act: refined, laid onto the average face, with its colours.

use super::face::outline::mouth_line;
use super::place::{PlaceError, Placement};
use super::subdivide::{Refined, triangulated};
use super::texture::{SKIN, Texture};
use artifact::Unit;
use artifact::picks::Pick;
use mesh::{Connectivity, Mesh};
use nalgebra::{Point2, Similarity3, Vector1};

/// Half the width of the average mouth, mm.
const MOUTH_HALF_WIDTH: f64 = 25.0;
/// Where lips may overlap: no farther from the mouth line, mm.
const LIP_OVERLAP: f64 = 5.0;
/// Lips that touch are this far apart on the unrolled face, half, mm.
const LIP_GAP: f64 = 0.05;
/// Vertices that the rig will work with at most.
pub const MOST_VERTICES: usize = 4_000_000;

/// A scan, ready to act.
#[derive(Debug, Clone)]
pub struct Scan {
    /// Triangles only; mm; the vertices of the file first, in their order.
    pub mesh: Mesh,
    /// Per vertex its place on the unrolled average face, mm. Along the slit of an open mouth, upper and lower lip lie
    /// on their own sides of the mouth line, also where they touch.
    pub domain: Vec<Point2<f64>>,
    /// Per vertex its linear RGB reflectance.
    pub albedo: Vec<[f32; 3]>,
    /// The average face's space into the scan's.
    pub face_from_canonical: Similarity3<f64>,
    /// Per landmark its name and how far the average face's lies from it, mm.
    pub residuals: Vec<(String, f64)>,
    /// Whether the surface is cut open between the lips. A closed mouth cannot open: its jaw would tear the skin.
    pub mouth_is_open: bool,
    /// Whether the upper lids' edges are among the landmarks. Lids that are closed cannot blink.
    pub eyes_are_open: bool,
}

/// Why a scan cannot act.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ScanError {
    /// It cannot be laid onto the average face.
    #[error(transparent)]
    Place(#[from] PlaceError),
    /// A picture, but nothing that says where it goes.
    #[error("the scan has no texture coordinates, so its picture cannot be put on")]
    NoTextureCoordinates,
    /// More vertices than the rig works with.
    #[error(
        "{levels} levels of subdivision make about {count} vertices of {from}; {MOST_VERTICES} are the most"
    )]
    TooMany {
        /// Levels asked for.
        levels: usize,
        /// Vertices of the file.
        from: usize,
        /// Vertices then.
        count: usize,
    },
}

/// What is known of a scan beside its surface.
#[derive(Debug, Clone, Copy)]
pub struct Notes<'a> {
    /// The unit that its file was read in, for messages.
    pub unit: Unit,
    /// Its landmarks.
    pub landmarks: &'a [Pick],
    /// Its picture.
    pub texture: Option<&'a Texture>,
    /// How often each triangle becomes four.
    pub levels: usize,
}

/// Makes a scan ready to act; `mesh` in mm, polygons of any size, open or closed.
///
/// # Errors
/// Landmarks that do not fit, a size that no head has, a picture without texture coordinates, too many levels.
pub fn scan(mesh: &Mesh, notes: &Notes) -> Result<Scan, ScanError> {
    prepare(mesh, notes).map(|(scan, _)| scan)
}

/// As [`scan`], with the way from the file's vertices to the scan's.
pub(super) fn prepare(mesh: &Mesh, notes: &Notes) -> Result<(Scan, Refined), ScanError> {
    check_count(mesh, notes.levels)?;
    if notes.texture.is_some() && mesh.corner_uvs.is_empty() {
        return Err(ScanError::NoTextureCoordinates);
    }
    let placement = Placement::of(&mesh.positions, notes.unit, notes.landmarks)?;
    let refined = Refined::of(mesh, notes.levels);
    let coarse = triangulated(mesh);
    let sides = lip_sides(&coarse, &placement.domain(&coarse.positions));
    let mut domain = placement.domain(&refined.mesh.positions);
    settle_lips(&mut domain, &refined.field(&sides));
    let albedo = match notes.texture {
        Some(texture) => texture.albedo(&refined.mesh),
        None => vec![SKIN; refined.mesh.positions.len()],
    };
    let is_named = |name: &str| notes.landmarks.iter().any(|pick| pick.marker == name);
    let scan = Scan {
        eyes_are_open: is_named("lid_upper_l") && is_named("lid_upper_r"),
        mouth_is_open: has_slit(&refined.mesh, &domain),
        mesh: refined.mesh.clone(),
        domain,
        albedo,
        face_from_canonical: placement.face_from_canonical,
        residuals: placement.residuals,
    };
    Ok((scan, refined))
}

fn check_count(mesh: &Mesh, levels: usize) -> Result<(), ScanError> {
    let from = mesh.positions.len();
    // By Euler, n vertices of triangles have about 3n edges, each of which becomes a vertex.
    let count = from.saturating_mul(4usize.saturating_pow(u32::try_from(levels).unwrap_or(u32::MAX)));
    match count > MOST_VERTICES {
        true => Err(ScanError::TooMany { levels, from, count }),
        false => Ok(()),
    }
}

/// Height over the mouth line, mm.
fn above_mouth(at: Point2<f64>) -> f64 {
    at.y - mouth_line(at.x)
}

fn between_corners(at: Point2<f64>) -> bool {
    at.x.abs() < MOUTH_HALF_WIDTH && above_mouth(at).abs() < LIP_OVERLAP
}

/// Per vertex +1 above the mouth and −1 below. Lips touch, overlap and curl in, so that the place of a vertex between
/// them says little; what hangs together with it between the corners of a cut mouth is one lip, whose mean says more.
fn lip_sides(mesh: &Mesh, domain: &[Point2<f64>]) -> Vec<Vector1<f64>> {
    let mut sides: Vec<Vector1<f64>> =
        domain.iter().map(|&at| Vector1::new(above_mouth(at).signum())).collect();
    let (starts, neighbors) = Connectivity::of(mesh.positions.len(), &mesh.triangles()).one_rings();
    let ring = |vertex: u32| &neighbors[starts[vertex as usize]..starts[vertex as usize + 1]];
    // A cut may end before the corners, where the lips hang together.
    for share in [0.96, 0.9, 0.8, 0.7] {
        let is_lip = |vertex: u32| {
            let at = domain[vertex as usize];
            between_corners(at) && at.x.abs() < share * MOUTH_HALF_WIDTH
        };
        let pieces = pieces(domain.len(), is_lip, ring);
        let sided: Option<Vec<f64>> = pieces.iter().map(|piece| one_side(piece, domain)).collect();
        if let Some(sided) = sided {
            for (piece, side) in pieces.iter().zip(sided) {
                piece.iter().for_each(|&vertex| sides[vertex as usize].x = side);
            }
            break;
        }
    }
    sides
}

/// The parts in which the vertices of a kind hang together.
fn pieces<'a>(count: usize, is_one: impl Fn(u32) -> bool, ring: impl Fn(u32) -> &'a [u32]) -> Vec<Vec<u32>> {
    let mut open: Vec<bool> = (0..count as u32).map(&is_one).collect();
    let mut pieces = Vec::new();
    for first in 0..count as u32 {
        if !std::mem::take(&mut open[first as usize]) {
            continue;
        }
        let mut piece = vec![first];
        let mut next = 0;
        while let Some(&vertex) = piece.get(next) {
            next += 1;
            piece.extend(ring(vertex).iter().filter(|&&other| std::mem::take(&mut open[other as usize])));
        }
        pieces.push(piece);
    }
    pieces
}

/// The side of a piece of lip: of its mean, unless it reaches far to both sides, as skin does that is not cut.
fn one_side(piece: &[u32], domain: &[Point2<f64>]) -> Option<f64> {
    let heights = || piece.iter().map(|&vertex| above_mouth(domain[vertex as usize]));
    let (low, high) = (heights().fold(0.0, f64::min), heights().fold(0.0, f64::max));
    (low.abs().min(high) < 0.7 * LIP_OVERLAP).then(|| heights().sum::<f64>().signum())
}

/// Brings vertices between the lips onto their own side of the mouth line.
fn settle_lips(domain: &mut [Point2<f64>], sides: &[Vector1<f64>]) {
    for (at, side) in domain.iter_mut().zip(sides) {
        let side = side.x.signum();
        if between_corners(*at) && above_mouth(*at) * side < LIP_GAP {
            at.y = mouth_line(at.x) + side * LIP_GAP;
        }
    }
}

/// Whether some boundary runs from one corner of the mouth to the other.
fn has_slit(mesh: &Mesh, domain: &[Point2<f64>]) -> bool {
    let loops = Connectivity::of(mesh.positions.len(), &mesh.triangles()).boundary_loops();
    loops.iter().any(|vertices| {
        let places = vertices.iter().map(|&vertex| domain[vertex as usize]);
        let near = |at: &Point2<f64>| at.x.abs() < 1.5 * MOUTH_HALF_WIDTH && above_mouth(*at).abs() < 20.0;
        let reach = |sign: f64| places.clone().map(|at| sign * at.x).fold(f64::NEG_INFINITY, f64::max);
        places.clone().all(|at| near(&at)) && reach(1.0).min(reach(-1.0)) > 0.5 * MOUTH_HALF_WIDTH
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::place::test_head;

    fn act_ready(open_mouth: bool, levels: usize) -> (Mesh, Scan) {
        let (head, landmarks) = test_head(open_mouth);
        let notes = Notes { unit: Unit::Mm, landmarks: &landmarks, texture: None, levels };
        let scan = scan(&head, &notes).expect("a scan");
        (head, scan)
    }

    #[test]
    fn lips_that_touch_lie_on_their_own_sides() {
        for levels in [0, 1, 2] {
            let (head, scan) = act_ready(true, levels);
            assert!(scan.mouth_is_open);
            let doubled = head.positions.len() - 11;
            for lower in doubled..head.positions.len() {
                let is_twin = |other: &usize| head.positions[*other] == head.positions[lower];
                let upper = (0..doubled).find(is_twin).expect("its twin");
                assert!(above_mouth(scan.domain[upper]) > 0.0 && above_mouth(scan.domain[lower]) < 0.0);
                assert!((scan.domain[upper] - scan.domain[lower]).norm() < 3.0);
            }
        }
    }

    /// The lower lip hangs together with what is below it only.
    #[test]
    fn no_edge_crosses_an_open_mouth() {
        let (_, scan) = act_ready(true, 2);
        let around = Connectivity::of(scan.mesh.positions.len(), &scan.mesh.triangles());
        for edge in around.edges() {
            let [a, b] = edge.vertices.map(|vertex| scan.domain[vertex as usize]);
            if a.x.abs().max(b.x.abs()) < 19.0 {
                assert!(above_mouth(a) * above_mouth(b) > 0.0, "{a} {b}");
            }
        }
    }

    #[test]
    fn a_closed_mouth_is_closed() {
        assert!(!act_ready(false, 1).1.mouth_is_open);
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let (head, landmarks) = test_head(false);
        let notes = Notes { unit: Unit::Mm, landmarks: &landmarks, texture: None, levels: 9 };
        let said = scan(&head, &notes).expect_err("too many").to_string();
        assert!(said.starts_with("9 levels of subdivision make about "), "{said}");
        let grey = Texture::from_srgb(1, 1, &[9; 3]).expect("a pixel");
        let notes = Notes { texture: Some(&grey), levels: 0, ..notes };
        assert_eq!(scan(&head, &notes).expect_err("no coordinates"), ScanError::NoTextureCoordinates);
    }
}
