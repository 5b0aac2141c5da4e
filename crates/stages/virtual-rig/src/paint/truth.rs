//! Where a camera should see a dot.

use super::{Dot, Touch};
use camera::Camera;
use nalgebra::{Point3, Vector2, Vector3};
use std::f64::consts::TAU;

/// Rings of quads that a dot is cut into.
const RINGS: usize = 8;
/// Quads per ring.
const SECTORS: usize = 64;
/// A node this far outside a triangle, in weights of its corners, still counts as on its edge.
const ON_EDGE: f64 = 1e-9;

/// A dot cut into small quads between rings and rays, whose corners are located on the surface once and follow it from
/// then on. Their projected areas give the dot's centroid in an image without asking any pixel.
///
/// The nodes are pushed outwards by √(θ / sin θ), θ = 2π / 64, so that the polygon has the area of the smooth outline.
#[derive(Debug, Clone)]
pub struct DotSamples {
    /// Corners of the surface and their weights: the centre, then ring by ring; none off the surface.
    nodes: Vec<Option<([u32; 3], [f64; 3])>>,
}

/// A dot as a camera sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DotView {
    /// Centroid of its visible paint, weighted by area in the image, px; none where nothing of it is seen.
    pub centroid_px: Option<Vector2<f64>>,
    /// Area of its visible paint in the image, px².
    pub area_px: f64,
    /// Centroid of all its paint, weighted by area on the surface, mm.
    pub center_in_world: Point3<f64>,
    /// Area of its paint on the surface, mm².
    pub area_mm2: f64,
    /// Share of that area that faces the camera, unhidden, inside the image.
    pub share_seen: f64,
    /// Angle between the surface's normal, averaged over the dot, and the direction to the camera, rad.
    pub angle_rad: f64,
}

impl DotSamples {
    pub(super) fn locate(dot: &Dot, triangles: &[[u32; 3]], touches: &[(u32, Touch)]) -> Self {
        let theta = TAU / SECTORS as f64;
        let push = (theta / theta.sin()).sqrt();
        let node = |ring: usize, sector: usize| {
            let angle = theta * sector as f64;
            let distance = push * dot.outline.radius(angle) * ring as f64 / RINGS as f64;
            find([distance * angle.cos(), distance * angle.sin()], touches)
                .map(|(triangle, weights)| (triangles[triangle as usize], weights))
        };
        let rings = (1..=RINGS).flat_map(|ring| (0..SECTORS).map(move |sector| (ring, sector)));
        let nodes = std::iter::once((0, 0)).chain(rings).map(|(ring, sector)| node(ring, sector)).collect();
        Self { nodes }
    }

    /// How a camera sees the dot. `visible` says whether nothing hides a point in the world that lands on that pixel
    /// position; it need not ask which way the surface faces.
    ///
    /// `positions`: #V × 3, world, mm; at mid-exposure if the surface moves.
    #[must_use]
    pub fn view(
        &self,
        positions: &[Point3<f64>],
        camera: &Camera,
        visible: impl Fn(&Point3<f64>, Vector2<f64>) -> bool,
    ) -> DotView {
        let nodes: Vec<Option<Node>> =
            self.nodes.iter().map(|node| Node::of(node, positions, camera)).collect();
        let mut sum = Sum::default();
        for triangle in patches() {
            let [Some(a), Some(b), Some(c)] = triangle.map(|node| nodes[node].as_ref()) else { continue };
            sum.add([a, b, c], camera, &visible);
        }
        sum.finish(camera)
    }
}

/// The triangles of all quads, counter-clockwise about the dot's normal.
fn patches() -> impl Iterator<Item = [usize; 3]> {
    let node = |ring: usize, sector: usize| match ring {
        0 => 0,
        _ => 1 + (ring - 1) * SECTORS + sector % SECTORS,
    };
    (0..RINGS).flat_map(move |ring| {
        (0..SECTORS).flat_map(move |sector| {
            let [inner, inner_next] = [sector, sector + 1].map(|sector| node(ring, sector));
            let [outer, outer_next] = [sector, sector + 1].map(|sector| node(ring + 1, sector));
            let both = [[inner, outer, outer_next], [inner, outer_next, inner_next]];
            both.into_iter().take(if ring == 0 { 1 } else { 2 })
        })
    })
}

/// The triangle that holds a place of the layer, and the weights of its corners.
fn find(place: [f64; 2], touches: &[(u32, Touch)]) -> Option<(u32, [f64; 3])> {
    touches.iter().find_map(|(triangle, touch)| {
        let weights = weights(place, &touch.corners)?;
        weights.iter().all(|&weight| weight >= -ON_EDGE).then_some((*triangle, weights))
    })
}

fn weights([x, y]: [f64; 2], [p, q, r]: &[[f64; 2]; 3]) -> Option<[f64; 3]> {
    let cross = |a: [f64; 2], b: [f64; 2]| a[0] * b[1] - a[1] * b[0];
    let [to_q, to_r, to_place] =
        [[q[0] - p[0], q[1] - p[1]], [r[0] - p[0], r[1] - p[1]], [x - p[0], y - p[1]]];
    let area = cross(to_q, to_r);
    let (second, third) = (cross(to_place, to_r) / area, cross(to_q, to_place) / area);
    (area != 0.0).then_some([1.0 - second - third, second, third])
}

struct Node {
    position: Point3<f64>,
    pixel: Vector2<f64>,
}

impl Node {
    fn of(place: &Option<([u32; 3], [f64; 3])>, positions: &[Point3<f64>], camera: &Camera) -> Option<Self> {
        let (corners, weights) = place.as_ref()?;
        let sum: Vector3<f64> = corners
            .iter()
            .zip(weights)
            .map(|(&vertex, weight)| *weight * positions[vertex as usize].coords)
            .sum();
        let position = Point3::from(sum);
        // Behind the camera nothing is seen, but the paint is still there.
        let pixel = camera.project(&position).unwrap_or(Vector2::repeat(f64::NAN));
        Some(Self { position, pixel })
    }
}

#[derive(Default)]
struct Sum {
    area_px: f64,
    moment_px: Vector2<f64>,
    area_mm2: f64,
    seen_mm2: f64,
    moment: Vector3<f64>,
    normal: Vector3<f64>,
}

impl Sum {
    fn add(
        &mut self,
        nodes: [&Node; 3],
        camera: &Camera,
        visible: &impl Fn(&Point3<f64>, Vector2<f64>) -> bool,
    ) {
        let [a, b, c] = nodes.map(|node| node.position.coords);
        let normal = 0.5 * (b - a).cross(&(c - a));
        let area_mm2 = normal.norm();
        let middle = (a + b + c) / 3.0;
        self.area_mm2 += area_mm2;
        self.moment += area_mm2 * middle;
        self.normal += normal;
        let [a, b, c] = nodes.map(|node| node.pixel);
        // y runs down in the image, so what faces the camera turns the other way.
        let area_px = -0.5 * (b - a).perp(&(c - a));
        let pixel = (a + b + c) / 3.0;
        if area_px > 0.0 && camera.contains(pixel) && visible(&middle.into(), pixel) {
            self.area_px += area_px;
            self.moment_px += area_px * pixel;
            self.seen_mm2 += area_mm2;
        }
    }

    fn finish(self, camera: &Camera) -> DotView {
        let center_in_world = Point3::from(self.moment / self.area_mm2);
        DotView {
            centroid_px: (self.area_px > 0.0).then(|| self.moment_px / self.area_px),
            area_px: self.area_px,
            center_in_world,
            area_mm2: self.area_mm2,
            share_seen: self.seen_mm2 / self.area_mm2,
            angle_rad: self.normal.angle(&(camera.eye_in_world() - center_in_world)),
        }
    }
}
