//! Which triangle holds which paint.

use super::edge::Spot;
use super::{Dot, DotSamples, Paint, Stroke};
use nalgebra::{Point3, Vector3};

/// A dot's coordinates reach this many radii from its centre, and two edges of its triangle more.
const REACH: f64 = 2.5;
/// Footprints of samples reach over a dot's edge by up to this share of its radius.
const DOT_MARGIN: f64 = 0.4;
/// No coordinate.
const UNSEEN: [f64; 2] = [f64::NAN; 2];

/// Coordinates of a stroke's wrinkle line on the skin at rest, for the vertices near it. A triangle can only be painted
/// if all its corners have them, so they should reach an edge farther than the paint.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct StrokeCoordinates {
    /// Vertices, in any order.
    pub vertices: Vec<u32>,
    /// (x along the line, p across it) of each, mm.
    pub coordinates: Vec<[f64; 2]>,
}

/// A layer that may touch a triangle, with the layer's coordinates of the triangle's corners, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Number of the layer: strokes first, then dots.
    pub layer: u32,
    /// Two coordinates per corner.
    pub corners: [[f64; 2]; 3],
}

/// All paint on a surface, and which triangles it may touch. Later layers lie over earlier ones; dots over strokes.
#[derive(Debug, Clone)]
pub struct Layers {
    strokes: Vec<Stroke>,
    dots: Vec<Dot>,
    samples: Vec<DotSamples>,
    /// Touches of triangle t: `starts[t]..starts[t + 1]`.
    starts: Vec<u32>,
    touches: Vec<Touch>,
}

impl Layers {
    /// The layers of dots and strokes on a surface at rest.
    ///
    /// A dot's coordinates are given to the vertices within its reach whose normals lie within 90° of its own, as far as
    /// triangles between such vertices lead: paint on one lip does not come off on the other.
    ///
    /// `rest`: #V × 3, mm; `normals`: #V × 3; `triangles`: #F × 3, counter-clockwise seen from outside.
    #[must_use]
    pub fn build(
        rest: &[Point3<f64>],
        normals: &[Vector3<f64>],
        triangles: &[[u32; 3]],
        dots: Vec<Dot>,
        strokes: Vec<(Stroke, StrokeCoordinates)>,
    ) -> Self {
        let surface = Surface { rest, normals, triangles, around: Around::of(rest.len(), triangles) };
        let mut touches = Vec::new();
        let mut coordinates = vec![UNSEEN; rest.len()];
        for (layer, (stroke, places)) in strokes.iter().enumerate() {
            surface.touch_stroke(stroke, places, layer as u32, &mut coordinates, &mut touches);
        }
        let mut samples = Vec::with_capacity(dots.len());
        for (index, dot) in dots.iter().enumerate() {
            let first = touches.len();
            surface.touch_dot(dot, (strokes.len() + index) as u32, &mut coordinates, &mut touches);
            samples.push(DotSamples::locate(dot, triangles, &touches[first..]));
        }
        let strokes = strokes.into_iter().map(|(stroke, _)| stroke).collect();
        let (starts, touches) = by_triangle(triangles.len(), touches);
        Self { strokes, dots, samples, starts, touches }
    }

    /// How many layers there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.strokes.len() + self.dots.len()
    }

    /// Whether there is no paint.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The strokes; layer number = position.
    #[must_use]
    pub fn strokes(&self) -> &[Stroke] {
        &self.strokes
    }

    /// The dots; their layers follow the strokes'.
    #[must_use]
    pub fn dots(&self) -> &[Dot] {
        &self.dots
    }

    /// The layer of a dot.
    #[must_use]
    pub fn layer_of_dot(&self, dot: usize) -> u32 {
        (self.strokes.len() + dot) as u32
    }

    /// Where the paint of each dot lies, in the order of the dots.
    #[must_use]
    pub fn dot_samples(&self) -> &[DotSamples] {
        &self.samples
    }

    /// The paint of a layer.
    #[must_use]
    pub fn paint(&self, layer: u32) -> Paint {
        match self.strokes.get(layer as usize) {
            Some(stroke) => stroke.paint,
            None => self.dots[layer as usize - self.strokes.len()].paint,
        }
    }

    /// The paint of a layer at a place in its coordinates.
    pub(crate) fn paint_at(&self, layer: u32, at: [f64; 2]) -> Paint {
        match self.strokes.get(layer as usize) {
            Some(stroke) => stroke.paint_at(at),
            None => self.paint(layer),
        }
    }

    /// The layers that may touch a triangle, lowest first.
    #[must_use]
    pub fn touching(&self, triangle: u32) -> &[Touch] {
        let [from, to] = [0, 1].map(|step| self.starts[triangle as usize + step] as usize);
        &self.touches[from..to]
    }

    /// The share of a sample's footprint that a layer covers; `ramp_px` is the footprint's width.
    pub(crate) fn share(&self, layer: u32, spot: &Spot, ramp_px: f64) -> f64 {
        match self.strokes.get(layer as usize) {
            Some(stroke) => stroke.share(spot, ramp_px),
            None => self.dots[layer as usize - self.strokes.len()].share(spot, ramp_px),
        }
    }
}

/// Touches in the order of triangles, then layers; and where each triangle's begin.
fn by_triangle(triangle_count: usize, mut touches: Vec<(u32, Touch)>) -> (Vec<u32>, Vec<Touch>) {
    touches.sort_by_key(|(triangle, touch)| (*triangle, touch.layer));
    let mut starts = vec![0; triangle_count + 1];
    for (triangle, _) in &touches {
        starts[*triangle as usize + 1] += 1;
    }
    for triangle in 0..triangle_count {
        starts[triangle + 1] += starts[triangle];
    }
    (starts, touches.into_iter().map(|(_, touch)| touch).collect())
}

struct Surface<'a> {
    rest: &'a [Point3<f64>],
    normals: &'a [Vector3<f64>],
    triangles: &'a [[u32; 3]],
    around: Around,
}

impl Surface<'_> {
    fn touch_stroke(
        &self,
        stroke: &Stroke,
        places: &StrokeCoordinates,
        layer: u32,
        coordinates: &mut [[f64; 2]],
        touches: &mut Vec<(u32, Touch)>,
    ) {
        for (&vertex, place) in places.vertices.iter().zip(&places.coordinates) {
            coordinates[vertex as usize] = *place;
        }
        for triangle in self.around.triangles_at(&places.vertices) {
            let corners = self.triangles[triangle as usize].map(|vertex| coordinates[vertex as usize]);
            let known = corners.iter().flatten().all(|x| x.is_finite());
            if known && stroke.may_touch(&corners) {
                touches.push((triangle, Touch { layer, corners }));
            }
        }
        places.vertices.iter().for_each(|&vertex| coordinates[vertex as usize] = UNSEEN);
    }

    fn touch_dot(
        &self,
        dot: &Dot,
        layer: u32,
        coordinates: &mut [[f64; 2]],
        touches: &mut Vec<(u32, Touch)>,
    ) {
        let axes = dot.axes();
        let vertices = self.near(dot);
        for &vertex in &vertices {
            coordinates[vertex as usize] = dot.coordinates(&self.rest[vertex as usize], &axes);
        }
        let radius = (1.0 + DOT_MARGIN) * dot.outline.largest_radius();
        for triangle in self.around.triangles_at(&vertices) {
            let corners = self.triangles[triangle as usize].map(|vertex| coordinates[vertex as usize]);
            let known = corners.iter().flatten().all(|x| x.is_finite());
            if known && distance_from_origin(&corners) <= radius {
                touches.push((triangle, Touch { layer, corners }));
            }
        }
        vertices.iter().for_each(|&vertex| coordinates[vertex as usize] = UNSEEN);
    }

    /// The vertices that triangles lead to from a dot's own, within its reach and facing its way. The corners of its own
    /// triangle always belong to them.
    fn near(&self, dot: &Dot) -> Vec<u32> {
        let home = self.triangles[dot.triangle as usize];
        let at = |vertex: u32| self.rest[vertex as usize];
        let edge = (0..3).map(|i| (at(home[i]) - at(home[(i + 1) % 3])).norm()).fold(0.0, f64::max);
        let reach = REACH * dot.outline.largest_radius() + 2.0 * edge;
        let belongs = |vertex: u32| {
            let faces_alike = self.normals[vertex as usize].dot(&dot.normal) > 0.0;
            faces_alike && (at(vertex) - dot.center).norm() <= reach || home.contains(&vertex)
        };
        let mut found = home.to_vec();
        let mut seen: std::collections::BTreeSet<u32> = home.into();
        let mut next = 0;
        while let Some(&vertex) = found.get(next) {
            next += 1;
            for &triangle in self.around.triangles(vertex) {
                let corners = self.triangles[triangle as usize];
                if corners.iter().all(|&corner| belongs(corner)) {
                    found.extend(corners.into_iter().filter(|&corner| seen.insert(corner)));
                }
            }
        }
        found
    }
}

/// The triangles around each vertex.
struct Around {
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Around {
    fn of(vertex_count: usize, triangles: &[[u32; 3]]) -> Self {
        let mut starts = vec![0u32; vertex_count + 1];
        for &vertex in triangles.iter().flatten() {
            starts[vertex as usize + 1] += 1;
        }
        for vertex in 0..vertex_count {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut list = vec![0; 3 * triangles.len()];
        for (triangle, corners) in triangles.iter().enumerate() {
            for &vertex in corners {
                list[next[vertex as usize] as usize] = triangle as u32;
                next[vertex as usize] += 1;
            }
        }
        Self { starts, triangles: list }
    }

    fn triangles(&self, vertex: u32) -> &[u32] {
        let [from, to] = [0, 1].map(|step| self.starts[vertex as usize + step] as usize);
        &self.triangles[from..to]
    }

    /// The triangles around some vertices, each once, in rising order.
    fn triangles_at(&self, vertices: &[u32]) -> Vec<u32> {
        let mut all: Vec<u32> = vertices.iter().flat_map(|&vertex| self.triangles(vertex)).copied().collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}

/// How far a flat triangle lies from the origin; 0 if it holds it.
fn distance_from_origin(corners: &[[f64; 2]; 3]) -> f64 {
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let sides: [f64; 3] = std::array::from_fn(|i| cross(corners[i], corners[(i + 1) % 3]));
    if sides.iter().all(|&side| side >= 0.0) || sides.iter().all(|&side| side <= 0.0) {
        return 0.0;
    }
    (0..3).map(|i| distance_to_segment(corners[i], corners[(i + 1) % 3])).fold(f64::INFINITY, f64::min)
}

fn distance_to_segment([x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> f64 {
    let (dx, dy) = (x1 - x0, y1 - y0);
    let length_squared = dx * dx + dy * dy;
    let along =
        if length_squared > 0.0 { (-(x0 * dx + y0 * dy) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    (x0 + along * dx).hypot(y0 + along * dy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::{GREEN, HalfWidth, Outline, Texture};

    type Grid = (Vec<Point3<f64>>, Vec<Vector3<f64>>, Vec<[u32; 3]>);

    /// A flat grid of 1 mm cells in the plane z = 0, facing +z.
    fn grid(cells: u32) -> Grid {
        let side = cells + 1;
        let points: Vec<_> =
            (0..side * side).map(|i| Point3::new(f64::from(i % side), f64::from(i / side), 0.0)).collect();
        let triangles = (0..cells * cells)
            .map(|i| i / cells * side + i % cells)
            .flat_map(|at| [[at, at + 1, at + side + 1], [at, at + side + 1, at + side]])
            .collect();
        let normals = vec![Vector3::z(); points.len()];
        (points, normals, triangles)
    }

    #[test]
    fn a_dot_touches_the_triangles_under_it_and_no_far_ones() {
        let (rest, normals, triangles) = grid(20);
        let place = (2 * (20 * 10 + 10), [0.2, 0.5, 0.3]);
        let dot = Dot::at("m", Outline::round(1.7), place, &triangles, &rest, &normals);
        let center = dot.center;
        let layers = Layers::build(&rest, &normals, &triangles, vec![dot], vec![]);
        for triangle in 0..triangles.len() as u32 {
            let near = triangles[triangle as usize].iter().any(|&v| (rest[v as usize] - center).norm() < 1.7);
            let far = triangles[triangle as usize].iter().all(|&v| (rest[v as usize] - center).norm() > 4.5);
            let touched = !layers.touching(triangle).is_empty();
            assert!((!near || touched) && (!far || !touched), "triangle {triangle}");
        }
    }

    #[test]
    fn paint_does_not_come_off_on_a_sheet_that_no_triangle_leads_to() {
        let (mut rest, mut normals, mut triangles) = grid(10);
        let (count, faces) = (rest.len() as u32, triangles.len());
        rest.extend(rest.clone().iter().map(|point| point + Vector3::new(0.0, 0.0, 0.5)));
        normals.extend(normals.clone());
        triangles.extend(triangles.clone().iter().map(|corners| corners.map(|v| v + count)));
        let dot = Dot::at("m", Outline::round(2.0), (101, [0.4, 0.3, 0.3]), &triangles, &rest, &normals);
        let layers = Layers::build(&rest, &normals, &triangles, vec![dot], vec![]);
        assert!((faces..2 * faces).all(|triangle| layers.touching(triangle as u32).is_empty()));
    }

    #[test]
    fn layers_of_a_triangle_come_strokes_first() {
        let (rest, normals, triangles) = grid(10);
        let stroke = Stroke {
            id: "w".to_string(),
            paint: GREEN,
            left: HalfWidth::through(vec![[0.0, 1.0]]),
            right: HalfWidth::through(vec![[0.0, 1.0]]),
            range: [0.0, 10.0],
            missing: vec![],
            smear_mm: 0.0,
            texture: Texture::default(),
        };
        let vertices: Vec<u32> = (0..rest.len() as u32).collect();
        let coordinates = rest.iter().map(|point| [point.x, point.y - 5.0]).collect();
        let dot = Dot::at("m", Outline::round(1.0), (110, [0.4, 0.3, 0.3]), &triangles, &rest, &normals);
        let strokes = vec![(stroke, StrokeCoordinates { vertices, coordinates })];
        let layers = Layers::build(&rest, &normals, &triangles, vec![dot], strokes);
        let both: Vec<u32> = layers.touching(110).iter().map(|touch| touch.layer).collect();
        assert_eq!(both, [0, layers.layer_of_dot(0)]);
        assert!(layers.touching(0).is_empty());
    }

    #[test]
    fn the_distance_to_a_triangle_is_zero_inside_and_to_the_nearest_edge_outside() {
        assert_eq!(distance_from_origin(&[[-1.0, -1.0], [1.0, -1.0], [0.0, 2.0]]), 0.0);
        assert_eq!(distance_from_origin(&[[-1.0, 3.0], [1.0, 3.0], [0.0, 7.0]]), 3.0);
        assert_eq!(distance_from_origin(&[[3.0, 4.0], [10.0, 4.0], [3.0, 9.0]]), 5.0);
    }
}
