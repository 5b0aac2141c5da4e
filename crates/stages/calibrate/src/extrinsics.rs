//! From cameras that each know the board in their own space to one space for all.
//!
//! Two cameras that saw the board at the same time know how they stand to each other; the links with the most instants in
//! agreement make a tree over all cameras. A detector may number a chessboard's corners from its other end, and a single view
//! may take a board's lean the wrong way round: both show as a link that no other instant agrees with.

use crate::Board;
use crate::intrinsics::Alone;
use camera::fit_rigid;
use nalgebra::{Isometry3, Point3};
use std::collections::BTreeMap;

/// Cameras and boards in the space of the first camera.
pub(crate) struct Joined {
    /// Per camera its pose.
    pub(crate) cam_from_root: Vec<Isometry3<f64>>,
    /// Per frame index the board's pose.
    pub(crate) root_from_board: BTreeMap<usize, Isometry3<f64>>,
    /// Per camera and view which of the board's numberings the detector chose.
    pub(crate) numbering: Vec<Vec<usize>>,
}

/// Instants that a link is guessed from at most.
const MOST_GUESSES: usize = 60;

/// The board, as far as links need it.
struct Plate {
    /// Its outermost corners.
    extremes: [Point3<f64>; 4],
    square_mm: f64,
    /// Per numbering the motion that carries each corner to the one that has its number in the first.
    motions: Vec<Isometry3<f64>>,
}

impl Plate {
    fn of(board: &Board) -> Self {
        let corners = board.corners();
        let [columns, _] = board.grid().map(|count| count as usize);
        let last = corners.len() - 1;
        let extremes = [0, columns - 1, last, last + 1 - columns].map(|id| corners[id]);
        let motion = |way: &Vec<u32>| {
            let moved: Vec<Point3<f64>> = way.iter().map(|&id| corners[id as usize]).collect();
            fit_rigid(&corners, &moved, None).unwrap_or_else(|_| Isometry3::identity())
        };
        let motions = board.numberings().iter().map(motion).collect();
        Self { extremes, square_mm: board.square_mm(), motions }
    }

    /// Mean squared distance of two poses' outermost corners in a camera's image, in squares; 1 at most.
    fn difference(&self, camera: &Alone, a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
        let mut sum = 0.0;
        for corner in &self.extremes {
            let [a, b] = [a, b].map(|pose| (pose * corner).coords);
            if b.z <= 0.0 {
                return 1.0;
            }
            let side = self.square_mm * camera.lens.focal_px.mean() / a.z;
            sum += (camera.lens.project(a) - camera.lens.project(b)).norm_squared() / (side * side);
        }
        (sum / 4.0).min(1.0)
    }

    /// The numbering that makes `expected` (in the first numbering) most like `pose`, and the difference left.
    fn best_numbering(
        &self,
        camera: &Alone,
        pose: &Isometry3<f64>,
        expected: &Isometry3<f64>,
    ) -> (usize, f64) {
        let differences =
            self.motions.iter().map(|motion| self.difference(camera, pose, &(expected * motion)));
        let mut best = (0, f64::INFINITY);
        differences.enumerate().filter(|(_, d)| d.is_finite()).for_each(|(way, d)| {
            if d < best.1 {
                best = (way, d);
            }
        });
        best
    }
}

/// How two cameras stand to each other.
struct Link {
    pair: [usize; 2],
    first_from_second: Isometry3<f64>,
    /// Instants that agree.
    support: usize,
}

/// All cameras in one space.
///
/// # Errors
/// The groups of cameras that no link joins.
pub(crate) fn join(board: &Board, cameras: &[Alone]) -> Result<Joined, Vec<Vec<usize>>> {
    let plate = Plate::of(board);
    let mut links = Vec::new();
    for second in 1..cameras.len() {
        links.extend((0..second).filter_map(|first| link(&plate, cameras, [first, second])));
    }
    // Stable: of equal links the first stands first.
    links.sort_by_key(|link| std::cmp::Reverse(link.support));
    let cam_from_root = spread(cameras.len(), &links)?;
    Ok(place(&plate, cameras, cam_from_root))
}

/// Boards before cameras whose poses are known.
pub(crate) fn place_boards(board: &Board, cameras: &[Alone], cam_from_root: Vec<Isometry3<f64>>) -> Joined {
    place(&Plate::of(board), cameras, cam_from_root)
}

fn link(plate: &Plate, cameras: &[Alone], pair: [usize; 2]) -> Option<Link> {
    let [a, b] = pair.map(|camera| &cameras[camera]);
    let at: BTreeMap<usize, &Isometry3<f64>> =
        a.views.iter().map(|(view, pose)| (view.frame, pose)).collect();
    let shared: Vec<[&Isometry3<f64>; 2]> =
        b.views.iter().filter_map(|(view, pose)| Some([*at.get(&view.frame)?, pose])).collect();
    let stride = shared.len().div_ceil(MOST_GUESSES).max(1);
    let guesses = shared.iter().step_by(stride).flat_map(|[a_from_board, b_from_board]| {
        plate.motions.iter().map(move |motion| **a_from_board * motion * b_from_board.inverse())
    });
    let differences = |guess: &Isometry3<f64>| -> Vec<f64> {
        let difference = |[a_from_board, b_from_board]: &[&Isometry3<f64>; 2]| {
            let expected = guess * **b_from_board;
            plate
                .motions
                .iter()
                .map(|motion| plate.difference(a, a_from_board, &(expected * motion.inverse())))
                .fold(1.0, f64::min)
        };
        shared.iter().map(difference).collect()
    };
    let scored = guesses.map(|guess| (differences(&guess), guess));
    let (differences, first_from_second) =
        scored.min_by(|(a, _), (b, _)| a.iter().sum::<f64>().total_cmp(&b.iter().sum()))?;
    let support = differences.iter().filter(|difference| **difference < 1.0).count();
    Some(Link { pair, first_from_second, support })
}

/// Poses along the strongest links, from the first camera on.
fn spread(count: usize, links: &[Link]) -> Result<Vec<Isometry3<f64>>, Vec<Vec<usize>>> {
    let mut poses: Vec<Option<Isometry3<f64>>> = vec![None; count];
    let mut group_of: Vec<usize> = (0..count).collect();
    let mut tree = Vec::new();
    for link in links {
        let [a, b] = link.pair.map(|camera| group_of[camera]);
        if a != b {
            group_of.iter_mut().filter(|group| **group == b).for_each(|group| *group = a);
            tree.push(link);
        }
    }
    let groups: std::collections::BTreeSet<usize> = group_of.iter().copied().collect();
    if groups.len() > 1 {
        let members = |group: &usize| (0..count).filter(|camera| group_of[*camera] == *group).collect();
        return Err(groups.iter().map(members).collect());
    }
    poses[0] = Some(Isometry3::identity());
    for _ in 0..count {
        for Link { pair: [first, second], first_from_second, .. } in &tree {
            match (poses[*first], poses[*second]) {
                (Some(pose), None) => poses[*second] = Some(first_from_second.inverse() * pose),
                (None, Some(pose)) => poses[*first] = Some(first_from_second * pose),
                _ => {}
            }
        }
    }
    Ok(poses.into_iter().flatten().collect())
}

/// Per frame the pose that its views agree on best, and how each view's corners are numbered in it.
fn place(plate: &Plate, cameras: &[Alone], cam_from_root: Vec<Isometry3<f64>>) -> Joined {
    let mut views: BTreeMap<usize, Vec<(usize, usize)>> = BTreeMap::new();
    for (c, camera) in cameras.iter().enumerate() {
        camera
            .views
            .iter()
            .enumerate()
            .for_each(|(v, (view, _))| views.entry(view.frame).or_default().push((c, v)));
    }
    let mut numbering: Vec<Vec<usize>> = cameras.iter().map(|camera| vec![0; camera.views.len()]).collect();
    let mut boards = BTreeMap::new();
    for (frame, seen) in views {
        let pose_of = |&(c, v): &(usize, usize)| cam_from_root[c].inverse() * cameras[c].views[v].1;
        let fits = |root_from_board: &Isometry3<f64>| -> Vec<(usize, f64)> {
            let fit = |&(c, v): &(usize, usize)| {
                plate.best_numbering(
                    &cameras[c],
                    &cameras[c].views[v].1,
                    &(cam_from_root[c] * root_from_board),
                )
            };
            seen.iter().map(fit).collect()
        };
        let total = |fits: &[(usize, f64)]| fits.iter().map(|(_, difference)| difference).sum::<f64>();
        let candidates = seen.iter().map(pose_of).map(|pose| (fits(&pose), pose));
        let best = candidates.min_by(|(a, _), (b, _)| total(a).total_cmp(&total(b)));
        if let Some((fits_there, pose)) = best {
            // What most views say is the board's own numbering.
            let count = |way: usize| fits_there.iter().filter(|(other, _)| *other == way).count();
            let common = (0..plate.motions.len()).rev().max_by_key(|&way| count(way)).unwrap_or(0);
            let pose = pose * plate.motions[common];
            let fits = fits(&pose);
            boards.insert(frame, pose);
            seen.iter().zip(fits).for_each(|(&(c, v), (way, _))| numbering[c][v] = way);
        }
    }
    Joined { cam_from_root, root_from_board: boards, numbering }
}
