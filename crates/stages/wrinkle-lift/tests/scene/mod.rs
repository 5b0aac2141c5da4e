//! A face, cameras before it, and wrinkles planted on it.
#![allow(dead_code, clippy::unwrap_used, reason = "each test uses its part of it")]

use artifact::{Section, SectionState, ValleyPoint, ValleysFrame};
use camera::{BrownConrady, Camera, Lens};
use mesh::Mesh;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector2, Vector3};
use operators::{Inverse, InvertParams, RbfMap, RbfSum};
use std::collections::BTreeMap;
use wrinkle_lift::{Ground, Image, Lifter, Params, Scene, Spaces, Tally};

/// Per wrinkle id its sections.
pub(crate) type Sections = BTreeMap<String, Vec<Section>>;

/// Radius of the face's curvature, mm.
const RADIUS: f64 = 90.0;

/// A dome of triangles with 1.5 mm sides: face space.
pub(crate) fn dome() -> Mesh {
    let count = 61u32;
    let side = |i: u32| 1.5 * (f64::from(i) - 30.0);
    let points = (0..count * count).map(|k| {
        let (x, y) = (side(k % count), side(k / count));
        [x, y, -(x * x + y * y) / (2.0 * RADIUS)]
    });
    let corner = |i: u32, j: u32| j * count + i;
    let squares = (0..count - 1).flat_map(|j| (0..count - 1).map(move |i| (i, j)));
    let triangles: Vec<[u32; 3]> = squares
        .flat_map(|(i, j)| {
            let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    Mesh::from_triangles(points.collect(), &triangles)
}

/// Coefficients of a warp that turns, stretches and bends a little, in units of 100 mm.
pub(crate) const BENT: [[f64; 3]; 10] = [
    [3.0, -5.0, 2.0],
    [99.0, 10.0, 0.0],
    [-10.0, 99.0, 2.0],
    [0.0, -2.0, 100.0],
    [0.5, 0.0, 1.0],
    [0.0, -0.8, 0.6],
    [0.0, 0.0, 0.3],
    [0.4, 0.0, -0.5],
    [0.0, 0.2, 0.0],
    [0.3, 0.0, 0.0],
];

/// The warp, and its inverse.
pub(crate) fn spaces() -> Spaces {
    let map = |polynomial: &[[f64; 3]]| {
        RbfMap::new(&RbfSum { origin_mm: [0.0; 3], scale_mm: 100.0, centers: &[], weights: &[], polynomial })
    };
    let same = [[0.0; 3], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 100.0]];
    let face_from_head = map(&BENT);
    let head_from_face = Inverse::of(face_from_head.clone(), map(&same), InvertParams::default());
    Spaces { face_from_head, head_from_face }
}

/// A camera half a metre away, so many degrees to the right of the face, with a lens that bends lines.
pub(crate) fn camera(azimuth_deg: f64) -> Camera {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::y() * azimuth_deg.to_radians());
    let eye = Point3::from(turn * Vector3::new(0.0, 30.0, 500.0));
    let distortion = BrownConrady { k1: -0.12, k2: 0.03, p1: 5e-4, p2: -3e-4, k3: 0.0 };
    let lens =
        Lens { focal_px: Vector2::new(3000.0, 3010.0), center_px: Vector2::new(690.0, 515.0), distortion };
    let pose = Camera::pose_looking_at(eye, Point3::new(0.0, 0.0, -10.0), Vector3::y());
    Camera { image_size: [1384, 1038], lens, cam_from_world: pose }
}

/// Where the head is.
pub(crate) fn pose() -> Isometry3<f64> {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.05, -0.1, 0.03));
    Isometry3::from_parts(Vector3::new(4.0, -3.0, 6.0).into(), turn)
}

/// A wrinkle on the dome.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Planted {
    /// Its deepest place is so deep, mm.
    pub(crate) d_mm: f64,
    pub(crate) w_mm: f64,
    /// It goes from x = −reach to reach, mm.
    pub(crate) reach: f64,
}

impl Default for Planted {
    fn default() -> Self {
        Self { d_mm: 1.5, w_mm: 2.0, reach: 25.0 }
    }
}

/// A place of a planted wrinkle.
pub(crate) struct True {
    pub(crate) foot: Point3<f64>,
    pub(crate) bottom: Point3<f64>,
    pub(crate) across: Vector3<f64>,
    pub(crate) w_mm: f64,
    pub(crate) d_mm: f64,
}

impl Planted {
    fn foot(x: f64) -> Point3<f64> {
        let y = 12.0 + 4.0 * (x / 12.0).sin();
        Point3::new(x, y, -(x * x + y * y) / (2.0 * RADIUS))
    }

    /// The wrinkle's place at a share of its length.
    pub(crate) fn at(&self, share: f64) -> True {
        let bottom = |share: f64| {
            let foot = Self::foot(self.reach * (2.0 * share - 1.0));
            let normal = Vector3::new(foot.x / RADIUS, foot.y / RADIUS, 1.0).normalize();
            let d = self.d_mm * (std::f64::consts::PI * share).sin();
            (foot, normal, foot - normal * d, d)
        };
        let (foot, normal, at, d_mm) = bottom(share);
        let along = bottom(share + 1e-4).2 - bottom(share - 1e-4).2;
        True { foot, bottom: at, across: along.cross(&normal).normalize(), w_mm: self.w_mm, d_mm }
    }

    /// Its sections as a camera sees them, at `count` places over the shares `part` of its length.
    pub(crate) fn seen(
        &self,
        camera: &Camera,
        world_from_head: &Isometry3<f64>,
        part: [f64; 2],
        count: usize,
    ) -> Vec<Section> {
        let inverse = spaces().head_from_face;
        let pixel = |point: Point3<f64>| {
            let head = inverse.preimages(&[point])[0].point;
            camera.project(&(world_from_head * head)).unwrap()
        };
        let section = |i: usize| {
            let u = i as f64 / (count - 1) as f64;
            let True { foot, bottom, across, w_mm, d_mm } = self.at(part[0] + u * (part[1] - part[0]));
            let width = 0.5 * (pixel(foot + across * w_mm) - pixel(foot - across * w_mm));
            let state = if d_mm > 0.0 { SectionState::Measured } else { SectionState::Flat };
            Section {
                u,
                at: pixel(bottom).into(),
                normal: width.normalize().into(),
                w_px: width.norm(),
                d_px: width.norm() * d_mm / w_mm,
                epsilon: 0.1,
                kappa: 0.2,
                tilt_rad: None,
                deviation: None,
                residual: None,
                state,
            }
        };
        (0..count).map(section).collect()
    }
}

/// Both ways along: the sections of a curve that was followed from its other end.
pub(crate) fn reversed(sections: &[Section]) -> Vec<Section> {
    let last = sections.last().unwrap().u;
    let turn = |section: &Section| Section {
        u: last - section.u,
        normal: section.normal.map(|x| -x),
        kappa: -section.kappa,
        ..*section
    };
    sections.iter().rev().map(turn).collect()
}

/// Sections of the wrinkle `brow`.
pub(crate) fn brow(sections: Vec<Section>) -> Sections {
    [("brow".to_string(), sections)].into()
}

/// Lifts what cameras with these poses of the head saw.
pub(crate) fn lifted(views: &[(Camera, Isometry3<f64>, Sections)], params: &Params) -> (ValleysFrame, Tally) {
    let (mesh, spaces) = (dome(), spaces());
    let ground = Ground::of(&mesh);
    let scene = Scene::new(&ground, mesh.positions.clone(), &spaces);
    let ids: Vec<String> = (1..=views.len()).map(|i| format!("w{i}")).collect();
    let images: Vec<Image> = views
        .iter()
        .zip(&ids)
        .map(|((camera, world_from_head, sections), id)| Image {
            id,
            camera,
            world_from_head: *world_from_head,
            scene: &scene,
            sections,
        })
        .collect();
    Lifter { ground: &ground, spaces: &spaces, params }.frame(1001, &mesh.positions, &images)
}

/// How far the points lie off the planted wrinkle's bottom, and their relative errors in width and depth, at the worst; only where the
/// wrinkle is deep.
pub(crate) fn worst(points: &[ValleyPoint], planted: &Planted) -> [f64; 3] {
    let truth: Vec<True> = (0..=2000).map(|i| planted.at(f64::from(i) / 2000.0)).collect();
    let mut worst = [0.0f64; 3];
    for point in points {
        let off = |one: &&True| (one.bottom - Point3::from(point.at_mm)).norm();
        let nearest = truth.iter().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
        if nearest.d_mm < 0.2 * planted.d_mm {
            continue;
        }
        let errors =
            [off(&nearest), (point.w_mm / nearest.w_mm - 1.0).abs(), (point.d_mm / nearest.d_mm - 1.0).abs()];
        (0..3).for_each(|i| worst[i] = worst[i].max(errors[i]));
    }
    worst
}
