//! One camera alone: its lens, and where the board was in each view.

use crate::Params;
use crate::bundle::{self, Adjusted, Element, Focal, Free, Loss, Observation, Scene, adjust};
use crate::planar::{focal_px, homography, pose, reversed};
use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Isometry3, Matrix3, Point2, Point3, Vector2};
use std::collections::BTreeMap;

/// What a camera saw of the board at one instant.
#[derive(Debug, Clone)]
pub(crate) struct View {
    /// Index of the instant.
    pub(crate) frame: usize,
    /// Corners by number, px.
    pub(crate) corners: BTreeMap<u32, Point2<f64>>,
}

/// A camera by itself.
#[derive(Debug, Clone)]
pub(crate) struct Alone {
    pub(crate) image_size: [u32; 2],
    pub(crate) lens: Lens,
    /// The views, with the pose of the board in camera space; a view whose pose could not be found is left out.
    pub(crate) views: Vec<(View, Isometry3<f64>)>,
    /// Whether the views fix the lens.
    pub(crate) is_determined: bool,
}

/// Focal lengths that are tried where the homographies do not tell, in widths of the image.
const FOCAL_WIDTHS: [f64; 5] = [0.6, 1.0, 1.6, 2.6, 4.5];
/// Scale of the robust loss while a camera is by itself, px: what is off by more is a corner found wrong.
const COARSE_PX: f64 = 2.0;
/// Half a pixel: no pose is given up for less.
const WORTHLESS: f64 = 1e-9;

/// A camera's lens from its views of a board, robustly; none where no start works out.
pub(crate) fn calibrate_alone(
    image_size: [u32; 2],
    board: &[Point3<f64>],
    views: &[View],
    params: &Params,
) -> Option<Alone> {
    let center = Vector2::new(f64::from(image_size[0]) - 1.0, f64::from(image_size[1]) - 1.0) / 2.0;
    let homographies: Vec<Option<Matrix3<f64>>> = views.iter().map(|view| view.homography(board)).collect();
    let sound: Vec<Matrix3<f64>> = homographies.iter().flatten().copied().collect();
    let width = f64::from(image_size[0].max(image_size[1]));
    let guess = focal_px(&sound, center).filter(|focal| (0.2 * width..20.0 * width).contains(focal));
    let starts = guess.into_iter().chain(FOCAL_WIDTHS.iter().map(|widths| widths * width));
    let start = |focal: f64| {
        let lens =
            Lens { focal_px: Vector2::repeat(focal), center_px: center, distortion: BrownConrady::default() };
        Solo::start(image_size, lens, board, views, &homographies)?
            .adjusted(Free { focal: Focal::Tied, ..Free::NOTHING })
    };
    let solos: Vec<(Solo, f64)> = starts.filter_map(start).collect();
    let best = solos.into_iter().min_by(|(_, a), (_, b)| a.total_cmp(b))?.0;
    best.refined(params)
}

/// Where the board was in each view of a camera whose lens is known; views that tell no pose are left out.
pub(crate) fn posed(camera: &Camera, board: &[Point3<f64>], views: Vec<View>) -> Alone {
    let pose_of = |view: View| {
        let straight = |at: &Point2<f64>| Some(camera.lens.unproject(at.coords)?.xy().into());
        let image: Vec<Point2<f64>> = view.corners.values().filter_map(straight).collect();
        let plane: Vec<Point2<f64>> = view.corners.keys().map(|&id| board[id as usize].xy()).collect();
        let start = (image.len() == plane.len())
            .then(|| homography(&plane, &image))
            .flatten()
            .as_ref()
            .and_then(pose)?;
        let middle = view.middle(board);
        let fits = [start, reversed(&start, &middle)].map(|start| fitted_pose(camera, board, &view, start));
        let best = fits.into_iter().flatten().min_by(|(_, a), (_, b)| a.total_cmp(b))?;
        Some((view, best.0))
    };
    let views = views.into_iter().filter_map(pose_of).collect();
    Alone { image_size: camera.image_size, lens: camera.lens, views, is_determined: true }
}

impl View {
    fn homography(&self, board: &[Point3<f64>]) -> Option<Matrix3<f64>> {
        let plane: Vec<Point2<f64>> = self.corners.keys().map(|&id| board[id as usize].xy()).collect();
        let image: Vec<Point2<f64>> = self.corners.values().copied().collect();
        homography(&plane, &image)
    }
}

/// A camera at the origin, and boards before it.
struct Solo {
    scene: Scene,
    views: Vec<View>,
}

impl Solo {
    fn start(
        image_size: [u32; 2],
        lens: Lens,
        board: &[Point3<f64>],
        views: &[View],
        homographies: &[Option<Matrix3<f64>>],
    ) -> Option<Self> {
        let camera = Camera { image_size, lens, cam_from_world: Isometry3::identity() };
        let to_normalised = calibration_matrix(&lens).try_inverse()?;
        let mut scene = Scene::new(vec![camera], vec![Free::NOTHING]);
        scene.body = board.to_vec();
        let mut kept = Vec::new();
        for (view, homography) in views.iter().zip(homographies) {
            let found = homography.and_then(|h| pose(&(to_normalised * h)));
            let is_in_front =
                |pose: &Isometry3<f64>| view.corners.keys().all(|&id| (pose * board[id as usize]).z > 0.0);
            let Some(world_from_body) = found.filter(is_in_front) else { continue };
            let element = scene.structure.len();
            scene.structure.push(Element::Body { world_from_body });
            scene.observations.extend(observations(view, element));
            kept.push(view.clone());
        }
        (!kept.is_empty()).then_some(Self { scene, views: kept })
    }

    /// Adjusted with these parameters free, and the cost.
    fn adjusted(mut self, free: Free) -> Option<(Self, f64)> {
        self.scene.free = vec![free];
        let loss = Loss::Huber { scale_px: COARSE_PX };
        let adjusted = adjust(&self.scene, &bundle::Params { loss, ..Default::default() }).ok()?;
        let cost = adjusted.cost(loss);
        (self.scene.cameras, self.scene.structure) = (adjusted.cameras, adjusted.structure);
        Some((self, cost))
    }

    /// Everything free that shall be, with poses that lean the right way.
    fn refined(self, params: &Params) -> Option<Alone> {
        let full = params.free().without_pose();
        let few =
            Free { center: false, distortion: [full.distortion[0], false, false, false, false], ..full };
        let (solo, _) = self.adjusted(few)?;
        let (solo, _) = solo.adjusted(full)?;
        let mut solo = solo;
        if solo.turn_reversed() {
            solo = solo.adjusted(full)?.0;
        }
        let loss = Loss::Huber { scale_px: COARSE_PX };
        let adjusted = adjust(&solo.scene, &bundle::Params { loss, ..Default::default() }).ok()?;
        let is_determined = adjusted.deviations.is_some();
        let camera = adjusted.cameras.first()?;
        let poses = adjusted.structure.iter().filter_map(|element| match element {
            Element::Body { world_from_body } => Some(*world_from_body),
            Element::Point(_) => None,
        });
        let views = solo.views.into_iter().zip(poses).collect();
        Some(Alone { image_size: camera.image_size, lens: camera.lens, views, is_determined })
    }

    /// Turns every board over that fits better the other way; whether any did.
    fn turn_reversed(&mut self) -> bool {
        let camera = self.scene.cameras[0].clone();
        let mut turned = false;
        for (view, element) in self.views.iter().zip(&mut self.scene.structure) {
            let Element::Body { world_from_body } = *element else { continue };
            let here = fitted_pose(&camera, &self.scene.body, view, world_from_body);
            let middle = view.middle(&self.scene.body);
            let there = fitted_pose(&camera, &self.scene.body, view, reversed(&world_from_body, &middle));
            if let (Some((_, cost)), Some((pose, other))) = (here, there)
                && other < cost * (1.0 - WORTHLESS)
            {
                *element = Element::Body { world_from_body: pose };
                turned = true;
            }
        }
        turned
    }
}

impl View {
    /// The middle of the corners that are seen, on the board.
    fn middle(&self, board: &[Point3<f64>]) -> Point3<f64> {
        let sum: nalgebra::Vector3<f64> = self.corners.keys().map(|&id| board[id as usize].coords).sum();
        Point3::from(sum / self.corners.len().max(1) as f64)
    }
}

/// The observations of a view by the scene's first camera.
fn observations(view: &View, element: usize) -> impl Iterator<Item = Observation> {
    view.corners.iter().map(move |(&id, at)| Observation {
        camera: 0,
        element,
        point: id as usize,
        pixel: at.coords,
    })
}

/// The pose of the board in camera space that fits a view best near a start, and its cost.
pub(crate) fn fitted_pose(
    camera: &Camera,
    board: &[Point3<f64>],
    view: &View,
    start: Isometry3<f64>,
) -> Option<(Isometry3<f64>, f64)> {
    let own = Camera { cam_from_world: Isometry3::identity(), ..camera.clone() };
    let mut scene = Scene::new(vec![own], vec![Free::NOTHING]);
    scene.body = board.to_vec();
    scene.structure.push(Element::Body { world_from_body: start });
    scene.observations.extend(observations(view, 0));
    let loss = Loss::Huber { scale_px: COARSE_PX };
    let adjusted = adjust(&scene, &bundle::Params { loss, ..Default::default() }).ok()?;
    match adjusted.structure.first()? {
        Element::Body { world_from_body } => Some((*world_from_body, adjusted.cost(loss))),
        Element::Point(_) => None,
    }
}

impl Adjusted {
    fn cost(&self, loss: Loss) -> f64 {
        self.residuals.iter().map(|residual| loss.cost(residual.norm_squared())).sum()
    }
}

fn calibration_matrix(lens: &Lens) -> Matrix3<f64> {
    let Lens { focal_px: f, center_px: c, .. } = lens;
    Matrix3::new(f.x, 0.0, c.x, 0.0, f.y, c.y, 0.0, 0.0, 1.0)
}
