//! Where a camera should see a dot.

use super::{Dot, Touch};
use camera::Camera;
use nalgebra::{Point3, Vector2, Vector3};
use std::collections::HashMap;

/// The radius of a dot over the size of the pieces that it is cut into.
const FINENESS: f64 = 12.0;

/// A dot cut into small triangles that lie on the surface and follow it. Their projected areas give the dot's centroid in an
/// image without asking any pixel.
///
/// Each triangle of the surface that the dot touches is halved until its pieces are small, and these along the dot's outline, so that a dot at
/// a rim has just the paint that there is skin for. Along the outline, chords stand for it: the area is 0.1 % too small.
#[derive(Debug, Clone, Default)]
pub struct DotSamples {
    /// Corners of the surface and their weights.
    nodes: Vec<Place>,
    /// Triangles between nodes, turned as the surface's.
    pieces: Vec<[u32; 3]>,
}

/// Corners of the surface and their weights.
type Place = ([u32; 3], [f64; 3]);

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
        let mut samples = Self::default();
        for (triangle, touch) in touches {
            let mut numbers = HashMap::new();
            samples.cut(dot, triangles[*triangle as usize], &touch.corners, &mut numbers);
        }
        samples
    }

    /// Adds what of a triangle is painted; `corners` are its corners in the dot's coordinates.
    fn cut(&mut self, dot: &Dot, vertices: [u32; 3], corners: &[[f64; 2]; 3], numbers: &mut Numbers) {
        let corner = |weights| Corner::of(dot, weights, corners);
        let whole = [corner([1.0, 0.0, 0.0]), corner([0.0, 1.0, 0.0]), corner([0.0, 0.0, 1.0])];
        let mut left = vec![whole];
        while let Some(piece) = left.pop() {
            let [a, b, c] = &piece;
            let longest = a.apart(b).max(b.apart(c)).max(c.apart(a));
            // Every point of a piece lies within its longest side of each corner.
            if a.place[0].hypot(a.place[1]) > dot.outline.largest_radius() + longest {
                continue;
            }
            if longest * FINENESS <= dot.outline.radius_mm {
                self.add(piece, vertices, numbers);
                continue;
            }
            let middle = |from: &Corner, to: &Corner| {
                corner(std::array::from_fn(|k| 0.5 * (from.weights[k] + to.weights[k])))
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            let [a, b, c] = piece;
            left.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
    }

    /// Adds the part of a piece that lies inside the outline.
    fn add(&mut self, piece: [Corner; 3], vertices: [u32; 3], numbers: &mut Numbers) {
        let mut kept: Vec<[f64; 3]> = Vec::with_capacity(4);
        for side in 0..3 {
            let (from, to) = (&piece[side], &piece[(side + 1) % 3]);
            if from.inside_mm > 0.0 {
                kept.push(from.weights);
            }
            if (from.inside_mm > 0.0) != (to.inside_mm > 0.0) {
                let share = from.inside_mm / (from.inside_mm - to.inside_mm);
                kept.push(std::array::from_fn(|k| {
                    from.weights[k] + share * (to.weights[k] - from.weights[k])
                }));
            }
        }
        let number = |weights: [f64; 3]| {
            *numbers.entry(weights.map(f64::to_bits)).or_insert_with(|| {
                self.nodes.push((vertices, weights));
                self.nodes.len() as u32 - 1
            })
        };
        let kept: Vec<u32> = kept.into_iter().map(number).collect();
        self.pieces.extend((2..kept.len()).map(|last| [kept[0], kept[last - 1], kept[last]]));
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
        let nodes: Vec<Node> = self.nodes.iter().map(|node| Node::of(node, positions, camera)).collect();
        let mut sum = Sum::default();
        for piece in &self.pieces {
            sum.add(piece.map(|node| &nodes[node as usize]), camera, &visible);
        }
        sum.finish(camera)
    }
}

/// Numbers of a triangle's nodes by their weights: neighbouring pieces share them.
type Numbers = HashMap<[u64; 3], u32>;

/// A corner of a piece: weights of the triangle's corners, and how far inside the outline it lies.
#[derive(Clone, Copy)]
struct Corner {
    weights: [f64; 3],
    /// In the dot's coordinates, mm.
    place: [f64; 2],
    inside_mm: f64,
}

impl Corner {
    fn of(dot: &Dot, weights: [f64; 3], corners: &[[f64; 2]; 3]) -> Self {
        let [a, b] = [0, 1].map(|axis| (0..3).map(|k| weights[k] * corners[k][axis]).sum::<f64>());
        Self { weights, place: [a, b], inside_mm: dot.outline.radius(b.atan2(a)) - a.hypot(b) }
    }

    fn apart(&self, other: &Self) -> f64 {
        (self.place[0] - other.place[0]).hypot(self.place[1] - other.place[1])
    }
}

struct Node {
    position: Point3<f64>,
    pixel: Vector2<f64>,
}

impl Node {
    fn of((corners, weights): &Place, positions: &[Point3<f64>], camera: &Camera) -> Self {
        let sum: Vector3<f64> = corners
            .iter()
            .zip(weights)
            .map(|(&vertex, weight)| *weight * positions[vertex as usize].coords)
            .sum();
        let position = Point3::from(sum);
        // Behind the camera nothing is seen, but the paint is still there.
        let pixel = camera.project(&position).unwrap_or(Vector2::repeat(f64::NAN));
        Self { position, pixel }
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
