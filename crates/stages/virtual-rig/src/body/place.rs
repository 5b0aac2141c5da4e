//! Where the points of a scan lie on the unrolled average face.
//!
//! People name landmarks on a scan ([`LANDMARKS`]). A similarity brings the average face onto them; an upright elliptic
//! cylinder in that frame unrolls the scan roughly; what is left over at the landmarks is spread smoothly between them
//! by moving least squares. The back of the head lands far outside of the face, where nothing is placed.

use super::face::{Person, surface};
use artifact::Unit;
use artifact::picks::{Pick, PickPlace};
use camera::{AlignError, fit_similarity};
use mesh::bounding_box;
use nalgebra::{Matrix3, Matrix3x2, Point2, Point3, Similarity3, Vector2};
use rayon::prelude::*;

/// A point of the face that people can find.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Landmark {
    /// Its id; `_l` and `_r` are the subject's sides.
    pub name: &'static str,
    /// Where it is.
    pub what: &'static str,
    /// (s, t) on the unrolled average face, mm.
    pub at: [f64; 2],
}

const fn landmark(name: &'static str, what: &'static str, at: [f64; 2]) -> Landmark {
    Landmark { name, what, at }
}

/// All landmarks that a scan may name. None is needed in particular, but [`LEAST`] in all; a scan with closed lids or
/// lips leaves out the edges that it does not show.
pub const LANDMARKS: [Landmark; 42] = [
    landmark("eye_inner_l", "inner corner of the eye", [19.0, 35.3]),
    landmark("eye_inner_r", "inner corner of the eye", [-19.0, 35.3]),
    landmark("eye_outer_l", "outer corner of the eye", [47.0, 36.7]),
    landmark("eye_outer_r", "outer corner of the eye", [-47.0, 36.7]),
    landmark("lid_upper_l", "middle of the upper lid's edge, the eye open", [33.0, 41.4]),
    landmark("lid_upper_r", "middle of the upper lid's edge, the eye open", [-33.0, 41.4]),
    landmark("lid_lower_l", "middle of the lower lid's edge", [33.0, 32.0]),
    landmark("lid_lower_r", "middle of the lower lid's edge", [-33.0, 32.0]),
    landmark("brow_inner_l", "inner end of the brow, half its height", [12.0, 54.0]),
    landmark("brow_inner_r", "inner end of the brow, half its height", [-12.0, 54.0]),
    landmark("brow_mid_l", "highest part of the brow, half its height", [34.0, 58.0]),
    landmark("brow_mid_r", "highest part of the brow, half its height", [-34.0, 58.0]),
    landmark("brow_outer_l", "outer end of the brow", [54.0, 52.0]),
    landmark("brow_outer_r", "outer end of the brow", [-54.0, 52.0]),
    landmark("forehead", "middle of the forehead, half way from the brows to the hair", [0.0, 80.0]),
    landmark("forehead_l", "as high as `forehead`, above the outer third of the brow", [42.0, 80.0]),
    landmark("forehead_r", "as high as `forehead`, above the outer third of the brow", [-42.0, 80.0]),
    landmark("temple_l", "hollow of the temple", [68.0, 56.0]),
    landmark("temple_r", "hollow of the temple", [-68.0, 56.0]),
    landmark("nose_root", "deepest point between the eyes", [0.0, 45.0]),
    landmark("nose_tip", "foremost point of the nose", [0.0, 6.0]),
    landmark("nose_wing_l", "outermost point of the nostril's wing", [17.0, 2.0]),
    landmark("nose_wing_r", "outermost point of the nostril's wing", [-17.0, 2.0]),
    landmark("nose_base", "where the nose meets the upper lip", [0.0, -9.0]),
    landmark("nasolabial_l", "in the fold, half way from the wing to the corner of the mouth", [26.0, -11.0]),
    landmark(
        "nasolabial_r",
        "in the fold, half way from the wing to the corner of the mouth",
        [-26.0, -11.0],
    ),
    landmark("cheekbone_l", "most prominent point of the cheekbone", [48.0, 18.0]),
    landmark("cheekbone_r", "most prominent point of the cheekbone", [-48.0, 18.0]),
    landmark(
        "mouth_corner_l",
        "corner of the mouth; where it was cut open, the end of the cut",
        [25.0, -27.9],
    ),
    landmark(
        "mouth_corner_r",
        "corner of the mouth; where it was cut open, the end of the cut",
        [-25.0, -27.9],
    ),
    landmark("lip_upper", "middle of the red lip's upper edge", [0.0, -21.6]),
    landmark("lip_line", "middle of the closed lips' line", [0.0, -27.8]),
    landmark("lip_upper_inner", "middle of the upper lip's lower edge, the lips parted", [0.0, -27.2]),
    landmark("lip_lower_inner", "middle of the lower lip's upper edge, the lips parted", [0.0, -28.4]),
    landmark("lip_lower", "middle of the red lip's lower edge", [0.0, -37.3]),
    landmark("chin_crease", "deepest point between lip and chin", [0.0, -44.5]),
    landmark("chin", "foremost point of the chin", [0.0, -60.0]),
    landmark("chin_under", "lowest point of the chin", [0.0, -72.0]),
    landmark("jaw_l", "edge of the jaw, half way from the chin to its angle", [45.0, -62.0]),
    landmark("jaw_r", "edge of the jaw, half way from the chin to its angle", [-45.0, -62.0]),
    landmark("jaw_angle_l", "angle of the jaw, below the ear", [82.0, -41.0]),
    landmark("jaw_angle_r", "angle of the jaw, below the ear", [-82.0, -41.0]),
];

/// Landmarks that a scan must name at least.
pub const LEAST: usize = 12;
/// Longest side of the box around a head (a bust, a face mask), mm.
const HEAD_MM: std::ops::RangeInclusive<f64> = 100.0..=500.0;
/// Size of a face relative to the average one.
const SCALE: std::ops::RangeInclusive<f64> = 0.6..=1.6;
/// A picked point lies no farther from the scan, mm.
const OFF_SCAN_MM: f64 = 12.0;
/// A landmark lies no farther from where the average face has it, mm: people differ by less.
const ASTRAY_MM: f64 = 22.0;
/// Semi-axes of the cylinder across and along, and the place of its axis, mm (the average head's).
const CYLINDER: [f64; 3] = [67.0, 83.0, -15.0];
/// Millimetres of s per radian around the head.
const ROLL: f64 = 72.0;
/// Landmarks pull with 1/(r² + ε)², mm²: they are met within a thousandth of a millimetre.
const EPSILON: f64 = 1e-4;
/// How stiff the local affine maps are, relative to the spread of the landmarks that they are fitted to.
const STIFFNESS: f64 = 0.05;

/// Why a scan cannot be laid onto the average face.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlaceError {
    /// A name that no landmark has.
    #[error("landmark {name} is not known; the closest name is {closest}")]
    Unknown {
        /// The name.
        name: String,
        /// A name that exists.
        closest: &'static str,
    },
    /// A vertex that the scan does not have.
    #[error("landmark {name}: vertex {vertex}; the scan has {count} (counted from 0)")]
    NoVertex {
        /// The landmark.
        name: String,
        /// What was picked.
        vertex: u32,
        /// Vertices of the scan.
        count: usize,
    },
    /// Too few to say where the face is.
    #[error("{count} landmarks; at least {LEAST} are needed, spread over the face")]
    TooFew {
        /// Landmarks given.
        count: usize,
    },
    /// No head has this size.
    #[error("the scan is {size_mm:.4} mm large when read in {unit}; a head has 100 to 500 mm{}", match .likely {
        Some(likely) => format!(": is its unit {likely}?"),
        None => String::new(),
    })]
    Size {
        /// Longest side of the box around it.
        size_mm: f64,
        /// The unit that it was read in.
        unit: Unit,
        /// The unit in which it would be a head.
        likely: Option<Unit>,
    },
    /// The landmarks span no face.
    #[error("the landmarks span {scale:.2} times an average face: were they picked in the unit of the scan?")]
    Scale {
        /// Size relative to the average face.
        scale: f64,
    },
    /// A picked point far from the scan.
    #[error(
        "landmark {name} lies {distance_mm:.1} mm off the scan: was it picked on another one, or in another unit?"
    )]
    OffScan {
        /// The landmark.
        name: String,
        /// Distance to the closest vertex.
        distance_mm: f64,
    },
    /// The subject's left and right are mixed up.
    #[error("left and right are exchanged: _l is the subject's left, at +x")]
    Mirrored,
    /// A landmark where none can be.
    #[error(
        "landmark {name} lies {distance_mm:.0} mm from where the others expect it: was another point picked?"
    )]
    Astray {
        /// The landmark.
        name: String,
        /// How far.
        distance_mm: f64,
    },
    /// All in one line.
    #[error("the landmarks do not span a face: {0}")]
    Align(#[from] AlignError),
}

/// A scan laid onto the average face.
#[derive(Debug, Clone)]
pub struct Placement {
    /// The average face's space into the scan's: a similarity, least squares over the landmarks [Umeyama1991].
    pub face_from_canonical: Similarity3<f64>,
    /// Per landmark its name and how far the average face's lies from it, mm in the average face's size.
    pub residuals: Vec<(String, f64)>,
    canonical_from_face: Similarity3<f64>,
    /// Per landmark where it is in the average face's space, and what the cylinder leaves over there.
    anchors: Vec<(Point3<f64>, Vector2<f64>)>,
}

impl Placement {
    /// Lays a scan onto the average face by its landmarks.
    ///
    /// `points`: the scan's vertices, mm; `unit`: what its file was read in, for messages.
    ///
    /// # Errors
    /// Unknown names, missing vertices, too few landmarks; a scan or landmarks that have not the size of a head; a
    /// landmark that cannot be where it was picked.
    pub fn of(points: &[Point3<f64>], unit: Unit, picks: &[Pick]) -> Result<Self, PlaceError> {
        check_size(points, unit)?;
        let named = named_points(points, picks)?;
        if named.len() < LEAST {
            return Err(PlaceError::TooFew { count: named.len() });
        }
        let average = Person::of_seed(0);
        let canonical: Vec<Point3<f64>> =
            named.iter().map(|(landmark, _)| surface::point(&average, landmark.at.into())).collect();
        let found: Vec<Point3<f64>> = named.iter().map(|(_, point)| *point).collect();
        let face_from_canonical = fit_similarity(&canonical, &found, None)?;
        let scale = face_from_canonical.scaling();
        if !SCALE.contains(&scale) {
            return Err(PlaceError::Scale { scale });
        }
        check_sides(&named, &average, &face_from_canonical)?;
        check_residuals(&named, &canonical)?;
        let canonical_from_face = face_from_canonical.inverse();
        let anchor = |(landmark, point): &(&Landmark, Point3<f64>)| {
            let place = canonical_from_face * point;
            (place, Vector2::from(landmark.at) - unroll(&place))
        };
        let residual = |((landmark, point), canonical): (&(&Landmark, Point3<f64>), &Point3<f64>)| {
            (landmark.name.to_string(), (canonical_from_face * point - canonical).norm())
        };
        Ok(Self {
            residuals: named.iter().zip(&canonical).map(residual).collect(),
            anchors: named.iter().map(anchor).collect(),
            face_from_canonical,
            canonical_from_face,
        })
    }

    /// The place of a point of the scan (mm) on the unrolled average face, mm.
    ///
    /// The cylinder's (s, t) and moving least squares of what it leaves over at the landmarks, affine, with weights
    /// 1/(r² + ε)² [Schaefer2006]: smooth, and exact at the landmarks. Deviation: the local maps are held back by a
    /// small penalty on their linear part, so that they do not run away outside of the landmarks.
    #[must_use]
    pub fn domain_at(&self, point: &Point3<f64>) -> Point2<f64> {
        let at = self.canonical_from_face * point;
        let weights: Vec<f64> =
            self.anchors.iter().map(|(place, _)| ((at - place).norm_squared() + EPSILON).powi(-2)).collect();
        let total: f64 = weights.iter().sum();
        let weighted = || weights.iter().map(|weight| weight / total).zip(&self.anchors);
        let (mut place_mean, mut rest_mean) = (nalgebra::Vector3::zeros(), Vector2::zeros());
        for (weight, (place, rest)) in weighted() {
            place_mean += weight * place.coords;
            rest_mean += weight * rest;
        }
        let (mut spread, mut cross) = (Matrix3::zeros(), Matrix3x2::zeros());
        for (weight, (place, rest)) in weighted() {
            let off = place.coords - place_mean;
            spread += weight * off * off.transpose();
            cross += weight * off * (rest - rest_mean).transpose();
        }
        spread += Matrix3::identity() * (STIFFNESS * spread.trace() + f64::MIN_POSITIVE);
        let linear = spread.cholesky().map_or_else(Matrix3x2::zeros, |factor| factor.solve(&cross));
        Point2::from(unroll(&at) + rest_mean + linear.transpose() * (at.coords - place_mean))
    }

    /// The places of many points, in their order.
    #[must_use]
    pub fn domain(&self, points: &[Point3<f64>]) -> Vec<Point2<f64>> {
        points.par_iter().map(|point| self.domain_at(point)).collect()
    }
}

/// Around the elliptic cylinder, and up.
fn unroll(at: &Point3<f64>) -> Vector2<f64> {
    let [across, along, axis] = CYLINDER;
    Vector2::new(ROLL * (at.x / across).atan2((at.z - axis) / along), at.y)
}

/// Refuses what has not the size of a head, and guesses the unit.
fn check_size(points: &[Point3<f64>], unit: Unit) -> Result<(), PlaceError> {
    let (low, high) = bounding_box(points);
    let size_mm = (high - low).max();
    if HEAD_MM.contains(&size_mm) {
        return Ok(());
    }
    let in_file = size_mm / unit.in_mm();
    let likely =
        [Unit::Mm, Unit::Cm, Unit::M].into_iter().find(|unit| HEAD_MM.contains(&(in_file * unit.in_mm())));
    Err(PlaceError::Size { size_mm, unit, likely })
}

fn named_points(
    points: &[Point3<f64>],
    picks: &[Pick],
) -> Result<Vec<(&'static Landmark, Point3<f64>)>, PlaceError> {
    let named = |pick: &Pick| {
        let name = || pick.marker.clone();
        let landmark = LANDMARKS
            .iter()
            .find(|landmark| landmark.name == pick.marker)
            .ok_or_else(|| PlaceError::Unknown { name: name(), closest: closest_name(&pick.marker) })?;
        let point = match pick.place {
            PickPlace::Vertex(vertex) => *points
                .get(vertex as usize)
                .ok_or_else(|| PlaceError::NoVertex { name: name(), vertex, count: points.len() })?,
            PickPlace::Point(point) => {
                let distance_mm =
                    points.iter().map(|vertex| (vertex - point).norm()).fold(f64::INFINITY, f64::min);
                if distance_mm > OFF_SCAN_MM {
                    return Err(PlaceError::OffScan { name: name(), distance_mm });
                }
                point
            }
        };
        Ok((landmark, point))
    };
    picks.iter().map(named).collect()
}

/// The landmark whose name takes the fewest changes of a letter.
fn closest_name(name: &str) -> &'static str {
    let changes = |other: &str| {
        let other: Vec<char> = other.chars().collect();
        let mut row: Vec<usize> = (0..=other.len()).collect();
        for (i, letter) in name.chars().enumerate() {
            let mut corner = row[0];
            row[0] = i + 1;
            for j in 0..other.len() {
                let changed = corner + usize::from(other[j] != letter);
                corner = row[j + 1];
                row[j + 1] = changed.min(row[j] + 1).min(corner + 1);
            }
        }
        row[other.len()]
    };
    LANDMARKS.iter().map(|landmark| landmark.name).min_by_key(|other| changes(other)).unwrap_or_default()
}

/// Whether the landmarks fit better with left and right exchanged.
fn check_sides(
    named: &[(&Landmark, Point3<f64>)],
    average: &Person,
    face_from_canonical: &Similarity3<f64>,
) -> Result<(), PlaceError> {
    let found: Vec<Point3<f64>> = named.iter().map(|(_, point)| *point).collect();
    let exchanged: Vec<Point3<f64>> = named
        .iter()
        .map(|(landmark, _)| surface::point(average, Point2::new(-landmark.at[0], landmark.at[1])))
        .collect();
    let error = |fit: &Similarity3<f64>, side: f64| -> f64 {
        let at = |landmark: &Landmark| Point2::new(side * landmark.at[0], landmark.at[1]);
        named
            .iter()
            .map(|(landmark, point)| (fit * surface::point(average, at(landmark)) - point).norm_squared())
            .sum()
    };
    let other = fit_similarity(&exchanged, &found, None)?;
    match error(&other, -1.0) < 0.5 * error(face_from_canonical, 1.0) {
        true => Err(PlaceError::Mirrored),
        false => Ok(()),
    }
}

/// Refuses the landmark that is farthest from where the others expect it, if it is too far.
fn check_residuals(named: &[(&Landmark, Point3<f64>)], canonical: &[Point3<f64>]) -> Result<(), PlaceError> {
    let found: Vec<Point3<f64>> = named.iter().map(|(_, point)| *point).collect();
    let mut worst = (0.0, "");
    for left_out in 0..named.len() {
        let weights: Vec<f64> = (0..named.len()).map(|i| if i == left_out { 0.0 } else { 1.0 }).collect();
        let fit = fit_similarity(canonical, &found, Some(&weights))?;
        let distance = (fit * canonical[left_out] - found[left_out]).norm() / fit.scaling();
        if distance > worst.0 {
            worst = (distance, named[left_out].0.name);
        }
    }
    match worst {
        (distance_mm, name) if distance_mm > ASTRAY_MM => {
            Err(PlaceError::Astray { name: name.to_string(), distance_mm })
        }
        _ => Ok(()),
    }
}

/// A mask of the average face in quads of 4 mm, with its landmarks; cut open along the mouth if asked, the lips touching.
#[cfg(test)]
pub(super) fn test_head(open_mouth: bool) -> (mesh::Mesh, Vec<Pick>) {
    use super::face::outline::mouth_line;
    const SIDE: i32 = 23;
    const ROWS: std::ops::Range<i32> = -24..27;
    let average = Person::of_seed(0);
    let row_length = (2 * SIDE + 1) as u32;
    let mut mesh = mesh::Mesh::default();
    for row in ROWS {
        for column in -SIDE..=SIDE {
            let (s, v) = (4.0 * f64::from(column), 4.0 * f64::from(row));
            // The row at −28 runs along the mouth.
            let t = v + (mouth_line(s) + 28.0) * (-((v + 28.0) / 15.0).powi(2)).exp();
            mesh.positions.push(surface::point(&average, Point2::new(s, t)));
        }
    }
    let vertex = |column: i32, row: i32| (row - ROWS.start) as u32 * row_length + (column + SIDE) as u32;
    let mut second = std::collections::HashMap::new();
    for column in -5..=5 {
        mesh.positions.push(mesh.positions[vertex(column, -7) as usize]);
        second.insert(vertex(column, -7), mesh.positions.len() as u32 - 1);
    }
    for row in ROWS.start..ROWS.end - 1 {
        for column in -SIDE..SIDE {
            let quad = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| vertex(column + i, row + j));
            let is_lower_lip = open_mouth && row == -8;
            mesh.polygons.push(&quad.map(|corner| match second.get(&corner) {
                Some(&lower) if is_lower_lip => lower,
                _ => corner,
            }));
        }
    }
    if !open_mouth {
        mesh.positions.truncate(mesh.positions.len() - second.len());
    }
    let pick = |landmark: &Landmark| Pick {
        marker: landmark.name.to_string(),
        place: PickPlace::Point(surface::point(&average, landmark.at.into())),
    };
    (mesh, LANDMARKS.iter().map(pick).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::face::outline::{EYE_HALF_WIDTH, eye_center, lid_edges, mouth_line};

    fn at(name: &str) -> Point2<f64> {
        LANDMARKS.iter().find(|landmark| landmark.name == name).expect(name).at.into()
    }

    #[test]
    fn the_table_agrees_with_the_contours() {
        let average = Person::of_seed(0);
        for (side, end) in [(1.0, "l"), (-1.0, "r")] {
            let center = eye_center(&average, side);
            let (lower, upper) = lid_edges(&average, side, center.x).expect("inside the eye");
            assert!((at(&format!("lid_upper_{end}")) - Point2::new(center.x, upper)).norm() < 0.1);
            assert!((at(&format!("lid_lower_{end}")) - Point2::new(center.x, lower)).norm() < 0.1);
            for (name, u) in [("inner", -1.0), ("outer", 1.0)] {
                let s = center.x + side * u * EYE_HALF_WIDTH;
                let (t, _) = lid_edges(&average, side, s).expect("a corner");
                assert!((at(&format!("eye_{name}_{end}")) - Point2::new(s, t)).norm() < 0.1);
            }
            let corner = at(&format!("mouth_corner_{end}"));
            assert!((corner - Point2::new(25.0 * side, mouth_line(25.0))).norm() < 0.1);
        }
        assert!((at("lip_line").y - mouth_line(0.0)).abs() < 0.1);
    }

    #[test]
    fn the_table_agrees_with_the_profile() {
        let average = Person::of_seed(0);
        let z = |t: f64| surface::point(&average, Point2::new(0.0, t)).z;
        let extreme = |low: f64, high: f64, sign: f64| {
            let steps = (0..=1000).map(|i| low + (high - low) * f64::from(i) / 1000.0);
            steps.max_by(|a, b| (sign * z(*a)).total_cmp(&(sign * z(*b)))).unwrap_or(low)
        };
        assert!((extreme(-5.0, 20.0, 1.0) - at("nose_tip").y).abs() < 1.0);
        assert!((extreme(35.0, 56.0, -1.0) - at("nose_root").y).abs() < 1.5);
        assert!((extreme(-50.0, -38.0, -1.0) - at("chin_crease").y).abs() < 1.5);
        assert!((extreme(-68.0, -50.0, 1.0) - at("chin").y).abs() < 2.0);
    }

    #[test]
    fn names_are_mirrored_and_unique() {
        for landmark in &LANDMARKS {
            assert_eq!(LANDMARKS.iter().filter(|other| other.name == landmark.name).count(), 1);
            if let Some(stem) = landmark.name.strip_suffix("_l") {
                let other = at(&format!("{stem}_r"));
                assert_eq!([-other.x, other.y], landmark.at, "{}", landmark.name);
            }
        }
        assert_eq!(closest_name("brow_iner_l"), "brow_inner_l");
    }

    fn place_of(picks: &mut [Pick], name: &str) -> usize {
        picks.iter().position(|pick| pick.marker == name).expect(name)
    }

    fn error(change: impl Fn(&mut Vec<Point3<f64>>, &mut Vec<Pick>)) -> String {
        let (head, mut picks) = test_head(false);
        let mut points = head.positions;
        change(&mut points, &mut picks);
        Placement::of(&points, Unit::Mm, &picks).expect_err("refused").to_string()
    }

    #[test]
    fn the_average_face_lies_on_itself() {
        let (head, picks) = test_head(false);
        let placement = Placement::of(&head.positions, Unit::Mm, &picks).expect("a face");
        assert!(
            (placement.face_from_canonical.to_homogeneous() - nalgebra::Matrix4::identity()).norm() < 1e-9
        );
        let average = Person::of_seed(0);
        let grid = (-16..=16)
            .flat_map(|i| (-15..=22).map(move |j| Point2::new(5.0 * f64::from(i), 4.0 * f64::from(j))));
        // Below the jaw's edge the skin turns inwards: nothing is placed there.
        let face = grid.filter(|at| at.y > surface::jaw_line(&average, at.x) + 5.0);
        let error = |at: Point2<f64>| ((placement.domain_at(&surface::point(&average, at)) - at).norm(), at);
        let worst = face.map(error).max_by(|a, b| a.0.total_cmp(&b.0)).expect("points");
        assert!(worst.0 < 7.0, "{worst:?}");
    }

    #[test]
    fn landmarks_are_met() {
        let (mut head, mut picks) = test_head(false);
        // Another face: wider, longer, with another nose.
        let other = |p: Point3<f64>| Point3::new(1.1 * p.x, 0.95 * p.y, p.z + 4.0 * (p.y / 20.0).sin());
        head.positions.iter_mut().for_each(|point| *point = other(*point));
        for pick in &mut picks {
            if let PickPlace::Point(point) = &mut pick.place {
                *point = other(*point);
            }
        }
        let placement = Placement::of(&head.positions, Unit::Mm, &picks).expect("a face");
        for (pick, landmark) in picks.iter().zip(&LANDMARKS) {
            let PickPlace::Point(point) = pick.place else { continue };
            assert!(
                (placement.domain_at(&point) - Point2::from(landmark.at)).norm() < 0.01,
                "{}",
                pick.marker
            );
        }
    }

    #[test]
    fn a_head_elsewhere_and_of_another_size_unrolls_alike() {
        let (head, mut picks) = test_head(false);
        let there = Similarity3::new(
            nalgebra::Vector3::new(20., 1600., -40.),
            nalgebra::Vector3::new(0.3, -0.7, 0.2),
            1.2,
        );
        let here = Placement::of(&head.positions, Unit::Mm, &picks).expect("a face");
        for pick in &mut picks {
            if let PickPlace::Point(point) = &mut pick.place {
                *point = there * *point;
            }
        }
        let moved: Vec<Point3<f64>> = head.positions.iter().map(|point| there * point).collect();
        let placement = Placement::of(&moved, Unit::Mm, &picks).expect("a face");
        let pairs = here.domain(&head.positions).into_iter().zip(placement.domain(&moved));
        assert!(pairs.into_iter().all(|(one, other)| (one - other).norm() < 1e-6));
    }

    #[test]
    fn the_back_of_the_head_is_far_from_the_face() {
        let (head, picks) = test_head(false);
        let placement = Placement::of(&head.positions, Unit::Mm, &picks).expect("a face");
        for x in [-40.0, -5.0, 5.0, 40.0] {
            assert!(placement.domain_at(&Point3::new(x, 60.0, -110.0)).x.abs() > 130.0);
        }
    }

    #[test]
    fn a_wrong_unit_is_named() {
        let said = error(|points, _| points.iter_mut().for_each(|point| *point *= 0.001));
        assert!(
            said.ends_with("mm large when read in mm; a head has 100 to 500 mm: is its unit m?"),
            "{said}"
        );
        let said = error(|points, _| points.iter_mut().for_each(|point| *point *= 10.0));
        assert!(said.ends_with("a head has 100 to 500 mm"), "{said}");
    }

    #[test]
    fn wrong_picks_are_named() {
        let said = error(|_, picks| picks[3].marker = "eye_outr_r".into());
        assert_eq!(said, "landmark eye_outr_r is not known; the closest name is eye_outer_r");
        let said = error(|_, picks| picks.truncate(11));
        assert_eq!(said, "11 landmarks; at least 12 are needed, spread over the face");
        let said = error(|points, picks| picks[0].place = PickPlace::Vertex(points.len() as u32));
        assert!(said.starts_with("landmark eye_inner_l: vertex "), "{said}");
        let said = error(|_, picks| {
            let (one, other) = (place_of(picks, "brow_mid_l"), place_of(picks, "mouth_corner_l"));
            picks[one].place = picks[other].place;
        });
        assert!(said.starts_with("landmark brow_mid_l lies "), "{said}");
        let said = error(|_, picks| picks[7].place = PickPlace::Point(Point3::new(0.0, 0.0, 0.1)));
        assert!(said.starts_with("landmark lid_lower_r lies "), "{said}");
    }

    #[test]
    fn exchanged_sides_are_named() {
        let said = error(|_, picks| {
            for pick in picks {
                let stem = pick.marker.strip_suffix("_l").map(|stem| format!("{stem}_r"));
                let other = || pick.marker.strip_suffix("_r").map(|stem| format!("{stem}_l"));
                pick.marker = stem.or_else(other).unwrap_or_else(|| pick.marker.clone());
            }
        });
        assert_eq!(said, "left and right are exchanged: _l is the subject's left, at +x");
    }
}
